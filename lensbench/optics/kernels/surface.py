"""Sag and its derivatives for every surface kind, and where one ray meets a surface. Surface frame, mm.

A surface is its kind (int) and plain arrays: p (8 parameters), breaks_x and breaks_y (breakpoints of the spline cells,
mm), bins_x and bins_y (cell at the lower end of each of equal bins between the first and the last breakpoint) and cells
(ny, nx, k, k), k = 4 up to degree 3 and 6 above: cells[j, i, b, a] multiplies t^b s^a with (s, t) from the cell's middle.
Parameters p by kind, curvatures in 1/mm, positive with the centre of curvature on the eye's side (depth = -sag):
    CONIC    c, k, a4, a6, a8, a10, a12, a14 : depth = c q / (1 + sqrt(1 - (1+k) c^2 q)) + a4 q^2 + ...,  q = x^2 + y^2
    TORIC    ca, cb, cos, sin : arc of curvature ca along the axis meridian, turned about a line at the radius 1/cb
    BICONIC  ca, cb, cos, sin, ka, kb : biconic with the first pair along the axis meridian
    SPLINE   c0 : curvature of the sphere from which the search for the intersection starts

Functions that are inlined into a loop over rays are straight-line code on numbers and flat tuples of them: with that LLVM
vectorises the loop. A tuple within a tuple is enough to stop it: numba then takes the arrays for overlapping ones.
"""

import math

import numba as nb

CONIC, TORIC, BICONIC, SPLINE = 0, 1, 2, 3
MAX_STEPS = 50

VECTOR = nb.types.Array(nb.float64, 1, "C", readonly=True)
MATRIX = nb.types.Array(nb.float64, 2, "C", readonly=True)
BINS = nb.types.Array(nb.int32, 1, "C", readonly=True)
CELLS = nb.types.Array(nb.float64, 4, "C", readonly=True)
SHAPE = nb.types.Tuple((nb.int64, VECTOR, VECTOR, VECTOR, BINS, BINS, CELLS))

FASTMATH = {"contract", "nsz"}  # what leaves NaN and infinity alone
NO_WRAPPERS = {
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}  # Python does not call them: a fifth less to compile
inline = nb.njit(nogil=True, cache=True, error_model="numpy", fastmath=FASTMATH, forceinline=True, **NO_WRAPPERS)
called = nb.njit(nogil=True, cache=True, error_model="numpy", fastmath=FASTMATH, **NO_WRAPPERS)
kernel = nb.njit(nogil=True, cache=True, parallel=True, error_model="numpy", fastmath=FASTMATH)


def compiled(lazy, signature):
    """A kernel without a signature of its own, compiled when it is first needed: few runs need all of them."""
    if signature.args not in lazy.overloads:
        lazy.disable_compile(False)
        lazy.compile(signature)
        lazy.disable_compile()
    return lazy


@inline
def eight(p):
    """The parameters as a tuple of numbers."""
    return p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]


@inline
def conic(p, x, y):
    """Rotationally symmetric conic with even asphere terms: (f, fx, fy, fxx, fxy, fyy) of the sag."""
    c, k, a4, a6, a8, a10, a12, a14 = p
    q = x * x + y * y
    root = math.sqrt(1 - (1 + k) * c * c * q)
    steeper = 1 / root
    depth = c * q / (1 + root) + q * q * (a4 + q * (a6 + q * (a8 + q * (a10 + q * (a12 + q * a14)))))
    first = c / 2 * steeper + q * (2 * a4 + q * (3 * a6 + q * (4 * a8 + q * (5 * a10 + q * (6 * a12 + q * 7 * a14)))))
    second = (1 + k) * c * c * c / 4 * steeper * steeper * steeper
    second += 2 * a4 + q * (6 * a6 + q * (12 * a8 + q * (20 * a10 + q * (30 * a12 + q * 42 * a14))))
    straight = -2 * first
    return (
        -depth,
        straight * x,
        straight * y,
        straight - 4 * x * x * second,
        -4 * x * y * second,
        straight - 4 * y * y * second,
    )


@inline
def turned(c, s, fu, fv, fuu, fuv, fvv):
    """Derivatives along (u, v) = (axis meridian at the angle of cosine c and sine s, across it) carried to (x, y)."""
    fxx = c * c * fuu - 2 * c * s * fuv + s * s * fvv
    fxy = c * s * (fuu - fvv) + (c * c - s * s) * fuv
    fyy = s * s * fuu + 2 * c * s * fuv + c * c * fvv
    return c * fu - s * fv, s * fu + c * fv, fxx, fxy, fyy


@inline
def toric(p, x, y):
    """True torus: (f, fx, fy, fxx, fxy, fyy) of the sag."""
    ca, cb = p[0], p[1]
    u, v = p[2] * x + p[3] * y, p[2] * y - p[3] * x
    root = math.sqrt(1 - ca * ca * u * u)
    steeper, g = 1 / root, ca * u * u / (1 + root)
    g1, g2 = ca * u * steeper, ca * steeper * steeper * steeper
    w = 1 - cb * g
    r = math.sqrt(w * w - cb * cb * v * v)
    k = 1 / r
    du, dv = w * g1 * k, cb * v * k
    duu = (w * g2 - cb * g1 * g1 + cb * du * du) * k
    duv, dvv = cb * du * dv * k, cb * (1 + dv * dv) * k
    fx, fy, fxx, fxy, fyy = turned(p[2], p[3], -du, -dv, -duu, -duv, -dvv)
    return -(g + cb * v * v / (w + r)), fx, fy, fxx, fxy, fyy


@inline
def biconic(p, x, y):
    """Biconic (Zemax BICONICX form): (f, fx, fy, fxx, fxy, fyy) of the sag."""
    ca, cb = p[0], p[1]
    u, v = p[2] * x + p[3] * y, p[2] * y - p[3] * x
    ea, eb = (1 + p[4]) * ca * ca, (1 + p[5]) * cb * cb
    root = math.sqrt(1 - ea * u * u - eb * v * v)
    k = 1 / root
    ru, rv = -ea * u * k, -eb * v * k
    ruu, ruv, rvv = -(ea + ru * ru) * k, -ru * rv * k, -(eb + rv * rv) * k
    h = 1 / (1 + root)
    depth = (ca * u * u + cb * v * v) * h
    du, dv = (2 * ca * u - depth * ru) * h, (2 * cb * v - depth * rv) * h
    duu = (2 * ca - 2 * du * ru - depth * ruu) * h
    duv = (-du * rv - dv * ru - depth * ruv) * h
    dvv = (2 * cb - 2 * dv * rv - depth * rvv) * h
    fx, fy, fxx, fxy, fyy = turned(p[2], p[3], -du, -dv, -duu, -duv, -dvv)
    return -depth, fx, fy, fxx, fxy, fyy


@inline
def bin_of(breaks, count, x):
    """Index of the bin of x; the first or last bin outside the breakpoints."""
    return min(max(int((x - breaks[0]) * (count / (breaks[-1] - breaks[0]))), 0), count - 1)


@inline
def middle(breaks, cell):
    """The middle of a cell, from which its polynomials count."""
    return 0.5 * (breaks[cell] + breaks[cell + 1])


@called
def find_cell(breaks, bins, x):
    """Index of the cell of x; the first or last cell outside the breakpoints."""
    cell = bins[bin_of(breaks, bins.size, x)]
    while cell < breaks.size - 2 and x >= breaks[cell + 1]:
        cell += 1
    while cell > 0 and x < breaks[cell]:
        cell -= 1
    return cell


@called
def spline(breaks_x, breaks_y, bins_x, bins_y, cells, x, y):
    """Tensor spline in its local polynomials: (f, fx, fy, fxx, fxy, fyy) of the sag."""
    i, j = find_cell(breaks_x, bins_x, x), find_cell(breaks_y, bins_y, y)
    s, t = x - middle(breaks_x, i), y - middle(breaks_y, j)
    f = fx = fxx = fy = fxy = fyy = 0.0
    for b in range(cells.shape[2] - 1, -1, -1):
        c, cx, cxx = 0.0, 0.0, 0.0
        for a in range(cells.shape[3] - 1, -1, -1):
            cxx = cxx * s + 2 * cx
            cx = cx * s + c
            c = c * s + cells[j, i, b, a]
        fyy = fyy * t + 2 * fy
        fy = fy * t + f
        f = f * t + c
        fxy = fxy * t + fx
        fx = fx * t + cx
        fxx = fxx * t + cxx
    return f, fx, fy, fxx, fxy, fyy


@called
def sag(shape, x, y):
    """(f, fx, fy, fxx, fxy, fyy) of the sag at (x, y); NaN where the surface does not exist."""
    kind, p, breaks_x, breaks_y, bins_x, bins_y, cells = shape
    if kind == CONIC:
        return conic(eight(p), x, y)
    if kind == TORIC:
        return toric(p, x, y)
    if kind == BICONIC:
        return biconic(p, x, y)
    return spline(breaks_x, breaks_y, bins_x, bins_y, cells, x, y)


@called
def start_curvature(kind, p):
    """Curvature of the sphere at the vertex that stands in for the surface when a search starts, 1/mm."""
    return 0.5 * (p[0] + p[1]) if kind in (TORIC, BICONIC) else p[0]


@called
def to_start_sphere(c, x, y, z, dx, dy, dz):
    """Distance along the ray to the sphere (or plane) of curvature c through the vertex; to the plane if it misses."""
    b = c * (x * dx + y * dy + z * dz) + dz
    e = c * (x * x + y * y + z * z) + 2 * z
    disc = b * b - c * e
    if disc < 0:
        return -z / dz
    root = math.sqrt(disc)
    return -e / (b + root) if b >= 0 else (root - b) / c


@called
def inside_domain(shape, x, y):
    """Whether the surface is defined at (x, y): only splines end."""
    kind, breaks_x, breaks_y = shape[0], shape[2], shape[3]
    if kind != SPLINE:
        return True
    return breaks_x[0] <= x <= breaks_x[-1] and breaks_y[0] <= y <= breaks_y[-1]


@called
def intersect(shape, x, y, z, dx, dy, dz):
    """Distance t (mm) along the ray to the surface, and a verdict: 0 met, 1 missed, 2 not converged.

    Newton's method on z - f(x, y), kept between the farthest point known to lie before the surface and the nearest one
    known to lie behind it or beyond its rim; where it would leave them, the interval is halved.
    """
    t = to_start_sphere(start_curvature(shape[0], shape[1]), x, y, z, dx, dy, dz)
    before, behind, left = 0.0, math.inf, False
    for _ in range(MAX_STEPS):
        f, fx, fy, _xx, _xy, _yy = sag(shape, x + t * dx, y + t * dy)
        error = z + t * dz - f
        wanted = t - error / (dz - fx * dx - fy * dy)
        if abs(error) < 1e-8 and math.isfinite(wanted):
            return wanted, 0 if inside_domain(shape, x + wanted * dx, y + wanted * dy) else 1
        if error < 0:
            before = max(before, t)
        else:
            behind = min(behind, t)
            left = left or not math.isfinite(error)
        if not before < wanted < behind:
            wanted = 0.5 * (before + behind) if behind < math.inf else before + 10.0
        t = wanted
    inside = inside_domain(shape, x + t * dx, y + t * dy)
    return math.nan, 1 if left or not inside else 2


@nb.njit(
    nb.void(SHAPE, VECTOR, VECTOR, nb.float64[:, ::1]),
    nogil=True, cache=True, error_model="numpy",
)  # fmt: skip
def sag_at(shape, x, y, out):
    """Fill out (6, n) with f, fx, fy, fxx, fxy, fyy at the points x, y (n,); NaN outside the domain.

    On one thread: any thread may ask, also beside one that traces.
    """
    for i in range(x.size):
        if inside_domain(shape, x[i], y[i]):
            d = sag(shape, x[i], y[i])
            for k in range(6):
                out[k, i] = d[k]
        else:
            out[:, i] = math.nan
