"""FieldAtlas: the gaze field of a lens as a table to interpolate in, for what must place many points fast.

The chief ray of the gaze with tangents (u, v) passes origin + depth * slope, depth in mm beyond a plane z = const before
the eye; its pupil vectors land at r_p [(A + depth C) + (B + depth D) S] d across the ray. All eight are tabled and affine
in depth, and none of them knows the eye's refraction, accommodation or pupil: another eye behind the same lens needs no
other table. Lengths in mm from the centre of rotation, wear frame.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from .conventions import Floats, ReadOnlyArrays, Status, unit
from .eye import Wearer
from .field import GazeField
from .gaze import trace
from .lens import Lens
from .lens_edge import LensEdge

BEYOND = 1.05  # on the tangents of the edge


@dataclass(frozen=True, slots=True, eq=False)
class FieldAtlas(ReadOnlyArrays):
    """Tables over a grid of gazes; u (nx,), v (ny,): equally spaced tangents x/z and y/z of the gaze.

    plane: z of the plane from which depth counts. table (5, ny, nx, 4), float32: origin and slope (ox, oy, tx, ty) of the
    chief ray at that plane; then the 2x2 matrices A, C, B, D row by row, between the Listing frames of gaze and outgoing
    ray. Where no ray passes, and past the edge, the nearest ray's deviation and matrices stand.
    """

    u: Floats
    v: Floats
    plane: float
    table: NDArray[np.float32]


def field_atlas(
    lens: Lens | None,
    wearer: Wearer,
    box: tuple[float, float, float, float],
    samples: int,
    edge: LensEdge | None = None,
) -> FieldAtlas:
    """The atlas of a worn lens (None: the naked eye), of its surfaces beyond the outline too.

    box: least and greatest tangent u, then v. samples: grid points along the box's longer side; its cells are squares.
    edge: the lens's; from BEYOND times it on rays are not used, for grazing ones go astray.
    """
    u0, u1, v0, v1 = box
    pitch = max(u1 - u0, v1 - v0) / (samples - 1)
    u, v = (low + pitch * np.arange(np.ceil((high - low) / pitch - 1e-9) + 1) for low, high in ((u0, u1), (v0, v1)))
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    gaze = unit(np.column_stack([uv, np.ones(len(uv))]))
    field = trace(lens, wearer, gaze, within_outline=False)
    plane = wearer.vertex_sphere_radius
    table = _table(field, uv, plane)
    used = field.status == Status.OK
    if edge is not None:
        used &= edge.within(gaze, BEYOND)
    grid = np.where(used, 0, 1).reshape(v.size, u.size)
    if grid.any() and not grid.all():
        nearest = distance_transform_edt(grid, return_distances=False, return_indices=True)
        table = table[np.ravel_multi_index(nearest, grid.shape).ravel()]
    straight = np.concatenate([plane * uv, uv], axis=1)
    table[:, :4] += straight
    tiles = np.moveaxis(table.reshape(v.size, u.size, 5, 4), 2, 0)
    return FieldAtlas(u, v, plane, np.ascontiguousarray(tiles, dtype=np.float32))


def _table(field: GazeField, uv: Floats, plane: float) -> Floats:
    """Rows (n, 20) of the table; origin and slope less those of the straight ray through uv (n, 2)."""
    leaving = field.origin - field.wearer.centre_of_rotation
    slope = field.direction[:, :2] / field.direction[:, 2:]
    to_plane = (plane - leaving[:, 2:]) / field.direction[:, 2:]
    origin = leaving[:, :2] + to_plane * field.direction[:, :2]
    per_depth = 1 / field.direction[:, 2:]
    a, b, c, d = (
        field.transfer[:, rows, columns].reshape(-1, 4)
        for rows in (slice(0, 2), slice(2, 4))
        for columns in (slice(0, 2), slice(2, 4))
    )
    straight = origin - plane * uv, slope - uv
    return np.concatenate([*straight, a + to_plane * c, per_depth * c, b + to_plane * d, per_depth * d], axis=1)
