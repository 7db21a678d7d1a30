"""Smoothing quintic tensor B-splines through sags that were rounded: whole grids, grids with gaps, scattered points.

Smallest roughness, the integral of z_xxx^2 + z_yyy^2, among the splines whose sum of squared residuals is that of the noise,
N sigma^2. Sources: Reinsch 1967 (how much to smooth); Eilers & Marx 1996 (penalised tensor splines).
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.linalg import eigh
from scipy.sparse import csr_array, kron
from scipy.sparse.linalg import splu

from .conventions import Floats

DEGREE = 5
LEAST_CELL = 0.9
MOST_CELLS = 120
MOST_CELLS_WITH_GAPS = 56
LIGHTEST, HEAVIEST = -14.0, 10.0


class SplineFit(NamedTuple):
    """knots_x, knots_y: full knot vectors, mm; coefficients (ny, nx): mm; residual: of each value given, mm (NaN in gaps).

    noise: rms of what no smooth surface explains, mm, estimated from the data; NaN where it cannot be told.
    """

    knots_x: Floats
    knots_y: Floats
    coefficients: Floats
    residual: Floats
    noise: float


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
        return _fit_whole(ax, ay, sag, sigma)
    px, py = np.meshgrid(x, y)
    rough = fit_points(px[~gaps], py[~gaps], sag[~gaps], sigma, (x[0], x[-1], y[0], y[-1]), searched=False)
    filled = np.where(gaps, evaluate(rough, x, y), sag)
    for _ in range(6):
        fit = _fit_whole(ax, ay, filled, sigma, ~gaps)
        filled = np.where(gaps, filled - fit.residual, filled)
    return fit._replace(residual=np.where(gaps, np.nan, fit.residual))


def evaluate(fit: SplineFit, x: Floats, y: Floats) -> Floats:
    """Sag (ny, nx) of a fit on the grid x (nx,), y (ny,), mm."""
    bx, by = (BSpline.design_matrix(a, t, DEGREE) for a, t in ((x, fit.knots_x), (y, fit.knots_y)))
    return by @ (bx @ fit.coefficients.T).T


def _fit_whole(ax: _Axis, ay: _Axis, sag: Floats, sigma: float, given: NDArray[np.bool_] | None = None) -> SplineFit:
    """Fit of a grid without gaps: in these bases smoothing shrinks each coefficient by itself."""
    c = ay.basis.T @ sag @ ax.basis
    missed = float(np.sum((sag - ay.basis @ c @ ax.basis.T) ** 2))
    rough = ay.roughness[:, None] + ax.roughness
    count = sag.size if given is None else np.count_nonzero(given)
    allowed = count * sigma**2 - missed
    power = c**2

    def excess(weight: float) -> float:
        return float(np.sum(power * (1 - 1 / (1 + weight * rough)) ** 2)) - allowed

    c = c / (1 + _heaviest(excess) * rough)
    residual = sag - ay.basis @ c @ ax.basis.T
    return SplineFit(ax.knots, ay.knots, ay.back @ c @ ax.back.T, residual, _flat_noise(power, rough))


def _heaviest(excess: Any, steps: int = 30) -> float:
    """The heaviest smoothing (bisected on a logarithmic scale) that leaves no excess of squared residuals; else the lightest."""
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


def fit_points(
    x: Floats, y: Floats, sag: Floats, sigma: float, box: tuple[float, float, float, float], searched: bool = True
) -> SplineFit:
    """Spline over a box (x min, x max, y min, y max) through scattered points x, y, sag (n,), mm, with noise sigma, mm.

    searched: smooth as much as the noise allows; otherwise as little as closes the gaps.
    """
    cells = int(min(MOST_CELLS_WITH_GAPS, max(2, 0.9 * np.sqrt(sag.size) - 4)))
    knots, bases, mass, rough = [], [], [], []
    for at, (low, high) in ((x, box[:2]), (y, box[2:])):
        breaks = np.linspace(low, high, cells + 1)
        knots.append(np.r_[[low] * DEGREE, breaks, [high] * DEGREE])
        bases.append(BSpline.design_matrix(at, knots[-1], DEGREE))
        mass.append(csr_array(_products(knots[-1], breaks, 0)))
        rough.append(csr_array(_products(knots[-1], breaks, 3)))
    design = _row_products(bases[1], bases[0])
    penalty = (kron(mass[1], rough[0]) + kron(rough[1], mass[0])) * (sag.size / ((box[1] - box[0]) * (box[3] - box[2])))
    normal, right = design.T @ design, design.T @ sag

    def solved(weight: float) -> Floats:
        return splu((normal + weight * penalty).tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(right)

    weight = 1e-10
    if searched:
        weight = _heaviest(lambda w: float(np.sum((design @ solved(w) - sag) ** 2)) - sag.size * sigma**2, 12)
    c = solved(weight)
    k = int(np.sqrt(c.size))
    return SplineFit(knots[0], knots[1], c.reshape(k, k), sag - design @ c, float("nan"))


def _row_products(a: Any, b: Any) -> csr_array:
    """Row-wise Kronecker product (n, Ka Kb) of two design matrices (n, Ka), (n, Kb) with six entries a row."""
    n = a.shape[0]
    ca, cb = (m.indices.reshape(n, DEGREE + 1) for m in (a, b))
    va, vb = (m.data.reshape(n, DEGREE + 1) for m in (a, b))
    columns = (ca[:, :, None] * b.shape[1] + cb[:, None, :]).ravel()
    values = (va[:, :, None] * vb[:, None, :]).ravel()
    starts = np.arange(n + 1) * (DEGREE + 1) ** 2
    return csr_array((values, columns, starts), shape=(n, a.shape[1] * b.shape[1]))
