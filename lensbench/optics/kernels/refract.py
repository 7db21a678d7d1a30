"""One surface for many rays at once: a vectorised kernel for each kind of surface. Frames and units as in surface, trace.

Each kernel starts Newton's method on a sphere, makes two steps (a spline's first one by the terms up to third order) and
corrects the slopes of the third evaluation by the second derivatives instead of evaluating once more. A ray that is not
safely met in this way becomes NaN: trace.finish takes it up with the search that never fails.

A kernel's arguments: surface (kind, p, breaks_x, breaks_y, bins_x, bins_y, cells, pose (12,): rotation row by row, then
vertex; surface to wear frame); n0, n1 refractive indices; rays, refracted (6, n): point (mm) and unit direction in the
wear frame, of which the columns from `first` on, as many as `bends` is wide, are read and written; bends (9, m): the way
to the surface t (mm), then U and W row by row, with which the surface takes offset x and optical momentum p of a
transverse ray to U x and W x + U^-T p, in the Listing frames of the rays before and after it.
"""

import math

import numba as nb

from .surface import BINS, CELLS, MATRIX, VECTOR, biconic, bin_of, conic, eight, inline, kernel, toric

SURFACE = nb.types.Tuple((nb.int64, VECTOR, VECTOR, VECTOR, BINS, BINS, CELLS, VECTOR))
ROWS = nb.float64[:, ::1]
LAST_STEP = 1e-6  # mm: a smaller last step leaves 1e-14 mm and 1e-7 D

SIGNATURE = nb.void(SURFACE, nb.float64, nb.float64, MATRIX, ROWS, ROWS, nb.uint64)


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
def to_sphere(c, local):
    """Distance along the ray to the near side of the sphere of curvature c; NaN if it misses."""
    x, y, z, dx, dy, dz = local
    b = c * (x * dx + y * dy + z * dz) + dz
    e = c * (x * x + y * y + z * z) + 2 * z
    return -e / (b + math.sqrt(b * b - c * e))


@inline
def newton(d, t, local):
    """The next t, from (f, fx, fy, ...) at t."""
    return t - (local[2] + t * local[5] - d[0]) / (local[5] - d[1] * local[3] - d[2] * local[4])


@inline
def settle(d, t, local):
    """The last t and (fx, fy, fxx, fxy, fyy) there, all NaN when the last step is not small or leads backwards."""
    f, fx, fy, fxx, fxy, fyy = d
    step = (f - local[2] - t * local[5]) / (local[5] - fx * local[3] - fy * local[4])
    step = step if (abs(step) < LAST_STEP) & (t >= 0) else math.nan
    u, v = step * local[3], step * local[4]
    return t + step, fx + fxx * u + fxy * v, fy + fxy * u + fyy * v, fxx, fxy, fyy


@inline
def listing_on_tangents(q, fx, fy, dx, dy, dz):
    """Theta_ij = e_i . r_j: the Listing frame of the world ray d against the surface's tangents r_x, r_y."""
    k = 1.0 / (1.0 + dz)
    a0, a1, a2 = 1 - dx * dx * k, -dx * dy * k, -dx
    b0, b1, b2 = a1, 1 - dy * dy * k, -dy
    ax, ay, az = q[0] * a0 + q[3] * a1 + q[6] * a2, q[1] * a0 + q[4] * a1 + q[7] * a2, q[2] * a0 + q[5] * a1 + q[8] * a2
    bx, by, bz = q[0] * b0 + q[3] * b1 + q[6] * b2, q[1] * b0 + q[4] * b1 + q[7] * b2, q[2] * b0 + q[5] * b1 + q[8] * b2
    return ax + fx * az, ay + fy * az, bx + fx * bz, by + fy * bz


@inline
def bend(q, ray, local, met, n0, n1):
    """Refraction where the surface is met: the new ray (6), t, U (4) and W (4), flat. met: t, fx, fy, fxx, fxy, fyy.

    Snell's law, and its derivative (generalised Coddington equations): an offset keeps its foot on the tangent plane,
    the tangential part of the momentum changes by -gamma II tau. det Theta = cos / area, area = 1 / sqrt(1 + slope^2).
    """
    t, fx, fy, fxx, fxy, fyy = met
    x, y, z, dx, dy, dz = ray
    area = 1.0 / math.sqrt(1 + fx * fx + fy * fy)
    cos_in = area * (local[5] - fx * local[3] - fy * local[4])
    ratio = n0 / n1
    cos_out = math.sqrt(1 - ratio * ratio * (1 - cos_in * cos_in))
    k = (cos_out - ratio * cos_in) * area
    gx, gy, gz = ratio * local[3] - k * fx, ratio * local[4] - k * fy, ratio * local[5] + k
    wx, wy, wz = q[0] * gx + q[1] * gy + q[2] * gz, q[3] * gx + q[4] * gy + q[5] * gz, q[6] * gx + q[7] * gy + q[8] * gz
    a, b, c, d = listing_on_tangents(q, fx, fy, dx, dy, dz)
    i = area / cos_in
    a, b, c, d = d * i, -b * i, -c * i, a * i
    e, f, g, h = listing_on_tangents(q, fx, fy, wx, wy, wz)
    gamma = -(n1 * cos_out - n0 * cos_in) * area * area / cos_out
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
def store(refracted, bends, first, i, v):
    """The i-th ray after the surface, and what the surface did to it."""
    refracted[0, first + i], refracted[1, first + i], refracted[2, first + i] = v[0], v[1], v[2]
    refracted[3, first + i], refracted[4, first + i], refracted[5, first + i] = v[3], v[4], v[5]
    bends[0, i], bends[1, i], bends[2, i], bends[3, i], bends[4, i] = v[6], v[7], v[8], v[9], v[10]
    bends[5, i], bends[6, i], bends[7, i], bends[8, i] = v[11], v[12], v[13], v[14]


@kernel
def spheres(surface, n0, n1, rays, refracted, bends, first):
    """Spheres and planes: CONIC with nothing but a curvature, in closed form."""
    _kind, p, _bx, _by, _nx, _ny, _cells, pose = surface
    c, q = p[0], pose_of(pose)
    for i in nb.prange(bends.shape[1]):
        ray = load(rays, first + i)
        local = to_surface(q, ray)
        t = to_sphere(c, local)
        normal = 1 + c * (local[2] + t * local[5])
        t = t if (t >= 0) & (normal > 0) else math.nan
        k = -c / normal
        fx, fy = k * (local[0] + t * local[3]), k * (local[1] + t * local[4])
        met = t, fx, fy, k * (1 + fx * fx), k * fx * fy, k * (1 + fy * fy)
        store(refracted, bends, first, i, bend(q, ray, local, met, n0, n1))


@kernel
def conics(surface, n0, n1, rays, refracted, bends, first):
    """CONIC."""
    _kind, parameters, _bx, _by, _nx, _ny, _cells, pose = surface
    p, q = eight(parameters), pose_of(pose)
    for i in nb.prange(bends.shape[1]):
        ray = load(rays, first + i)
        local = to_surface(q, ray)
        t = to_sphere(p[0], local)
        t = newton(conic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        t = newton(conic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        met = settle(conic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        store(refracted, bends, first, i, bend(q, ray, local, met, n0, n1))


@kernel
def torics(surface, n0, n1, rays, refracted, bends, first):
    """TORIC."""
    _kind, parameters, _bx, _by, _nx, _ny, _cells, pose = surface
    p, q = eight(parameters), pose_of(pose)
    for i in nb.prange(bends.shape[1]):
        ray = load(rays, first + i)
        local = to_surface(q, ray)
        t = to_sphere(0.5 * (p[0] + p[1]), local)
        t = newton(toric(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        t = newton(toric(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        met = settle(toric(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        store(refracted, bends, first, i, bend(q, ray, local, met, n0, n1))


@kernel
def biconics(surface, n0, n1, rays, refracted, bends, first):
    """BICONIC."""
    _kind, parameters, _bx, _by, _nx, _ny, _cells, pose = surface
    p, q = eight(parameters), pose_of(pose)
    for i in nb.prange(bends.shape[1]):
        ray = load(rays, first + i)
        local = to_surface(q, ray)
        t = to_sphere(0.5 * (p[0] + p[1]), local)
        t = newton(biconic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        t = newton(biconic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        met = settle(biconic(p, local[0] + t * local[3], local[1] + t * local[4]), t, local)
        store(refracted, bends, first, i, bend(q, ray, local, met, n0, n1))


@inline
def guess_cell(breaks, bins, x):
    """Index of the cell of x, wherever a bin holds no more than one breakpoint; x is NaN-safe."""
    cell = bins[bin_of(breaks, bins.size, x)]
    return cell + (x >= breaks[cell + 1])


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
def cubic_row(cells, j, i, b, s):
    """The b-th row of a cell of 4 x 4, as a polynomial in s."""
    return cubic(cells[j, i, b, 0], cells[j, i, b, 1], cells[j, i, b, 2], cells[j, i, b, 3], s)


@inline
def quintic_row(cells, j, i, b, s):
    """The b-th row of a cell of 6 x 6, as a polynomial in s."""
    return quintic(
        cells[j, i, b, 0],
        cells[j, i, b, 1],
        cells[j, i, b, 2],
        cells[j, i, b, 3],
        cells[j, i, b, 4],
        cells[j, i, b, 5],
        s,
    )


@inline
def bicubic(cells, j, i, s, t):
    """(f, fx, fy, fxx, fxy, fyy) in a cell of 4 x 4."""
    a0, a1, a2 = cubic_row(cells, j, i, 0, s)
    b0, b1, b2 = cubic_row(cells, j, i, 1, s)
    c0, c1, c2 = cubic_row(cells, j, i, 2, s)
    d0, d1, d2 = cubic_row(cells, j, i, 3, s)
    f, fy, fyy = cubic(a0, b0, c0, d0, t)
    fx, fxy, _ = cubic(a1, b1, c1, d1, t)
    fxx, _, _ = cubic(a2, b2, c2, d2, t)
    return f, fx, fy, fxx, fxy, fyy


@inline
def biquintic(cells, j, i, s, t):
    """(f, fx, fy, fxx, fxy, fyy) in a cell of 6 x 6."""
    a0, a1, a2 = quintic_row(cells, j, i, 0, s)
    b0, b1, b2 = quintic_row(cells, j, i, 1, s)
    c0, c1, c2 = quintic_row(cells, j, i, 2, s)
    d0, d1, d2 = quintic_row(cells, j, i, 3, s)
    e0, e1, e2 = quintic_row(cells, j, i, 4, s)
    f0, f1, f2 = quintic_row(cells, j, i, 5, s)
    f, fy, fyy = quintic(a0, b0, c0, d0, e0, f0, t)
    fx, fxy, _ = quintic(a1, b1, c1, d1, e1, f1, t)
    fxx, _, _ = quintic(a2, b2, c2, d2, e2, f2, t)
    return f, fx, fy, fxx, fxy, fyy


@inline
def corner(cells, j, i, s, t):
    """(f, fx, fy) of a cell by the terms up to third order: near enough for a first step, and few numbers to fetch."""
    a, ax, _ = cubic_row(cells, j, i, 0, s)
    b0, b1, b2 = cells[j, i, 1, 0], cells[j, i, 1, 1], cells[j, i, 1, 2]
    c0, c1, d0 = cells[j, i, 2, 0], cells[j, i, 2, 1], cells[j, i, 3, 0]
    b, c = b0 + s * (b1 + s * b2), c0 + s * c1
    return a + t * (b + t * (c + t * d0)), ax + t * (b1 + 2 * s * b2 + t * c1), b + t * (2 * c + t * 3 * d0)


@inline
def in_cell(breaks, cell, x):
    """Whether x lies in the cell."""
    return (x >= breaks[cell]) & (x <= breaks[cell + 1])


@kernel
def bicubics(surface, n0, n1, rays, refracted, bends, first):
    """SPLINE up to degree 3."""
    _kind, p, bx, by, nx, ny, cells, pose = surface
    c, q = p[0], pose_of(pose)
    for k in nb.prange(bends.shape[1]):
        ray = load(rays, first + k)
        local = to_surface(q, ray)
        t = to_sphere(c, local)
        x, y = local[0] + t * local[3], local[1] + t * local[4]
        i, j = guess_cell(bx, nx, x), guess_cell(by, ny, y)
        t = newton(corner(cells, j, i, x - bx[i], y - by[j]), t, local)
        x, y = local[0] + t * local[3], local[1] + t * local[4]
        i, j = guess_cell(bx, nx, x), guess_cell(by, ny, y)
        t = newton(bicubic(cells, j, i, x - bx[i], y - by[j]), t, local)
        x, y = local[0] + t * local[3], local[1] + t * local[4]
        i, j = guess_cell(bx, nx, x), guess_cell(by, ny, y)
        t = t if in_cell(bx, i, x) & in_cell(by, j, y) else math.nan
        met = settle(bicubic(cells, j, i, x - bx[i], y - by[j]), t, local)
        store(refracted, bends, first, k, bend(q, ray, local, met, n0, n1))


@kernel
def biquintics(surface, n0, n1, rays, refracted, bends, first):
    """SPLINE of degree 4 and 5."""
    _kind, p, bx, by, nx, ny, cells, pose = surface
    c, q = p[0], pose_of(pose)
    for k in nb.prange(bends.shape[1]):
        ray = load(rays, first + k)
        local = to_surface(q, ray)
        t = to_sphere(c, local)
        x, y = local[0] + t * local[3], local[1] + t * local[4]
        i, j = guess_cell(bx, nx, x), guess_cell(by, ny, y)
        t = newton(corner(cells, j, i, x - bx[i], y - by[j]), t, local)
        x, y = local[0] + t * local[3], local[1] + t * local[4]
        i, j = guess_cell(bx, nx, x), guess_cell(by, ny, y)
        t = newton(biquintic(cells, j, i, x - bx[i], y - by[j]), t, local)
        x, y = local[0] + t * local[3], local[1] + t * local[4]
        i, j = guess_cell(bx, nx, x), guess_cell(by, ny, y)
        t = t if in_cell(bx, i, x) & in_cell(by, j, y) else math.nan
        met = settle(biquintic(cells, j, i, x - bx[i], y - by[j]), t, local)
        store(refracted, bends, first, k, bend(q, ray, local, met, n0, n1))
