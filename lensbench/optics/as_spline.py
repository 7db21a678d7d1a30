"""Any surface as the arrays of a tensor B-spline: what files and CAD take."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import make_interp_spline

from .conventions import Floats
from .kernels import surface as kernel
from .scattered import fitted_points
from .surfaces import Surface, bspline

CELL = 1.0  # mm, of the spline that stands for a closed form
STEEPEST = 2.0  # slope up to which a closed form that ends within the box is followed
SAME = 1e-9  # mm: two sags that differ by less are the same


class SplineArrays(NamedTuple):
    """Full knot vectors (mm), coefficients (rows of y, columns of x; mm, + towards the scene), degree; misfit (mm): the
    greatest difference to the surface that the arrays stand for.
    """

    knots_x: Floats
    knots_y: Floats
    coefficients: Floats
    degree: int
    misfit: float


def as_bspline(surface: Surface, box: tuple[float, float, float, float]) -> SplineArrays:
    """The B-spline that a surface is, exactly, or one that passes through the surface on a grid of 1 mm.

    box: x min, x max, y min, y max (mm, surface frame) to cover, if the surface is no spline already. Where a closed form
    ends within the box (a sphere at its equator) the spline goes on smoothly.
    """
    if surface.kind != kernel.SPLINE:
        return _through(surface, _breaks(box[0], box[1]), _breaks(box[2], box[3]), 1)
    for repeats in range(1, 6):
        found = _through(surface, surface.breaks_x, surface.breaks_y, repeats)
        if found.misfit < SAME:
            return found
    return found


def _breaks(low: float, high: float) -> Floats:
    return np.linspace(low, high, int(np.ceil((high - low) / CELL)) + 1)


def _through(surface: Surface, breaks_x: Floats, breaks_y: Floats, repeats: int) -> SplineArrays:
    """The spline through the surface at the averages of its knots; each inner knot stands `repeats` times."""
    degree = 3 if surface.kind == kernel.SPLINE and surface.cells.shape[2] == 4 else 5
    knots_x, knots_y = (_knots(breaks, degree, repeats) for breaks in (breaks_x, breaks_y))
    x, y = (np.clip(knot_averages(k, degree), k[0], k[-1]) for k in (knots_x, knots_y))
    z = surface.sag(*np.meshgrid(x, y))
    if np.isnan(z).any():
        return _continued(surface, x, y, z)
    rows = make_interp_spline(x, z.T, k=degree, t=knots_x).c
    coefficients = make_interp_spline(y, rows.T, k=degree, t=knots_y).c
    return _measured(surface, knots_x, knots_y, coefficients, degree)


def _continued(surface: Surface, x: Floats, y: Floats, z: Floats) -> SplineArrays:
    """As far as the surface is not steep, a spline near it, beyond that one that goes on smoothly."""
    gx, gy = np.meshgrid(x, y)
    slopes = surface.derivatives(gx, gy)[1:3]
    there = np.hypot(*slopes) < STEEPEST
    fit = fitted_points(gx[there], gy[there], z[there], 2 * CELL)
    found = as_bspline(fit.surface, (0.0, 0.0, 0.0, 0.0))
    return _measured(surface, found.knots_x, found.knots_y, found.coefficients + fit.height, found.degree)


def _measured(surface: Surface, knots_x: Floats, knots_y: Floats, coefficients: Floats, degree: int) -> SplineArrays:
    between = [np.linspace(k[0], k[-1], 4 * k.size) for k in (knots_x, knots_y)]
    at = np.meshgrid(*between)
    wanted = surface.derivatives(*at)
    misfit = np.abs(bspline(knots_x, knots_y, coefficients, degree).sag(*at) - wanted.f)
    misfit = misfit[np.hypot(wanted.fx, wanted.fy) < STEEPEST]
    return SplineArrays(knots_x, knots_y, coefficients, degree, float(misfit.max(initial=0.0)))


def _knots(breaks: Floats, degree: int, repeats: int) -> Floats:
    inner = np.repeat(breaks[1:-1], repeats)
    return np.concatenate([np.full(degree + 1, breaks[0]), inner, np.full(degree + 1, breaks[-1])])


def knot_averages(knots: Floats, degree: int) -> Floats:
    """Where the coefficients belong: averages (n,) of knots, which are the coefficients of x. Source: Greville 1964."""
    return np.array([knots[k + 1 : k + degree + 1].mean() for k in range(knots.size - degree - 1)])
