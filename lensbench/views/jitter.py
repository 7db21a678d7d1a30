"""What the wearer sees, drawn by multipass vertex jitter on VTK.

Each vertex is drawn at gaze + spread d, its apparent direction for the point d of the pupil; the passes over many d are
averaged in linear light. The true distance is kept, so that what is nearer hides what is farther in every pass.
Source: Kakimoto, Tatsukawa & Nishita 2010; here one pass moves all vertices in the vertex shader.
"""

from typing import Any, NamedTuple

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (the classes that draw)
from numba import njit
from numpy.typing import NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFont
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkPoints, vtkStringOutputWindow, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataObject, vtkImageData, vtkPolyData
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkShaderProperty,
    vtkTexture,
)

from ..errors import LensBenchError
from ..layers import SeenPart, SeenScene
from ..optics.conventions import Floats
from ..scenes.scene import Part
from .offscreen import require_gl

Pixels = NDArray[np.uint8]
Light = NDArray[np.float32]

_CODES = np.arange(256) / 255.0
_LIGHT_OF_CODE = np.where(_CODES <= 0.04045, _CODES / 12.92, ((_CODES + 0.055) / 1.055) ** 2.4).astype(np.float32)
_INK, _RIM_COLOUR, _RIM_WIDTH = (32, 36, 40), (46, 48, 52), 0.012

_DECLARE = """//VTK::PositionVC::Dec
in vec3 jitGaze;
in vec3 jitSpreadX;
in vec3 jitSpreadY;
in float jitReach;
"""
_PLACE = """//VTK::PositionVC::Impl
  vec3 jitSeen = normalize(jitGaze + jitPoint.x * jitSpreadX + jitPoint.y * jitSpreadY);
  gl_Position = jitProjection * vec4(jitReach * jitSeen, 1.0);
  gl_Position.xy += jitShift * gl_Position.w;
"""

# ---- light ------------------------------------------------------------------------------------------------------------


def decode(codes: Pixels) -> Light:
    """Linear light, 0 to 1, of sRGB codes of any shape. Source: IEC 61966-2-1."""
    return np.take(_LIGHT_OF_CODE, codes)


def encode(light: Light) -> Pixels:
    """sRGB codes of linear light, 0 to 1. Source: IEC 61966-2-1."""
    clipped = np.clip(light, 0.0, 1.0)
    code = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    return np.round(255 * code).astype(np.uint8)


# ---- sampling ---------------------------------------------------------------------------------------------------------


def pupil_points(passes: int, seed: int) -> Floats:
    """Points (passes, 2) of the unit disc with mean 0, in an order drawn from the seed. Source: Vogel 1979."""
    k = np.arange(passes)
    radius, angle = np.sqrt((k + 0.5) / passes), k * np.pi * (3 - np.sqrt(5))
    disc = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    return np.random.default_rng(seed).permutation(disc - disc.mean(axis=0))


def pixel_shifts(passes: int) -> Floats:
    """Shifts (passes, 2) within a pixel, -0.5 to 0.5 with mean 0: a low-discrepancy sequence. Source: Roberts 2018, R2."""
    shift = np.outer(np.arange(passes), [0.7548776662466927, 0.5698402909980532]) % 1.0
    return shift - shift.mean(axis=0)


# ---- the picture ------------------------------------------------------------------------------------------------------


def render_view(seen: SeenScene, passes: int = 48, seed: int = 0, around: Pixels | None = None) -> Pixels:
    """The picture (h, w, 3), sRGB, first row at the top, as the turning eye sees it; the wearer's right is on the right.

    passes: points of the pupil that are averaged. The same seed gives the same picture. around: the naked eye's picture
    of the same layer, if it was drawn already: it is what is seen past the lens's edge.
    Raises LensBenchError where this machine cannot draw.
    """
    require_gl()
    sampling = pupil_points(passes, seed), pixel_shifts(passes)
    width, height = seen.layer.size
    if seen.around is None:
        return encode(_average(seen, seen.through, Window(0, 0, width, height), *sampling))
    glass, rim = _lens_masks(seen)
    picture = np.zeros((height, width, 3), dtype=np.float32)
    if glass.any():
        window = _window_of(glass[..., 0])
        picture[window.slices] = _average(seen, seen.through, window, *sampling)
    past = 1 - glass
    if past.any():
        window = _window_of(past[..., 0])
        naked = _average(seen, seen.around, window, *sampling) if around is None else decode(around[window.slices])
        picture[window.slices] += past[window.slices] * (naked - picture[window.slices])
    return encode(picture + rim * (decode(np.array(_RIM_COLOUR)) - picture))


class Window(NamedTuple):
    """The part of a picture that is drawn: its upper left pixel and its size."""

    left: int
    top: int
    width: int
    height: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """The part in an array (h, w, ...) of the picture."""
        return slice(self.top, self.top + self.height), slice(self.left, self.left + self.width)


def _window_of(share: Light) -> Window:
    """The smallest window that holds every pixel (h, w) with a share."""
    rows, columns = (np.flatnonzero(share.any(axis=axis)) for axis in (1, 0))
    return Window(int(columns[0]), int(rows[0]), int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1)


def _average(seen: SeenScene, parts: tuple[SeenPart, ...], window: Window, points: Floats, shifts: Floats) -> Light:
    """Mean light (h, w, 3) in a window over the points of the pupil (n, 2) and the shifts within a pixel (n, 2)."""
    total = np.zeros((window.height, window.width, 3), dtype=np.float32)
    stage = _Stage(seen, parts, window)
    try:
        for point, shift in zip(points, shifts, strict=True):
            add_light(stage.draw(point, shift), _LIGHT_OF_CODE, total)
    finally:
        stage.close()
    return total[::-1] / np.float32(len(points))


@njit(nogil=True, cache=True)
def add_light(codes, light_of_code, total):  # type: ignore[no-untyped-def]
    """Add the light of sRGB codes (h, w, 4) to the total (h, w, 3), in place."""
    for i in range(codes.shape[0]):
        for j in range(codes.shape[1]):
            for c in range(3):
                total[i, j, c] += light_of_code[codes[i, j, c]]


class _Stage:
    """An off-screen window with the parts of a scene in it. Vertices stand in the camera's frame: right, up, back."""

    def __init__(self, seen: SeenScene, parts: tuple[SeenPart, ...], window: Window) -> None:
        self.size = window.width, window.height
        self.shader = vtkShaderProperty()
        self.shader.AddVertexShaderReplacement("//VTK::PositionVC::Dec", True, _DECLARE, False)
        self.shader.AddVertexShaderReplacement("//VTK::PositionVC::Impl", True, _PLACE, False)
        self.shader.GetVertexCustomUniforms().SetUniformMatrix4x4("jitProjection", _projection(seen, parts, window))
        self.renderer = vtkRenderer()
        self.renderer.SetBackground(*(code / 255 for code in seen.background))
        self.renderer.GetCullers().RemoveAllItems()
        for part in parts:
            self.renderer.AddActor(_actor(part, seen.frame, self.shader))
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(True)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*self.size)
        self.window.AddRenderer(self.renderer)
        self.pixels = vtkUnsignedCharArray()
        self.checked = False

    def draw(self, point: Floats, shift: Floats) -> Pixels:
        """One pass for a point of the pupil, shifted by a part of a pixel: sRGB codes (h, w, 4), lowest row first."""
        width, height = self.size
        uniforms = self.shader.GetVertexCustomUniforms()
        uniforms.SetUniform2f("jitPoint", list(point))
        uniforms.SetUniform2f("jitShift", [2 * shift[0] / width, 2 * shift[1] / height])
        if self.checked:
            self.window.Render()
        else:
            self._first_render()
        self.window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, self.pixels)
        return vtk_to_numpy(self.pixels).reshape(height, width, 4)

    def _first_render(self) -> None:
        """Render and find out whether the driver took the shader; VTK itself only prints its message."""
        actors = list(self.renderer.GetActors())
        drawn = []
        for actor in actors:
            actor.GetMapper().AddObserver("UpdateShaderEvent", lambda *_: drawn.append(True))
        listener, printer = vtkStringOutputWindow(), vtkOutputWindow.GetInstance()
        vtkOutputWindow.SetInstance(listener)
        try:
            self.window.Render()
        finally:
            vtkOutputWindow.SetInstance(printer)
        for actor in actors:
            actor.GetMapper().RemoveObservers("UpdateShaderEvent")
        if len(drawn) < len(actors):
            message = " ".join(listener.GetOutput().split())[-300:]
            raise LensBenchError(f"the graphics driver refused the shader of the view: {message or 'no message'}")
        self.checked = True

    def close(self) -> None:
        """Free what the window holds on the graphics card."""
        self.renderer.RemoveAllViewProps()
        self.window.RemoveRenderer(self.renderer)
        self.window.Finalize()


def _projection(seen: SeenScene, parts: tuple[SeenPart, ...], window: Window) -> list[float]:
    """Perspective matrix of the window, 16 numbers column by column; its near and far planes enclose every part."""
    reach = np.concatenate([part.reach for part in parts])
    near, far = 0.5 * np.nanmin(reach), 2.0 * np.nanmax(reach)
    width, height = seen.layer.size
    focal = width / np.tan(seen.layer.half_width)
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[0, 2] = focal / window.width, (2 * window.left + window.width - width) / window.width
    matrix[1, 1], matrix[1, 2] = focal / window.height, (height - 2 * window.top - window.height) / window.height
    matrix[2, 2:] = (near + far) / (near - far), 2 * near * far / (near - far)
    matrix[3, 2] = -1.0
    return matrix.T.ravel().tolist()


def _actor(part: SeenPart, frame: Floats, shader: vtkShaderProperty) -> vtkActor:
    """The part without the triangles whose vertices no ray meets, unlit, with its texture as it is."""
    camera = frame * [[-1.0], [1.0], [-1.0]]
    gaze = np.nan_to_num(part.gaze @ camera.T)
    spread = np.nan_to_num(camera @ part.spread)
    known = np.isfinite(part.gaze).all(axis=1) & np.isfinite(part.spread).all(axis=(1, 2))
    mesh = _mesh(part.part, gaze * part.reach[:, None], known)
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(mesh)
    values = {"jitGaze": gaze, "jitSpreadX": spread[..., 0], "jitSpreadY": spread[..., 1], "jitReach": part.reach}
    for name, array in values.items():
        mesh.GetPointData().AddArray(_vtk_array(name, array))
        mapper.MapDataArrayToVertexAttribute(name, name, vtkDataObject.FIELD_ASSOCIATION_POINTS, -1)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.SetShaderProperty(shader)
    actor.GetProperty().LightingOff()
    actor.SetTexture(_texture(part.part.image))
    return actor


def _mesh(part: Part, points: Floats, known: NDArray[np.bool_]) -> vtkPolyData:
    triangles = part.triangles[known[part.triangles].all(axis=1)]
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtk(np.arange(0, triangles.size + 1, 3, dtype=np.int64), deep=True),
        numpy_to_vtk(triangles.astype(np.int64).ravel(), deep=True),
    )
    places = vtkPoints()
    places.SetData(_vtk_array("points", points))
    mesh = vtkPolyData()
    mesh.SetPoints(places)
    mesh.SetPolys(cells)
    mesh.GetPointData().SetTCoords(_vtk_array("uv", part.uv))
    return mesh


def _vtk_array(name: str, values: Floats) -> Any:
    array = numpy_to_vtk(np.ascontiguousarray(values, dtype=np.float32), deep=True)
    array.SetName(name)
    return array


def _texture(image: Pixels) -> vtkTexture:
    """The image (h, w, 3) as it is: no mipmaps, whose blur no number of passes would remove."""
    height, width = image.shape[:2]
    data = vtkImageData()
    data.SetDimensions(width, height, 1)
    data.GetPointData().SetScalars(numpy_to_vtk(image[::-1].reshape(-1, 3), deep=True))
    texture = vtkTexture()
    texture.SetInputData(data)
    texture.InterpolateOn()
    texture.MipmapOff()
    texture.RepeatOff()
    texture.EdgeClampOn()
    return texture


# ---- the lens's edge --------------------------------------------------------------------------------------------------


def _lens_masks(seen: SeenScene) -> tuple[Light, Light]:
    """How much of each pixel (h, w, 1) shows the lens, and how much its rim, 0 to 1.

    The lens is seen within all rim curves; where one of them lies outside another, it is no edge.
    """
    width, height = seen.layer.size
    fine = max(1, min(4, 8192 // max(width, height)))
    glass = rim = None
    for curve in seen.rims:
        inside, edge = _curve_masks(curve, seen, fine)
        if glass is None:
            glass, rim = inside, edge
        else:
            rim = ImageChops.lighter(ImageChops.darker(rim, inside), ImageChops.darker(edge, glass))
            glass = ImageChops.darker(glass, inside)
    return tuple(_reduced(mask, fine) for mask in (glass, rim))


def _curve_masks(curve: Floats, seen: SeenScene, fine: int) -> tuple[Image.Image, Image.Image]:
    """The inside of a curve (k, 2) of the picture plane and the line along it, `fine` times finer than the picture."""
    width, height = seen.layer.size
    per_tangent = fine * width / 2 / np.tan(seen.layer.half_width)
    path = np.array([fine * width / 2, fine * height / 2]) - per_tangent * curve
    closed = [tuple(p) for p in np.clip(np.vstack([path, path[:1]]), -1e5, 1e5)]
    inside, edge = (Image.new("L", (fine * width, fine * height)) for _ in range(2))
    if len(closed) < 3:
        return inside, edge
    ImageDraw.Draw(inside).polygon(closed, 255)
    ImageDraw.Draw(edge).line(closed, 255, max(fine, round(_RIM_WIDTH * per_tangent)), "curve")
    return inside, edge


def _reduced(mask: Image.Image, fine: int) -> Light:
    return np.asarray(mask.reduce(fine), dtype=np.float32)[..., None] / np.float32(255)


# ---- pictures side by side --------------------------------------------------------------------------------------------


def side_by_side(pictures: list[tuple[str, Pixels]], caption: str) -> Pixels:
    """Pictures of one height in a row (h, w, 3), each under its title, with a caption below all."""
    height = pictures[0][1].shape[0]
    letter, gap = max(11, height // 24), max(4, height // 60)
    titles, captions = _sans("-Bold", letter), _sans("", letter)
    width = sum(picture.shape[1] + gap for _, picture in pictures) + gap
    top, bottom = 2 * letter, 2 * letter
    strip = Image.new("RGB", (width, top + height + bottom), "white")
    pen, x = ImageDraw.Draw(strip), gap
    for title, picture in pictures:
        strip.paste(Image.fromarray(picture), (x, top))
        pen.text((x + picture.shape[1] / 2, top / 2), title, _INK, titles, "mm")
        x += picture.shape[1] + gap
    pen.text((gap, top + height + bottom / 2), caption, _INK, captions, "lm")
    return np.asarray(strip)


def _sans(weight: str, size: int) -> ImageFont.FreeTypeFont:
    from matplotlib import get_data_path

    return ImageFont.truetype(f"{get_data_path()}/fonts/ttf/DejaVuSans{weight}.ttf", size)
