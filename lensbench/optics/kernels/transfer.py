"""The 4 x 4 transfer matrix of a ray through two surfaces, from what each of them does to transverse rays.

Transverse rays: x0, x1 (offset, mm) and p0, p1 (optical momentum n * slope).
"""

from .surface import inline


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
def store_transfer(upper, lower, i, v):
    """The 4 x 4 matrix of the i-th ray, row by row: two rows into upper (8, n), two into lower (8, n)."""
    upper[0, i], upper[1, i], upper[2, i], upper[3, i] = v[0], v[1], v[4], v[5]
    upper[4, i], upper[5, i], upper[6, i], upper[7, i] = v[2], v[3], v[6], v[7]
    lower[0, i], lower[1, i], lower[2, i], lower[3, i] = v[8], v[9], v[12], v[13]
    lower[4, i], lower[5, i], lower[6, i], lower[7, i] = v[10], v[11], v[14], v[15]
