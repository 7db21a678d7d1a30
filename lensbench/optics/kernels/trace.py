"""The chief ray through both surfaces of a lens with its 4x4 transfer matrix, one ray after the other, in parallel.

Transverse rays are carried as rows of the transfer matrix: x0, x1 (offset, mm) and p0, p1 (optical momentum n * slope),
each a tuple of 4 (the derivative by the two start offsets and the two start slopes).
"""

import math

import numba as nb

from .surface import CELLS, FASTMATH, MATRIX, VECTOR, inline, intersect, sag

OK, MISSED_BACK, MISSED_FRONT, NOT_CONVERGED, TOTAL_INTERNAL_REFLECTION = 0, 1, 2, 4, 5


@inline
def mix(a, u, b, v):
    """a u + b v for two rows."""
    return (a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2], a * u[3] + b * v[3])


@inline
def frame_on_surface(q, fx, fy, dx, dy, dz):
    """Theta_ij = e_i . r_j: the Listing frame of the world ray d against the surface's tangents r_x, r_y."""
    k = 1.0 / (1.0 + dz)
    a0, a1, a2 = 1 - dx * dx * k, -dx * dy * k, -dx
    b0, b1, b2 = a1, 1 - dy * dy * k, -dy
    ax, ay, az = q[0] * a0 + q[3] * a1 + q[6] * a2, q[1] * a0 + q[4] * a1 + q[7] * a2, q[2] * a0 + q[5] * a1 + q[8] * a2
    bx, by, bz = q[0] * b0 + q[3] * b1 + q[6] * b2, q[1] * b0 + q[4] * b1 + q[7] * b2, q[2] * b0 + q[5] * b1 + q[8] * b2
    return ax + fx * az, ay + fy * az, bx + fx * bz, by + fy * bz


@inline
def refract_pencil(x0, x1, p0, p1, before, after, gamma, e, f, g):
    """Transverse rays through a surface of second fundamental form (e, f, g).

    Offsets keep their foot on the tangent plane; the tangential part of the momentum changes by -gamma II tau.
    Generalised Coddington equations in Hamiltonian form: Snell's law at the displaced foot, to first order.
    """
    a, b, c, d = before
    det = 1.0 / (a * d - b * c)
    t0, t1 = mix(d * det, x0, -b * det, x1), mix(-c * det, x0, a * det, x1)
    q0 = mix(1.0, mix(a, p0, c, p1), -gamma, mix(e, t0, f, t1))
    q1 = mix(1.0, mix(b, p0, d, p1), -gamma, mix(f, t0, g, t1))
    a, b, c, d = after
    det = 1.0 / (a * d - b * c)
    return mix(a, t0, b, t1), mix(c, t0, d, t1), mix(d * det, q0, -c * det, q1), mix(-b * det, q0, a * det, q1)


@inline
def cross_surface(surface, n0, n1, ray, rows):
    """One surface: (new ray, new rows, verdict). verdict: 0 ok, 1 missed or behind the start, 2 no convergence, 3 TIR."""
    kind, p, breaks_x, breaks_y, cells, q = surface
    x, y, z, dx, dy, dz = ray
    ox, oy, oz = x - q[9], y - q[10], z - q[11]
    lx, ly, lz = q[0] * ox + q[3] * oy + q[6] * oz, q[1] * ox + q[4] * oy + q[7] * oz, q[2] * ox + q[5] * oy + q[8] * oz
    ex, ey, ez = q[0] * dx + q[3] * dy + q[6] * dz, q[1] * dx + q[4] * dy + q[7] * dz, q[2] * dx + q[5] * dy + q[8] * dz
    t, verdict = intersect(kind, p, breaks_x, breaks_y, cells, lx, ly, lz, ex, ey, ez)
    if verdict != 0 or t < 0:
        return ray, rows, max(verdict, 1)
    _f, fx, fy, fxx, fxy, fyy = sag(kind, p, breaks_x, breaks_y, cells, lx + t * ex, ly + t * ey)
    area = 1.0 / math.sqrt(1 + fx * fx + fy * fy)
    cos_in = area * (ez - fx * ex - fy * ey)
    ratio = n0 / n1
    square = 1 - ratio * ratio * (1 - cos_in * cos_in)
    if square < 0:
        return ray, rows, 3
    cos_out = math.sqrt(square)
    k = (cos_out - ratio * cos_in) * area
    gx, gy, gz = ratio * ex - k * fx, ratio * ey - k * fy, ratio * ez + k
    wx, wy, wz = q[0] * gx + q[1] * gy + q[2] * gz, q[3] * gx + q[4] * gy + q[5] * gz, q[6] * gx + q[7] * gy + q[8] * gz
    x0, x1, p0, p1 = rows
    x0, x1 = mix(1.0, x0, t / n0, p0), mix(1.0, x1, t / n0, p1)
    rows = refract_pencil(
        x0, x1, p0, p1,
        frame_on_surface(q, fx, fy, dx, dy, dz), frame_on_surface(q, fx, fy, wx, wy, wz),
        n1 * cos_out - n0 * cos_in, area * fxx, area * fxy, area * fyy,
    )  # fmt: skip
    return (x + t * dx, y + t * dy, z + t * dz, wx, wy, wz), rows, 0


@inline
def verdict_to_status(verdict, missed):
    """Status of a ray from the verdict at one surface."""
    if verdict == 1:
        return missed
    return NOT_CONVERGED if verdict == 2 else TOTAL_INTERNAL_REFLECTION


SURFACE = nb.types.Tuple((nb.int64, VECTOR, VECTOR, VECTOR, CELLS, VECTOR))


@nb.njit(
    nb.void(SURFACE, SURFACE, nb.float64, MATRIX, MATRIX, nb.float64[:, ::1], nb.int8[::1]),
    nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FASTMATH,
)  # fmt: skip
def trace_rays(back, front, index, start, direction, out, status):
    """Trace n rays from the eye through the lens.

    back, front: (kind, p, breaks_x, breaks_y, cells, pose (12,): rotation row by row, then vertex; surface to wear frame).
    index: refractive index of the lens. start, direction: (3, n) mm and unit vectors, wear frame.
    out: (25, n): entry point on the back surface (3), exit point on the front surface (3), direction in the scene (3),
    transfer matrix row by row (16) from start to exit; NaN where status (n,) is not OK.
    """
    for i in nb.prange(status.size):
        ray = (start[0, i], start[1, i], start[2, i], direction[0, i], direction[1, i], direction[2, i])
        rows = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
        inner, rows, verdict = cross_surface(back, 1.0, index, ray, rows)
        state = OK if verdict == 0 else verdict_to_status(verdict, MISSED_BACK)
        outer = inner
        if state == OK:
            outer, rows, verdict = cross_surface(front, index, 1.0, inner, rows)
            state = OK if verdict == 0 else verdict_to_status(verdict, MISSED_FRONT)
        status[i] = state
        if state != OK:
            out[:, i] = math.nan
            continue
        for k in range(3):
            out[k, i] = inner[k]
        for k in range(6):
            out[3 + k, i] = outer[k]
        for r in range(4):
            for c in range(4):
                out[9 + 4 * r + c, i] = rows[r][c]
