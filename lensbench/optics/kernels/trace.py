"""One ray at a time with the search that never fails, for the rays that the vectorised kernels of refract leave as NaN;
and what became of each ray.
"""

import math

import numba as nb
import numpy as np

from .outline import OUTLINE, inside
from .refract import ROWS, SURFACE, bend, load, pose_of, to_surface
from .surface import FASTMATH, MATRIX, VECTOR, called, inline, intersect, sag
from .transfer import store_transfer, transfer

OK, MISSED_BACK, MISSED_FRONT, OUTSIDE_OUTLINE, NOT_CONVERGED, TOTAL_INTERNAL_REFLECTION = range(6)
SOUGHT = -1
LENS = nb.types.Tuple((SURFACE, SURFACE, VECTOR))
INDICES = nb.types.Array(nb.int64, 1, "C", readonly=True)
SEARCH = nb.void(LENS, nb.float64, OUTLINE, MATRIX, nb.int64, INDICES, ROWS, nb.int8[::1])
ONE, BLOCK = np.uint64(1), np.uint64(64)


@called
def cross(surface, n0, n1, ray):
    """One surface, surely: the verdict 0 ok, 1 missed or behind the start, 2 no convergence, 3 total internal reflection,
    and what `bend` returns.
    """
    shape, q = surface[:7], pose_of(surface[7])
    local = to_surface(q, ray)
    t, verdict = intersect(shape, local[0], local[1], local[2], local[3], local[4], local[5])
    _f, fx, fy, fxx, fxy, fyy = sag(shape, local[0] + t * local[3], local[1] + t * local[4])
    v = bend(q, ray, local, (t, fx, fy, fxx, fxy, fyy, 1 / math.sqrt(1 + fx * fx + fy * fy)), n0, n1)
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
def trace_one(back, front, index, ray, out, upper, lower, i):
    """The i-th ray through the lens into column i of out and of its last rows, upper and lower; its status."""
    verdict, inner = cross(back, 1.0, index, ray)
    if verdict != 0:
        return verdict_to_status(verdict, MISSED_BACK)
    verdict, outer = cross(front, index, 1.0, inner[:6])
    if verdict != 0:
        return verdict_to_status(verdict, MISSED_FRONT)
    for k in range(6):
        out[k, i], out[6 + k, i] = inner[k], outer[k]
    store_transfer(
        upper, lower, i, transfer(inner[6], inner[7:11], inner[11:], outer[6] / index, outer[7:11], outer[11:])
    )
    return OK


@inline
def on_lens(q, out, row, i):
    """x, y in the lens frame, whose pose is q, of the i-th point (wear frame) in three rows of out."""
    x, y, z = out[row, i] - q[9], out[row + 1, i] - q[10], out[row + 2, i] - q[11]
    return q[0] * x + q[3] * y + q[6] * z, q[1] * x + q[4] * y + q[7] * z


@inline
def surely_inside(limits, point):
    """Whether a point lies within the least radius of the outline (limits as of it); False for NaN."""
    x, y = point[0] - limits[0], point[1] - limits[1]
    return x * x + y * y <= limits[2]


@called
def outline_status(outline, q, out, i):
    """Status of the i-th ray, which has passed the surfaces: whether it enters and leaves within the outline."""
    for row in (0, 6):
        x, y = on_lens(q, out, row, i)
        if not inside(outline, x, y):
            return OUTSIDE_OUTLINE
    return OK


@nb.njit(
    nb.void(VECTOR, OUTLINE, nb.uint64, nb.uint64, ROWS, nb.int8[::1]),
    nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FASTMATH,
)  # fmt: skip
def judge(pose, outline, first, count, out, status):
    """Status (n,) of so many rays from `first` on: those that enter or leave beyond the outline of the lens, whose pose (12,)
    is given, fail and become NaN; those whose direction in out (row 11) is NaN are SOUGHT, for `search` to take up.

    out (28, >= n): in the lens the point on the back surface (3) and the direction (3), in the scene the point on the front
    surface (3) and the direction (3), wear frame, mm; then the transfer matrix (16) row by row. A block of rays that all pass
    near the centre of the outline, the rule, is told at once by a loop that LLVM vectorises.
    """
    limits, q = outline[0], pose_of(pose)
    for block in nb.prange((count + BLOCK - ONE) // BLOCK):
        low, high = first + block * BLOCK, first + min(count, (block + ONE) * BLOCK)
        passed = 0
        for i in range(low, high):
            entered, left = on_lens(q, out, 0, i), on_lens(q, out, 6, i)
            passed += surely_inside(limits, entered) & surely_inside(limits, left) & (out[11, i] == out[11, i])
        for i in range(low, high):
            status[i] = OK
            if passed < high - low:
                status[i] = SOUGHT if math.isnan(out[11, i]) else outline_status(outline, q, out, i)
            if status[i] == OUTSIDE_OUTLINE:
                out[:, i] = math.nan


@nb.njit(nogil=True, cache=True, error_model="numpy", fastmath=FASTMATH)
def search(lens, index, outline, rays, first, sought, out, status):
    """Trace the rays number `sought` (m,) after `first`, of rays (6, >= count), by the search that never fails; columns of out
    (28, >= n) and their status (n,) as `judge` leaves them, and NaN where the status is not OK.

    lens: back surface, front surface and pose (12,) of the lens; index: of its material. On one thread: several may share
    the rays.
    """
    back, front, pose = lens
    q = pose_of(pose)
    for k in sought:
        i = first + k
        state = trace_one(back, front, index, load(rays, k), out, out[12:20], out[20:28], i)
        status[i] = outline_status(outline, q, out, i) if state == OK else state
        if status[i] != OK:
            out[:, i] = math.nan
