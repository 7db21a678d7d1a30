"""Ellipses of confusion: one flat panel a depth, and all depths in space before the eye and the lens."""

from collections.abc import Iterable, Sequence

import numpy as np
import pyvista as pv
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..layers import EllipseSheet
from ..optics.conventions import Floats
from ..optics.eye import Wearer
from ..optics.lens import Lens
from . import maps
from .bands import Bands, value_bands
from .lens3d import FOOT, in_view, opaque_bytes
from .maps import EYE, INK
from .meshes import angular_diameters, ellipse_mesh, ellipse_outlines, lens_mesh, passing
from .stage import FINENESS, snapshot, stage

_FACTORS = np.array([0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000])


def ellipse_figure(
    lens: Lens | None,
    wearer: Wearer,
    sheets: Sequence[EllipseSheet],
    exaggeration: float | None = None,
    panel: float = 3.9,
    notes: Sequence[str] = (),
) -> Figure:
    """Ellipses of confusion, one panel a depth (three in a row), as the wearer looks at them: straight ahead, the wearer's
    right (-x) to the right. Coloured by the major diameter seen from the centre of rotation (arcmin). lens None: the
    naked eye. All panels show one field of view and exaggerate alike: what is larger in a panel is larger for the eye.

    exaggeration: of all ellipses; None: see fitting_exaggeration. panel: side of a panel in inches of 100 pixels. notes:
    small print (who looks).
    """
    columns, rows = min(len(sheets), 3), -(-len(sheets) // 3)
    across = 0.85 + columns * (panel + 0.75) + 0.95
    low = maps.LINE * len(maps.wrapped(across, notes))
    up = 1.0 + rows * (panel + 0.95) + low
    figure = maps.blank_figure(across, up)
    bands, factor = ellipse_bands(sheets, wearer), exaggeration or fitting_exaggeration(sheets)
    reach = 1.04 * max(_reach(sheet, wearer, factor) for sheet in sheets)
    for k, sheet in enumerate(sheets):
        left, bottom = 0.85 + (k % 3) * (panel + 0.75), up - 1.0 - (k // 3 + 1) * (panel + 0.95) + 0.75
        axes = maps.place(figure, left, bottom, panel, panel)
        _draw_sheet(axes, sheet, wearer, bands, (factor, reach))
    maps.colour_bar(maps.place(figure, across - 0.85, 0.95 + low, 0.18, panel - 0.4), bands, "arcmin")
    maps.titles(figure, 0.85 / across, "Ellipses of confusion", lens.name if lens else "naked eye")
    eye = "naked" if lens is None else EYE[lens.side]
    scale = f"all panels {np.degrees(2 * np.arctan(reach)):.0f}° wide; " if len(sheets) > 1 else ""
    seen = f"{eye} eye, as the wearer sees it; {scale}colour: major diameter seen from the eye"
    maps.small_print(figure, *notes, seen)
    return figure


def ellipse_bands(sheets: Iterable[EllipseSheet], wearer: Wearer) -> Bands:
    """One scale of major diameters (arcmin) for several sheets."""
    return value_bands("defocus", np.concatenate([angular_diameters(sheet, wearer) for sheet in sheets]))


def fitting_exaggeration(sheets: Iterable[EllipseSheet]) -> float:
    """One factor for sheets that are compared: 1 where the large ellipses of the most blurred one are 0.6 to 1.3 times as
    wide as they are apart, else what makes them at most 1.3 times.
    """
    factor = min(_fitting(sheet) for sheet in sheets)
    return factor if np.isfinite(factor) else 1.0


def _fitting(sheet: EllipseSheet) -> float:
    """What suits one sheet; infinite where it has no ellipse to draw."""
    passed = passing(sheet)
    if not passed.any():
        return np.inf
    spread = np.ptp(sheet.centre[passed, :2], axis=0) / max(np.sqrt(sheet.status.size) - 1, 1)
    large = 2 * np.percentile(sheet.semi_major[passed], 95)
    share = large / spread.max() if spread.max() > 0 else 0.0
    if share == 0.0:
        return np.inf
    if 0.6 <= share <= 1.3:
        return 1.0
    return float(_FACTORS[max(np.searchsorted(_FACTORS, 1.3 / share, "right") - 1, 0)])


def _reach(sheet: EllipseSheet, wearer: Wearer, exaggeration: float) -> float:
    """How far from straight ahead the ellipses of a sheet reach: a tangent, seen from the centre of rotation."""
    outlines = ellipse_outlines(sheet, exaggeration)[..., :2]
    return float(np.abs(outlines).max(initial=1.0)) / (sheet.depth + wearer.eye.centre_of_rotation)


def _draw_sheet(axes: Axes, sheet: EllipseSheet, wearer: Wearer, bands: Bands, scale: tuple[float, float]) -> None:
    """One depth: filled ellipses in cm, x rising to the left as the wearer looks. scale: exaggeration, and tangent of half
    the field of view that the panel shows.
    """
    exaggeration, reach = scale
    outlines = ellipse_outlines(sheet, exaggeration)[..., :2] / 10
    angle = angular_diameters(sheet, wearer)
    faces = bands.colours[np.clip(bands.rank(angle[passing(sheet)]).astype(int), 0, len(bands.colours) - 1)]
    axes.add_collection(PolyCollection(outlines, facecolors=faces, edgecolors=0.5 * faces, linewidths=0.5))
    half = reach * (sheet.depth + wearer.eye.centre_of_rotation) / 10
    axes.set(xlim=(half, -half), ylim=(-half, half), aspect="equal", ylabel="y, cm")
    axes.set_xlabel("wearer's left ←   x, cm   → right")
    axes.set_title(_sheet_title(sheet, exaggeration), size=11, color=INK)
    maps.calm(axes)


def _sheet_title(sheet: EllipseSheet, exaggeration: float, origin: str = " from the eye") -> str:
    scale = "true scale" if exaggeration == 1.0 else f"ellipses ×{exaggeration:g}"
    return f"{sheet.depth / 10:g} cm{origin}, {scale}"


def ellipse_stack(
    lens: Lens | None,
    wearer: Wearer,
    sheets: Sequence[EllipseSheet],
    exaggeration: float | None = None,
    size: tuple[int, int] = (1300, 620),
    subtitle: str = "",
) -> NDArray[np.uint8]:
    """The eye, the lens and the ellipses before them in space, distances to scale; picture (h, w, 3).

    Depths within four times the nearest share a scene, a farther one gets its own. Colour and exaggeration: see
    ellipse_figure.
    """
    figure = maps.blank_figure(size[0] / 100, size[1] / 100)
    bands = ellipse_bands(sheets, wearer)
    factor = exaggeration or fitting_exaggeration(sheets)
    groups = _scenes([(sheet, factor) for sheet in sheets])
    room = (size[0] - 100) // len(groups), size[1] - 100
    for k, group in enumerate(groups):
        plotter = stage(room)
        frames = draw_ellipses(plotter, lens, wearer, group, bands)
        look_along(plotter, wearer, np.concatenate(frames))
        for (sheet, factor), frame in zip(group, frames, strict=True):
            spot = (in_view(plotter, frame)[1] + 1) / 2 * room + (k * room[0] - 6, FOOT + 2)
            figure.text(
                *spot / (figure.get_size_inches() * 100), _sheet_title(sheet, factor, ""), ha="right", color=INK
            )
        figure.figimage(snapshot(plotter), k * room[0], FOOT, origin="upper", zorder=-1)
    maps.titles(figure, 0.03, "Ellipses of confusion in space", lens.name if lens else "naked eye", subtitle)
    maps.colour_bar(maps.place(figure, size[0] / 100 - 0.75, 0.7, 0.18, size[1] / 100 - 1.9), bands, "arcmin")
    seen = "seen from behind the wearer's right shoulder; depths and colours from the eye (colour: major diameter)"
    maps.small_print(figure, seen)
    return maps.figure_array(figure)


def draw_ellipses(
    plotter: pv.Plotter,
    lens: Lens | None,
    wearer: Wearer,
    sheets: Sequence[tuple[EllipseSheet, float]],
    bands: Bands,
) -> list[Floats]:
    """Put the eye, the lens and sheets, each with its exaggeration, on a stage; the corners (4, 3) round each sheet, mm."""
    add_wearer(plotter, lens, wearer)
    return [_add_sheet(plotter, sheet, wearer, bands, factor) for sheet, factor in sheets]


def _scenes(sheets: Iterable[tuple[EllipseSheet, float]]) -> list[list[tuple[EllipseSheet, float]]]:
    """Sheets and their exaggerations, nearest first, grouped so that no depth exceeds four times its group's least."""
    groups: list[list[tuple[EllipseSheet, float]]] = []
    for sheet, factor in sorted(sheets, key=lambda pair: pair[0].depth):
        if not groups or sheet.depth > 4 * groups[-1][0][0].depth:
            groups.append([])
        groups[-1].append((sheet, factor))
    return groups


def add_wearer(plotter: pv.Plotter, lens: Lens | None, wearer: Wearer) -> None:
    """The eyeball, 12 mm in radius, and the worn lens."""
    plotter.add_mesh(pv.Sphere(radius=12.0, center=wearer.centre_of_rotation), color="#d9c8b8", smooth_shading=True)
    if lens is not None:
        for part in lens_mesh(lens, wearer.wear, rings=8, around=90)[:3]:
            plotter.add_mesh(part, color="#7fb2d6", opacity=0.7)


def _frame(z: float, outlines: Floats) -> Floats:
    """Corners (4, 3) of the rectangle round the ellipses at z, mm; the second is the upper one on the wearer's left."""
    rim = outlines[..., :2].reshape(-1, 2)
    (x0, y0), (x1, y1) = (rim.min(axis=0), rim.max(axis=0)) if len(rim) else ((0.0, 0.0), (0.0, 0.0))
    return np.array([[x, y, z] for x, y in ((x0, y1), (x1, y1), (x1, y0), (x0, y0))])


def _add_sheet(plotter: pv.Plotter, sheet: EllipseSheet, wearer: Wearer, bands: Bands, exaggeration: float) -> Floats:
    """The ellipses of one depth as polygons in one mesh, lines of sight to the rectangle round them; its corners."""
    outlines = ellipse_outlines(sheet, exaggeration)
    corners = _frame(wearer.corneal_apex + sheet.depth, outlines)
    plotter.add_mesh(pv.lines_from_points(corners, close=True), color="#9aa4ac", line_width=FINENESS)
    for corner in corners:
        plotter.add_mesh(pv.Line(wearer.centre_of_rotation, corner), color="#d5dade", line_width=0.7 * FINENESS)
    if not len(outlines):
        return corners
    ellipses = ellipse_mesh(sheet, wearer, exaggeration)
    ellipses.cell_data["rank"] = bands.rank(ellipses["diameter_arcmin"])
    table = pv.LookupTable(values=opaque_bytes(bands.colours), scalar_range=(0, len(bands.colours)))
    plotter.add_mesh(ellipses, scalars="rank", cmap=table, show_scalar_bar=False, lighting=False)
    return corners


def look_along(plotter: pv.Plotter, wearer: Wearer, corners: Floats) -> None:
    """Stand behind the wearer's right shoulder, so that the eye and the sheets' corners (n, 3) fill the stage."""
    deepest = corners[:, 2].max()
    plotter.camera.focal_point, plotter.camera.up = (0.0, 0.0, 0.5 * deepest), (0, 1, 0)
    plotter.camera.position = (-1.5 * deepest, 0.75 * deepest, -1.0 * deepest)
    plotter.camera.view_angle = 24
    plotter.reset_camera()
    head = wearer.centre_of_rotation + 40.0 * np.array([[-1, -1, 0], [1, 1, 0], [0, 0, 1]])
    reach = np.abs(in_view(plotter, np.vstack([head, corners]))).max(axis=0)
    plotter.camera.zoom(float((np.array([0.95, 0.9]) / reach).min()))
