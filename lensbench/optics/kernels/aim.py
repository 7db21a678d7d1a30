"""Newton's method for the gaze whose chief ray meets a point."""

import math

import numba as nb

from .refract import ROWS
from .surface import FASTMATH, MATRIX, inline

LONGEST_TURN = 0.2  # rad


@inline
def listing(x, y, z):
    """e1 and e2 of the frame across a ray, flat."""
    k = 1.0 / (1.0 + z)
    return 1 - x * x * k, -x * y * k, -x, -x * y * k, 1 - y * y * k, -y


@nb.njit(
    nb.void(MATRIX, MATRIX, MATRIX, nb.float64, ROWS),
    nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FASTMATH,
)  # fmt: skip
def turn(traced, gaze, target, lever, out):
    """How far each chief ray misses its target, and the gaze that would mend it.

    traced (28, >= n): as trace.finish leaves it. gaze, target (3, n): unit vectors; mm, wear frame. lever: mm from the
    centre of rotation to the pupil. out (4, n): the turned gaze, and the distance (mm) by which the ray missed.
    """
    for i in nb.prange(gaze.shape[1]):
        dx, dy, dz = traced[9, i], traced[10, i], traced[11, i]
        rx, ry, rz = target[0, i] - traced[6, i], target[1, i] - traced[7, i], target[2, i] - traced[8, i]
        e = listing(dx, dy, dz)
        x, y = e[0] * rx + e[1] * ry + e[2] * rz, e[3] * rx + e[4] * ry + e[5] * rz
        s = dx * rx + dy * ry + dz * rz
        a = lever * (traced[12, i] + s * traced[20, i]) + traced[14, i] + s * traced[22, i]
        b = lever * (traced[13, i] + s * traced[21, i]) + traced[15, i] + s * traced[23, i]
        c = lever * (traced[16, i] + s * traced[24, i]) + traced[18, i] + s * traced[26, i]
        d = lever * (traced[17, i] + s * traced[25, i]) + traced[19, i] + s * traced[27, i]
        det = 1.0 / (a * d - b * c)
        u, v = (d * x - b * y) * det, (a * y - c * x) * det
        short = LONGEST_TURN / max(LONGEST_TURN, math.sqrt(u * u + v * v))
        u, v = u * short, v * short
        gx, gy, gz = gaze[0, i], gaze[1, i], gaze[2, i]
        f = listing(gx, gy, gz)
        gx, gy, gz = gx + u * f[0] + v * f[3], gy + u * f[1] + v * f[4], gz + u * f[2] + v * f[5]
        k = 1.0 / math.sqrt(gx * gx + gy * gy + gz * gz)
        out[0, i], out[1, i], out[2, i], out[3, i] = gx * k, gy * k, gz * k, math.sqrt(x * x + y * y)
