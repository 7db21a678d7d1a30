"""A smooth surface through points that lie anywhere: tensor B-spline by least squares, held where there are no points."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline
from scipy.linalg import solveh_banded
from scipy.sparse import csr_array, kron

from .conventions import Floats
from .surfaces import Surface, bspline

DEGREE = 5
STIFFNESS = 1e-10  # weight of the third derivatives against the points: decides only where there are none
MOST_CELLS = 64


class PointFit(NamedTuple):
    """A fitted surface, counted from its sag at (0, 0); height (mm): that sag, or 0 where the surface does not reach it.

    residuals (n,): mm, points less surface.
    """

    surface: Surface
    height: float
    residuals: Floats


def fitted_points(x: ArrayLike, y: ArrayLike, z: ArrayLike, knot_pitch: float, note: str = "") -> PointFit:
    """Quintic B-spline surface nearest to points x, y, z (n,) mm, +z to the scene, over the box of the points.

    knot_pitch: wanted width of the cells, mm (no finer than the points' spacing). Where a cell has too few points the
    third derivatives decide, so that the surface goes on smoothly. Source: Eilers & Marx 1996 (penalised B-splines).
    """
    px, py, pz = (np.ravel(np.asarray(a, dtype=float)) for a in (x, y, z))
    knots_x, knots_y = _knots(px, knot_pitch), _knots(py, knot_pitch)
    basis_x, basis_y = _basis(knots_x, px), _basis(knots_y, py)
    design = csr_array(_rowwise_product(basis_y, basis_x))
    bend = _roughness(knots_x, knots_y) * (STIFFNESS * px.size)
    coefficients = _solved(csr_array(design.T @ design + bend), design.T @ pz)
    residuals = pz - design @ coefficients
    grid = coefficients.reshape(basis_y.shape[1], basis_x.shape[1])
    height = float(np.nan_to_num(bspline(knots_x, knots_y, grid, DEGREE).sag(0.0, 0.0)))
    return PointFit(bspline(knots_x, knots_y, grid - height, DEGREE, note=note), height, residuals)


def _solved(matrix: csr_array, right: Floats) -> Floats:
    """Solution of a symmetric, positive definite system whose entries lie near the diagonal."""
    entries = matrix.tocoo()
    upper = entries.col >= entries.row
    row, col = entries.row[upper], entries.col[upper]
    width = int((col - row).max())
    band = np.zeros((width + 1, matrix.shape[0]))
    band[width + row - col, col] = entries.data[upper]
    return np.asarray(solveh_banded(band, right, overwrite_ab=True, check_finite=False), dtype=float)


def _knots(values: Floats, pitch: float) -> Floats:
    low, high = float(values.min()), float(values.max())
    cells = int(np.clip(np.ceil((high - low) / pitch), 1, MOST_CELLS))
    width = (high - low) / cells
    return np.asarray(low + width * np.arange(-DEGREE, cells + DEGREE + 1), dtype=float)


def _basis(knots: Floats, values: Floats) -> csr_array:
    return csr_array(BSpline.design_matrix(np.clip(values, knots[DEGREE], knots[-1 - DEGREE]), knots, DEGREE))


def _rowwise_product(a: csr_array, b: csr_array) -> csr_array:
    """Row k of the product: the Kronecker product of row k of a and row k of b (each row holds DEGREE + 1 entries)."""
    n, width = a.shape[0], DEGREE + 1
    value = a.data.reshape(n, width, 1) * b.data.reshape(n, 1, width)
    column = a.indices.reshape(n, width, 1) * b.shape[1] + b.indices.reshape(n, 1, width)
    rows = np.arange(0, n * width**2 + 1, width**2)
    return csr_array((value.ravel(), column.ravel(), rows), shape=(n, a.shape[1] * b.shape[1]))


def _roughness(knots_x: Floats, knots_y: Floats) -> csr_array:
    """Quadratic form of the squared third differences of the coefficients (equal knots) along x, along y and mixed."""
    nx, ny = (k.size - DEGREE - 1 for k in (knots_x, knots_y))
    form = csr_array((ny * nx, ny * nx))
    for order_x, order_y in ((3, 0), (0, 3), (2, 1), (1, 2)):
        difference = csr_array(kron(_difference(ny, order_y), _difference(nx, order_x)))
        form = form + difference.T @ difference
    return csr_array(form)


def _difference(n: int, order: int) -> csr_array:
    return csr_array(np.diff(np.eye(n), order, axis=0))
