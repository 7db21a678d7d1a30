"""The blur matrix in every voxel of a view frustum, from a gaze field: 16 bytes a voxel, as fast as they are written;
therefore float32 from the columns on, and the depths of one gaze side by side.
"""

import numba as nb
import numpy as np

from .surface import VECTOR, inline, kernel

VECTORS = nb.types.Array(nb.float64, 2, "A", readonly=True)
MATRICES = nb.types.Array(nb.float64, 3, "A", readonly=True)
DEPTHS = nb.types.Array(nb.float32, 1, "C", readonly=True)
SIGNATURE = nb.void(VECTORS, VECTORS, MATRICES, VECTOR, VECTOR, DEPTHS, nb.float32[:, :, ::1])
ZERO, HALF, NAN, single = np.float32(0), np.float32(0.5), np.float32(np.nan), np.float32


@inline
def column(t, i, r, v0, v1, v2, v3):
    """G = r (A + B V), H = r (C + D V), B and D of the i-th transfer matrix t, row by row, for the vergence V."""
    b0, b1, b2, b3 = t[i, 0, 2], t[i, 0, 3], t[i, 1, 2], t[i, 1, 3]
    d0, d1, d2, d3 = t[i, 2, 2], t[i, 2, 3], t[i, 3, 2], t[i, 3, 3]
    return (
        single(r * (t[i, 0, 0] + b0 * v0 + b1 * v2)), single(r * (t[i, 0, 1] + b0 * v1 + b1 * v3)),
        single(r * (t[i, 1, 0] + b2 * v0 + b3 * v2)), single(r * (t[i, 1, 1] + b2 * v1 + b3 * v3)),
        single(r * (t[i, 2, 0] + d0 * v0 + d1 * v2)), single(r * (t[i, 2, 1] + d0 * v1 + d1 * v3)),
        single(r * (t[i, 3, 0] + d2 * v0 + d3 * v2)), single(r * (t[i, 3, 1] + d2 * v1 + d3 * v3)),
        single(b0), single(b1), single(b2), single(b3), single(d0), single(d1), single(d2), single(d3),
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


@kernel
def fill(origin, direction, transfer, eye, used, depths, out):
    """Blur matrices M (mm) of n gazes on planes straight ahead.

    origin, direction (n, 3), transfer (n, 4, 4): as in a gaze field. eye (6,): pupil radius (mm), refraction row by row
    (1/mm), and what is left of the amplitude of accommodation (1/mm) beyond what is in `used` (n,). depths (k,): mm, wear
    frame. out (4, n, k): M row by row, NaN where the plane lies behind the lens.
    """
    limit = single(eye[0] * eye[5])
    for i in nb.prange(used.size):
        v = column(transfer, i, eye[0], eye[1] - used[i], eye[2], eye[3], eye[4] - used[i])
        z, per_depth = single(origin[i, 2]), single(1 / direction[i, 2])
        for k in range(depths.size):
            s = (depths[k] - z) * per_depth
            s = s if s > ZERO else NAN
            m = blurred(v, s, limit)
            out[0, i, k], out[1, i, k], out[2, i, k], out[3, i, k] = m[0], m[1], m[2], m[3]
