"""Light and codes, and the points over which the passes average."""

import numpy as np
from numpy.typing import NDArray

from ...optics.conventions import Floats

Pixels = NDArray[np.uint8]
Light = NDArray[np.float32]

_CODES = np.arange(256) / 255.0
LIGHT_OF_CODE = np.where(_CODES <= 0.04045, _CODES / 12.92, ((_CODES + 0.055) / 1.055) ** 2.4).astype(np.float32)


def decode(codes: Pixels) -> Light:
    """Linear light, 0 to 1, of sRGB codes of any shape. Source: IEC 61966-2-1."""
    return np.take(LIGHT_OF_CODE, codes)


def encode(light: Light) -> Pixels:
    """sRGB codes of linear light, 0 to 1. Source: IEC 61966-2-1."""
    clipped = np.clip(light, 0.0, 1.0)
    code = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    return np.round(255 * code).astype(np.uint8)


def pupil_points(passes: int, seed: int) -> Floats:
    """Points (passes, 2) of the unit disc with mean 0, in an order drawn from the seed. Source: Vogel 1979."""
    k = np.arange(passes)
    radius, angle = np.sqrt((k + 0.5) / passes), k * np.pi * (3 - np.sqrt(5))
    disc = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    return np.random.default_rng(seed).permutation(disc - disc.mean(axis=0))


def pixel_shifts(passes: int) -> Floats:
    """Shifts (passes, 2) within a pixel, -0.5 to 0.5 with mean 0: a low-discrepancy sequence. Source: Roberts 2018, R2."""
    shift = np.outer(np.arange(passes), [0.7548776662466927, 0.5698402909980532]) % 1.0
    return shift - shift.mean(axis=0)
