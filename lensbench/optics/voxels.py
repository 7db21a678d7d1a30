"""The blur field of a view frustum: every gaze of a field on every plane straight ahead.

Source: Kakimoto, Tatsukawa & Nishita 2010; the gaze field holds what its columns of voxels have in common.
"""

import numpy as np
from numpy.typing import NDArray

from . import kernels
from .conventions import Floats, inverse_2x2
from .field import Accommodation, GazeField


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
    given, left = (0.0, eye.accommodation) if isinstance(rule, str) else (rule, 0.0)
    used = np.array(np.broadcast_to(given, field.status.shape)) / 1000
    numbers = np.array([eye.pupil_diameter / 2, *eye.pupil_refraction.ravel() / 1000, left / 1000])
    planes, out = np.asarray(z, dtype=np.float32), blur.reshape(4, used.size, -1)
    fill = kernels.surface.compiled(kernels.voxels.fill, kernels.voxels.SIGNATURE)
    fill(field.origin, field.direction, field.transfer, numbers, used, planes, out)
    return blur


def ndc_blur(field: GazeField, z: Floats, blur: NDArray[np.float32], half_angle: float) -> NDArray[np.float32]:
    """Blur matrices (2, 2, n, k) of blur_on_planes as the picture of the turning eye shows them: its NDC by pupil vector.

    half_angle: of the picture, rad. NDC: tangent of the gaze over that of half_angle, x to the wearer's left, y up.
    """
    out = np.empty_like(blur)
    tangent = field.directions[:, :2] / field.directions[:, 2:]
    across = field.gaze_frame[:, :2]
    per_turn = (across[..., :2] - across[..., 2:] * tangent[:, None]) / field.directions[:, 2:, None]
    per_turn = np.swapaxes(per_turn, 1, 2) / np.tan(half_angle)
    for k, plane in enumerate(z):
        distance = distance_to_plane(field, plane)
        turn = inverse_2x2(field.gaze_derivative(distance)) / distance[:, None, None]
        out[..., k] = np.moveaxis(per_turn @ turn @ np.moveaxis(blur[..., k], -1, 0), 0, -1)
    return out


def distance_to_plane(field: GazeField, z: float | Floats) -> Floats:
    """Distance (..., n) along each outgoing ray to the planes z (mm, wear frame); NaN where the plane lies behind."""
    along = (z - field.origin[:, 2]) / field.direction[:, 2]
    return np.where(along > 0, along, np.nan)
