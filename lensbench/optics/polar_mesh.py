"""A lens as polygons on a polar grid within its outline."""

import numpy as np
from numpy.typing import NDArray

from .conventions import Floats
from .lens import Lens, Outline


def polar_points(outline: Outline, rings: int, around: int) -> Floats:
    """x, y (1 + rings * around, 2), mm: the outline's centre, then rings of `around` points, the last one on the outline."""
    x, y = outline.points(around)
    fraction = np.linspace(1 / rings, 1, rings)[:, None, None]
    rim = np.stack([x, y], axis=-1) - outline.centre
    return np.concatenate([np.zeros((1, 2)), (fraction * rim).reshape(-1, 2)]) + outline.centre


def polar_faces(rings: int, around: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Triangles round the middle vertex and quadrilaterals between the rings, counter-clockwise seen from the scene."""
    here = np.arange(around)
    beside = np.roll(here, -1)
    triangles = np.stack([np.zeros_like(here), 1 + here, 1 + beside], axis=-1)
    inner = 1 + around * np.arange(rings - 1)[:, None]
    quads = np.stack([inner + here, inner + around + here, inner + around + beside, inner + beside], axis=-1)
    return triangles, quads.reshape(-1, 4)


def lens_triangles(lens: Lens, rings: int = 60, around: int = 360) -> tuple[Floats, NDArray[np.intp]]:
    """The closed skin of a lens: points (n, 3), mm, lens frame, and triangles (m, 3), counter-clockwise from outside.

    The first half of the points lies on the front, in the order of polar_points, the second half on the back.
    """
    flat = polar_points(lens.outline, rings, around)
    middle, quads = polar_faces(rings, around)
    front = np.concatenate([middle, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    half, last = len(flat), len(flat) - around
    here = last + np.arange(around)
    beside = last + np.roll(np.arange(around), -1)
    edge = np.concatenate(
        [np.stack([here, here + half, beside + half], axis=-1), np.stack([here, beside + half, beside], axis=-1)]
    )
    points = [np.column_stack([flat, z]) for z in (lens.front_height(*flat.T), lens.back_height(*flat.T))]
    return np.concatenate(points), np.concatenate([front, front[:, ::-1] + half, edge])
