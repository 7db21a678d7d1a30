"""How a quantity is banded and coloured: the field's isoline steps, colour-blind-safe colours, one scale when compared."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

import numpy as np
from matplotlib import colormaps
from numpy.typing import NDArray

from ..errors import InputError
from ..layers import LensMap
from ..optics.conventions import Floats, Status, mean_power
from ..optics.lens import Lens

_MOST_BANDS, _MOST_ASKED = 24, 200


@dataclass(frozen=True, slots=True)
class MapStyle:
    """How a quantity is banded. colours: colour maps; two of them diverge from `centre` (None: the ordered mean power,
    rounded to the step, so that alike designs look alike).

    steps: band widths in the quantity's unit, the first that gives at most 24 bands is taken (half of the first where the
    map would have less than four); every label_every-th
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
_FINE = tuple(m * 10.0**e for e in range(-4, 3) for m in (1, 2, 5))
_ANY_STEPS = tuple(m * 10.0**e for e in range(-4, 12) for m in (1, 2, 5))
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
    "ellipse_diagonal": MapStyle(("magma_r",), label_every=1, decimals=0, levels=_ARCMIN),
    "prism": MapStyle(("BuPu",), _PRISM_STEPS, decimals=1),
    "prism_horizontal": MapStyle(_SIGNED, _PRISM_STEPS, decimals=1),
    "prism_vertical": MapStyle(_SIGNED, _PRISM_STEPS, decimals=1),
    "magnification": MapStyle(_SIGNED, (0.01, 0.02, 0.05, 0.1, 0.2, 0.5), centre=1.0),
    "difference": MapStyle(_SIGNED),
    "magnification_anisotropy": MapStyle(_AMOUNT, (0.5, 1.0, 2.0, 5.0, 10.0, 20.0), decimals=1),
    "skew": MapStyle(_SIGNED, _FINE, decimals=1),
    "image_rotation": MapStyle(_SIGNED, _FINE, decimals=1),
    "swim": MapStyle(("magma_r",), _FINE, decimals=1),
    "transverse_chromatic": MapStyle(("BuPu",), (0.02, 0.05, 0.1, 0.2, 0.5), strong=(0.1,)),
    "thickness": MapStyle(("GnBu",), (0.2, 0.5, 1.0, 2.0), decimals=1),
    "defocus_by_real_rays": MapStyle(("magma_r",), label_every=1, decimals=0, levels=_ARCMIN),
    "defocus_left_out": MapStyle(_SIGNED, _FINE, decimals=2),
    "higher_order_rms": MapStyle(_AMOUNT, _FINE),
    "coma": MapStyle(_AMOUNT, _FINE),
    "trefoil": MapStyle(_AMOUNT, _FINE),
    "spherical_aberration": MapStyle(_SIGNED, _FINE, decimals=3),
    "vertical_imbalance": MapStyle(_SIGNED, _FINE),
    "induced_vergence": MapStyle(_SIGNED, _FINE),
    "mean_power_difference": MapStyle(_SIGNED, (0.05, 0.1, 0.25, 0.5, 1.0)),
    "astigmatic_difference": MapStyle(_AMOUNT, (0.05, 0.1, 0.25, 0.5, 1.0)),
    "magnification_difference": MapStyle(_SIGNED, _FINE, decimals=1),
    "cyclo_difference": MapStyle(_SIGNED, _FINE, decimals=1),
    "front_surface_mean_power": MapStyle(_AMOUNT),
    "back_surface_mean_power": MapStyle(("YlGnBu_r",)),
}
_OTHER = MapStyle(_SIGNED, _ANY_STEPS)
_MODES = ("lensmeter_", "front_surface_", "back_surface_", "surface_")


def map_style(quantity: str) -> MapStyle:
    """The style of a quantity; what a lensmeter or the surfaces show looks like what is seen as worn."""
    mode = next((m for m in _MODES if quantity.startswith(m)), "")
    return STYLES.get(quantity) or STYLES.get(quantity.removeprefix(mode), _OTHER)


def is_cyclic(quantity: str) -> bool:
    """Whether the ends of the quantity's scale are neighbours: an axis."""
    return quantity.endswith("axis")


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

    def line_colours(self) -> list[str]:
        """Colours (k + 1) of the isolines: dark on pale bands, pale on dark ones."""
        below = self.colours[np.maximum(np.arange(self.levels.size) - 1, 0)] @ [0.2126, 0.7152, 0.0722]
        return ["#2b3036" if light > 0.35 else "#e8ecef" for light in below]


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
    style, cyclic = map_style(quantity), is_cyclic(quantity)
    finite = values[np.isfinite(values)]
    span = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    levels = _levels(style, (0.0, 180.0) if cyclic else limits or _scale_span(style, finite), step)
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
    style = map_style(pictured[0].quantity)
    levels = _levels(style, _scale_span(style, values), None)
    return float(levels[0]), float(levels[-1])


def _scale_span(style: MapStyle, values: Floats) -> tuple[float, float]:
    """Range (least, greatest) that a scale is to show: all values (n,), or the middle 98 % of them where the rest (rays
    at the rim that nearly fail) lies so far out that it would make the bands coarse."""
    if values.size == 0:
        return 0.0, 0.0
    low, inner_low, inner_high, high = (float(v) for v in np.percentile(values, (0, 1, 99, 100)))
    far_out = high - low > max(_MOST_BANDS * style.steps[0], 4 * (inner_high - inner_low))
    return (inner_low, inner_high) if far_out else (low, high)


def _levels(style: MapStyle, span: tuple[float, float], step: float | None) -> Floats:
    low, high = span
    if not low <= high:
        raise InputError(f"the scale must rise: its limits are {low:g} and {high:g}")
    if style.levels and step is None:
        fixed = np.array([*style.levels, *((high,) if high > style.levels[-1] else ())])
        return fixed[max(np.searchsorted(fixed, low, "right") - 1, 0) : max(np.searchsorted(fixed, high), 1) + 1]
    if step is None:
        step = next(s for s in (*style.steps, *_ANY_STEPS) if high - low <= _MOST_BANDS * s)
        step /= 2 if 0 < high - low < 4 * style.steps[0] else 1
    if not step > 0 or high - low > _MOST_ASKED * step:
        raise InputError(f"a step of {step:g} does not make 1 to {_MOST_ASKED} bands from {low:g} to {high:g}")
    first, last = np.floor(low / step + 1e-3), np.ceil(high / step - 1e-3)
    return step * np.arange(first, max(last, first + 1) + 1)


def _level_text(style: MapStyle, levels: Floats, step: float) -> tuple[str, ...]:
    """Levels as printed: signed where colours diverge from zero, with the digits that the step needs."""
    needed = next((d for d in range(6) if abs(round(step, d) - step) < 1e-6), 6)
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
