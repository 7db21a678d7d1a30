"""Sags read from a file, on a regular grid or scattered, and how they become a smooth surface in the lens."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..optics.conventions import Floats
from ..optics.smoothing import SplineFit, evaluate, fit_grid, fit_points
from ..optics.surfaces import fitted
from .detection import decide, shape_of
from .fit_report import NOISY, Report
from .flaws import rounding_step, spikes
from .orientation import Orientation
from .surface_data import Fitted, Reading

LEAST_SIDE = 6
LEAST_SCATTERED = 40


@dataclass(frozen=True, slots=True, eq=False)
class PointGrid:
    """Sags as the file has them. values (rows, columns): mm, in the file's order and sign, NaN where a value is missing.

    width, height: extent along the file's columns and rows, mm; the centre of the grid is the surface's origin, or
    `centre` (along columns, along rows, mm, from the middle of the grid) if the file says so. digit: mm, of the last
    digit written. side "R" | "L" | "", face "F" | "B" | "": as the file says. stated: the order of the points, where the
    format fixes it. remark: what else is to be said of the file.
    """

    source: str
    values: Floats
    width: float
    height: float
    digit: float
    side: str = ""
    face: str = ""
    stated: Orientation | None = None
    centre: tuple[float, float] = (0.0, 0.0)
    remark: str = ""

    @property
    def pitch(self) -> tuple[float, float]:
        """Spacing along the columns and rows, mm."""
        rows, columns = self.values.shape
        return self.width / (columns - 1), self.height / (rows - 1)

    def file_axes(self) -> tuple[Floats, Floats]:
        """Coordinates along the columns (columns,) and along the rows (rows,), mm, in the file's order."""
        rows, columns = self.values.shape
        u = np.linspace(-self.width / 2, self.width / 2, columns) - self.centre[0]
        return u, np.linspace(-self.height / 2, self.height / 2, rows) - self.centre[1]

    def fitted(self, reading: Reading) -> Fitted:
        """Smoothing quintic B-spline through the points, counted from the sag at the centre."""
        reading = completed(reading, self.side, self.face)
        step = rounding_step(self.values, self.digit)
        refused = spikes(self.values, step)
        z = np.where(refused, np.nan, self.values)
        if min(z.shape) < LEAST_SIDE:
            raise InputError(f"{self.source}: {z.shape[1]} x {z.shape[0]} points are too few; a surface needs 6 x 6")
        if np.count_nonzero(np.isfinite(z)) < max(LEAST_SCATTERED - 4, z.size / 4):
            raise InputError(f"{self.source}: only {np.count_nonzero(np.isfinite(z))} of {z.size} points have a value")
        u, v = self.file_axes()
        given = np.isfinite(z)
        gu, gv = np.meshgrid(u, v)
        decision = decide(
            self.source, shape_of(gu[given], gv[given], z[given], step / np.sqrt(12)), reading, self.stated
        )
        o = decision.orientation
        (x, y), z = _lens_axes(o, u, v), o.sign * o.to_lens(z)
        fit = _with_noise_found(lambda sigma: fit_grid(x, y, z, sigma), step / np.sqrt(12))
        report = Report(self.source, self._size(), min(self.pitch), self.digit, step, reading, decision, fit)
        facts = report.facts(refused, np.isnan(self.values), self.remark)
        reach = _reach(*np.meshgrid(x, y), ~np.isnan(o.to_lens(self.values)))
        return Fitted(replace(fitted(fit, **reading.pose), note=report.line(facts)), facts, reach)

    def _size(self) -> str:
        rows, columns = self.values.shape
        return f"{columns} x {rows} points, pitch {self.pitch[0]:g} x {self.pitch[1]:g} mm"


@dataclass(frozen=True, slots=True, eq=False)
class PointCloud:
    """Sags at scattered points x, y, z (n,), mm, in the file's frame; digit, side, face, stated, remark as in a PointGrid.

    u (along x) and v (against y) stand for a grid's columns and rows where an orientation is told or found.
    """

    source: str
    x: Floats
    y: Floats
    z: Floats
    digit: float
    side: str = ""
    face: str = ""
    stated: Orientation | None = None
    remark: str = ""

    def fitted(self, reading: Reading) -> Fitted:
        """Smoothing quintic B-spline over the points' box, counted from the sag at (0, 0)."""
        if self.z.size < LEAST_SCATTERED:
            raise InputError(f"{self.source}: {self.z.size} points are too few; a surface needs {LEAST_SCATTERED}")
        if min(np.ptp(self.x), np.ptp(self.y)) <= 0:
            raise InputError(f"{self.source}: all points lie on one line")
        reading = completed(reading, self.side, self.face)
        step = rounding_step(self.z, self.digit)
        decision = decide(self.source, shape_of(self.x, -self.y, self.z, step / np.sqrt(12)), reading, self.stated)
        o = decision.orientation
        x, y = o.matrix() @ np.array([self.x, -self.y])
        z, box = o.sign * self.z, (x.min(), x.max(), y.min(), y.max())
        fit, refused = _without_spikes(x, y, z, step, box)
        width, height = float(np.ptp(self.x)), float(np.ptp(self.y))
        size = f"{self.z.size} scattered points over {width:g} x {height:g} mm"
        pitch = float(np.sqrt(width * height / self.z.size))
        report = Report(self.source, size, pitch, self.digit, step, reading, decision, fit)
        facts = report.facts(refused, np.zeros(self.z.size, dtype=bool), self.remark)
        reach = min(-box[0], box[1], -box[2], box[3], float(np.hypot(x, y).max()))
        return Fitted(replace(fitted(fit, **reading.pose), note=report.line(facts)), facts, float(reach))


def completed(reading: Reading, side: str, face: str) -> Reading:
    """The reading with the side and face that the file says, where it has none of its own."""
    return replace(reading, side=reading.side or side, face=reading.face or face)


def _reach(x: Floats, y: Floats, given: NDArray[np.bool_]) -> float:
    """The largest radius about the origin within the grid of which no more than one point in 50 is missing, mm."""
    inside = min(-x.min(), x.max(), -y.min(), y.max())
    distance = np.hypot(x, y).ravel()
    order = np.argsort(distance)
    share = np.cumsum(~given.ravel()[order]) / np.arange(1, order.size + 1)
    few = np.flatnonzero(share <= 0.02)
    return float(min(inside, distance[order[few[-1]]])) if few.size else 0.0


def _lens_axes(o: Orientation, u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """x (nx,) and y (ny,), rising, of a grid whose columns lie at u and whose rows lie at v."""
    along, across = (u, v) if o.rows == "horizontal" else (v, u)
    x = o.matrix()[0].sum() * along
    y = o.matrix()[1].sum() * across
    return np.sort(x), np.sort(y)


def _with_noise_found(fit_to: Callable[[float], SplineFit], sigma: float) -> SplineFit:
    """The fit to noise sigma or, where the values themselves show more than NOISY times as much, to what they show."""
    fit = fit_to(sigma)
    if np.isfinite(fit.noise) and fit.noise > NOISY * sigma:
        return fit_to(fit.noise)
    return fit


def _without_spikes(
    x: Floats, y: Floats, z: Floats, step: float, box: tuple[float, float, float, float]
) -> tuple[SplineFit, NDArray[np.bool_]]:
    """The fit of scattered points without those that stand out from it by 3 rounding steps plus 10 robust deviations."""
    sigma = step / np.sqrt(12)
    fit = fit_points(x, y, z, sigma, box)
    refused = np.zeros(z.size, dtype=bool)
    for _ in range(3):
        off = np.abs(z - _at(fit, x, y))
        out = off > 3 * step + 10 * 1.4826 * np.median(off)
        if not (out & ~refused).any() or np.count_nonzero(out) > 0.02 * z.size:
            break
        refused = out
        fit = fit_points(x[~refused], y[~refused], z[~refused], sigma, box)
    residual = np.full(z.size, np.nan)
    residual[~refused] = fit.residual
    return fit._replace(residual=residual), refused


def _at(fit: SplineFit, x: Floats, y: Floats) -> Floats:
    return fitted(fit).sag(x, y) + evaluate(fit, np.zeros(1), np.zeros(1))[0, 0]


def grid_of(x: Floats, y: Floats, z: Floats) -> tuple[Floats, tuple[float, float, float, float]] | None:
    """Points as a grid (rows from the greatest y down, NaN where there is none) and its box, if they lie on a regular one."""
    steps = []
    for values in (x, y):
        levels = np.unique(np.round(values, 6))
        gaps = np.diff(levels)
        if levels.size < LEAST_SIDE or gaps.min() <= 0:
            return None
        pitch = (levels[-1] - levels[0]) / round((levels[-1] - levels[0]) / float(np.median(gaps)))
        count = round((levels[-1] - levels[0]) / pitch) + 1
        place = (values - levels[0]) / pitch
        if count * LEAST_SIDE > 4 * z.size or np.abs(place - np.round(place)).max() > 0.01:
            return None
        steps.append((levels[0], levels[-1], count, np.round(place).astype(int)))
    (x0, x1, nx, column), (y0, y1, ny, row) = steps
    if nx * ny > 4 * z.size or np.unique(row * nx + column).size != z.size:
        return None
    grid = np.full((ny, nx), np.nan)
    grid[ny - 1 - row, column] = z
    return grid, (float(x0), float(x1), float(y0), float(y1))
