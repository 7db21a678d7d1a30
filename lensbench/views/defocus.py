"""The defocus map drawn over a view: a white veil that is the denser the more the eye sees blurred, or colours, with its scale.

After Kakimoto, Tatsukawa & Nishita 2010, section 5.3 and figure 15; their measure is "ellipse_diagonal".
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw

from ..errors import InputError
from ..layers import DefocusView
from ..optics.conventions import Floats
from .bands import Bands, value_bands
from .jitter.light import Pixels
from .jitter.picture import letters, side_by_side

ARCMIN = float(np.degrees(60.0))  # per rad
DENSEST = 0.85
WAYS = ("veil", "colours")
SAID = {
    "defocus": "rms diameter of the blur that the eye receives, arcmin",
    "ellipse_diagonal": "diagonal 2|ε| of the ellipse of confusion, arcmin seen from the lens",
}
_INK = (32, 36, 40)


class Scale(NamedTuple):
    """How defocus is drawn. way: "veil" (white, the denser the more up to `limit`, arcmin) or "colours" (bands). measure: of
    MEASURES.
    """

    way: str
    limit: float
    measure: str = "defocus"


def shared_scale(maps: Sequence[DefocusView], way: str = "veil") -> Scale:
    """One scale for several maps: its limit is the least of 1, 2, 3, 5, 10, ... arcmin above 98 % of all their pixels."""
    if way not in WAYS:
        raise InputError(f"defocus: {way!r} is none of {', '.join(WAYS)}")
    values = np.concatenate([m.defocus[np.isfinite(m.defocus)] for m in maps])
    if values.size == 0:
        raise InputError("there is no defocus to draw: through the lens no point of the scene is met")
    most = float(np.percentile(values, 98)) * ARCMIN
    limit = next(s for e in range(6) for s in (1.0 * 10**e, 2.0 * 10**e, 3.0 * 10**e, 5.0 * 10**e) if s >= most)
    return Scale(way, limit, maps[0].measure)


def with_defocus(picture: Pixels, found: DefocusView, scale: Scale) -> Pixels:
    """A view's picture (h, w, 3) under its defocus map; untouched beyond the lens's edge and where the scene is empty."""
    arcmin = found.defocus * ARCMIN
    drawn = np.isfinite(arcmin)[..., None]
    return np.round(np.where(drawn, _covered(picture, arcmin, scale), picture)).astype(np.uint8)


def _covered(ground: Floats | Pixels, arcmin: Floats, scale: Scale) -> Floats:
    """A ground (h, w, 3), sRGB, covered as defocus (h, w) asks: under colours it is grey, so that they stay what they are."""
    value = np.nan_to_num(arcmin)
    if scale.way == "veil":
        return ground + DENSEST * np.minimum(value / scale.limit, 1.0)[..., None] * (255.0 - ground)
    bands = _bands(scale)
    rank = np.clip(np.searchsorted(bands.levels, value, "right") - 1, 0, len(bands.colours) - 1)
    grey = np.repeat(ground @ [0.2126, 0.7152, 0.0722], 3).reshape(ground.shape)
    return grey + 0.6 * (255 * bands.colours[rank] - grey)


def _bands(scale: Scale) -> Bands:
    return value_bands(scale.measure, np.array([0.0, scale.limit]), limits=(0.0, scale.limit))


def under_scale(pictures: Sequence[Pixels], maps: Sequence[DefocusView], way: str = "veil") -> list[Pixels]:
    """Pictures of one size under their defocus maps, all in one scale, each with its bar below."""
    scale = shared_scale(maps, way)
    height, width, _ = pictures[0].shape
    bar = scale_bar(scale, width, max(11, height // 28))
    bar = bar[: len(bar) - (height + len(bar)) % 2]
    return [np.vstack([with_defocus(p, m, scale), bar]) for p, m in zip(pictures, maps, strict=True)]


def defocus_strip(
    views: Sequence[tuple[str, Pixels, DefocusView]], caption: str, way: str = "veil", scale: Scale | None = None
) -> Pixels:
    """Views (title, picture, defocus map) side by side under one scale of defocus, with its bar below."""
    scale = scale or shared_scale([found for _, _, found in views], way)
    strip = side_by_side([(title, with_defocus(picture, found, scale)) for title, picture, found in views], caption)
    height = views[0][1].shape[0]
    bar = scale_bar(scale, strip.shape[1], max(11, height // 24))
    return np.vstack([strip, bar])


def scale_bar(scale: Scale, width: int, letter: int) -> Pixels:
    """The scale (h, width, 3): what the veil or the colours mean in arcmin. letter: height of its text, pixels."""
    image = Image.new("RGB", (width, round(5.4 * letter)), "white")
    pen, font = ImageDraw.Draw(image), letters("", letter)
    left, right, top, low = 2 * letter, width - 2 * letter, round(1.9 * letter), round(3.3 * letter)
    fitting = min(1.0, (width - left) / pen.textlength(SAID[scale.measure], font))
    pen.text((left, letter), SAID[scale.measure], _INK, letters("", max(6, int(fitting * letter))), "lm")
    ticks = _ticks(scale)
    run = np.interp(np.linspace(0, ticks.size - 1, right - left), np.arange(ticks.size), ticks)
    dark_then_light = np.where(np.arange(low - top) < (low - top) / 2, 40.0, 150.0)
    ground = np.broadcast_to(dark_then_light[:, None, None], (low - top, run.size, 3))
    covered = _covered(ground, np.broadcast_to(run, ground.shape[:2]), scale)
    image.paste(Image.fromarray(np.round(covered).astype(np.uint8)), (left, top))
    pen.rectangle((left, top, right, low), None, _INK)
    for x, value in zip(np.linspace(left, right, ticks.size), ticks, strict=True):
        pen.line((x, low, x, low + 0.35 * letter), _INK)
        pen.text((x, low + 0.5 * letter), f"{value:g}", _INK, font, "mt")
    return np.asarray(image)


def _ticks(scale: Scale) -> Floats:
    """Levels (k,), arcmin, at equal distances along the bar."""
    if scale.way == "colours":
        return _bands(scale).levels
    threes = f"{scale.limit:e}".startswith("3")
    return np.linspace(0.0, scale.limit, 7 if threes else 6)
