"""Distortion: where the turning eye sees the directions of the object space, and how the picture changes over the gaze.

The local magnification matrix (GazeField.magnification) takes small turns of the line from the centre of rotation to the
object into the turns of the gaze that follow them, each in its Listing frame; the identity for the naked eye.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .conventions import Floats, unit
from .eye import Wearer
from .field import GazeField
from .gaze import look_at, trace
from .lens import Lens

STEP = 1e-3  # rad, of the central differences over the gaze
FAR = 1e8  # mm: as good as infinity for a chart


class Chart(NamedTuple):
    """Points of a flat chart: where they are and where the eye sees them, tangents (n, 2) at the centre of rotation; status."""

    object: Floats
    apparent: Floats
    status: NDArray[np.int8]


def seen_chart(lens: Lens | None, wearer: Wearer, tangents: ArrayLike, depth: float = np.inf) -> Chart:
    """How a chart straight ahead, `depth` mm before the cornea, is seen. tangents (n, 2): x and y over z of its points,
    from the centre of rotation; NaN where no ray within the outline meets the point."""
    at = np.asarray(tangents, dtype=float)
    away = min(depth, FAR) + wearer.eye.centre_of_rotation
    points = wearer.centre_of_rotation + away * np.column_stack([at, np.ones(len(at))])
    field = look_at(lens, wearer, points)
    seen = np.where((field.status == 0)[:, None], field.directions, np.nan)
    return Chart(at, seen[:, :2] / seen[:, 2:], field.status)


def area_magnification(magnification: Floats) -> Floats:
    """Linear magnification of equal area (...,): the root of the determinant."""
    m = magnification
    return np.sqrt(np.abs(m[..., 0, 0] * m[..., 1, 1] - m[..., 0, 1] * m[..., 1, 0]))


def anisotropy(magnification: Floats) -> Floats:
    """Greatest over least magnification, less 1 (...,)."""
    m = magnification
    turning = np.hypot(m[..., 0, 0] + m[..., 1, 1], m[..., 1, 0] - m[..., 0, 1])
    stretching = np.hypot(m[..., 0, 0] - m[..., 1, 1], m[..., 1, 0] + m[..., 0, 1])
    return 2 * stretching / (turning - stretching)


def rotation(magnification: Floats) -> Floats:
    """Turn (...,) of the image, rad, counter-clockwise seen from the front: the rotation of the polar decomposition."""
    m = magnification
    return np.arctan2(m[..., 1, 0] - m[..., 0, 1], m[..., 0, 0] + m[..., 1, 1])


def skew(magnification: Floats) -> Floats:
    """Skew (...,), rad: by how much the right angle between the images of +x and +y is too small."""
    x, y = magnification[..., 0], magnification[..., 1]
    return np.arcsin(np.sum(x * y, axis=-1) / (np.linalg.norm(x, axis=-1) * np.linalg.norm(y, axis=-1)))


def magnification_gradient(field: GazeField, distance: ArrayLike = np.inf) -> Floats:
    """Change of the magnification matrix over the gaze (n, 2, 2, 2), 1/rad; the last index is the gaze's turn along e1, e2.

    By central differences of traces, the object distance (mm, a number or (n,)) kept; the outline is ignored.
    """
    columns = []
    for across in (field.gaze_frame[:, 0], field.gaze_frame[:, 1]):
        ahead, behind = (
            trace(
                field.lens, field.wearer, unit(field.directions + sign * STEP * across), within_outline=False
            ).magnification(distance)
            for sign in (1, -1)
        )
        columns.append((ahead - behind) / (2 * STEP))
    return np.stack(columns, axis=-1)


def swim(field: GazeField, distance: ArrayLike = np.inf) -> Floats:
    """Swim (n,), 1/rad: |gradient of the magnification matrix over the gaze| / sqrt 2 (Frobenius norm).

    Where the picture is only enlarged it is the slope of the magnification; 1/rad = 1.745 %/degree.
    """
    return np.sqrt(np.sum(magnification_gradient(field, distance) ** 2, axis=(-3, -2, -1)) / 2)
