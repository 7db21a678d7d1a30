"""The worn lens in space with a map on it, and the ellipses of confusion in space."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QVBoxLayout
from pyvista import Actor

from ..layers import EllipseLayer, EllipseSheet, Probe
from ..optics.conventions import Floats
from ..optics.eye import Wearer
from ..optics.gaze import worn_pose
from ..optics.lens import Lens
from ..session import Pane, Workbench
from ..views.bands import Bands
from ..views.ellipses import draw_ellipses, ellipse_bands, fitting_exaggeration, look_along
from ..views.lens3d import lens_actors, look_at_lens
from ..views.meshes import LensMesh, lens_mesh
from .colour_bar import ColourBar
from .content import Content
from .map_source import BandedMap, map_question
from .scene_source import answer_with_scene
from .stage_widget import StageWidget

RINGS, AROUND = 30, 180
SIDES = {  # direction towards the camera and what is up, wear frame
    "the front": ((0, 0, 1), (0, 1, 0)),
    "behind": ((0, 0, -1), (0, 1, 0)),
    "above": ((0, 1, 0), (0, 0, -1)),
    "the wearer's right": ((-1, 0, 0), (0, 1, 0)),
    "the wearer's left": ((1, 0, 0), (0, 1, 0)),
}


class SpaceContent(Content):
    """A stage with a colour bar below. camera_moved(): by the user."""

    camera_moved = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.stage, self.bar = StageWidget(), ColourBar()
        layout = QVBoxLayout(self, spacing=0)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.stage, 1)
        layout.addWidget(self.bar)
        self.stage.turned.connect(self.camera_moved)
        self.stage.haste = lambda: self.haste()

    @property
    def bands(self) -> Bands | None:
        """The scale that is shown."""
        return self.bar.bands

    def look(self, name: str) -> None:
        """Look from one of SIDES, or from the place where the camera was at first ("")."""
        if name:
            self.stage.look_from(*SIDES[name])
        elif self.stage.stage is not None:
            self.look_first(self.stage.stage)
            self.stage.refresh()

    @property
    def at_rest(self) -> bool:
        return self.stage.at_rest

    def look_first(self, plotter: Any) -> None:
        """Place the camera where it stands at first."""
        raise NotImplementedError

    def close_stage(self) -> None:
        self.stage.close_stage()


class LensContent(SpaceContent):
    """The worn lens, a map on its front surface."""

    def __init__(self) -> None:
        super().__init__()
        self._lens: tuple[Lens, Wearer, LensMesh] | None = None
        self._looked: tuple[Any, ...] = ()
        self.stage.hovered.connect(self._hovered)

    def question(self, bench: Workbench, pane: Pane) -> Any:
        question = map_question(bench, pane)
        if question is None:
            return None
        key, found = question
        return key, partial(_in_space, found)

    def show_answer(self, answer: tuple[BandedMap, LensMesh, list[Actor]], bench: Workbench, pane: Pane) -> None:
        (lens, wearer, lens_map, bands, _), mesh, actors = answer
        self._lens = lens, wearer, mesh

        def put(plotter: Any) -> None:
            for actor in actors:
                plotter.add_actor(actor, reset_camera=False)
            if self._looked != (lens.side, lens.outline):
                self._looked = lens.side, lens.outline
                self.look_first(plotter)

        rim = np.asarray(mesh.edge.points)
        left, right = ("temporal", "nasal") if lens.side == "R" else ("nasal", "temporal")
        self.stage.words = [(rim[np.argmin(rim[:, 0])], left), (rim[np.argmax(rim[:, 0])], right)]
        self.stage.draw(put)
        self.bar.show_bands(bands, lens_map.label, lens_map.unit)

    def look_first(self, plotter: Any) -> None:
        if self._lens is not None:
            lens, _, mesh = self._lens
            look_at_lens(plotter, mesh, lens.side)

    def show_probe(self, probe: Probe | None) -> None:
        self.stage.mark = None if probe is None else probe.exit
        self.stage.update()

    def _hovered(self, across: float, up: float) -> None:
        """Where the line of sight under the pointer meets the front surface (found on its mesh)."""
        if self._lens is None or self.stage.stage is None:
            return
        lens, wearer, mesh = self._lens
        renderer = self.stage.stage.renderer
        ends = []
        for depth in (0.0, 1.0):
            renderer.SetViewPoint(across, up, 2 * depth - 1)
            renderer.ViewToWorld()
            ends.append(np.array(renderer.GetViewPoint()))
        points, _ = mesh.front.ray_trace(*ends)
        if len(points):
            at = min(points, key=lambda p: float(np.linalg.norm(p - ends[0])))
            x, y, _z = worn_pose(lens, wearer.wear).to_lens(at)
            self.pointed.emit((float(x), float(y)), None)


def _in_space(found: Callable[[], BandedMap]) -> tuple[BandedMap, LensMesh, list[Actor]]:
    banded = found()
    mesh = lens_mesh(banded.lens, banded.wearer.wear, RINGS, AROUND)
    return banded, mesh, lens_actors(banded.lens, banded.wearer, mesh, (banded.lens_map, banded.bands))


class EllipsesContent(SpaceContent):
    """The eye, the lens, and ellipses of confusion at the depths of the workbench."""

    def __init__(self) -> None:
        super().__init__()
        self._looked: tuple[float, ...] = ()
        self._sights: tuple[Wearer, Floats] | None = None

    def question(self, bench: Workbench, pane: Pane) -> Any:
        lens = bench.lens_of(pane)
        wearer = bench.worn_by(lens)
        layer = EllipseLayer(bench.depths, 20, accommodation=bench.accommodation)
        return (lens, wearer, layer, pane), partial(answer_with_scene, lens, wearer, layer, "")

    def show_answer(self, answer: tuple[EllipseSheet, ...], bench: Workbench, pane: Pane) -> None:
        lens = bench.lens_of(pane)
        wearer = bench.worn_by(lens)
        bands = ellipse_bands(answer, wearer)
        common = fitting_exaggeration(answer)
        sheets = [(sheet, common) for sheet in answer]

        def put(plotter: Any) -> None:
            corners = draw_ellipses(plotter, lens, wearer, sheets, bands)
            self.stage.words = [
                (corner[1], f"{sheet.depth:g} mm from the eye" + (f", ×{factor:g}" if factor != 1 else ""))
                for corner, (sheet, factor) in zip(corners, sheets, strict=True)
            ]
            self._sights = wearer, np.concatenate(corners)
            if self._looked != bench.depths:
                self._looked = bench.depths
                self.look_first(plotter)

        self.stage.draw(put)
        self.bar.show_bands(bands, "Major diameter of the ellipses seen from the eye", "arcmin")

    def look_first(self, plotter: Any) -> None:
        if self._sights is not None:
            look_along(plotter, *self._sights)

    def show_probe(self, probe: Probe | None) -> None:
        nearest = min(self._looked, default=0.0)
        self.stage.mark = None if probe is None else probe.exit + nearest * probe.outgoing
        self.stage.update()
