"""A zone of the view: what is seen through one field, each of its actors drawn by the zone's shader."""

from typing import Any

import numpy as np
from vtkmodules.vtkCommonCore import VTK_FLOAT
from vtkmodules.vtkRenderingCore import vtkShaderProperty
from vtkmodules.vtkRenderingOpenGL2 import vtkTextureObject

from ...layers import SeenScene
from ...optics.atlas import FieldAtlas
from ...optics.conventions import Floats
from ...optics.lens_edge import LensEdge
from . import shaders
from .camera import Frames

RULES = ("retina", "object", "paper")


class CardTable:
    """A float32 table (h, w, 1 or 4) as a texture of one window, read texel by texel."""

    def __init__(self, window: Any) -> None:
        self.window = window
        self.table: Any = None
        self.texture = vtkTextureObject()
        self.texture.SetContext(window)
        self.texture.SetMinificationFilter(vtkTextureObject.Nearest)
        self.texture.SetMagnificationFilter(vtkTextureObject.Nearest)

    def load(self, table: Any, shape: tuple[int, int, int]) -> None:
        """Put a table of this shape on the card, unless it is there already."""
        if table is self.table:
            return
        self.release()
        height, width, components = shape
        texels = np.ascontiguousarray(table, dtype=np.float32)
        self.texture.Create2DFromRaw(width, height, components, VTK_FLOAT, texels)
        self.table = table

    def unit(self) -> int:
        """The number of the texture unit that now holds the table. To be asked before each rendering."""
        self.texture.Activate()
        return int(self.texture.GetTextureUnit())

    def release(self) -> None:
        """Free the texture."""
        if self.table is not None:
            self.texture.Deactivate()
            self.texture.ReleaseGraphicsResources(self.window)
        self.table = None


class Zone:
    """Actors that are drawn by one shader and seen through one field.

    kind: "atlas" (gaze and blur come from the field's atlas), "vertices" (each vertex brings its own along), or "rim" (the
    lens's edge itself, which stands in the head's frame). side: 1 within the lens's edge, -1 beyond it. core_of: the zone
    whose triangles that lie well within the edge this one draws instead, without a test of each fragment.
    """

    def __init__(self, window: Any, kind: str, side: int = 1, core_of: "Zone | None" = None) -> None:
        self.kind, self.side, self.core = kind, side, core_of is not None
        self.field, self.edge = core_of.field if core_of else CardTable(window), CardTable(window)
        self.actors: list[Any] = []
        self.bounded, self.split = False, -1.0
        self.shader = vtkShaderProperty()
        self.uniforms = self.shader.GetVertexCustomUniforms()
        declare, place, self.test = shaders.KINDS[f"{kind} core" if self.core else kind]
        for tag, code in (
            ("//VTK::System::Dec", shaders.EXTENSION),
            ("//VTK::CustomUniforms::Dec", declare),
            ("//VTK::Camera::Dec", shaders.CAMERA),
            ("//VTK::PositionVC::Impl", "//VTK::PositionVC::Impl\n" + place),
        ):
            self.shader.AddVertexShaderReplacement(tag, True, code, False)

    def _bound(self, bounded: bool) -> None:
        """Whether fragments are tested for the zone: the test costs a third of a pass, even where it always holds."""
        if bounded == self.bounded:
            return
        self.bounded = bounded
        self.shader.ClearAllFragmentShaderReplacements()
        if bounded:
            for tag, code in (
                ("//VTK::CustomUniforms::Dec", self.test),
                ("//VTK::Color::Impl", shaders.ZONE_COLOUR + "//VTK::Color::Impl\n"),
            ):
                self.shader.AddFragmentShaderReplacement(tag, True, code, False)

    def take(self, actor: Any) -> Any:
        """Draw an actor, whose vtkPolyDataMapper must be no other zone's, in this zone. Returns the actor."""
        actor.SetShaderProperty(self.shader)
        self.actors.append(actor)
        return actor

    def see(self, seen: SeenScene, atlas: FieldAtlas) -> None:
        """Take over the eye, and the atlas if this zone reads one."""
        if self.kind != "atlas":
            return
        tiles, rows, columns, _ = atlas.table.shape
        self.field.load(atlas.table, (tiles * rows, columns, 4))
        eye, rule = seen.wearer.eye, seen.layer.accommodation
        code, limit = (RULES.index(rule), eye.accommodation) if isinstance(rule, str) else (3, float(rule))
        refraction = eye.pupil_refraction / 1000
        set_ = self.uniforms
        set_.SetUniform4f("jitGrid", [atlas.u[0], atlas.v[0], 1 / (atlas.u[1] - atlas.u[0]), atlas.plane])
        set_.SetUniform2f("jitCount", [columns, rows])
        set_.SetUniform3f("jitRefraction", [refraction[0, 0], refraction[0, 1], refraction[1, 1]])
        set_.SetUniform4f("jitEye", [eye.pupil_diameter / 2, limit / 1000, code, 0.0])

    def look(self, found: Frames, edge: LensEdge | None, split: float, parted: bool) -> None:
        """Take over the camera.

        edge: where the zone ends (None: nowhere). split: pixel left of which the zone ends too. parted: whether its core
        is drawn apart.
        """
        set_ = self.uniforms
        set_.SetUniformMatrix3x3("jitToHead", found.to_head.T.ravel().tolist())
        set_.SetUniformMatrix4x4("jitToDevice", found.to_device.T.ravel().tolist())
        self._bound(edge is not None)
        self.split = split
        if edge is not None and self.kind != "rim":
            self.edge.load(edge.radius, (1, edge.radius.size, 1))
            set_.SetUniformMatrix3x3("jitFromPixel", (edge.frame @ found.from_pixel).T.ravel().tolist())
        if self.kind != "rim":
            self._cull(found, edge, parted)

    def _cull(self, found: Frames, edge: LensEdge | None, parted: bool) -> None:
        """Which triangles are not drawn, as they lie wholly in another zone."""
        about, within = np.zeros((7, 3)), np.zeros((13, 3))
        if edge is not None:
            right = found.to_device[0, :3] if self.split >= 0 else edge.frame[2]
            if self.side > 0:
                about = np.vstack([edge.bounds(6)[0], right])
            if self.side < 0 or parted:
                within = np.vstack([edge.bounds(12)[1], right])
        self.uniforms.SetUniform1fv("jitAbout", about.size, about.ravel().tolist())
        self.uniforms.SetUniform1fv("jitWithin", within.size, within.ravel().tolist())

    def set_pass(self, point: Floats, shift: Floats, pixels: Floats) -> None:
        """The pupil's point, and the shift in device coordinates and in pixels."""
        self.uniforms.SetUniform2f("jitPoint", point.tolist())
        self.uniforms.SetUniform2f("jitShift", shift.tolist())
        self.uniforms.SetUniform4f("jitZone", [float(self.side), self.split, *pixels.tolist()])

    def bind(self) -> None:
        """Hold the textures in their units for the rendering that starts."""
        for name, table in (("jitField", self.field), ("jitEdge", self.edge)):
            if table.table is not None:
                self.uniforms.SetUniformi(name, table.unit())

    def release(self) -> None:
        """Free the textures."""
        self.field.release()
        self.edge.release()
