"""First order against real rays: how blur by both compares over the lens, and spots of single gazes."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..layers import RealRays, RealRaysCheck, Spot
from ..optics.conventions import Floats
from ..optics.lens import Lens
from . import maps
from .maps import INK, QUIET

_COLOURS = ("#1f6aa5", "#c2571a", "#2f8f4e", "#7a3b8f", "#8a6d1c", "#b3315f", "#444444")
_MARKERS = "osD^vPX"


def real_rays_figure(lens: Lens, found: RealRays, names: Sequence[str]) -> Figure:
    """Blur by real rays against the first order, gaze by gaze, and the share of gazes within a deviation; arcmin.

    names: of the distances, in words.
    """
    figure = maps.blank_figure(13.0, 6.0)
    pairs, share = maps.place(figure, 0.9, 0.75, 5.0, 4.2), maps.place(figure, 7.1, 0.75, 5.5, 4.2)
    for k, (check, name) in enumerate(zip(found.checks, names, strict=True)):
        colour = _COLOURS[k % len(_COLOURS)]
        pairs.plot(
            np.maximum(check.first_order, 0.1),
            np.maximum(check.real_rays, 0.1),
            _MARKERS[k % len(_MARKERS)],
            color=colour,
            markersize=3,
            alpha=0.5,
            markeredgewidth=0,
            label=name,
        )
        _draw_share(share, check, colour)
    low, high = 0.1, 1.3 * max(float(np.nanmax(check.real_rays, initial=1.0)) for check in found.checks)
    pairs.plot([low, high], [low, high], color=INK, linewidth=0.8)
    pairs.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high))
    pairs.set(xlabel="first order, rms blur diameter, arcmin", ylabel="real rays, rms blur diameter, arcmin")
    share.set(xscale="log", xlim=(0.003, 30), ylim=(0, 100))
    share.set(xlabel="deviation of the first order, arcmin", ylabel="share of the gazes within, %")
    for axes in (pairs, share):
        maps.calm(axes)
        axes.xaxis.set_major_formatter("{x:g}")
    pairs.yaxis.set_major_formatter("{x:g}")
    share.axhline(90, color=QUIET, linewidth=0.8, linestyle=":")
    handles, labels = pairs.get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="upper left",
        bbox_to_anchor=(0.06, 0.89),
        ncols=len(labels),
        frameon=False,
        fontsize=9,
        markerscale=2,
        columnspacing=1.2,
        handletextpad=0.2,
    )
    maps.titles(
        figure, 0.9 / 13.0, "First order against real rays", lens.name, "gazes over the whole lens, whole pupil"
    )
    return figure


def _draw_share(axes: Axes, check: RealRaysCheck, colour: str) -> None:
    deviation = np.sort(np.abs(check.deviation[np.isfinite(check.deviation)]))
    axes.plot(deviation, 100 * (np.arange(deviation.size) + 1) / max(deviation.size, 1), color=colour, linewidth=1.8)


def spots_figure(lens: Lens, spots: Sequence[Spot], names: Sequence[str]) -> Figure:
    """Real rays at the objects and the first-order ellipse of confusion, one panel a gaze, as the wearer looks at them.

    names: of the distances, in words.
    """
    panel = 2.75
    figure = maps.blank_figure(0.9 + len(spots) * (panel + 0.75), panel + 2.05)
    for k, (spot, name) in enumerate(zip(spots, names, strict=True)):
        axes = maps.place(figure, 0.9 + k * (panel + 0.75), 0.7, panel, panel)
        _draw_spot(axes, spot)
        axes.set_title(f"{spot.name}\n{name}", size=9.5, color=INK)
    figure.axes[0].set_ylabel("up, arcmin")
    about = "dots: real rays through equal areas of the pupil; line: first-order ellipse"
    maps.titles(figure, 0.9 / figure.get_size_inches()[0], "Spots and ellipses of confusion", lens.name, about)
    return figure


def _draw_spot(axes: Axes, spot: Spot) -> None:
    turn = np.linspace(0, 2 * np.pi, 121)
    rim: Floats = spot.first_order @ np.stack([np.cos(turn), np.sin(turn)])
    axes.plot(*spot.points.T, ".", color="#1f6aa5", markersize=2.2)
    axes.plot(*rim, color="#c2571a", linewidth=1.6)
    reach = 1.08 * max(float(np.nanmax(np.abs(spot.points), initial=0.0)), float(np.abs(rim).max()), 0.1)
    axes.set(xlim=(reach, -reach), ylim=(-reach, reach), aspect="equal", xlabel="left ←  arcmin  → right")
    maps.calm(axes)
