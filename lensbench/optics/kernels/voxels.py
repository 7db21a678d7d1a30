"""The blur matrix in every voxel of a view frustum, from the columns of a gaze field: 16 bytes a voxel, as fast as they are
written; therefore float32 throughout, and the depths of one gaze side by side.
"""

import numba as nb
import numpy as np

from .surface import FASTMATH, inline

COLUMNS = nb.types.Array(nb.float32, 2, "C", readonly=True)
DEPTHS = nb.types.Array(nb.float32, 1, "C", readonly=True)
ZERO, HALF, NAN = np.float32(0), np.float32(0.5), np.float32(np.nan)


@inline
def column(c, i):
    """G, H, B and D of the i-th gaze."""
    return (
        c[2, i], c[3, i], c[4, i], c[5, i], c[6, i], c[7, i], c[8, i], c[9, i],
        c[10, i], c[11, i], c[12, i], c[13, i], c[14, i], c[15, i], c[16, i], c[17, i],
    )  # fmt: skip


@inline
def blurred(v, s, limit):
    """M = G + s H - a N with N = B + s D, flat; a: half the trace of N^-1 (G + s H) within 0 and the limit, which makes
    the rms blur on the retina smallest.
    """
    n0, n1, n2, n3 = v[8] + s * v[12], v[9] + s * v[13], v[10] + s * v[14], v[11] + s * v[15]
    m0, m1, m2, m3 = v[0] + s * v[4], v[1] + s * v[5], v[2] + s * v[6], v[3] + s * v[7]
    a = HALF * (n3 * m0 - n1 * m2 + n0 * m3 - n2 * m1) / (n0 * n3 - n1 * n2)
    a = a if a > ZERO else ZERO
    a = a if a < limit else limit
    return m0 - a * n0, m1 - a * n1, m2 - a * n2, m3 - a * n3


@nb.njit(
    nb.void(COLUMNS, DEPTHS, nb.float32, nb.float32[:, :, ::1]),
    nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FASTMATH,
)  # fmt: skip
def fill(columns, depths, limit, out):
    """Blur matrices M (mm) of n gazes on planes straight ahead.

    columns (18, n): z (mm) of each ray's origin, 1 / z of its direction, and what M is made of, row by row: G = r (A + B R),
    H = r (C + D R), B, D with the pupil's radius r (mm) and the refraction R (1/mm). depths (k,): mm, wear frame. limit:
    amplitude of accommodation (1/mm) times r. out (4, n, k): M row by row, NaN where the plane lies behind the lens.
    """
    for i in nb.prange(columns.shape[1]):
        v, z, per_depth = column(columns, i), columns[0, i], columns[1, i]
        for k in range(depths.size):
            s = (depths[k] - z) * per_depth
            s = s if s > ZERO else NAN
            m = blurred(v, s, limit)
            out[0, i, k], out[1, i, k], out[2, i, k], out[3, i, k] = m[0], m[1], m[2], m[3]
