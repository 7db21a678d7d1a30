"""The blur field of a view frustum: every gaze of a field on every plane straight ahead.

Source: Kakimoto, Tatsukawa & Nishita 2010; the gaze field holds what its columns of voxels have in common.
"""

import numpy as np
from numpy.typing import NDArray

from .conventions import Floats
from .field import Accommodation, GazeField
from .kernels import voxels as kernel


def blur_on_planes(
    field: GazeField, z: Floats, rule: Accommodation = "retina", out: NDArray[np.float32] | None = None
) -> NDArray[np.float32]:
    """Blur matrices M (2, 2, n, k), mm across the outgoing rays, of n gazes on the planes z (k,) mm, wear frame.

    float32: within 1e-6 of the pupil's radius and 1e-8 rad at the lens's exit point of what field.blur says. NaN where a
    ray failed or the plane lies behind the lens. out: a C-contiguous array to fill instead of a new one.
    """
    blur = np.empty((2, 2, field.status.size, z.size), dtype=np.float32) if out is None else out
    if isinstance(rule, str) and rule != "retina":
        for k, plane in enumerate(z):
            blur[..., k] = np.moveaxis(field.blur(distance_to_plane(field, plane), rule), 0, -1)
        return blur
    eye = field.wearer.eye
    given, limit = (0.0, eye.accommodation) if isinstance(rule, str) else (rule, 0.0)
    columns, planes = _columns(field, given), np.asarray(z, dtype=np.float32)
    kernel.fill(columns, planes, np.float32(eye.pupil_diameter / 2000 * limit), blur.reshape(4, -1, planes.size))
    return blur


def distance_to_plane(field: GazeField, z: float | Floats) -> Floats:
    """Distance (..., n) along each outgoing ray to the planes z (mm, wear frame); NaN where the plane lies behind."""
    along = (z - field.origin[:, 2]) / field.direction[:, 2]
    return np.where(along > 0, along, np.nan)


def _columns(field: GazeField, accommodation: float | Floats) -> NDArray[np.float32]:
    """The columns (18, n) of kernels.voxels.fill; accommodation (D, a number or (n,)) that is given beforehand."""
    eye, transfer = field.wearer.eye, np.moveaxis(field.transfer, 0, 2)
    used = np.broadcast_to(accommodation, field.status.shape)
    vergence = (eye.pupil_refraction[..., None] - used * np.eye(2)[..., None]) / 1000
    columns = np.empty((18, used.size), dtype=np.float32)
    columns[0], columns[1] = field.origin[:, 2], 1 / field.direction[:, 2]
    blocks = columns[2:].reshape(4, 2, 2, -1)
    for k in (0, 1):
        offset, slope = transfer[2 * k : 2 * k + 2, :2], transfer[2 * k : 2 * k + 2, 2:]
        blocks[k] = eye.pupil_diameter / 2 * (offset + np.einsum("ijn,jkn->ikn", slope, vergence))
        blocks[2 + k] = slope
    return columns
