"""The lens without an eye: vertex powers as a focimeter (lensmeter) reads them, and the powers of its surfaces.

A focimeter's axis meets the surface that lies on its stop along that surface's normal. Within the lens such a ray goes
straight on along the normal, so that the other surface is met where the normal cuts it. Everything is in the lens frame;
powers and prisms lie in the frame across the normal (the lens's x and y carried by the minimal rotation of +z onto it).
Source: ISO 8598-1 (focimeters that focus on the axis), ISO 13666 (back and front vertex power).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .conventions import Floats, inverse_2x2, listing_frame, unit
from .eye import Wear
from .gaze import TracedRays, trace_rays, worn_pose
from .lens import Lens, surface_height
from .surfaces import Surface

UNWORN = Wear()
_MOST_STEPS = 60
_LEAD = 1.0  # mm of air before the back surface


class VertexPower(NamedTuple):
    """What a focimeter reads at n points: power (n, 2, 2) D; prism (n, 2) cm/m along x and y, towards the base; status (n,)."""

    power: Floats
    prism: Floats
    status: NDArray[np.int8]


def back_vertex_power(lens: Lens, x: ArrayLike, y: ArrayLike) -> VertexPower:
    """Reading with the back surface on the stop, centred so that the axis leaves the front surface at lens points x, y, mm.

    The vergence at the back surface of light from infinity: -D^-1 C of the transfer matrix along the back normal.
    """
    start = _back_points(lens, _front_points(lens, x, y))
    normal = surface_normal(lens.back, start[:, 0], start[:, 1])
    rays = _traced(lens, start, normal)
    transfer = rays.transfer
    local = np.einsum("nij,nj->ni", listing_frame(normal), rays.direction)
    power = -1000 * inverse_2x2(transfer[:, 2:, 2:]) @ transfer[:, 2:, :2]
    return VertexPower(power, 100 * local[:, :2] / local[:, 2:], rays.status)


def front_vertex_power(lens: Lens, x: ArrayLike, y: ArrayLike) -> VertexPower:
    """Reading with the front surface on the stop at lens points x, y, mm; prism seen along the front normal.

    Light that is parallel behind the lens: -C A^-1 of the transfer matrix, in the frame across the front normal.
    """
    front = _front_points(lens, x, y)
    normal = surface_normal(lens.front, front[:, 0], front[:, 1])
    start = _back_points(lens, front, normal)
    eye_side = _refracted(normal, surface_normal(lens.back, start[:, 0], start[:, 1]), lens.index)
    rays = _traced(lens, start, eye_side)
    transfer = rays.transfer
    local = np.einsum("nij,nj->ni", listing_frame(normal), eye_side)
    power = -1000 * transfer[:, 2:, :2] @ inverse_2x2(transfer[:, :2, :2])
    return VertexPower(power, -100 * local[:, :2] / local[:, 2:], rays.status)


def surface_power(surface: Surface, x: ArrayLike, y: ArrayLike, index: float) -> Floats:
    """Power (..., 2, 2) in D of a posed surface at lens points x, y (mm), as a front surface; see Surface.surface_power."""
    u, v = _surface_points(surface, x, y)
    normal = surface_normal(surface, x, y)
    turn = (listing_frame(normal) @ surface.rotation @ np.swapaxes(listing_frame(normal @ surface.rotation), -1, -2))[
        ..., :2, :2
    ]
    return turn @ surface.surface_power(u, v, index) @ np.swapaxes(turn, -1, -2)


def surface_normal(surface: Surface, x: ArrayLike, y: ArrayLike) -> Floats:
    """Unit normals (..., 3) of a posed surface at lens points x, y (mm, any shape), towards the scene."""
    _, fx, fy, *_ = surface.derivatives(*_surface_points(surface, x, y))
    return unit(np.stack([-fx, -fy, np.ones_like(fx)], axis=-1)) @ surface.rotation.T


def _surface_points(surface: Surface, x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
    """Lens points x, y (mm) of a posed surface in its own frame."""
    z = surface_height(surface, x, y)
    decentred = np.asarray(x) - surface.decentration[0], np.asarray(y) - surface.decentration[1], z
    local = np.stack(np.broadcast_arrays(*decentred), axis=-1) @ surface.rotation
    return local[..., 0], local[..., 1]


def _front_points(lens: Lens, x: ArrayLike, y: ArrayLike) -> Floats:
    px, py = np.broadcast_arrays(np.asarray(x, dtype=float).ravel(), np.asarray(y, dtype=float).ravel())
    return np.stack([px, py, lens.front_height(px, py)], axis=-1)


def _back_points(lens: Lens, front: Floats, normal: Floats | None = None) -> Floats:
    """Points (n, 3) of the back surface that lie behind the front points (n, 3) along `normal`, or along its own normals.

    Found by repetition: the error shrinks by about thickness over radius each time.
    """
    start = front
    for _ in range(_MOST_STEPS):
        along = surface_normal(lens.back, start[:, 0], start[:, 1]) if normal is None else normal
        way = (front[:, 2] - lens.back_height(start[:, 0], start[:, 1])) / along[:, 2]
        last, start = start, front - way[:, None] * along
        if np.nanmax(np.abs(start - last), initial=0.0) < 1e-12:
            break
    return start


def _refracted(inside: Floats, normal: Floats, index: float) -> Floats:
    """Directions (n, 3) in air of rays with directions `inside` the lens: Snell's law in vector form."""
    tangential = index * (inside - np.sum(inside * normal, axis=1, keepdims=True) * normal)
    with np.errstate(invalid="ignore"):
        return tangential + np.sqrt(1 - np.sum(tangential**2, axis=1, keepdims=True)) * normal


def _traced(lens: Lens, start: Floats, direction: Floats) -> TracedRays:
    """Rays from points on the back surface (lens frame) through the lens, with their transfer matrices from there."""
    rays = trace_rays(lens, UNWORN, worn_pose(lens, UNWORN).to_wear(start) - _LEAD * direction, direction)
    transfer = rays.transfer.copy()
    transfer[:, :, 2:] -= _LEAD * transfer[:, :, :2]
    return rays._replace(transfer=transfer)
