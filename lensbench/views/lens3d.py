"""The worn lens in space, with a map on its front surface."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyvista as pv
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..layers import LensMap
from ..optics.conventions import Floats
from ..optics.eye import Wearer
from ..optics.gaze import WornPose, worn_pose
from ..optics.lens import Lens
from . import maps
from .bands import Bands, map_bands
from .maps import EYE, INK, QUIET
from .meshes import LensMesh, lens_mesh, map_and_rest
from .stage import FINENESS, snapshot, stage

_LIGHT = {"ambient": 0.85, "diffuse": 0.2, "specular": 0.0}
_VIEW = (0.62, 0.4, 1.0)  # towards the camera, wear frame, left lens: before the wearer, on the temporal side, above
_FILLED = np.array([0.8, 0.96])  # of half the stage's width and height
FOOT = 30  # pixels below the stage, for the small print


def map_on_lens(
    lens: Lens,
    wearer: Wearer,
    lens_map: LensMap,
    size: tuple[int, int] = (800, 600),
    limits: tuple[float, float] | None = None,
    subtitle: str = "",
    notes: Sequence[str] = (),
) -> NDArray[np.uint8]:
    """The worn lens (wear frame) obliquely from the front, the map as bands and isolines on it; picture (h, w, 3).

    size: (width, height) pixels; limits, notes: as in maps.map_figure.
    """
    mesh = lens_mesh(lens, wearer.wear)
    bands = map_bands(lens, lens_map, None, limits)
    foot = FOOT + round(100 * maps.LINE * len(maps.wrapped(size[0] / 100, notes)))
    room = size[0] - 100, size[1] - 70 - foot
    plotter = stage(room)
    for actor in lens_actors(lens, wearer, mesh, (lens_map, bands)):
        plotter.add_actor(actor, reset_camera=False)
    look_at_lens(plotter, mesh, lens.side)
    figure = maps.blank_figure(size[0] / 100, size[1] / 100)
    _name_sides(figure, plotter, mesh, lens.side, (*room, foot))
    figure.figimage(snapshot(plotter), 0, foot, origin="upper", zorder=-1)
    maps.titles(figure, 0.03, lens_map.label, lens.name, subtitle)
    if np.isfinite(lens_map.values).any():
        bar = maps.place(figure, size[0] / 100 - 0.95, foot / 100 + 0.4, 0.2, room[1] / 100 - 0.9)
        maps.colour_bar(bar, bands, lens_map.unit)
    else:
        figure.text(0.03, (foot + 6) / size[1], "no ray passes: the lens is bare", size=10, color=INK)
    maps.small_print(figure, *notes, f"{EYE[lens.side]} lens as worn, seen from the front, above and the temporal side")
    return maps.figure_array(figure)


def lens_actors(lens: Lens, wearer: Wearer, mesh: LensMesh, layer: tuple[LensMap, Bands]) -> list[pv.Actor]:
    """A worn lens for a stage: its body, a map with its bands on it, and its reference marks. Any thread may make them."""
    return [*_body(mesh), *_map(mesh, *layer), *_marks(lens, worn_pose(lens, wearer.wear))]


def _actor(mesh: pv.PolyData, **look: Any) -> pv.Actor:
    return pv.Actor(pv.DataSetMapper(mesh), pv.Property(**look))


def _line(mesh: pv.PolyData, colour: Any, width: float) -> pv.Actor:
    return _actor(mesh, color=colour, line_width=width * FINENESS, lighting=False)


def _body(mesh: LensMesh) -> list[pv.Actor]:
    half = mesh.edge.n_points // 2
    rims = [pv.lines_from_points(rim, close=True) for rim in (mesh.edge.points[:half], mesh.edge.points[half:])]
    return [
        _actor(mesh.back, color="#b9c3cb", opacity=0.6, **_LIGHT),
        _actor(mesh.edge, color="#c9d2d9", **_LIGHT),
        *(_line(rim, "#39424a", 1.2) for rim in rims),
    ]


def _map(mesh: LensMesh, lens_map: LensMap, bands: Bands) -> list[pv.Actor]:
    """The front surface in exact bands, bare where the map has no value, with isolines 0.05 mm before it."""
    layer, bare = map_and_rest(mesh, lens_map)
    found = [_actor(bare, color="#e3e8ec", **_LIGHT)] if bare.n_cells else []
    if not layer.n_cells:
        return found
    data = layer.cell_data if bands.cyclic else layer.point_data
    data["rank"] = np.nan_to_num(bands.rank(data[lens_map.column]))
    found.append(_banded(layer, bands))
    return found if bands.cyclic or bands.constant else [*found, *_isolines(layer, bands)]


def _banded(layer: pv.PolyData, bands: Bands) -> pv.Actor:
    """A mesh with its "rank" in the colours of the bands."""
    actor = _actor(layer, **_LIGHT)
    actor.mapper.lookup_table = pv.LookupTable(values=opaque_bytes(bands.colours), scalar_range=(0, len(bands.colours)))
    actor.mapper.scalar_range = 0, len(bands.colours)
    actor.mapper.scalar_map_mode = "cell_field" if bands.cyclic else "point_field"
    actor.mapper.array_name = "rank"
    actor.mapper.interpolate_before_map = True
    return actor


def opaque_bytes(colours: Floats) -> NDArray[np.uint8]:
    """Colours (k, 3), 0 to 1, as opaque bytes (k, 4)."""
    return np.round(np.insert(colours, 3, 1.0, axis=1) * 255).astype(np.uint8)


def _isolines(layer: pv.PolyData, bands: Bands) -> list[pv.Actor]:
    ranks, looks = bands.rank(bands.shifted), list(zip(bands.weight, bands.line_colours(), strict=True))
    found = []
    for weight, colour in set(looks):
        levels = [r for r, look in zip(ranks, looks, strict=True) if look == (weight, colour) and r > 0]
        lines = layer.contour(levels, scalars="rank") if levels else pv.PolyData()
        if lines.n_points:
            lines.points += 0.05 * lines["Normals"]
            lines.clear_data()
            found.append(_line(lines, colour, (0.7, 1.3, 2.2)[weight]))
    return found


def _marks(lens: Lens, pose: WornPose) -> list[pv.Actor]:
    """The reference marks on the front surface, dark upon white."""
    marks, found = lens.points.named().items(), []
    for colour, width, height in (("white", 5.5, 0.12), (INK, 2.2, 0.2)):
        lines = [_mark(lens, pose, *shape, height) for mark in marks for shape in _shapes(*mark)]
        there = [pv.lines_from_points(line) for line in lines if np.isfinite(line).all()]
        if there:
            found.append(_line(pv.merge(there), colour, width))
    return found


def _shapes(name: str, point: tuple[float, float]) -> list[tuple[Floats, Floats]]:
    """The lines x, y (n,) of a mark: a cross, a dot or a ring (1.3 mm in radius for far, 0.9 mm for near)."""
    turn = np.linspace(0, 2 * np.pi, 37)
    radius = {"distance_reference_point": 1.3, "near_reference_point": 0.9}.get(name, 0.2)
    shapes = [(radius * np.cos(turn), radius * np.sin(turn))]
    if name == "fitting_point":
        arm = np.linspace(-1.8, 1.8, 13)
        shapes = [(arm, 0 * arm), (0 * arm, arm)]
    return [(x + point[0], y + point[1]) for x, y in shapes]


def _mark(lens: Lens, pose: WornPose, x: Floats, y: Floats, height: float) -> Floats:
    return pose.to_wear(np.column_stack([x, y, lens.front_height(x, y) + height]))


def look_at_lens(plotter: pv.Plotter, mesh: LensMesh, side: str) -> None:
    """Stand before the wearer, above and on the temporal side of the lens, and fill the stage with it."""
    direction = np.array(_VIEW) * (-1 if side == "R" else 1, 1, 1)
    middle = np.array(mesh.front.center)
    plotter.camera.focal_point, plotter.camera.up = middle, (0, 1, 0)
    plotter.camera.position = middle + 300 * direction / np.linalg.norm(direction)
    plotter.camera.view_angle = 16
    plotter.reset_camera()
    reach = np.abs(in_view(plotter, mesh.edge.points)).max(axis=0)
    plotter.camera.zoom(float((_FILLED / reach).min()))


def in_view(plotter: pv.Plotter, points: Floats) -> Floats:
    """Where points (n, 3) appear: (n, 2), -1 to 1 over the stage's width and height, up positive."""
    width, height = plotter.window_size
    matrix = plotter.camera.GetCompositeProjectionTransformMatrix(width / height, -1, 1)
    to_view = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
    seen = np.column_stack([points, np.ones(len(points))]) @ to_view.T
    return seen[:, :2] / seen[:, 3:]


def _name_sides(figure: Figure, plotter: pv.Plotter, mesh: LensMesh, side: str, room: tuple[int, int, int]) -> None:
    """Write "nasal" and "temporal" beside the lens: at -x on the left, at +x on the right of the picture.

    room: width and height of the stage, height of what is below it, pixels.
    """
    pixels = (in_view(plotter, mesh.edge.points) + 1) / 2 * room[:2] + [0, room[2]]
    words = ("temporal", "nasal") if side == "R" else ("nasal", "temporal")
    for word, align, gap, last in zip(words, ("right", "left"), (-8, 8), (np.argmin, np.argmax), strict=True):
        spot = (pixels[last(pixels[:, 0])] + [gap, 0]) / figure.get_size_inches() / 100
        figure.text(*spot, word, ha=align, va="center", size=9, color=QUIET)
