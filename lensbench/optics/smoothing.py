"""Smoothing quintic tensor B-splines through sags that were rounded: whole grids, grids with gaps, scattered points.

Smallest roughness, the integral of z_xxx^2 + z_yyy^2, among the splines whose sum of squared residuals is that of the noise,
N sigma^2. Sources: Reinsch 1967 (how much to smooth); Eilers & Marx 1996 (penalised tensor splines).
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import eigh, solveh_banded
from scipy.sparse import csr_array, kron

from .conventions import Floats

DEGREE = 5
LEAST_CELL = 0.9
MOST_CELLS = 120
MOST_CELLS_SCATTERED = 44
MOST_GAPS = 300
START_WEIGHT = 1e-3
LIGHTEST, HEAVIEST = -12.0, 8.0


class SplineFit(NamedTuple):
    """knots_x, knots_y: full knot vectors, mm; coefficients (ny, nx): mm; residual: of each value given, mm (NaN in gaps).

    noise: rms of what no smooth surface explains, mm, estimated from the data; NaN where it cannot be told.
    astigmatism: rms error of the difference of the principal curvatures, 1/mm, that noise of rms sigma leaves in the fit.
    """

    knots_x: Floats
    knots_y: Floats
    coefficients: Floats
    residual: Floats
    noise: float
    astigmatism: float


class _Axis(NamedTuple):
    """One axis of a grid: knots; basis (n, K) with orthonormal columns sorted by roughness; back (K, K) to the B-splines."""

    knots: Floats
    basis: Floats
    back: Floats
    roughness: Floats


def fit_grid(x: Floats, y: Floats, sag: Floats, sigma: float) -> SplineFit:
    """Spline through a grid with equal steps. x (nx,), y (ny,): rising, mm; sag (ny, nx): mm, NaN in gaps.

    sigma: rms noise of a value, mm (a rounding step q has q / sqrt(12)). A grid has at least 6 x 6 points.
    """
    ax, ay = (_axis(a.size, float(a[0]), float(a[-1])) for a in (x, y))
    gaps = np.isnan(sag)
    if not gaps.any():
        return _fit_whole(ax, ay, sag, sigma)[0]
    if np.count_nonzero(gaps) > MOST_GAPS:
        return _fit_around_gaps(x, y, sag, sigma)
    weight, fit = START_WEIGHT, None
    for _ in range(3):
        fit, weight = _fit_whole(ax, ay, _filled(ax, ay, sag, weight), sigma)
    assert fit is not None
    return fit._replace(residual=np.where(gaps, np.nan, fit.residual))


def _filled(ax: _Axis, ay: _Axis, sag: Floats, weight: float) -> Floats:
    """The sags with those values in the gaps that smoothing with this weight leaves as they are."""
    gaps = np.isnan(sag)
    row, column = np.nonzero(gaps)
    shrunk = 1 / (1 + weight * (ay.roughness[:, None] + ax.roughness))
    base = float(np.nanmean(sag))
    rest = np.where(gaps, 0.0, sag - base)
    smooth = ay.basis @ (shrunk * (ay.basis.T @ rest @ ax.basis)) @ ax.basis.T
    spread = np.einsum("gj,gi->gji", ay.basis[row], ax.basis[column]).reshape(row.size, -1)
    response = (spread * shrunk.ravel()) @ spread.T
    filled = sag.copy()
    filled[gaps] = base + np.linalg.solve(np.eye(row.size) - response, smooth[gaps])
    return filled


def _fit_around_gaps(x: Floats, y: Floats, sag: Floats, sigma: float) -> SplineFit:
    """The points that there are as scattered points."""
    given = ~np.isnan(sag)
    px, py = np.meshgrid(x, y)
    fit = fit_points(px[given], py[given], sag[given], sigma, (x[0], x[-1], y[0], y[-1]))
    residual = np.full(sag.shape, np.nan)
    residual[given] = fit.residual
    return fit._replace(residual=residual)


def evaluate(fit: SplineFit, x: Floats, y: Floats) -> Floats:
    """Sag (ny, nx) of a fit on the grid x (nx,), y (ny,), mm."""
    bx, by = (BSpline.design_matrix(a, t, DEGREE) for a, t in ((x, fit.knots_x), (y, fit.knots_y)))
    return by @ (bx @ fit.coefficients.T).T


def derivatives(fit: SplineFit, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Slopes (ny, nx) along x and along y of a fit on the grid x (nx,), y (ny,)."""
    unit_x, unit_y = (BSpline(t, np.eye(t.size - DEGREE - 1), DEGREE) for t in (fit.knots_x, fit.knots_y))
    c = fit.coefficients
    return unit_y(y) @ c @ unit_x(x, nu=1).T, unit_y(y, nu=1) @ c @ unit_x(x).T


def _fit_whole(ax: _Axis, ay: _Axis, sag: Floats, sigma: float) -> tuple[SplineFit, float]:
    """Fit of a grid without gaps, and its weight of roughness: in these bases smoothing shrinks each coefficient by itself."""
    c = ay.basis.T @ sag @ ax.basis
    allowed = sag.size * sigma**2 - float(np.sum((sag - ay.basis @ c @ ax.basis.T) ** 2))
    rough = ay.roughness[:, None] + ax.roughness
    power = c**2
    noise = _flat_noise(power, rough)

    def excess(weight: float) -> float:
        return float(np.sum(power * (1 - 1 / (1 + weight * rough)) ** 2)) - allowed

    weight = _heaviest(excess)
    c = c / (1 + weight * rough)
    residual = sag - ay.basis @ c @ ax.basis.T
    left = sigma * _astigmatism_noise(ax, ay, 1 / (1 + weight * rough))
    return SplineFit(ax.knots, ay.knots, ay.back @ c @ ax.back.T, residual, noise, left), weight


def _astigmatism_noise(ax: _Axis, ay: _Axis, shrunk: Floats) -> float:
    """Rms error of z_xx - z_yy and 2 z_xy together for noise of rms 1, over the middle of the grid."""
    (x0, x1, x2), (y0, y1, y2) = (_probe(a) for a in (ax, ay))
    gain = shrunk**2
    normal = (y0**2) @ gain @ (x2**2).T + (y2**2) @ gain @ (x0**2).T - 2 * (y0 * y2) @ gain @ (x0 * x2).T
    return float(np.sqrt(np.mean(normal + 4 * (y1**2) @ gain @ (x1**2).T)))


def _probe(axis: _Axis) -> tuple[Floats, ...]:
    """The smoothing basis and its first two derivatives (5, K) at five points in the middle half of the axis."""
    first, last = axis.knots[0], axis.knots[-1]
    at = (first + last) / 2 + (last - first) * np.linspace(-0.23, 0.23, 5)
    spline = BSpline(axis.knots, axis.back, DEGREE)
    return tuple(spline(at, nu=order) for order in range(3))


def _heaviest(excess: Any, steps: int = 30) -> float:
    """The heaviest smoothing (bisected on a log scale) that leaves no excess of squared residuals, or the lightest."""
    low, high = LIGHTEST, HEAVIEST
    if excess(10.0**low) >= 0:
        return 10.0**low
    for _ in range(steps):
        middle = (low + high) / 2
        low, high = (low, middle) if excess(10.0**middle) > 0 else (middle, high)
    return float(10.0**low)


def _flat_noise(power: Floats, rough: Floats) -> float:
    """Rms noise from the roughest quarter of the coefficients, if the quarter before it is no larger (white); else NaN."""
    order = np.argsort(rough, axis=None)
    third, last = np.array_split(np.sqrt(power.ravel()[order]), 4)[2:]
    before, noise = float(np.median(third)) / 0.6745, float(np.median(last)) / 0.6745
    return noise if before < 1.5 * noise else float("nan")


@lru_cache(maxsize=16)
def _axis(count: int, first: float, last: float) -> _Axis:
    x = np.linspace(first, last, count)
    breaks = _breaks(x)
    knots = np.r_[[first] * DEGREE, breaks, [last] * DEGREE]
    basis = BSpline.design_matrix(x, knots, DEGREE).toarray()
    roughness, back = eigh(_roughness(knots, breaks), basis.T @ basis)
    return _Axis(knots, basis @ back, back, np.clip(roughness, 0, None) * count)


def _breaks(x: Floats) -> Floats:
    """Breakpoints: at the points (not-a-knot) or, where these lie denser than the least cell, equally spaced."""
    cells = min(round((x[-1] - x[0]) / LEAST_CELL), MOST_CELLS)
    if cells >= x.size - 6:
        return np.r_[x[0], x[3:-3], x[-1]]
    return np.linspace(x[0], x[-1], cells + 1)


def _roughness(knots: Floats, breaks: Floats) -> Floats:
    """Integrals (K, K) of products of third derivatives, per length of the axis."""
    return _products(knots, breaks, 3) / (breaks[-1] - breaks[0])


def _products(knots: Floats, breaks: Floats, order: int) -> Floats:
    """Integrals (K, K) over the axis of products of the basis functions' derivatives of this order, by Gauss's rule."""
    node, weight = np.polynomial.legendre.leggauss(DEGREE - order + 1)
    half = np.diff(breaks)[:, None] / 2
    at = (breaks[:-1, None] + half * (node + 1)).ravel()
    d = BSpline(knots, np.eye(knots.size - DEGREE - 1), DEGREE).derivative(order)(at)
    return d.T @ (d * (half * weight).ravel()[:, None])


def fit_points(x: Floats, y: Floats, sag: Floats, sigma: float, box: tuple[float, float, float, float]) -> SplineFit:
    """Spline over a box (x min, x max, y min, y max) through scattered points x, y, sag (n,), mm, with rms noise sigma, mm."""
    cells = min(MOST_CELLS_SCATTERED, max(2, int(0.9 * np.sqrt(sag.size) - 4)))
    knots, bases, mass, rough = [], [], [], []
    for at, (low, high) in ((x, box[:2]), (y, box[2:])):
        breaks = np.linspace(low, high, cells + 1)
        knots.append(np.r_[[low] * DEGREE, breaks, [high] * DEGREE])
        bases.append(BSpline.design_matrix(at, knots[-1], DEGREE))
        mass.append(csr_array(_products(knots[-1], breaks, 0)))
        rough.append(csr_array(_products(knots[-1], breaks, 3)))
    design = _row_products(bases[1], bases[0])
    area = (box[1] - box[0]) * (box[3] - box[2])
    penalty = _banded((kron(mass[1], rough[0], "coo") + kron(rough[1], mass[0], "coo")) * (sag.size / area))
    normal, right = _banded(design.T @ design), design.T @ sag

    def solved(weight: float) -> Floats:
        return solveh_banded(normal + weight * penalty, right, lower=True, overwrite_ab=True, check_finite=False)

    def excess(weight: float) -> float:
        return float(np.sum((design @ solved(weight) - sag) ** 2)) - sag.size * sigma**2

    weight = _heaviest(excess, 10)
    c = solved(weight)
    left = sigma * _scattered_astigmatism_noise(knots, design, normal + weight * penalty)
    count = cells + DEGREE
    return SplineFit(knots[0], knots[1], c.reshape(count, count), sag - design @ c, float("nan"), left)


def _scattered_astigmatism_noise(knots: list[Floats], design: Any, bands: Floats) -> float:
    """As for a grid, from four points in the middle: how much each value moves the curvatures there."""
    tx, ty = knots
    px, py = (((t[0] + t[-1]) / 2 + (t[-1] - t[0]) * np.array([-0.17, 0.12])) for t in knots)
    bx, by = (
        [BSpline(t, np.eye(t.size - DEGREE - 1), DEGREE)(at, nu=m) for m in range(3)] for t, at in ((tx, px), (ty, py))
    )
    normal, mixed = np.kron(by[0], bx[2]) - np.kron(by[2], bx[0]), 2 * np.kron(by[1], bx[1])
    response = design @ solveh_banded(bands, np.vstack([normal, mixed]).T, lower=True, check_finite=False)
    return float(np.sqrt(np.sum(response**2) / 4))


def _banded(matrix: Any) -> Floats:
    """The lower bands (bandwidth + 1, K) of a symmetric sparse matrix of the tensor basis."""
    entries = matrix.tocoo()
    below = entries.row >= entries.col
    row, column = entries.row[below], entries.col[below]
    width = DEGREE * (int(np.sqrt(matrix.shape[0])) + 1)
    bands = np.zeros((width + 1, matrix.shape[0]))
    bands[row - column, column] = entries.data[below]
    return bands


def _row_products(a: Any, b: Any) -> csr_array:
    """Row-wise Kronecker product (n, Ka Kb) of two design matrices (n, Ka), (n, Kb) with six entries a row."""
    n = a.shape[0]
    ca, cb = (m.indices.reshape(n, DEGREE + 1) for m in (a, b))
    va, vb = (m.data.reshape(n, DEGREE + 1) for m in (a, b))
    columns = (ca[:, :, None] * b.shape[1] + cb[:, None, :]).ravel()
    values = (va[:, :, None] * vb[:, None, :]).ravel()
    starts = np.arange(n + 1) * (DEGREE + 1) ** 2
    return csr_array((values, columns, starts), shape=(n, a.shape[1] * b.shape[1]))
