"""Surfaces of a lens: sphere, plane, conic, torus, biconic and tensor B-spline, all as one frozen type.

Sag z = f(x, y) in the surface's own vertex frame, mm, +z to the scene; a radius is positive when the centre of curvature
is on the eye's side, so a front surface convex to the scene has a positive radius and negative sag off axis.
"""

from dataclasses import dataclass, field
from math import factorial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline

from .conventions import Floats, ReadOnlyArrays, rotation_xy
from .kernels import surface as kernel
from .smoothing import DEGREE, SplineFit, evaluate, fit_grid

_NO_BREAKS = np.zeros(2)
_NO_BINS = np.zeros(1, dtype=np.int32)
_NO_CELLS = np.zeros((1, 1, 4, 4))
MOST_BINS = 100_000
SAME_WIDTH = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class Surface(ReadOnlyArrays):
    """One refracting surface and its pose in the lens.

    kind and the arrays p, breaks_x, breaks_y, bins_x, bins_y, cells: see optics.kernels.surface.
    decentration: (x, y) of the surface's vertex in the lens, mm. tilt: (about x, about y) of its axis, rad; the turn is
    R_y R_x about the vertex. note: how the surface was understood, one line for the reader.
    """

    kind: int
    p: Floats
    breaks_x: Floats = field(default_factory=lambda: _NO_BREAKS)
    breaks_y: Floats = field(default_factory=lambda: _NO_BREAKS)
    bins_x: NDArray[np.int32] = field(default_factory=lambda: _NO_BINS)
    bins_y: NDArray[np.int32] = field(default_factory=lambda: _NO_BINS)
    cells: Floats = field(default_factory=lambda: _NO_CELLS)
    decentration: tuple[float, float] = (0.0, 0.0)
    tilt: tuple[float, float] = (0.0, 0.0)
    note: str = ""

    @property
    def even(self) -> bool:
        """Whether all cells are equally wide, or there are none."""
        widths = np.diff(self.breaks_x), np.diff(self.breaks_y)
        return all(np.ptp(w) <= SAME_WIDTH * abs(w[0]) for w in widths)

    @property
    def rotation(self) -> Floats:
        """Turn (3, 3) from the surface frame to the lens frame."""
        return rotation_xy(*self.tilt)

    def shape_arrays(self) -> tuple[Any, ...]:
        """(kind, p, breaks_x, breaks_y, bins_x, bins_y, cells) as the kernels take them."""
        return self.kind, self.p, self.breaks_x, self.breaks_y, self.bins_x, self.bins_y, self.cells

    def derivatives(self, x: ArrayLike, y: ArrayLike) -> "SagDerivatives":
        """Sag and derivatives at points x, y (mm, surface frame, any shape); NaN where there is no surface."""
        bx, by = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        out = np.empty((6, bx.size))
        px, py = (np.ascontiguousarray(a).ravel() for a in (bx, by))
        kernel.sag_at(self.shape_arrays(), px, py, out)
        return SagDerivatives(*(row.reshape(bx.shape) for row in out))

    def sag(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Sag f(x, y), mm, surface frame."""
        return self.derivatives(x, y).f

    def describe(self) -> str:
        """The surface in one line: kind, radii in mm, constants and pose; how it was read, if it was read from points."""
        parts = [self._describe_shape()]
        if any(self.decentration):
            parts.append("decentred by {:g}, {:g} mm".format(*self.decentration))
        if any(self.tilt):
            parts.append("tilted by {:g}, {:g} deg about x, y".format(*np.degrees(self.tilt)))
        return "; ".join(parts)

    def _describe_shape(self) -> str:
        if self.kind == kernel.SPLINE:
            ny, nx = self.cells.shape[:2]
            return self.note or f"B-spline of {nx} x {ny} cells"
        along = _radius(self.p[0])
        if self.kind == kernel.CONIC:
            terms = "".join(f", a{4 + 2 * k} = {a:.4g}" for k, a in enumerate(self.p[2:]) if a)
            conic_constant = f", conic constant {self.p[1]:g}" if self.p[1] else ""
            if not (self.p[0] or terms):
                return "plane"
            return f"{'asphere' if terms or conic_constant else 'sphere'}, {along}{conic_constant}{terms}"
        axis = np.degrees(np.arctan2(self.p[3], self.p[2])) % 180
        kind = "torus" if self.kind == kernel.TORIC else "biconic"
        constants = f", conic constants {self.p[4]:g}, {self.p[5]:g}" if self.kind == kernel.BICONIC else ""
        return f"{kind}, {along} along {axis:g} deg, {_radius(self.p[1])} across{constants}"

    def surface_power(self, x: ArrayLike, y: ArrayLike, index: float) -> Floats:
        """Surface power matrices (..., 2, 2) in D at (x, y), as (index - 1) times the curvature seen from the scene.

        Sign as for a front surface: convex to the scene is positive; a back surface adds with the opposite sign.
        Projected on the surface frame's x and y by the minimal rotation of the normal.
        Source: do Carmo 1976 (second fundamental form).
        """
        _, fx, fy, fxx, fxy, fyy = self.derivatives(x, y)
        w = np.sqrt(1 + fx**2 + fy**2)
        k = 1 / (w * (1 + w))
        tangent = np.stack([1 - fx**2 * k, -fx * fy * k, -fx * fy * k, 1 - fy**2 * k], -1).reshape(*w.shape, 2, 2)
        second_form = np.stack([fxx, fxy, fxy, fyy], -1).reshape(*w.shape, 2, 2) / w[..., None, None]
        return -1000 * (index - 1) * np.swapaxes(tangent, -1, -2) @ second_form @ tangent


def _radius(curvature: float) -> str:
    return f"radius {1 / curvature:.7g} mm" if curvature else "flat"


class SagDerivatives(NamedTuple):
    """Sag f (mm), its slopes fx, fy and second derivatives fxx, fxy, fyy (1/mm), each of the points' shape."""

    f: Floats
    fx: Floats
    fy: Floats
    fxx: Floats
    fxy: Floats
    fyy: Floats


def conic(curvature: float, conic_constant: float = 0.0, asphere: ArrayLike = (), **pose: Any) -> Surface:
    """Conic of revolution with up to six even asphere terms a4, a6, ... (mm^-3, mm^-5, ...; positive towards the eye).

    curvature: 1/mm, positive with the centre on the eye's side; pose: decentration, tilt, note.
    """
    terms = np.atleast_1d(np.asarray(asphere, dtype=float))
    if terms.size > 6:
        raise ValueError(f"at most 6 asphere terms (a4 to a14), not {terms.size}")
    return Surface(kernel.CONIC, np.array([curvature, conic_constant, *terms, *[0.0] * (6 - terms.size)]), **pose)


def sphere(radius: float, **pose: Any) -> Surface:
    """Sphere of the given radius (mm; inf: a plane)."""
    return conic(1.0 / radius, **pose)


def plane(**pose: Any) -> Surface:
    """Plane."""
    return conic(0.0, **pose)


def toric(curvature_along: float, curvature_across: float, axis: float, **pose: Any) -> Surface:
    """True torus: an arc along the meridian `axis` (degrees TABO), turned about a line across the other meridian.

    curvature_along, curvature_across: principal curvatures at the vertex along and across that meridian, 1/mm.
    """
    return Surface(kernel.TORIC, _two_meridians(curvature_along, curvature_across, axis), **pose)


def biconic(
    curvature_along: float, curvature_across: float, axis: float, conic_along: float, conic_across: float, **pose: Any
) -> Surface:
    """Biconic with one curvature (1/mm) and conic constant along the meridian `axis` (degrees), another across it."""
    p = _two_meridians(curvature_along, curvature_across, axis, conic_along, conic_across)
    return Surface(kernel.BICONIC, p, **pose)


def _two_meridians(along: float, across: float, axis: float, *conics: float) -> Floats:
    p = np.zeros(8)
    angle = np.radians(axis)
    p[: 4 + len(conics)] = along, across, np.cos(angle), np.sin(angle), *conics
    return p


def bspline(knots_x: ArrayLike, knots_y: ArrayLike, coefficients: ArrayLike, degree: int, **pose: Any) -> Surface:
    """Tensor B-spline sag of degree 2 to 5, kept as local polynomials in its cells.

    knots_x (nx + degree + 1,), knots_y (ny + degree + 1,): full knot vectors, mm; coefficients (ny, nx): mm, +z to the
    scene, row j belongs to knots_y. The sag need not vanish at (0, 0): it counts from the surface's vertex frame.
    Source: de Boor 1978.
    """
    c = np.asarray(coefficients, dtype=float)
    breaks_x, of_x, local_x = _local_powers(knots_x, degree)
    breaks_y, of_y, local_y = _local_powers(knots_y, degree)
    along = np.einsum("niq,iqa->nia", c[:, of_x], local_x)
    cells = np.swapaxes(local_y, 1, 2)[:, None] @ np.swapaxes(along[of_y], 1, 2)
    arrays = breaks_x, breaks_y, bins_of(breaks_x), bins_of(breaks_y), cells
    shape = Surface(kernel.SPLINE, np.zeros(8), *arrays)
    _, _, _, fxx, _, fyy = shape.derivatives((breaks_x[0] + breaks_x[-1]) / 2, (breaks_y[0] + breaks_y[-1]) / 2)
    return Surface(kernel.SPLINE, np.array([-(fxx + fyy) / 2, *[0.0] * 7]), *arrays, **pose)


def bins_of(breaks: Floats) -> NDArray[np.int32]:
    """The cell at the lower end of each of equal bins, so many that, up to MOST_BINS, none holds two breakpoints."""
    span = breaks[-1] - breaks[0]
    count = int(min(np.ceil(1.001 * span / np.diff(breaks).min()), MOST_BINS))
    ends = breaks[0] + span / count * np.arange(count)
    return np.clip(np.searchsorted(breaks, ends, side="right") - 1, 0, breaks.size - 2).astype(np.int32)


def _local_powers(knots: ArrayLike, degree: int) -> tuple[Floats, NDArray[np.intp], Floats]:
    """Breakpoints (k + 1,); of each cell the basis functions (k, degree + 1) and their Taylor coefficients in its middle.

    The coefficients have shape (k, degree + 1, 4 or 6).
    """
    t = np.asarray(knots, dtype=float)
    basis = BSpline(t, np.eye(t.size - degree - 1), degree)
    breaks = _evenly(np.unique(t[degree : t.size - degree]))
    middle = (breaks[:-1] + breaks[1:]) / 2
    of = np.searchsorted(t, middle)[:, None] - 1 - degree + np.arange(degree + 1)
    powers = np.zeros((*of.shape, 4 if degree <= 3 else 6))
    for m in range(degree + 1):
        powers[:, :, m] = np.take_along_axis(basis(middle, nu=m), of, axis=1) / factorial(m)
    return breaks, of, powers


def _evenly(breaks: Floats) -> Floats:
    """The breakpoints (k + 1,), with more of them between where that makes all cells equally wide, at most twice as many."""
    widths = np.diff(breaks)
    ends = np.rint(widths / widths.min()).astype(int).cumsum()
    even = np.linspace(breaks[0], breaks[-1], ends[-1] + 1)
    if ends[-1] > 2 * widths.size or np.abs(even[ends] - breaks[1:]).max() > SAME_WIDTH * (breaks[-1] - breaks[0]):
        return breaks
    return even


def fitted_grid(x: ArrayLike, y: ArrayLike, sag: ArrayLike, rounding_step: float, **pose: Any) -> Surface:
    """Smoothing quintic B-spline through a grid of sags whose last digit was rounded, counted from its sag at (0, 0).

    x (nx,), y (ny,): rising, equally spaced, mm; sag (ny, nx): mm, +z to the scene, NaN where it is missing; rounding_step
    q: mm. The sum of squared residuals is that of the rounding, N q^2 / 12 (see optics.smoothing).
    """
    gx, gy, z = (np.asarray(a, dtype=float) for a in (x, y, sag))
    return fitted(fit_grid(gx, gy, z, rounding_step / np.sqrt(12)), **pose)


def fitted(fit: SplineFit, **pose: Any) -> Surface:
    """The surface of a fit, counted from its sag at (0, 0)."""
    vertex = evaluate(fit, np.zeros(1), np.zeros(1))
    return bspline(fit.knots_x, fit.knots_y, fit.coefficients - vertex, DEGREE, **pose)


def power_noise(rounding_step: float, pitch: float, index: float) -> float:
    """Expected rms error of astigmatism (D) that the rounding of a grid of sags leaves when it is interpolated.

    rounding_step, pitch: mm. Smoothing as in `fitted_grid` lowers it, so it is an upper estimate. The factor 1.14 was
    found by fitting rounded samples of a progressive surface.
    """
    return 1140.0 * (index - 1.0) * rounding_step / pitch**2
