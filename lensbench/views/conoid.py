"""One conoid: how light from the pupil spreads along a gaze, in space and as a profile of its semi-axes."""

from collections.abc import Iterable

import numpy as np
import pyvista as pv
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ..optics.conoid import Conoid, GazeConoids
from ..optics.conventions import Floats
from ..optics.eye import Wearer
from ..optics.lens import Lens
from . import maps
from .ellipses import add_wearer
from .lens3d import in_view
from .stage import FINENESS, snapshot, stage

COLOURS = {"relaxed": "#2f6fb5", "tense": "#d9822b", "used": "#202428"}
LINES, CIRCLE = "#b3261e", "#1d7a46"
AROUND, ALONG = 72, 60
WIDE, TALL, BELOW = 1200, 430, 440  # pixels: the stage, and what is below it
SKIN = "#8fa3b3"
Words = list[tuple[Floats, str]]


def conoid_picture(
    lens: Lens | None,
    wearer: Wearer,
    found: GazeConoids,
    exaggeration: float | None = None,
    about: Iterable[str] = (),
) -> NDArray[np.uint8]:
    """The conoid in space above, its signed semi-axes along the ray and the numbers below; picture (h, w, 3)."""
    factor = exaggeration or fitting_factor(found)
    figure = maps.blank_figure(WIDE / 100, (BELOW + TALL + 80) / 100)
    plotter = stage((WIDE, TALL))
    words = draw_conoid(plotter, lens, wearer, found, factor)
    look_at_conoid(plotter, found)
    _write_words(figure, plotter, words)
    figure.figimage(snapshot(plotter), 0, BELOW, origin="upper", zorder=-1)
    draw_profile(maps.place(figure, 0.8, 0.75, 6.6, 3.25), found)
    _write_numbers(figure, found)
    maps.titles(figure, 0.8 / (WIDE / 100), "Conoid of a gaze", lens.name if lens else "naked eye", *about)
    maps.small_print(
        figure,
        f"above: seen from the wearer's right, ×{factor:g} across the ray; distances along it count from the front surface",
    )
    return maps.figure_array(figure)


def fitting_factor(found: GazeConoids) -> float:
    """By how much the conoid is drawn wider, so that it is a sixth as wide as long and no ellipse at the object is half as
    wide; from 1, 2, 5, 10, ...
    """
    used = found.used.eoc(np.array([0.0, found.reach()])).semi_major.max()
    others = max(conoid.eoc(found.reach()).semi_major for conoid in found.states.values())
    wanted = found.reach() / max(12 * used, 4 * others)
    steps = np.array([1, 2, 5, 10, 20, 50, 100])
    return float(steps[max(np.searchsorted(steps, wanted, "right") - 1, 0)])


def draw_conoid(plotter: pv.Plotter, lens: Lens | None, wearer: Wearer, found: GazeConoids, factor: float) -> Words:
    """Put the eye, the lens and the conoid on a stage; what is to be written where (mm, wear frame)."""
    add_wearer(plotter, lens, wearer)
    end = found.exit + found.reach() * found.frame[2]
    plotter.add_mesh(pv.Line(found.pupil, end), color="#9aa4ac", line_width=FINENESS)
    plotter.add_mesh(_surface(found, factor), color=SKIN, opacity=0.35, smooth_shading=True)
    words: Words = []
    if np.isfinite(found.distance):
        words += [_draw_ellipse(plotter, found, name, factor) for name in ("used", "relaxed", "tense")][:1]
    used = found.used
    for distance in set(used.focal_lines):
        if 0 < distance <= found.reach():
            rim = _rim(found, used, distance, factor)
            plotter.add_mesh(pv.lines_from_points(rim, close=True), color=LINES, line_width=4 * FINENESS)
            words.append((rim[np.argmax(rim[:, 1])], f"focal line {_text(distance)}"))
    if 0 < used.least_confusion <= found.reach() and len(set(used.focal_lines)) > 1:
        rim = _rim(found, used, used.least_confusion, factor)
        plotter.add_mesh(pv.lines_from_points(rim, close=True), color=CIRCLE, line_width=3 * FINENESS)
        words.append((rim[np.argmax(rim[:, 1])], f"least confusion {_text(used.least_confusion)}"))
    return words


def look_at_conoid(plotter: pv.Plotter, found: GazeConoids) -> None:
    """Stand on the wearer's right, a little above and behind, the ray from left to right."""
    start, end = found.pupil - 25 * found.across[2], found.exit + found.reach() * found.frame[2]
    middle, length = (start + end) / 2, float(np.linalg.norm(end - start))
    plotter.camera.focal_point, plotter.camera.up = middle, (0, 1, 0)
    plotter.camera.position = middle + 3 * length * np.array([-0.93, 0.28, -0.22])
    plotter.camera.view_angle = 20
    plotter.renderer.ResetCameraClippingRange()
    plotter.reset_camera()
    drawn = np.vstack([actor.mapper.dataset.points for actor in plotter.actors.values()])
    reach = np.abs(in_view(plotter, drawn)).max(axis=0)
    plotter.camera.zoom(float((np.array([0.94, 0.9]) / reach).min()))


def _rim(found: GazeConoids, conoid: Conoid, distance: float, factor: float) -> Floats:
    """Rim (m, 3), mm, of the exaggerated ellipse at a distance."""
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    across = (conoid.blur(distance) @ np.stack([np.cos(turn), np.sin(turn)])).T @ found.frame[:2]
    return found.exit + distance * found.frame[2] + factor * across


def _surface(found: GazeConoids, factor: float) -> pv.StructuredGrid:
    """The used conoid from the pupil on."""
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    pupil = found.pupil + factor * found.pupil_radius * np.stack([np.cos(turn), np.sin(turn)], 1) @ found.across[:2]
    rims = [pupil, *(_rim(found, found.used, s, factor) for s in np.linspace(0, found.reach(), ALONG))]
    points = np.stack([np.vstack([rim, rim[:1]]) for rim in rims])
    return pv.StructuredGrid(*np.moveaxis(points, -1, 0))


def _draw_ellipse(plotter: pv.Plotter, found: GazeConoids, name: str, factor: float) -> tuple[Floats, str]:
    rim = _rim(found, found.states[name], found.distance, factor)
    width = (4 if name == "used" else 1.8) * FINENESS
    plotter.add_mesh(pv.lines_from_points(rim, close=True), color=COLOURS[name], line_width=width)
    return rim[np.argmax(rim[:, 1])], f"object {_text(found.distance)}"


def _text(distance: float) -> str:
    """A distance (mm) along the ray for a reader."""
    if not np.isfinite(distance):
        return "infinity"
    return f"{distance / 10:.1f} cm" if abs(distance) < 1000 else f"{distance / 1000:.2f} m"


def _write_words(figure: Figure, plotter: pv.Plotter, words: Words) -> None:
    """Each above its point, or above what is written there."""
    taken: list[tuple[float, float]] = []
    size = figure.get_size_inches() * 100
    halo = [withStroke(linewidth=3, foreground="white")]
    for point, word in words:
        x, y = (in_view(plotter, np.asarray(point)[None])[0] + 1) / 2 * (WIDE, TALL) + (0, BELOW + 9)
        while any(abs(x - other[0]) < 140 and abs(y - other[1]) < 16 for other in taken):
            y += 17
        taken.append((x, y))
        figure.text(x / size[0], y / size[1], word, ha="center", size=9, color=maps.INK, path_effects=halo)


def draw_profile(axes: Axes, found: GazeConoids) -> None:
    """Signed semi-axes, mm, against the distance along the ray, cm: a focal line where one passes zero."""
    distance = np.linspace(0.0, found.reach(), 400)
    for name in ("used", "relaxed", "tense"):
        width = 3.2 if name == "used" else 1.3
        for axis, label in zip(found.states[name].signed_axes(distance), (name, None), strict=True):
            axes.plot(distance / 10, axis, color=COLOURS[name], linewidth=width, label=label)
    used = found.used
    axes.fill_between(distance / 10, *used.signed_axes(distance), color=SKIN, alpha=0.2, linewidth=0)
    axes.axhline(0, color=maps.QUIET, linewidth=0.9)
    axes.axvline(found.distance / 10, color=maps.QUIET, linewidth=1.2, linestyle=":", label="object")
    limits = axes.get_ylim()
    axes.plot(np.array(used.focal_lines) / 10, [0, 0], "o", color=LINES, markersize=8, zorder=5, label="focal lines")
    circle = used.least_confusion
    axes.plot(
        [circle / 10] * 2,
        np.ravel(used.signed_axes(circle)),
        "o-",
        color=CIRCLE,
        markersize=5,
        zorder=4,
        label="least confusion",
    )
    axes.set(
        xlim=(0, found.reach() / 10), xlabel="along the ray from the front surface, cm", ylabel="signed semi-axes, mm"
    )
    axes.set_ylim(limits)
    maps.calm(axes)
    axes.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=6, fontsize=8.5, frameon=False, columnspacing=1.2)


def _write_numbers(figure: Figure, found: GazeConoids) -> None:
    """Accommodation, focal lines, circle of least confusion and the ellipse at the object, state by state."""
    axes = maps.place(figure, 7.75, 0.75, 4.25, 3.4)
    axes.axis("off")
    rows = (
        "accommodation",
        "focal lines",
        "",
        "least confusion",
        "its diameter",
        f"axes at {_text(found.distance)}",
        "",
    )
    for k, row in enumerate(rows):
        axes.text(0, 0.86 - 0.12 * k, row, size=9, color=maps.QUIET, transform=axes.transAxes)
    for j, (name, conoid) in enumerate(found.states.items()):
        x = 0.48 + 0.21 * j
        axes.text(x, 1.0, name, size=10, weight="bold", color=COLOURS[name], ha="center", transform=axes.transAxes)
        for k, cell in enumerate(_cells(conoid, found.distance)):
            axes.text(x, 0.86 - 0.12 * k, cell, size=9, color=maps.INK, ha="center", transform=axes.transAxes)


def _cells(conoid: Conoid, distance: float) -> tuple[str, ...]:
    """What is said of one state."""
    at, circle = conoid.eoc(distance), conoid.least_confusion
    diameter = f"{2 * conoid.eoc(circle).semi_major:.2f} mm" if np.isfinite(circle) else "-"
    axes = (f"{2 * at.semi_major:.2f} mm", f"{2 * at.semi_minor:.2f} mm") if np.isfinite(distance) else ("-", "-")
    return (
        f"{conoid.accommodation:.2f} D",
        *(_text(line) for line in conoid.focal_lines),
        _text(circle),
        diameter,
        *axes,
    )
