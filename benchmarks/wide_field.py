"""After figure 14 of the paper: the upper left quarter of a field of 100 degrees, a layer of large ellipses by each scheme."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

import lensbench as lb
from lensbench.optics.conventions import Floats
from lensbench.optics.field import GazeField
from lensbench.views import maps

from . import schemes

HALF_ANGLE, ROWS, PLANE, EXAGGERATION = 50.0, 10, 270.0, 4.0  # degrees, in the quarter, mm, times
RIM = np.stack([np.cos(turn := np.linspace(0, 2 * np.pi, 48)), np.sin(turn)])
PANEL = 3.6  # inches


def wide_figure(lens: lb.Lens, wearer: lb.Wearer, about: str) -> Figure:
    """Ellipses by Table 1, Table 2 and the gaze field, each over the real rays that it stands for, and real rays alone."""
    field = quarter(lens, wearer)
    landed = schemes.real_rays(field, PLANE)
    real = schemes.real_ellipses(field, PLANE)[0]
    figure = maps.blank_figure(0.9 + 4 * (PANEL + 0.25), PANEL + 1.95)
    found = {"Table 1": schemes.by_table_1, "Table 2": schemes.by_table_2, "LensBench": schemes.ours, "real rays": None}
    for k, (name, scheme) in enumerate(found.items()):
        axes = maps.place(figure, 0.8 + k * (PANEL + 0.25), 0.75, PANEL, PANEL)
        draw_spots(axes, field, landed, "#8c959d" if scheme else maps.INK)
        title = f"{name}, 128 through the pupil"
        if scheme is not None:
            matrices = scheme(field, PLANE)
            draw_outlines(axes, field, matrices)
            title = f"{name}: {deviation(schemes.sizes(matrices)[0] / real)}"
        finish(axes, title, first=k == 0)
    title = f"A layer at {PLANE / 10:g} cm in a field of {2 * HALF_ANGLE:g}°, upper left quarter"
    maps.titles(figure, 0.8 / figure.get_size_inches()[0], title, about, f"all ellipses and spots ×{EXAGGERATION:g}")
    maps.small_print(
        figure,
        "each at the direction in which it is seen, as the wearer looks at it; outlines: by the scheme; dots: real rays",
    )
    return figure


def deviation(ratio: Floats) -> str:
    """In words: how far rms sizes are from real rays' (n,), NaN where a scheme has no answer."""
    off, lost = np.abs(ratio - 1), int(np.isnan(ratio).sum())
    found = f"rms size off by {np.nanmedian(off):.1%}, at most {np.nanmax(off):.0%}"
    return f"{found}\nno answer for {lost} of {off.size} rays" if lost else found


def quarter(lens: lb.Lens, wearer: lb.Wearer) -> GazeField:
    """Gazes up and to the wearer's left whose whole pencils pass the lens."""
    half = float(np.radians(HALF_ANGLE))
    field = schemes.passing_field(lens, wearer, lb.GazeGrid(2 * ROWS, 2 * ROWS, half, half))
    field = field.take((field.directions[:, :2] > 0).all(axis=1))
    return field.take(np.isfinite(schemes.real_rays(field, PLANE)).all(axis=(1, 2)))


def in_view(field: GazeField, offsets: Floats) -> Floats:
    """x, y (n, m, 2), cm, of exaggerated offsets (n, m, 2), mm, across the outgoing rays, about where these are seen."""
    seen = PLANE * field.directions[:, :2] / field.directions[:, 2:]
    return (seen[:, None] + EXAGGERATION * offsets) / 10


def draw_spots(axes: Axes, field: GazeField, landed: Floats, colour: str) -> None:
    """Where real rays land."""
    spots = in_view(field, landed).reshape(-1, 2)
    axes.plot(*spots.T, ".", color=colour, markersize=0.9, markeredgewidth=0)


def draw_outlines(axes: Axes, field: GazeField, matrices: Floats) -> None:
    """Ellipses of blur matrices (n, 2, 2), mm."""
    rims = in_view(field, np.swapaxes(matrices @ RIM, 1, 2))
    axes.add_collection(PolyCollection(rims, facecolors="none", edgecolors="#b3261e", linewidths=0.9))


def finish(axes: Axes, title: str, first: bool) -> None:
    """One scale for all panels, x rising to the left."""
    reach = 1.04 * PLANE / 10 * np.tan(np.radians(HALF_ANGLE))
    axes.set(xlim=(reach, 0), ylim=(0, reach), aspect="equal", xlabel="wearer's left ←   x, cm")
    axes.set_title(title, size=10, color=maps.INK)
    maps.calm(axes)
    if first:
        axes.set_ylabel("y, cm")
    else:
        axes.tick_params(labelleft=False)
