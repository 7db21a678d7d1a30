"""The distortion grid: a chart of upright lines and how the turning eye sees it through the lens."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..layers import DistortionGrid
from ..optics.conventions import Floats
from ..optics.lens import Lens
from . import maps
from .maps import EYE, QUIET

_DEGREES = np.arange(-60, 61, 10)


def distortion_figure(lens: Lens | None, grid: DistortionGrid, subtitle: str = "") -> Figure:
    """The chart (pale) and its image (dark), as the wearer looks at them, in the plane of a picture (tangents)."""
    figure = maps.blank_figure(7.6, 8.1)
    axes = maps.place(figure, 0.8, 0.75, 6.4, 6.4)
    axes.add_collection(LineCollection(_lines(grid.object, grid), colors="#c3c9ce", linewidths=0.8))
    axes.add_collection(LineCollection(_lines(grid.apparent, grid), colors="#1f6aa5", linewidths=1.4))
    both = np.concatenate([np.abs(grid.object).ravel(), np.abs(grid.apparent[np.isfinite(grid.apparent)])])
    _angle_axes(axes, 1.04 * float(both.max()))
    maps.titles(figure, 0.8 / 7.6, "Distortion", lens.name if lens else "naked eye", subtitle)
    eye = "naked" if lens is None else EYE[lens.side]
    maps.small_print(figure, f"{eye} eye, as the wearer sees it; pale: the chart, blue: its image")
    return figure


def _lines(points: Floats, grid: DistortionGrid) -> list[NDArray[np.float64]]:
    """The rows and columns (k, 2) of the chart, broken where no ray passes."""
    step = grid.layer.fineness
    rows = [points[j] for j in range(0, len(points), step)] + [points[:, i] for i in range(0, len(points), step)]
    return [part for row in rows for part in _unbroken(row)]


def _unbroken(row: Floats) -> list[Floats]:
    known = np.isfinite(row).all(axis=1)
    ends = np.flatnonzero(np.diff(known.astype(int))) + 1
    return [part for part in np.split(row, ends) if len(part) > 1 and np.isfinite(part).all()]


def _angle_axes(axes: Axes, reach: float) -> None:
    """Tangents labelled in degrees, the wearer's left on the left."""
    degrees = _DEGREES[np.abs(np.tan(np.radians(_DEGREES))) < reach]
    ticks = np.tan(np.radians(degrees))
    axes.set(xlim=(reach, -reach), ylim=(-reach, reach), aspect="equal", ylabel="up, °")
    axes.set_xlabel("wearer's left ←   direction, °   → right")
    axes.set_xticks(ticks, [f"{d}" for d in degrees])
    axes.set_yticks(ticks, [f"{d}" for d in degrees])
    axes.axhline(0, color=QUIET, linewidth=0.5)
    axes.axvline(0, color=QUIET, linewidth=0.5)
    maps.calm(axes)
    axes.grid(False)
