"""From what each surface does to a ray to the transfer matrix of the lens; and one ray at a time with the search that
never fails, for the rays that the vectorised kernels of refract leave as NaN.

Transverse rays: x0, x1 (offset, mm) and p0, p1 (optical momentum n * slope).
"""

import math

import numba as nb

from .outline import OUTLINE, inside
from .refract import ROWS, SURFACE, bend, load, pose_of, to_surface
from .surface import FASTMATH, MATRIX, VECTOR, called, inline, intersect, sag

OK, MISSED_BACK, MISSED_FRONT, OUTSIDE_OUTLINE, NOT_CONVERGED, TOTAL_INTERNAL_REFLECTION = range(6)
LENS = nb.types.Tuple((SURFACE, SURFACE, VECTOR))


@inline
def times(a, b):
    """Product of two 2 x 2 matrices, row by row."""
    return a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]


@inline
def plus(a, k, b):
    """a + k b for two 2 x 2 matrices."""
    return a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2], a[3] + k * b[3]


@inline
def inverse_transposed(u):
    """U^-T of a 2 x 2 matrix."""
    k = 1.0 / (u[0] * u[3] - u[1] * u[2])
    return u[3] * k, -u[2] * k, -u[1] * k, u[0] * k


@inline
def transfer(t0, u0, w0, t1, u1, w1):
    """The blocks A, B, C, D (16 numbers) over the ways t0, t1 (mm, divided by the index) and both surfaces' U and W."""
    c, d = w0, plus(inverse_transposed(u0), t0, w0)
    a, b = plus(u0, t1, c), plus((t0 * u0[0], t0 * u0[1], t0 * u0[2], t0 * u0[3]), t1, d)
    v1 = inverse_transposed(u1)
    c, d = plus(times(w1, a), 1.0, times(v1, c)), plus(times(w1, b), 1.0, times(v1, d))
    a, b = times(u1, a), times(u1, b)
    return (
        a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3], c[0], c[1], c[2], c[3], d[0], d[1], d[2], d[3],
    )  # fmt: skip


@inline
def store_transfer(out, i, v):
    """The 4 x 4 matrix of the i-th ray, row by row."""
    out[12, i], out[13, i], out[14, i], out[15, i] = v[0], v[1], v[4], v[5]
    out[16, i], out[17, i], out[18, i], out[19, i] = v[2], v[3], v[6], v[7]
    out[20, i], out[21, i], out[22, i], out[23, i] = v[8], v[9], v[12], v[13]
    out[24, i], out[25, i], out[26, i], out[27, i] = v[10], v[11], v[14], v[15]


@nb.njit(
    nb.void(MATRIX, MATRIX, nb.float64, nb.uint64, ROWS),
    nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FASTMATH,
)  # fmt: skip
def compose(back, front, index, first, out):
    """Transfer matrices into rows 12 to 27 of out, from `first` on; back, front (9, m): bends as written by refract."""
    for i in nb.prange(back.shape[1]):
        u0 = back[1, i], back[2, i], back[3, i], back[4, i]
        w0 = back[5, i], back[6, i], back[7, i], back[8, i]
        u1 = front[1, i], front[2, i], front[3, i], front[4, i]
        w1 = front[5, i], front[6, i], front[7, i], front[8, i]
        store_transfer(out, first + i, transfer(back[0, i], u0, w0, front[0, i] / index, u1, w1))


@called
def cross(surface, n0, n1, ray):
    """One surface, surely: the verdict 0 ok, 1 missed or behind the start, 2 no convergence, 3 total internal reflection,
    and what `bend` returns.
    """
    shape, q = surface[:7], pose_of(surface[7])
    local = to_surface(q, ray)
    t, verdict = intersect(shape, local[0], local[1], local[2], local[3], local[4], local[5])
    _f, fx, fy, fxx, fxy, fyy = sag(shape, local[0] + t * local[3], local[1] + t * local[4])
    v = bend(q, ray, local, (t, fx, fy, fxx, fxy, fyy), n0, n1)
    if verdict == 0:
        verdict = 1 if t < 0 else (0 if math.isfinite(v[3]) else 3)
    return verdict, v


@called
def verdict_to_status(verdict, missed):
    """Status of a ray from the verdict at one surface."""
    if verdict == 1:
        return missed
    return NOT_CONVERGED if verdict == 2 else TOTAL_INTERNAL_REFLECTION


@called
def trace_one(back, front, index, ray, out, i):
    """The i-th ray through the lens into column i of out; its status."""
    verdict, inner = cross(back, 1.0, index, ray)
    if verdict != 0:
        return verdict_to_status(verdict, MISSED_BACK)
    verdict, outer = cross(front, index, 1.0, inner[:6])
    if verdict != 0:
        return verdict_to_status(verdict, MISSED_FRONT)
    for k in range(6):
        out[k, i], out[6 + k, i] = inner[k], outer[k]
    store_transfer(out, i, transfer(inner[6], inner[7:11], inner[11:], outer[6] / index, outer[7:11], outer[11:]))
    return OK


@inline
def within(outline, q, point):
    """Whether a point (wear frame) lies within the outline of the lens whose pose is q."""
    x, y, z = point[0] - q[9], point[1] - q[10], point[2] - q[11]
    return inside(outline, q[0] * x + q[3] * y + q[6] * z, q[1] * x + q[4] * y + q[7] * z)


@nb.njit(
    nb.void(LENS, nb.float64, OUTLINE, MATRIX, ROWS, nb.int8[::1]),
    nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FASTMATH,
)  # fmt: skip
def finish(lens, index, outline, rays, out, status):
    """Trace those of the n rays (6, n) whose direction in out (row 11) is NaN one by one, and fill in status (n,).

    lens: back surface, front surface and pose (12,) of the lens; index: of its material. Rays that enter or leave beyond
    its outline fail. out (28, >= n): in the lens the point on the back surface (3) and the direction (3), in the scene the
    point on the front surface (3) and the direction (3), wear frame, mm; then the transfer matrix (16) row by row; NaN
    where the status is not OK.
    """
    back, front, pose = lens
    q = pose_of(pose)
    for i in nb.prange(status.size):
        state = OK
        if math.isnan(out[11, i]):
            state = trace_one(back, front, index, load(rays, i), out, i)
        if state == OK:
            entry, leaving = (out[0, i], out[1, i], out[2, i]), (out[6, i], out[7, i], out[8, i])
            state = OK if within(outline, q, entry) and within(outline, q, leaving) else OUTSIDE_OUTLINE
        if state != OK:
            out[:, i] = math.nan
        status[i] = state
