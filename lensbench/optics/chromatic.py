"""Transverse chromatic aberration of the worn lens, gaze by gaze."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats
from .field import GazeField
from .gaze import trace
from .materials import DISPERSION_LINES


def transverse_chromatic_aberration(field: GazeField, distance: ArrayLike = np.inf) -> Floats:
    """Prism for the blue less prism for the red line (n, 2), cm/m, along e1 and e2 of the gaze frame.

    Two traces of the same gazes at two indices. The lines are F' and C' for a lens of the reference wavelength e, F and C
    for d. For a near object (`distance` mm, a number or (n,)) the offset of the two rays there counts, per distance. A
    thin lens follows prism over Abbe number (V_d, at d). Raises ValueError for the naked eye.
    """
    if field.lens is None:
        raise ValueError("the naked eye has no lens whose dispersion could be told")
    w = (1 / np.asarray(distance, dtype=float))[..., None]
    return _prism(field, "blue", w) - _prism(field, "red", w)


def _prism(field: GazeField, colour: str, w: Floats) -> Floats:
    """Deviation (n, 2), cm/m, at the distance 1/w, of the rays of one line."""
    lens = field.lens
    assert lens is not None
    index = lens.material.index_at(DISPERSION_LINES[lens.wavelength][colour], lens.wavelength)
    coloured = replace(lens, material=replace(lens.material, n_d=index, n_e=index))
    rays = trace(coloured, field.wearer, field.directions, within_outline=False)
    to_point = rays.direction + w * (rays.origin - field.origin)
    local = np.einsum("nij,nj->ni", field.gaze_frame, to_point)
    return 100 * local[:, :2] / local[:, 2:]
