"""A pair of lenses on one page: the convergence path over both, and what differs between the eyes over the gaze."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from ..optics.lens import Lens
from ..pair import ConvergencePath, PairMap, PairRequest, PairResult, PathOnLens
from . import maps
from .bands import value_bands
from .maps import INK, QUIET

_RIGHT, _LEFT = "#1f6aa5", "#c2571a"
_NAMED = (0.0, 10.0, 20.0, 30.0)  # lowerings written beside the path, degrees


def pair_figure(request: PairRequest, result: PairResult, subtitle: str = "") -> Figure:
    """One page, seen from in front of the wearer: the right lens on the left."""
    figure = maps.blank_figure(15.0, 16.0)
    pair, path = request.pair, result.path
    _draw_lens(maps.place(figure, 0.8, 10.6, 4.3, 4.3), pair.right, path, path.right, _RIGHT)
    _draw_lens(maps.place(figure, 5.7, 10.6, 4.3, 4.3), pair.left, path, path.left, _LEFT)
    _draw_ways(maps.place(figure, 11.2, 10.6, 1.5, 4.0), maps.place(figure, 13.0, 10.6, 1.5, 4.0), path)
    for k, found in enumerate(result.maps.values()):
        left, bottom = 0.8 + (k % 3) * 4.9, 5.3 - (k // 3) * 4.4
        _draw_map(figure, (left, bottom), found)
    names = pair.right.name if pair.right.name == pair.left.name else f"{pair.right.name}  /  {pair.left.name}"
    maps.titles(figure, 0.8 / 15.0, "Both eyes", names, subtitle)
    maps.small_print(
        figure, "seen from the front: the right lens on the left; R less L, each eye against its prescription"
    )
    return figure


def _draw_lens(axes: Axes, lens: Lens, path: ConvergencePath, way: PathOnLens, colour: str) -> None:
    """Outline, main meridian, convergence path and reference points of one lens."""
    x0, x1, y0, y1 = lens.outline.box
    reach = 0.53 * max(x1 - x0, y1 - y0)
    middle = (x0 + x1) / 2, (y0 + y1) / 2
    axes.add_patch(Polygon(np.transpose(lens.outline.points()), facecolor="#f3f7fa", edgecolor=INK, linewidth=1.3))
    y = np.linspace(y0, y1, 200)
    inside = lens.outline.contains(lens.meridian_x(y), y)
    axes.plot(
        lens.meridian_x(y)[inside], y[inside], color=QUIET, linewidth=1.1, linestyle=(0, (5, 3)), label="main meridian"
    )
    axes.plot(way.x, way.y, color=colour, linewidth=2.2, label="convergence path")
    for lowering in _NAMED:
        k = int(np.argmin(np.abs(path.lowering - lowering)))
        if np.isfinite(way.x[k]):
            axes.plot(way.x[k], way.y[k], "o", color=colour, markersize=4)
            spot = {"xytext": (8, 0), "textcoords": "offset points", "va": "center", "size": 8.5, "color": INK}
            axes.annotate(f"{lowering:.0f}°", (way.x[k], way.y[k]), **spot)
    maps.draw_marks(axes, lens)
    axes.set(xlim=(middle[0] - reach, middle[0] + reach), ylim=(middle[1] - reach, middle[1] + reach), ylabel="y, mm")
    sides = ("temporal", "nasal") if lens.side == "R" else ("nasal", "temporal")
    axes.set_xlabel(f"{sides[0]}  ←  x, mm  →  {sides[1]}")
    axes.set_title(f"{maps.EYE[lens.side]} lens", size=11, color=INK)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, fontsize=8, frameon=False, columnspacing=1.2)
    maps.calm(axes)


def _draw_ways(off: Axes, imbalance: Axes, path: ConvergencePath) -> None:
    """Along the path: how far it lies from each lens's meridian, and what the lenses ask of the eyes."""
    for way, colour, width, name in ((path.right, _RIGHT, 3.6, "right"), (path.left, _LEFT, 1.4, "left")):
        off.plot(way.off_meridian, -path.lowering, color=colour, linewidth=width, label=name)
    off.set(xlabel="path nasal of\nmeridian, mm", ylabel="gaze, degrees (down is negative)")
    imbalance.plot(path.vertical_imbalance, -path.lowering, color="#2f8f4e", linewidth=2.0, label="vertical")
    imbalance.plot(path.induced_vergence, -path.lowering, color="#7a3b8f", linewidth=2.0, label="convergence")
    imbalance.set(xlabel="imbalance,\ncm/m")
    imbalance.tick_params(labelleft=False)
    for axes, least in ((off, 1.0), (imbalance, 0.5)):
        drawn = np.concatenate([line.get_xdata() for line in axes.get_lines()])
        reach = 1.1 * max(least, float(np.nanmax(np.abs(drawn), initial=0.0)))
        axes.axvline(0, color=QUIET, linewidth=0.8, linestyle=":")
        axes.set(xlim=(-reach, reach), ylim=(-path.lowering.max(), -path.lowering.min()))
        axes.legend(loc="lower left", bbox_to_anchor=(-0.05, 1.0), fontsize=8, frameon=False, handlelength=1.2)
        maps.calm(axes)


def _draw_map(figure: Figure, corner: Sequence[float], found: PairMap) -> None:
    axes = maps.place(figure, *corner, 3.2, 3.2)
    axes.set_title(found.label, size=10.5, color=INK)
    axes.set(xlabel="wearer's right ←  azimuth, °  → left", ylabel="elevation, °", aspect="equal")
    maps.calm(axes)
    if not np.isfinite(found.values).any():
        axes.text(0, 0, "no common gaze", ha="center", color=INK)
        return
    bands = value_bands(found.quantity, found.values)
    ends = [bands.colours[0], *bands.colours, bands.colours[-1]]
    axes.contourf(found.azimuth, found.elevation, found.values, bands.shifted, colors=ends, extend="both")
    if not bands.constant:
        thickness = np.array([0.5, 1.1, 2.0])[bands.weight]
        style = {"colors": bands.line_colours(), "linewidths": thickness, "linestyles": "solid"}
        axes.contour(found.azimuth, found.elevation, found.values, bands.shifted, **style)
    maps.colour_bar(maps.place(figure, corner[0] + 3.32, corner[1] + 0.15, 0.14, 2.6), bands, found.unit)
