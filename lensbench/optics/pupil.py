"""Sample points of the pupil, and the Zernike polynomials on it (OSA/ANSI Z80.28)."""

from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats, ReadOnlyArrays


@dataclass(frozen=True, slots=True, eq=False)
class Pupil(ReadOnlyArrays):
    """Sample points (m, 2) in the unit disc and their weights (m,), which add up to 1."""

    points: Floats
    weights: Floats


def gauss_pupil(rings: int = 4, spokes: int = 14) -> Pupil:
    """Gauss-Legendre in the squared radius times equal angles: means over the disc are exact for polynomials of a degree
    below 4 times `rings` and below `spokes`. The default is exact for products of two Zernike polynomials of order 6."""
    node, weight = np.polynomial.legendre.leggauss(rings)
    radius, angle = np.sqrt((node + 1) / 2), (np.arange(spokes) + 0.5) * 2 * np.pi / spokes
    points = radius[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return Pupil(points.reshape(-1, 2), np.repeat(weight / (2 * spokes), spokes))


def vogel_pupil(count: int) -> Pupil:
    """Equal areas on Vogel's spiral: no rings or spokes that a picture of the spot would show. Source: Vogel 1979."""
    k = np.arange(count)
    radius, angle = np.sqrt((k + 0.5) / count), k * np.pi * (3 - np.sqrt(5))
    return Pupil(radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1), np.full(count, 1 / count))


def zernike(points: ArrayLike, order: int = 6) -> Floats:
    """Zernike polynomials (m, (order + 1)(order + 2) / 2) at points (m, 2) of the unit disc, by the single index j.

    j = (n (n + 2) + m) / 2, normalised to unit rms, angle from +x counter-clockwise. Source: ANSI Z80.28-2017.
    """
    x, y = np.asarray(points, dtype=float).T
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    columns = []
    for n in range(order + 1):
        for m in range(-n, n + 1, 2):
            turning = np.cos(m * angle) if m >= 0 else np.sin(-m * angle)
            norm = np.sqrt((n + 1) * (1 if m == 0 else 2))
            columns.append(norm * _radial(n, abs(m), radius) * turning)
    return np.stack(columns, axis=-1)


def _radial(n: int, m: int, radius: Floats) -> Floats:
    terms = (
        (-1) ** k
        * factorial(n - k)
        / (factorial(k) * factorial((n + m) // 2 - k) * factorial((n - m) // 2 - k))
        * radius ** (n - 2 * k)
        for k in range((n - m) // 2 + 1)
    )
    return np.asarray(sum(terms))
