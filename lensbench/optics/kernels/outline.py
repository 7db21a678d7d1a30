"""Whether points lie within the edge of a lens: a star-shaped curve, linear in polar coordinates about its centre."""

import math

import numba as nb

from .surface import VECTOR, inline

OUTLINE = nb.types.Tuple((VECTOR, VECTOR, VECTOR))


@inline
def inside(outline, x, y):
    """Whether (x, y) lies within the outline: limits (centre x, y, squares of the least and greatest radius), angles
    (rad, rising from 0 to below 2 pi) and the radii there; False for NaN.
    """
    limits, angles, radii = outline
    x, y = x - limits[0], y - limits[1]
    square = x * x + y * y
    if square <= limits[2]:
        return True
    if not square <= limits[3]:
        return False
    angle = math.atan2(y, x) % (2 * math.pi)
    low, high = -1, angles.size
    while high - low > 1:
        middle = (low + high) // 2
        if angle < angles[middle]:
            high = middle
        else:
            low = middle
    low, high = (high - 1) % angles.size, high % angles.size
    share = (angle - angles[low]) % (2 * math.pi) / ((angles[high] - angles[low]) % (2 * math.pi))
    radius = radii[low] + share * (radii[high] - radii[low])
    return square <= radius * radius


@nb.njit(
    nb.void(OUTLINE, VECTOR, VECTOR, nb.boolean[::1]),
    nogil=True, cache=True, error_model="numpy",
)  # fmt: skip
def contains(outline, x, y, out):
    """Fill out (n,) with whether the points x, y (n,) lie within the outline; on one thread, as surface.sag_at."""
    for i in range(x.size):
        out[i] = inside(outline, x[i], y[i])
