"""Newton's method for the gaze whose chief ray meets a point."""

import math

import numba as nb

from .refract import ROWS
from .surface import FASTMATH, MATRIX, inline

LONGEST_TURN = 0.2  # rad
STATES = nb.types.Array(nb.int8, 1, "C", readonly=True)
INDICES = nb.types.Array(nb.int64, 1, "C", readonly=True)


@inline
def listing(x, y, z):
    """e1 and e2 of the frame across a ray, flat."""
    k = 1.0 / (1.0 + z)
    return 1 - x * x * k, -x * y * k, -x, -x * y * k, 1 - y * y * k, -y


@inline
def missed(traced, j, tx, ty, tz, lever):
    """Where the j-th ray passes the target (mm, frame across the ray), and the turn of the gaze (rad) that mends it."""
    dx, dy, dz = traced[9, j], traced[10, j], traced[11, j]
    rx, ry, rz = tx - traced[6, j], ty - traced[7, j], tz - traced[8, j]
    e = listing(dx, dy, dz)
    x, y = e[0] * rx + e[1] * ry + e[2] * rz, e[3] * rx + e[4] * ry + e[5] * rz
    s = dx * rx + dy * ry + dz * rz
    a = lever * (traced[12, j] + s * traced[20, j]) + traced[14, j] + s * traced[22, j]
    b = lever * (traced[13, j] + s * traced[21, j]) + traced[15, j] + s * traced[23, j]
    c = lever * (traced[16, j] + s * traced[24, j]) + traced[18, j] + s * traced[26, j]
    d = lever * (traced[17, j] + s * traced[25, j]) + traced[19, j] + s * traced[27, j]
    det = 1.0 / (a * d - b * c)
    u, v = (d * x - b * y) * det, (a * y - c * x) * det
    short = LONGEST_TURN / max(LONGEST_TURN, math.sqrt(u * u + v * v))
    return x, y, u * short, v * short


@nb.njit(
    nb.void(MATRIX, STATES, INDICES, MATRIX, nb.float64, ROWS, ROWS, nb.float64[::1], nb.int8[::1]),
    nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FASTMATH,
)  # fmt: skip
def turn(traced, status, seeking, target, lever, passed, gaze, miss, reason):
    """By how much chief rays miss their targets, and the gazes that would mend it.

    traced (28, >= m), status (m,): as trace.judge leaves them, of the gazes number `seeking` (m,) of n. target (3, n): mm,
    wear frame. lever: mm from the centre of rotation to the pupil. Changed in place: passed (3, n), the last gaze whose ray
    passed; gaze (3, n), turned to the target, or half-way back to that one where the ray failed; miss (n,), mm, infinite
    where it failed; reason (n,), the first failure.
    """
    for j in nb.prange(seeking.size):
        i = seeking[j]
        gx, gy, gz = gaze[0, i], gaze[1, i], gaze[2, i]
        if status[j] == 0:
            x, y, u, v = missed(traced, j, target[0, i], target[1, i], target[2, i], lever)
            miss[i] = math.sqrt(x * x + y * y)
            passed[0, i], passed[1, i], passed[2, i] = gx, gy, gz
            f = listing(gx, gy, gz)
            gx, gy, gz = gx + u * f[0] + v * f[3], gy + u * f[1] + v * f[4], gz + u * f[2] + v * f[5]
        else:
            miss[i] = math.inf
            reason[i] = status[j] if reason[i] == 0 else reason[i]
            gx, gy, gz = gx + passed[0, i], gy + passed[1, i], gz + passed[2, i]
        k = 1.0 / math.sqrt(gx * gx + gy * gy + gz * gz)
        gaze[0, i], gaze[1, i], gaze[2, i] = gx * k, gy * k, gz * k
