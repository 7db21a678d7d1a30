"""Flat pictures of a lens: maps with bands and isolines, power profiles, cross-sections. Matplotlib only, no GL.

Every map is seen from in front of the wearer: +x (the wearer's left) to the right of the picture, +y up.
"""

import os
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps, rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray
from PIL import Image

from ..errors import InputError
from ..optics.conventions import Floats, Status, mean_power
from ..optics.lens import Lens
from ..workbench import LensMap, Profile

INK, QUIET = "#202428", "#667078"
_MOST_BANDS, _MOST_ASKED = 24, 200

# ---- styles and bands -------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class MapStyle:
    """How a quantity is banded. colours: colour maps; two of them diverge from `centre` (None: the ordered mean power,
    rounded to the step, so that alike designs look alike).

    steps: band widths in the quantity's unit, the first that gives at most 24 bands is taken; every label_every-th
    multiple is emphasised and labelled; strong: levels drawn strongest; levels: fixed uneven levels instead of steps.
    """

    colours: tuple[str, ...]
    steps: tuple[float, ...] = (0.25, 0.5, 1.0, 2.0, 5.0, 10.0)
    label_every: int = 2
    strong: tuple[float, ...] = ()
    centre: float | None = 0.0
    decimals: int = 2
    levels: tuple[float, ...] = ()


_SIGNED = ("Purples", "YlOrBr")
_AMOUNT = ("YlGnBu",)
_PRISM_STEPS = (0.5, 1.0, 2.0, 5.0, 10.0)
_ANY_STEPS = tuple(m * 10.0**e for e in range(-4, 4) for m in (1, 2, 5))
_ARCMIN = (0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 90.0, 120.0, 180.0, 300.0)

STYLES = {
    "mean_power": MapStyle(_SIGNED, centre=None),
    "sphere": MapStyle(_SIGNED, centre=None),
    "cylinder": MapStyle(("YlGnBu_r",)),
    "astigmatism": MapStyle(_AMOUNT, strong=(0.5, 1.0)),
    "axis": MapStyle(("twilight",), steps=(15.0,), label_every=1, decimals=0),
    "mean_error": MapStyle(_SIGNED),
    "astigmatic_error": MapStyle(_AMOUNT, strong=(0.5, 1.0)),
    "residual_mean": MapStyle(_SIGNED),
    "accommodation": MapStyle(("BuGn",)),
    "defocus": MapStyle(("magma_r",), label_every=1, decimals=0, levels=_ARCMIN),
    "prism": MapStyle(("BuPu",), _PRISM_STEPS, decimals=1),
    "prism_horizontal": MapStyle(_SIGNED, _PRISM_STEPS, decimals=1),
    "prism_vertical": MapStyle(_SIGNED, _PRISM_STEPS, decimals=1),
    "magnification": MapStyle(_SIGNED, (0.01, 0.02, 0.05, 0.1, 0.2, 0.5), centre=1.0),
    "thickness": MapStyle(("GnBu",), (0.2, 0.5, 1.0, 2.0), decimals=1),
}
_OTHER = MapStyle(_SIGNED, _ANY_STEPS)


@dataclass(frozen=True, slots=True, eq=False)
class Bands:
    """Levels (k + 1,) rising in the map's unit and the colours (k, 3), 0 to 1, of the bands between them.

    weight (k + 1,): 0 thin, 1 emphasised and labelled, 2 strongest. text: every level as printed. span: least and
    greatest value of the map. cyclic: the ends of the scale are neighbours (an axis), so no isolines.
    """

    levels: Floats
    colours: Floats
    weight: NDArray[np.intp]
    text: tuple[str, ...]
    span: tuple[float, float]
    cyclic: bool = False

    @property
    def constant(self) -> bool:
        """Whether the map varies by less than a hundredth of a band."""
        return self.span[1] - self.span[0] < 0.01 * float(np.diff(self.levels).min())

    def rank(self, values: Floats) -> Floats:
        """Values as numbers of bands above the lowest level, 0 to k, so that all bands are equally wide."""
        return np.interp(values, self.levels, np.arange(self.levels.size))

    @property
    def shifted(self) -> Floats:
        """Levels moved down by 1/2500 of a band (0.1 mD of 0.25 D): a plateau exactly on a level draws no noise."""
        return self.levels - 4e-4 * float(np.diff(self.levels).min())


def map_bands(
    lens: Lens, lens_map: LensMap, step: float | None = None, limits: tuple[float, float] | None = None
) -> Bands:
    """Bands for a map; step and limits in the map's unit. Raises InputError for a step or limits that make no bands."""
    ordered = float(mean_power(lens.ordered.power())) if lens.ordered else 0.0
    return value_bands(lens_map.quantity, lens_map.values, step, limits, ordered)


def value_bands(
    quantity: str,
    values: Floats,
    step: float | None = None,
    limits: tuple[float, float] | None = None,
    ordered: float = 0.0,
) -> Bands:
    """Bands for values (any shape, NaN where there are none) of a quantity; see map_bands. ordered: mean power, D."""
    style, cyclic = STYLES.get(quantity, _OTHER), quantity == "axis"
    finite = values[np.isfinite(values)]
    span = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    levels = _levels(style, (0.0, 180.0) if cyclic else limits or span, step)
    width = step or float(np.diff(levels).min())
    weight = np.where(np.round(levels / width) % (1 if style.levels else style.label_every) == 0, 1, 0)
    weight[np.isclose(levels[:, None], style.strong).any(axis=1)] = 2
    centre = width * round(ordered / width) if style.centre is None else style.centre
    colours = _band_colours(style, levels, centre)
    return Bands(levels, colours, weight, _level_text(style, levels, width), span, cyclic)


def shared_limits(maps: Iterable[LensMap]) -> tuple[float, float]:
    """One scale (least, greatest) for maps of one quantity, rounded outwards to the step that suits their range."""
    pictured = list(maps)
    values = np.concatenate([m.values[np.isfinite(m.values)] for m in pictured])
    if values.size == 0:
        raise InputError("there is no common scale: no ray passes in any of these maps")
    style = STYLES.get(pictured[0].quantity, _OTHER)
    levels = _levels(style, (float(values.min()), float(values.max())), None)
    return float(levels[0]), float(levels[-1])


def _levels(style: MapStyle, span: tuple[float, float], step: float | None) -> Floats:
    low, high = span
    if not low <= high:
        raise InputError(f"the scale must rise: its limits are {low:g} and {high:g}")
    if style.levels and step is None:
        fixed = np.array([*style.levels, *((high,) if high > style.levels[-1] else ())])
        return fixed[max(np.searchsorted(fixed, low, "right") - 1, 0) : max(np.searchsorted(fixed, high), 1) + 1]
    if step is None:
        step = next((s for s in style.steps if high - low <= _MOST_BANDS * s), style.steps[-1])
    if not step > 0 or high - low > _MOST_ASKED * step:
        raise InputError(f"a step of {step:g} does not make 1 to {_MOST_ASKED} bands from {low:g} to {high:g}")
    first, last = np.floor(low / step + 1e-3), np.ceil(high / step - 1e-3)
    return step * np.arange(first, max(last, first + 1) + 1)


def _level_text(style: MapStyle, levels: Floats, step: float) -> tuple[str, ...]:
    """Levels as printed: signed where colours diverge from zero, with the digits that the step needs."""
    needed = next(d for d in range(7) if abs(round(step, d) - step) < 1e-6)
    sign = "+" if len(style.colours) > 1 and style.centre != 1.0 else ""
    return tuple(f"{v + 0.0:{sign if abs(v) > 1e-9 else ''}.{max(style.decimals, needed)}f}" for v in levels)


def _band_colours(style: MapStyle, levels: Floats, centre: float) -> Floats:
    """Colours (k, 3) of the bands: along one map over the whole scale, or outwards from the centre along two."""
    k = levels.size - 1
    if len(style.colours) == 1:
        return _even_colours(style.colours[0])[np.round((np.arange(k) + 0.5) / k * 255).astype(int)]
    middle = (levels[1:] + levels[:-1]) / 2 - centre
    reach = np.round(np.abs(middle) / np.abs(levels - centre).max() * 255).astype(int)
    return np.where(middle[:, None] < 0, *(_even_colours(name)[reach] for name in style.colours))


@cache
def _even_colours(name: str) -> Floats:
    """The colour map (256, 3) without its darkest end, resampled to even steps of CIE lightness; cyclic maps as they are."""
    if name == "twilight":
        return colormaps[name](np.linspace(0, 1, 256))[:, :3]
    colours = colormaps[name](np.linspace(0, 1, 512))[:, :3]
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    lightness = 116 * np.cbrt(linear @ [0.2126, 0.7152, 0.0722]) - 16
    order = np.argsort(lightness)
    darkest, palest = max(lightness.min(), 22.0), lightness.max()
    ends = (palest, darkest) if lightness[0] > lightness[-1] else (darkest, palest)
    wanted = np.linspace(*ends, 256)
    return np.stack([np.interp(wanted, lightness[order], channel[order]) for channel in colours.T], axis=-1)


def extended(lens_map: LensMap) -> Floats:
    """The map's values (ny, nx) carried one sample beyond the edge (linearly), so that bands can be cut at the outline."""
    v = np.pad(lens_map.values, 2, constant_values=np.nan)
    ny, nx = lens_map.values.shape
    total, count = np.zeros((ny, nx)), np.zeros((ny, nx))
    for dy, dx in ((j, i) for j in (-1, 0, 1) for i in (-1, 0, 1) if (i, j) != (0, 0)):
        near, far = (v[2 + k * dy : 2 + k * dy + ny, 2 + k * dx : 2 + k * dx + nx] for k in (1, 2))
        guess = np.where(np.isfinite(far), 2 * near - far, near)
        total, count = total + np.nan_to_num(guess), count + np.isfinite(guess)
    beyond = ~np.isfinite(lens_map.values) & (lens_map.status == Status.OUTSIDE_OUTLINE) & (count > 0)
    return np.where(beyond, total / np.maximum(count, 1), lens_map.values)


# ---- maps -------------------------------------------------------------------------------------------------------------


def map_figure(
    lens: Lens,
    lens_map: LensMap,
    step: float | None = None,
    limits: tuple[float, float] | None = None,
    subtitle: str = "",
) -> Figure:
    """Bands and labelled isolines of a map within the lens's outline, with reference marks and colour bar.

    step, limits: in the map's unit, else what suits the quantity. subtitle: a line under the title (object distance).
    """
    figure, axes = _lens_axes(lens)
    titles(figure, axes, title_of(lens, lens_map.label), subtitle)
    if np.isfinite(lens_map.values).any():
        bands = map_bands(lens, lens_map, step, limits)
        _draw_bands(axes, lens, lens_map, bands)
        box = axes.get_position()
        bar = figure.add_axes((box.x1 + 0.03, box.y0 + 0.08 * box.height, 0.025, 0.84 * box.height))
        colour_bar(bar, bands, lens_map.unit)
    else:
        centre = lens.outline.centre
        axes.text(*centre, f"no ray passes: there is no {lens_map.label.lower()} to show", ha="center", color=INK)
    axes.add_patch(Polygon(np.transpose(lens.outline.points()), fill=False, edgecolor=INK, linewidth=1.4, zorder=4))
    _draw_marks(axes, lens)
    return figure


def blank_figure(width: float, height: float) -> Figure:
    """An empty white figure of a size in inches of 100 pixels, with a canvas of its own."""
    figure = Figure((width, height), dpi=100, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def place(figure: Figure, *box: float) -> Axes:
    """Axes at (left, bottom, width, height) in inches."""
    return figure.add_axes(tuple(np.array(box) / np.tile(figure.get_size_inches(), 2)))


def title_of(lens: Lens, what: str) -> str:
    return f"{lens.name}: {what}" if lens.name else what.capitalize()


def _lens_axes(lens: Lens) -> tuple[Figure, Axes]:
    """A figure about 900 pixels wide with equal axes (mm) around the lens's outline."""
    x0, x1, y0, y1 = lens.outline.box
    width, height = x1 - x0 + 3, y1 - y0 + 3
    scale = min(6.5 / width, 7.0 / height)
    across, up = scale * width, scale * height
    size = 2.4 + max(across, 6.2), up + 1.85
    figure = blank_figure(*size)
    axes = place(figure, 0.8, 1.05, across, up)
    axes.set(xlim=(x0 - 1.5, x1 + 1.5), ylim=(y0 - 1.5, y1 + 1.5), ylabel="y, mm")
    sides = ("temporal", "nasal") if lens.side == "R" else ("nasal", "temporal")
    axes.set_xlabel(f"{sides[0]}  ←        x, mm        →  {sides[1]}", color=INK)
    calm(axes)
    eye = {"R": "right", "L": "left"}[lens.side]
    figure.text(1 - 0.15 / size[0], 0.12 / size[1], f"{eye} lens, seen from the front", ha="right", size=8, color=QUIET)
    return figure, axes


def calm(axes: Axes) -> None:
    axes.set_axisbelow(True)
    axes.grid(color="#e4e7ea", linewidth=0.6)
    axes.tick_params(colors=QUIET, labelsize=9)
    for spine in axes.spines.values():
        spine.set_color("#c3c9ce")


def titles(figure: Figure, axes: Axes, title: str, subtitle: str) -> None:
    left, height = axes.get_position().x0, figure.get_size_inches()[1]
    figure.text(left, 1 - 0.38 / height, title, size=14, weight="bold", color=INK)
    figure.text(left, 1 - 0.62 / height, subtitle, size=10, color=QUIET)


def _draw_bands(axes: Axes, lens: Lens, lens_map: LensMap, bands: Bands) -> None:
    outline = Polygon(np.transpose(lens.outline.points()), transform=axes.transData)
    colours, values = bands.colours, extended(lens_map)
    if bands.cyclic:
        scale = {"cmap": ListedColormap(colours), "norm": BoundaryNorm(bands.levels, len(colours))}
        axes.pcolormesh(lens_map.x, lens_map.y, values, shading="nearest", **scale).set_clip_path(outline)
        return
    ends = [colours[0], *colours, colours[-1]]
    axes.contourf(lens_map.x, lens_map.y, values, bands.shifted, colors=ends, extend="both").set_clip_path(outline)
    if bands.constant:
        note = f"constant: {np.mean(bands.span):.2f} {lens_map.unit}"
        axes.text(*lens.outline.centre, note, ha="center", va="bottom", size=11, color=INK, path_effects=_halo())
        return
    _draw_isolines(axes, lens_map, values, bands).set_clip_path(outline)


def _draw_isolines(axes: Axes, lens_map: LensMap, values: Floats, bands: Bands) -> Any:
    thickness = np.array([0.5, 1.1, 2.0])[bands.weight]
    lines = axes.contour(
        lens_map.x, lens_map.y, values, bands.shifted, colors=_line_colours(bands), linewidths=thickness
    )
    named = [i for i in np.flatnonzero(bands.weight) if bands.span[0] < bands.shifted[i] < bands.span[1]]
    names = {bands.shifted[i]: bands.text[i] for i in named}
    for label in axes.clabel(lines, list(names), fmt=names, fontsize=8, colors=INK, inline_spacing=2):
        label.set_path_effects(_halo())
    return lines


def _line_colours(bands: Bands) -> list[str]:
    """Dark isolines on pale bands, pale ones on dark bands."""
    below = bands.colours[np.maximum(np.arange(bands.levels.size) - 1, 0)] @ [0.2126, 0.7152, 0.0722]
    return ["#2b3036" if light > 0.35 else "#e8ecef" for light in below]


def _halo() -> list[withStroke]:
    return [withStroke(linewidth=2.2, foreground="white", alpha=0.85)]


MARKS = {
    "fitting_point": ("fitting point", "+", 13),
    "prism_reference_point": ("prism reference point", ".", 8),
    "distance_reference_point": ("distance reference point", "o", 12),
    "near_reference_point": ("near reference point", "o", 7),
}


def _draw_marks(axes: Axes, lens: Lens) -> None:
    halo = [withStroke(linewidth=3.4, foreground="white")]
    for name, (x, y) in lens.points.named().items():
        label, marker, size = MARKS[name]
        fill = INK if marker == "." else "none"
        style = {"markersize": size, "markeredgewidth": 1.5, "markeredgecolor": INK, "markerfacecolor": fill}
        axes.plot(x, y, marker, label=label, path_effects=halo, zorder=5, **style)
    figure = axes.figure
    bottom = 0.34 / figure.get_size_inches()[1]
    figure.legend(
        loc="lower center", bbox_to_anchor=(0.5, bottom), ncols=4, fontsize=8, frameon=False, handletextpad=0.3
    )


def colour_bar(axes: Axes, bands: Bands, unit: str) -> None:
    """The bands with their levels and unit; arrows where the map goes beyond the scale."""
    tolerance = 0.01 * float(np.diff(bands.levels).min())
    below, above = bands.span[0] < bands.levels[0] - tolerance, bands.span[1] > bands.levels[-1] + tolerance
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[below, above]
    colours = ListedColormap(bands.colours)
    scale = ScalarMappable(BoundaryNorm(np.arange(len(bands.levels)), len(bands.colours)), colours)
    named = (
        np.flatnonzero(bands.weight) if bands.weight.any() and len(bands.levels) > 6 else np.arange(len(bands.levels))
    )
    bar = axes.figure.colorbar(scale, cax=axes, ticks=named, extend=extend, extendfrac=0.04)
    bar.ax.set_yticklabels([bands.text[i] for i in named])
    bar.ax.tick_params(labelsize=9, colors=INK, length=3)
    bar.ax.minorticks_off()
    bar.outline.set_edgecolor("#8b949c")
    axes.set_title(unit, size=10, color=INK, pad=14 if above else 8)


# ---- profiles and sections --------------------------------------------------------------------------------------------


def profile_figure(lens: Lens, profile: Profile, subtitle: str = "") -> Figure:
    """Power (D, across) against height y (mm, up) along the main meridian: mean, least and greatest power; astigmatism."""
    figure = blank_figure(9.0, 7.2)
    power, astig = place(figure, 0.8, 0.65, 4.2, 5.6), place(figure, 5.3, 0.65, 1.9, 5.6)
    power.fill_betweenx(profile.y, profile.least_power, profile.greatest_power, color="#f0c48a", alpha=0.6, linewidth=0)
    for values, colour, width, label in (
        (profile.least_power, "#b86e1c", 1.0, "least and greatest power"),
        (profile.greatest_power, "#b86e1c", 1.0, None),
        (profile.mean_power, INK, 2.0, "mean power"),
    ):
        power.plot(values, profile.y, color=colour, linewidth=width, label=label)
    astig.plot(profile.astigmatism, profile.y, color="#1f6aa5", linewidth=2.0)
    _, _, bottom, top = lens.outline.box
    power.set(xlabel="as-worn power, D", ylabel="y, mm")
    astig.set(xlim=(0, max(1.0, 1.1 * np.nanmax(profile.astigmatism, initial=0.0))), xlabel="astigmatism, D")
    for axes in (power, astig):
        axes.set_ylim(bottom, top)
        calm(axes)
    astig.tick_params(labelleft=False)
    _ordered_lines(power, lens)
    _height_lines(power, astig, lens)
    power.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=2, fontsize=9, frameon=False)
    titles(figure, power, title_of(lens, "power along the main meridian"), subtitle)
    return figure


def _ordered_lines(axes: Axes, lens: Lens) -> None:
    if lens.ordered is None:
        return
    far, near = (float(mean_power(lens.ordered.power(near))) for near in (False, True))
    bottom, top = axes.get_ylim()
    for value, name, y, va in ((far, "ordered", bottom + 1, "bottom"), (near, "ordered + addition", top - 1, "top")):
        if name == "ordered" or near != far:
            axes.axvline(value, color="#7a3b8f", linewidth=1.1, linestyle=(0, (5, 3)))
            spot = {"rotation": 90, "xytext": (-3, 0), "textcoords": "offset points", "ha": "right", "va": va}
            axes.annotate(f"{name} {value:+.2f} D", (value, y), size=8.5, color="#7a3b8f", path_effects=_halo(), **spot)


def _height_lines(power: Axes, astig: Axes, lens: Lens) -> None:
    """A line at the height of each reference point, named beside the second panel; names of one height share a line."""
    names: dict[float, list[str]] = {}
    for name, (_, y) in lens.points.named().items():
        names.setdefault(y, []).append(MARKS[name][0])
    for y, there in names.items():
        for axes in (power, astig):
            axes.axhline(y, color=QUIET, linewidth=0.8, linestyle=":")
        spot = {"xytext": (6, 0), "textcoords": "offset points", "va": "center"}
        astig.annotate(",\n".join(there), (1, y), xycoords=("axes fraction", "data"), size=8.5, color=INK, **spot)


def section_figure(lens: Lens) -> Figure:
    """Vertical and horizontal cross-section of the lens to one scale, mm, with thickness at the centre and the edges.

    Through x = 0 and y = 0 of the lens frame, or through the middle of an outline that does not hold that point.
    """
    at = (0.0, 0.0) if lens.outline.contains(0.0, 0.0) else lens.outline.centre
    across, up = _section(lens, at, 0), _section(lens, at, 1)
    heights = np.concatenate([across[1:], up[1:]], axis=1)
    x0, x1, y0, y1 = lens.outline.box
    depth = (float(np.nanmin(heights)) - 8, float(np.nanmax(heights)) + 8)
    deep, wide, tall = depth[1] - depth[0], x1 - x0 + 20, y1 - y0 + 10
    scale = min(9.0 / (deep + wide), 6.0 / tall)
    figure = blank_figure(scale * (deep + wide) + 2.0, scale * tall + 1.6)
    upright = place(figure, 0.7, 0.65, scale * deep, scale * tall)
    flat = place(figure, 1.6 + scale * deep, 0.65 + scale * (tall - deep), scale * wide, scale * deep)
    upright.set(xlim=depth, ylim=(y0 - 5, y1 + 5), xlabel="eye ←  z, mm  → scene", ylabel="y, mm")
    flat.set(xlim=(x0 - 10, x1 + 10), ylim=depth[::-1], xlabel="x, mm", ylabel="scene ← z, mm → eye")
    _draw_section(upright, up, upright=True)
    _draw_section(flat, across, upright=False)
    upright.set_title(f"vertical, x = {at[0]:g} mm", size=10, color=INK)
    flat.set_title(f"horizontal, y = {at[1]:g} mm, seen from above", size=10, color=INK)
    titles(figure, upright, title_of(lens, "cross-sections"), "")
    thin = lens.minimum_edge_thickness()
    facts = (
        f"centre thickness  {lens.centre_thickness:.2f} mm",
        f"thinnest edge  {thin.thickness:.2f} mm, at x = {thin.x:.1f} mm, y = {thin.y:.1f} mm",
        f"mass  {lens.weight():.1f} g",
        f"material  {lens.material.name}, index {lens.index:.3f} ({lens.wavelength} line)",
    )
    flat.text(0, -0.4, "\n".join(facts), transform=flat.transAxes, va="top", size=10, linespacing=1.7, color=INK)
    return figure


def _section(lens: Lens, at: tuple[float, float], k: int) -> Floats:
    """Cross-section along x (k = 0) or y (k = 1) through `at`: rows position, back and front height (3, n), mm."""
    low, high = lens.outline.box[2 * k : 2 * k + 2]
    along = np.linspace(low, high, 601)
    x, y = (along, np.full_like(along, at[1])) if k == 0 else (np.full_like(along, at[0]), along)
    section = np.stack([along, lens.back_height(x, y), lens.front_height(x, y)])
    return section[:, lens.outline.contains(x, y) & np.isfinite(section).all(axis=0)]


def _draw_section(axes: Axes, section: Floats, upright: bool) -> None:
    along, back, front = section
    ring = np.stack([np.append(along, along[::-1]), np.append(back, front[::-1])], axis=-1)
    style = {"facecolor": "#cfe3f1", "edgecolor": "#24506e", "linewidth": 1.3}
    axes.add_patch(Polygon(ring[:, ::-1] if upright else ring, **style))
    for i, outwards in ((0, -1), (int(np.argmin(np.abs(along))), 0), (along.size - 1, 1)):
        text = f"{front[i] - back[i]:.2f} mm"
        spot = along[i] + (2 if upright else 5) * outwards, (front[i] + back[i]) / 2 if outwards else front[i] + 2
        align = {"ha": "left" if upright and not outwards else "center", "va": "center"}
        axes.text(*(spot[::-1] if upright else spot), text, size=9, color=INK, **align)
    calm(axes)


# ---- files ------------------------------------------------------------------------------------------------------------


def figure_array(figure: Figure) -> NDArray[np.uint8]:
    """The figure as a picture (h, w, 3), uint8."""
    canvas = figure.canvas if isinstance(figure.canvas, FigureCanvasAgg) else FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def save_png(picture: NDArray[np.uint8] | Figure, path: str | Path) -> None:
    """Write a picture (h, w, 3) or a figure as PNG; the file appears whole or not at all."""
    pixels = figure_array(picture) if isinstance(picture, Figure) else picture
    _write_whole(Path(path), lambda name: Image.fromarray(pixels).save(name, format="png"))


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure as .png or, with its text kept as text, as .svg; the file appears whole or not at all."""
    path = Path(path)
    if path.suffix.lower() == ".png":
        save_png(figure, path)
    elif path.suffix.lower() == ".svg":
        with rc_context({"svg.fonttype": "none"}):
            _write_whole(path, lambda name: figure.savefig(name, format="svg"))
    else:
        raise InputError(f"{path.name}: a figure is saved as .png or .svg")


def _write_whole(path: Path, write: Callable[[str], Any]) -> None:
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=path.suffix)
    os.close(handle)
    try:
        write(name)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise
