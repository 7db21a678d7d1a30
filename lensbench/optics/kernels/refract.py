"""One surface for many rays at once: a vectorised kernel for each kind of surface. Frames and units as in surface, trace.

Each kernel starts on a quadric near the surface, comes closer on a parabola along the ray (on a spline by the terms up to
third order about the middle of a cell) and corrects t and the slopes of the next evaluation by the second derivatives
instead of evaluating once more. A ray that is not safely met in this way becomes NaN: trace.search takes it up with the
search that never fails.

A kernel's arguments: surface (kind, p, breaks_x, breaks_y, bins_x, bins_y, cells, pose (12,): rotation row by row, then
vertex; surface to wear frame); bins_x and bins_y again, or None where all cells of a spline are equally wide; n0, n1
refractive indices; rays, refracted (6, n): point (mm) and unit direction in the wear frame, of which `count` columns from
`first` on are read and written. Of the first surface, rays has those columns only, before is None and out (9, count) takes
its bends: the way to the surface t (mm), then U and W row by row, with which the surface takes offset x and optical momentum
p of a transverse ray to U x and W x + U^-T p, in the Listing frames of the rays before and after it. Of the second surface,
before holds the bends of the first one, and out and lower (8, n) take the upper and the lower half of the transfer matrices
through both: more rows of one array than this, and LLVM will not compare so many for overlaps, and vectorise. Of the first,
lower is None.
"""

import math

import numba as nb

from .surface import BINS, CELLS, MATRIX, VECTOR, biconic, conic, eight, inline, kernel, middle, toric
from .transfer import store_transfer, transfer

SURFACE = nb.types.Tuple((nb.int64, VECTOR, VECTOR, VECTOR, BINS, BINS, CELLS, VECTOR))
ROWS = nb.float64[:, ::1]
UNKNOWN = (0.0, 0.0, 0.0, 0.0)
LAST_STEP = 1e-5  # mm: a smaller last step leaves 1e-12 mm and 1e-6 D


def signature(even, second):
    """The types of a kernel's arguments, for even cells or any, for the first or the second surface."""
    bins = nb.none if even else BINS
    before, lower = (MATRIX, ROWS) if second else (nb.none, nb.none)
    indices = nb.float64, nb.float64
    return nb.void(SURFACE, bins, bins, *indices, MATRIX, ROWS, before, ROWS, lower, nb.uint64, nb.uint64)


@inline
def pose_of(pose):
    """The pose as a tuple of numbers."""
    return pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6], pose[7], pose[8], pose[9], pose[10], pose[11]


@inline
def to_surface(q, ray):
    """Point and direction of a ray in the surface's frame."""
    x, y, z, dx, dy, dz = ray
    ox, oy, oz = x - q[9], y - q[10], z - q[11]
    return (
        q[0] * ox + q[3] * oy + q[6] * oz,
        q[1] * ox + q[4] * oy + q[7] * oz,
        q[2] * ox + q[5] * oy + q[8] * oz,
        q[0] * dx + q[3] * dy + q[6] * dz,
        q[1] * dx + q[4] * dy + q[7] * dz,
        q[2] * dx + q[5] * dy + q[8] * dz,
    )


@inline
def to_quadric(a, b, c, local):
    """Distance along the ray to the near side of a u^2 + b v^2 + c z^2 + 2 z = 0; NaN if it misses. Frame of the axes."""
    u, v, z, du, dv, dz = local
    square = a * du * du + b * dv * dv + c * dz * dz
    half = a * u * du + b * v * dv + c * z * dz + dz
    rest = a * u * u + b * v * v + c * z * z + 2 * z
    return -rest / (half + math.sqrt(half * half - square * rest))


@inline
def to_sphere(c, local):
    """Distance along the ray to the near side of the sphere of curvature c through the vertex; NaN if it misses."""
    x, y, z, dx, dy, dz = local
    half = c * (x * dx + y * dy + z * dz) + dz
    rest = c * (x * x + y * y + z * z) + 2 * z
    return -rest / (half + math.sqrt(half * half - c * rest))


@inline
def on_axes(c, s, local):
    """The ray in the frame of the meridians: u along the one at the angle of cosine c and sine s, v across it."""
    x, y, z, dx, dy, dz = local
    return c * x + s * y, c * y - s * x, z, c * dx + s * dy, c * dy - s * dx, dz


@inline
def closer(d, t, local):
    """The next t, from (f, fx, fy, fxx, fxy, fyy) at t: where the ray meets the parabola above it."""
    f, fx, fy, fxx, fxy, fyy = d
    dx, dy, dz = local[3], local[4], local[5]
    error, slope = local[2] + t * dz - f, dz - fx * dx - fy * dy
    bend = -(fxx * dx * dx + 2 * fxy * dx * dy + fyy * dy * dy)
    return t - 2 * error / (slope + math.sqrt(slope * slope - 2 * error * bend))


@inline
def settle(d, third, t, local):
    """The last t and (fx, fy, fxx, fxy, fyy, area) there, all NaN when the last step is not small or leads backwards.

    third: (fxxx, fxxy, fxyy, fyyy), roughly.
    """
    f, fx, fy, fxx, fxy, fyy = d
    step = (f - local[2] - t * local[5]) / (local[5] - fx * local[3] - fy * local[4])
    step = step if (abs(step) < LAST_STEP) & (t >= 0) else math.nan
    u, v = step * local[3], step * local[4]
    fx, fy = fx + fxx * u + fxy * v, fy + fxy * u + fyy * v
    fxx, fxy = fxx + third[0] * u + third[1] * v, fxy + third[1] * u + third[2] * v
    fyy = fyy + third[2] * u + third[3] * v
    return t + step, fx, fy, fxx, fxy, fyy, 1 / math.sqrt(1 + fx * fx + fy * fy)


@inline
def reciprocals(a, b):
    """1 / a and 1 / b by one division."""
    k = 1 / (a * b)
    return b * k, a * k


@inline
def tangents(q, fx, fy):
    """The surface's tangents (1, 0, fx) and (0, 1, fy) in the wear frame, flat."""
    return (
        q[0] + fx * q[2], q[3] + fx * q[5], q[6] + fx * q[8],
        q[1] + fy * q[2], q[4] + fy * q[5], q[7] + fy * q[8],
    )  # fmt: skip


@inline
def listing_on_tangents(r, x, y, k, a, b):
    """Theta_ij = e_i . r_j: the Listing frame e_i of a ray (x, y, z) against the tangents r_j in the wear frame.

    k = 1 / (1 + z); a, b: the ray on the two tangents. The frame is e_i = E_i - k d_i (d + E_z) with the axes E of wear.
    """
    a, b = k * (a + r[2]), k * (b + r[5])
    return r[0] - x * a, r[3] - x * b, r[1] - y * a, r[4] - y * b


@inline
def bend(q, ray, local, met, n0, n1):
    """Refraction where the surface is met: the new ray (6), t, U (4) and W (4), flat. met: as from settle.

    Snell's law, and its derivative (generalised Coddington equations): an offset keeps its foot on the tangent plane,
    the tangential part of the momentum changes by -gamma II tau. det Theta = cos / area, area = 1 / sqrt(1 + slope^2).
    """
    t, fx, fy, fxx, fxy, fyy, area = met
    x, y, z, dx, dy, dz = ray
    r = tangents(q, fx, fy)
    cos_in = area * (local[5] - fx * local[3] - fy * local[4])
    ratio = n0 / n1
    cos_out = math.sqrt(1 - ratio * ratio * (1 - cos_in * cos_in))
    k = (cos_out - ratio * cos_in) * area
    nx, ny, nz = q[2] - fx * q[0] - fy * q[1], q[5] - fx * q[3] - fy * q[4], q[8] - fx * q[6] - fy * q[7]
    wx, wy, wz = ratio * dx + k * nx, ratio * dy + k * ny, ratio * dz + k * nz
    in_front, behind = reciprocals(1 + dz, 1 + wz)
    per_cos_in, per_cos_out = reciprocals(cos_in, cos_out)
    along_x, along_y = local[3] + fx * local[5], local[4] + fy * local[5]
    a, b, c, d = listing_on_tangents(r, dx, dy, in_front, along_x, along_y)
    i = area * per_cos_in
    a, b, c, d = d * i, -b * i, -c * i, a * i
    e, f, g, h = listing_on_tangents(r, wx, wy, behind, ratio * along_x, ratio * along_y)
    gamma = -(n1 * cos_out - n0 * cos_in) * area * area * per_cos_out
    xa, xb, ya, yb = fxx * a + fxy * c, fxx * b + fxy * d, fxy * a + fyy * c, fxy * b + fyy * d
    return (
        x + t * dx, y + t * dy, z + t * dz, wx, wy, wz, t,
        e * a + f * c, e * b + f * d, g * a + h * c, g * b + h * d,
        gamma * (h * xa - g * ya), gamma * (h * xb - g * yb), gamma * (e * ya - f * xa), gamma * (e * yb - f * xb),
    )  # fmt: skip


@inline
def load(rays, i):
    """The i-th ray."""
    return rays[0, i], rays[1, i], rays[2, i], rays[3, i], rays[4, i], rays[5, i]


@inline
def incoming(rays, before, first, k):
    """The k-th ray before the surface."""
    return load(rays, k if before is None else first + k)


@inline
def store(refracted, before, out, lower, first, k, v, n0):
    """The k-th ray after the surface; and what the surface, or both surfaces, did to it."""
    i = first + k
    refracted[0, i], refracted[1, i], refracted[2, i] = v[0], v[1], v[2]
    refracted[3, i], refracted[4, i], refracted[5, i] = v[3], v[4], v[5]
    if before is None:
        out[0, k], out[1, k], out[2, k], out[3, k], out[4, k] = v[6], v[7], v[8], v[9], v[10]
        out[5, k], out[6, k], out[7, k], out[8, k] = v[11], v[12], v[13], v[14]
    else:
        u0 = before[1, k], before[2, k], before[3, k], before[4, k]
        w0 = before[5, k], before[6, k], before[7, k], before[8, k]
        u1 = v[7], v[8], v[9], v[10]
        w1 = v[11], v[12], v[13], v[14]
        store_transfer(out, lower, i, transfer(before[0, k], u0, w0, v[6] / n0, u1, w1))


@kernel
def spheres(surface, bins_x, bins_y, n0, n1, rays, refracted, before, out, lower, first, count):
    """Spheres and planes: CONIC with nothing but a curvature, in closed form."""
    _kind, p, _bx, _by, _nx, _ny, _cells, pose = surface
    c, q = p[0], pose_of(pose)
    for k in nb.prange(count):
        ray = incoming(rays, before, first, k)
        local = to_surface(q, ray)
        t = to_sphere(c, local)
        normal = 1 + c * (local[2] + t * local[5])
        t = t if (t >= 0) & (normal > 0) else math.nan
        f2 = -c / normal
        fx, fy = f2 * (local[0] + t * local[3]), f2 * (local[1] + t * local[4])
        met = t, fx, fy, f2 * (1 + fx * fx), f2 * fx * fy, f2 * (1 + fy * fy), normal
        store(refracted, before, out, lower, first, k, bend(q, ray, local, met, n0, n1), n0)


@kernel
def conics(surface, bins_x, bins_y, n0, n1, rays, refracted, before, out, lower, first, count):
    """CONIC."""
    _kind, parameters, _bx, _by, _nx, _ny, _cells, pose = surface
    p, q = eight(parameters), pose_of(pose)
    for k in nb.prange(count):
        ray = incoming(rays, before, first, k)
        local = to_surface(q, ray)
        t = to_quadric(p[0], p[0], (1 + p[1]) * p[0], local)
        t = closer(conic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        t = closer(conic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        met = settle(conic(p, local[0] + t * local[3], local[1] + t * local[4]), UNKNOWN, t, local)
        store(refracted, before, out, lower, first, k, bend(q, ray, local, met, n0, n1), n0)


@inline
def closer_to_torus(p, t, axial):
    """The next t, from the implicit form of the torus: the depth g of the arc below a point of the turned profile, twice.

    axial: the ray in the frame of the meridians. Its second derivative along the ray is near that of the quadric.
    """
    ca, cb = p[0], p[1]
    u, v, z, du, dv, dz = axial
    u, v, z = u + t * du, v + t * dv, z + t * dz
    h, h1 = -2 * z - cb * (z * z + v * v), -2 * dz - 2 * cb * (z * dz + v * dv)
    root = math.sqrt(1 - cb * h)
    k, k1 = reciprocals(1 + root, 2 * root)
    g, g1 = h * k, h1 * k1
    error, slope = 2 * g - ca * (g * g + u * u), 2 * g1 - 2 * ca * (g * g1 + u * du)
    square = ca * du * du + cb * dv * dv + 0.5 * (ca + cb) * dz * dz
    return t - error / (slope + square * error / slope)


@kernel
def torics(surface, bins_x, bins_y, n0, n1, rays, refracted, before, out, lower, first, count):
    """TORIC."""
    _kind, parameters, _bx, _by, _nx, _ny, _cells, pose = surface
    p, q = eight(parameters), pose_of(pose)
    for k in nb.prange(count):
        ray = incoming(rays, before, first, k)
        local = to_surface(q, ray)
        axial = on_axes(p[2], p[3], local)
        t = closer_to_torus(p, to_quadric(p[0], p[1], 0.5 * (p[0] + p[1]), axial), axial)
        met = settle(toric(p, local[0] + t * local[3], local[1] + t * local[4]), UNKNOWN, t, local)
        store(refracted, before, out, lower, first, k, bend(q, ray, local, met, n0, n1), n0)


@kernel
def biconics(surface, bins_x, bins_y, n0, n1, rays, refracted, before, out, lower, first, count):
    """BICONIC."""
    _kind, parameters, _bx, _by, _nx, _ny, _cells, pose = surface
    p, q = eight(parameters), pose_of(pose)
    for k in nb.prange(count):
        ray = incoming(rays, before, first, k)
        local = to_surface(q, ray)
        t = to_quadric(p[0], p[1], 0.5 * ((1 + p[4]) * p[0] + (1 + p[5]) * p[1]), on_axes(p[2], p[3], local))
        t = closer(biconic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        t = closer(biconic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        met = settle(biconic(p, local[0] + t * local[3], local[1] + t * local[4]), UNKNOWN, t, local)
        store(refracted, before, out, lower, first, k, bend(q, ray, local, met, n0, n1), n0)


@inline
def axis_of(breaks, bins):
    """Where an axis of cells starts (mm), its bins per mm, its last bin and a bin's width (mm)."""
    last = breaks.size - 2 if bins is None else bins.size - 1
    width = (breaks[-1] - breaks[0]) / (last + 1)
    return breaks[0], 1 / width, last, width


@inline
def locate(axis, breaks, bins, x):
    """The cell of x, wherever a bin holds no more than one breakpoint, and x from the cell's middle; x is NaN-safe."""
    start, per_mm, last, width = axis
    k = min(max(int((x - start) * per_mm), 0), last)
    if bins is None:
        return k, x - start - (k + 0.5) * width
    cell = bins[k]
    cell += x >= breaks[cell + 1]
    return cell, x - middle(breaks, cell)


@inline
def in_cell(breaks, bins, cell, x):
    """Whether x lies in its cell; without bins, whether it lies in any."""
    first, last = (0, breaks.size - 1) if bins is None else (cell, cell + 1)
    return (x >= breaks[first]) & (x <= breaks[last])


@inline
def cubic(a, b, c, d, s):
    """Polynomial a + b s + c s^2 + d s^3, its first and its second derivative."""
    return a + s * (b + s * (c + s * d)), b + s * (2 * c + s * 3 * d), 2 * c + 6 * s * d


@inline
def quintic(a, b, c, d, e, f, s):
    """Polynomial a + b s + ... + f s^5, its first and its second derivative."""
    return (
        a + s * (b + s * (c + s * (d + s * (e + s * f)))),
        b + s * (2 * c + s * (3 * d + s * (4 * e + s * 5 * f))),
        2 * c + s * (6 * d + s * (12 * e + s * 20 * f)),
    )


@inline
def cubic_row(cells, c, k, s):
    """The row of a cell from its k-th number on, of four, as a polynomial in s."""
    return cubic(cells[c, k], cells[c, k + 1], cells[c, k + 2], cells[c, k + 3], s)


@inline
def quintic_row(cells, c, k, s):
    """The row of a cell from its k-th number on, of six, as a polynomial in s."""
    return quintic(cells[c, k], cells[c, k + 1], cells[c, k + 2], cells[c, k + 3], cells[c, k + 4], cells[c, k + 5], s)


@inline
def bicubic(cells, c, s, t):
    """(f, fx, fy, fxx, fxy, fyy) in a cell of 4 x 4."""
    a0, a1, a2 = cubic_row(cells, c, 0, s)
    b0, b1, b2 = cubic_row(cells, c, 4, s)
    c0, c1, c2 = cubic_row(cells, c, 8, s)
    d0, d1, d2 = cubic_row(cells, c, 12, s)
    f, fy, fyy = cubic(a0, b0, c0, d0, t)
    fx, fxy, _ = cubic(a1, b1, c1, d1, t)
    fxx, _, _ = cubic(a2, b2, c2, d2, t)
    return f, fx, fy, fxx, fxy, fyy


@inline
def biquintic(cells, c, s, t):
    """(f, fx, fy, fxx, fxy, fyy) in a cell of 6 x 6."""
    a0, a1, a2 = quintic_row(cells, c, 0, s)
    b0, b1, b2 = quintic_row(cells, c, 6, s)
    c0, c1, c2 = quintic_row(cells, c, 12, s)
    d0, d1, d2 = quintic_row(cells, c, 18, s)
    e0, e1, e2 = quintic_row(cells, c, 24, s)
    f0, f1, f2 = quintic_row(cells, c, 30, s)
    f, fy, fyy = quintic(a0, b0, c0, d0, e0, f0, t)
    fx, fxy, _ = quintic(a1, b1, c1, d1, e1, f1, t)
    fxx, _, _ = quintic(a2, b2, c2, d2, e2, f2, t)
    return f, fx, fy, fxx, fxy, fyy


@inline
def third_order(cells, c, n, s, t):
    """(f, fx, fy, fxx, fxy, fyy) of a cell of n x n by the terms up to third order: near enough for a first step, and few
    numbers to fetch.
    """
    a, ax, axx = cubic_row(cells, c, 0, s)
    b0, b1, b2 = cells[c, n], cells[c, n + 1], cells[c, n + 2]
    c0, c1, d0 = cells[c, 2 * n], cells[c, 2 * n + 1], cells[c, 3 * n]
    b, bx, d = b0 + s * (b1 + s * b2), b1 + 2 * s * b2, c0 + s * c1
    return (
        a + t * (b + t * (d + t * d0)), ax + t * (bx + t * c1), b + t * (2 * d + t * 3 * d0),
        axx + 2 * t * b2, bx + 2 * t * c1, 2 * d + 6 * t * d0,
    )  # fmt: skip


@inline
def third_derivatives(cells, c, n):
    """(fxxx, fxxy, fxyy, fyyy) in the middle of a cell of n x n."""
    return 6 * cells[c, 3], 2 * cells[c, n + 2], 2 * cells[c, 2 * n + 1], 6 * cells[c, 3 * n]


@kernel
def bicubics(surface, bins_x, bins_y, n0, n1, rays, refracted, before, out, lower, first, count):
    """SPLINE up to degree 3."""
    _kind, p, bx, by, _nx, _ny, cells, pose = surface
    across, cells = cells.shape[1], cells.reshape(-1, 16)
    c, q, axis_x, axis_y = p[0], pose_of(pose), axis_of(bx, bins_x), axis_of(by, bins_y)
    for k in nb.prange(count):
        ray = incoming(rays, before, first, k)
        local = to_surface(q, ray)
        t = to_sphere(c, local)
        i, x = locate(axis_x, bx, bins_x, local[0] + t * local[3])
        j, y = locate(axis_y, by, bins_y, local[1] + t * local[4])
        t = closer(third_order(cells, j * across + i, 4, x, y), t, local)
        i, x = locate(axis_x, bx, bins_x, local[0] + t * local[3])
        j, y = locate(axis_y, by, bins_y, local[1] + t * local[4])
        cell = j * across + i
        inside = in_cell(bx, bins_x, i, local[0] + t * local[3]) & in_cell(by, bins_y, j, local[1] + t * local[4])
        t = t if inside else math.nan
        met = settle(bicubic(cells, cell, x, y), third_derivatives(cells, cell, 4), t, local)
        store(refracted, before, out, lower, first, k, bend(q, ray, local, met, n0, n1), n0)


@kernel
def biquintics(surface, bins_x, bins_y, n0, n1, rays, refracted, before, out, lower, first, count):
    """SPLINE of degree 4 and 5."""
    _kind, p, bx, by, _nx, _ny, cells, pose = surface
    across, cells = cells.shape[1], cells.reshape(-1, 36)
    c, q, axis_x, axis_y = p[0], pose_of(pose), axis_of(bx, bins_x), axis_of(by, bins_y)
    for k in nb.prange(count):
        ray = incoming(rays, before, first, k)
        local = to_surface(q, ray)
        t = to_sphere(c, local)
        i, x = locate(axis_x, bx, bins_x, local[0] + t * local[3])
        j, y = locate(axis_y, by, bins_y, local[1] + t * local[4])
        t = closer(third_order(cells, j * across + i, 6, x, y), t, local)
        i, x = locate(axis_x, bx, bins_x, local[0] + t * local[3])
        j, y = locate(axis_y, by, bins_y, local[1] + t * local[4])
        cell = j * across + i
        inside = in_cell(bx, bins_x, i, local[0] + t * local[3]) & in_cell(by, bins_y, j, local[1] + t * local[4])
        t = t if inside else math.nan
        met = settle(biquintic(cells, cell, x, y), third_derivatives(cells, cell, 6), t, local)
        store(refracted, before, out, lower, first, k, bend(q, ray, local, met, n0, n1), n0)
