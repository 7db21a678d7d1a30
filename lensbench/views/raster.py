"""Maps for a picture that changes as one looks: bands as pixels and isolines as polylines, within milliseconds."""

from typing import NamedTuple

import numpy as np
from contourpy import LineType, contour_generator
from numpy.typing import NDArray

from ..layers import LensMap
from ..optics.conventions import Floats
from .bands import Bands, extended


class Isoline(NamedTuple):
    """points (n, 2), mm, of a level (its number in the bands)."""

    level: int
    points: Floats


def band_pixels(lens_map: LensMap, bands: Bands, longest: int = 640) -> NDArray[np.uint8]:
    """The bands as pixels (h, w, 4), blue, green, red, alpha, first row at the top; transparent where there is no value.

    The picture covers the map's samples from the first to the last, bilinear between them (an axis: the nearest one).
    """
    values = extended(lens_map)
    ny, nx = values.shape
    fine = max(1, longest // max(nx, ny))
    across, up = (_weights(n, fine, bands.cyclic) for n in (nx, ny))
    known = np.isfinite(values)
    full = up @ known @ across.T > 0.999
    number = _band_numbers(up @ np.where(known, values, 0.0) @ across.T, bands)
    table = np.round(np.insert(bands.colours[:, ::-1], 3, 1.0, axis=1) * 255).astype(np.uint8)
    pixels = table[number]
    pixels[~full] = 0
    return np.ascontiguousarray(pixels[::-1])


def _weights(samples: int, fine: int, nearest: bool) -> Floats:
    """Weights (pixels, samples) of the samples at the middles of the pixels."""
    count = fine * (samples - 1)
    place = (np.arange(count) + 0.5) / fine
    if nearest:
        return np.eye(samples)[np.round(place).astype(int)]
    low = np.floor(place).astype(int)
    weights = np.zeros((count, samples))
    weights[np.arange(count), low] = 1 - (place - low)
    weights[np.arange(count), low + 1] = place - low
    return weights


def _band_numbers(values: Floats, bands: Bands) -> NDArray[np.intp]:
    """The number of the band that holds each value; what lies beyond the scale is in the outermost band."""
    levels, last = bands.shifted, len(bands.colours) - 1
    steps = np.diff(levels)
    if np.allclose(steps, steps[0]):
        return np.clip((values - levels[0]) / steps[0], 0, last).astype(np.intp)
    return np.clip(np.searchsorted(levels, values, side="right") - 1, 0, last)


def isolines(lens_map: LensMap, bands: Bands) -> list[Isoline]:
    """The lines between the bands; none of a constant map or of an axis."""
    if bands.cyclic or bands.constant:
        return []
    lines = contour_generator(lens_map.x, lens_map.y, extended(lens_map), line_type=LineType.Separate)
    found = [(k, level) for k, level in enumerate(bands.shifted) if bands.span[0] < level < bands.span[1]]
    return [Isoline(k, np.asarray(points)) for k, level in found for points in lines.lines(float(level))]
