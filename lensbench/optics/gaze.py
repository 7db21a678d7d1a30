"""From a lens and a wearer to chief rays: pose of the worn lens, grids of gaze, and the trace itself."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import kernels
from .buffers import uninitialised
from .conventions import Floats, Status, listing_frame, unit
from .eye import Wear, Wearer
from .field import GazeField
from .lens import Lens
from .surfaces import Surface

MOST_STEPS = 30
CLOSE = 1e-6  # of the distance: one more step of Newton's method then leaves less than 1e-11
ENDLESS = np.array([0.0, 0.0, np.inf, np.inf]), np.zeros(1), np.zeros(1)  # an outline that holds every point
ENOUGH = 256  # rays that a thread of its own searches sooner than it is started
CHUNK = 32768  # rays: few enough to stay in the processor's cache, many as each of three kernels waits for all threads


@dataclass(frozen=True, slots=True)
class GazeGrid:
    """Regular grid of gaze directions, ny rows (lowest first) of nx.

    kind "tangent": regular in tan(angle), the plane of a picture; "angles": regular in azimuth and elevation (Fick).
    half_width, half_height: half extent, rad. centre: azimuth (towards the wearer's left) and elevation, rad.
    """

    nx: int = 64
    ny: int = 64
    half_width: float = np.radians(30.0)
    half_height: float = np.radians(30.0)
    kind: str = "tangent"
    centre: tuple[float, float] = (0.0, 0.0)

    def axes(self) -> tuple[Floats, Floats]:
        """The grid's coordinates u (nx,) and v (ny,): tangents or angles in rad, relative to the centre."""
        if self.kind not in ("tangent", "angles"):
            raise ValueError(f"a grid of gaze is of kind 'tangent' or 'angles', not {self.kind!r}")
        half = np.array([self.half_width, self.half_height])
        half = np.tan(half) if self.kind == "tangent" else half
        return np.linspace(-half[0], half[0], self.nx), np.linspace(-half[1], half[1], self.ny)

    def directions(self) -> Floats:
        """Unit vectors (ny * nx, 3), wear frame, row by row; the same read-only array for every equal grid."""
        return _grid_directions(self)


@lru_cache(maxsize=8)
def _grid_directions(grid: GazeGrid) -> Floats:
    u, v = (a.ravel() for a in np.meshgrid(*grid.axes()))
    azimuth, elevation = grid.centre
    if grid.kind == "angles":
        directions = direction_from_angles(azimuth + u, elevation + v)
    else:
        frame = listing_frame(direction_from_angles(azimuth, elevation))
        directions = unit(np.stack([u, v, np.ones_like(u)], axis=-1) @ frame)
    directions = np.asfortranarray(directions)
    directions.setflags(write=False)
    return directions


def direction_from_angles(azimuth: ArrayLike, elevation: ArrayLike) -> Floats:
    """Unit vectors (..., 3) of Fick angles in rad: azimuth towards the wearer's left, elevation upwards."""
    a, e = np.broadcast_arrays(np.asarray(azimuth, dtype=float), np.asarray(elevation, dtype=float))
    return np.stack([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)], axis=-1)


def angles_from_direction(direction: ArrayLike) -> tuple[Floats, Floats]:
    """Fick azimuth and elevation in rad of vectors (..., 3)."""
    d = np.asarray(direction, dtype=float)
    return np.arctan2(d[..., 0], d[..., 2]), np.arctan2(d[..., 1], np.hypot(d[..., 0], d[..., 2]))


class WornPose(NamedTuple):
    """Lens frame to wear frame: p_wear = rotation @ p_lens + shift (mm)."""

    rotation: Floats
    shift: Floats

    def to_wear(self, points: ArrayLike) -> Floats:
        """Points (..., 3) from the lens frame to the wear frame, mm."""
        return np.asarray(points, dtype=float) @ self.rotation.T + self.shift

    def to_lens(self, points: ArrayLike) -> Floats:
        """Points (..., 3) from the wear frame to the lens frame, mm."""
        return (np.asarray(points, dtype=float) - self.shift) @ self.rotation


def worn_pose(lens: Lens, wear: Wear) -> WornPose:
    """Pose of the worn lens: the back-surface point behind the fitting point is the pivot and meets the line of sight."""
    x, y = lens.points.fitting_point
    rotation = wear.rotation(lens.side)
    pivot = np.array([x, y, float(lens.back_height(x, y))])
    return WornPose(rotation, np.array([*wear.decentration, 0.0]) - rotation @ pivot)


class TracedRays(NamedTuple):
    """Real rays behind a lens, wear frame: entry and exit point (n, 3) mm, direction (n, 3), transfer (n, 4, 4), status."""

    entry: Floats
    exit: Floats
    direction: Floats
    transfer: Floats
    status: NDArray[np.int8]


def trace_rays(lens: Lens, wear: Wear, start: ArrayLike, direction: ArrayLike) -> TracedRays:
    """Trace any rays from the eye's side: start (n, 3) mm and unit direction (n, 3), wear frame; the outline is ignored.

    The transfer matrix runs from the start point to the exit point on the front surface; NaN where status is not OK.
    """
    d = np.asarray(direction, dtype=float).reshape(-1, 3)
    rays = _Rays(np.broadcast_to(np.asarray(start, dtype=float), d.shape).T, 0.0, d.T)
    return _traced_rays(*_through(lens, wear, rays, within_outline=False))


class _Rays(NamedTuple):
    """n rays in the wear frame that start (mm) at points (3, n) + lever * direction, direction (3, n)."""

    points: Floats
    lever: float
    direction: Floats

    def write(self, first: int, count: int, out: Floats) -> None:
        """Start and direction of `count` rays from `first` on into out (6, >= count)."""
        part = slice(first, first + count)
        start, out[3:, :count] = out[:3, :count], self.direction[:, part]
        np.multiply(self.direction[:, part], self.lever, out=start)
        start += self.points[:, part]


def _rows(count: int, n: int) -> Floats:
    """Uninitialised rows (count, >= n), of a width at which they do not fall on the same lines of the processor's cache."""
    width = -(-n // 8) * 8
    width = width + 8 if width % 64 == 0 else width
    return uninitialised(count * width).reshape(count, width)


def _through(lens: Lens, wear: Wear, rays: _Rays, within_outline: bool) -> tuple[Floats, NDArray[np.int8]]:
    """n rays through the lens: out (28, >= n) and status (n,), see kernels.trace.judge."""
    n = rays.direction.shape[1]
    out, status = _rows(28, n), np.empty(n, dtype=np.int8)
    started, bends = _rows(6, min(CHUNK, n)), _rows(9, min(CHUNK, n))
    worn, outline = _worn(lens, wear)
    outline = outline if within_outline else ENDLESS
    back, front = _kernel(lens.back, second=False), _kernel(lens.front, second=True)
    inside, outside, upper, lower = out[:6], out[6:12], out[12:20], out[20:]
    for first in range(0, n, CHUNK):
        count = min(CHUNK, n - first)
        rays.write(first, count, started)
        back(worn[0], 1.0, lens.index, started, inside, None, bends, None, first, count)
        front(worn[1], lens.index, 1.0, inside, outside, bends, upper, lower, first, count)
        kernels.trace.judge(worn[2], outline, first, count, out, status)
        sought = np.flatnonzero(status[first : first + count] == kernels.trace.SOUGHT)
        if sought.size:
            _search((worn, lens.index, outline, started, first), sought, (out, status))
    return out, status


def _search(before: tuple[Any, ...], sought: NDArray[np.int64], after: tuple[Any, ...]) -> None:
    """The search that never fails, for the rays sought of a chunk; on several threads where there are many."""
    search = kernels.surface.compiled(kernels.trace.search, kernels.trace.SEARCH)
    threads = min(sought.size // ENOUGH, numba.get_num_threads())
    if threads < 2:
        search(*before, sought, *after)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(lambda part: search(*before, part, *after), np.array_split(sought, threads)))


@lru_cache(maxsize=16)
def _worn(lens: Lens, wear: Wear) -> tuple[tuple[Any, Any, Floats], tuple[Floats, Floats, Floats]]:
    """The worn lens as the kernels take it: (back surface, front surface, pose (12,)) and its outline."""
    pose = worn_pose(lens, wear)
    back, front = _posed(lens.back, pose, 0.0), _posed(lens.front, pose, lens.centre_thickness)
    return (back, front, np.concatenate([pose.rotation.ravel(), pose.shift])), lens.outline.shape_arrays()


def _posed(surface: Surface, pose: WornPose, height: float) -> tuple[Any, ...]:
    vertex = pose.to_wear([*surface.decentration, height])
    return *surface.shape_arrays(), np.concatenate([(pose.rotation @ surface.rotation).ravel(), vertex])


@lru_cache(maxsize=32)
def _kernel(surface: Surface, second: bool) -> Callable[..., None]:
    """The vectorised kernel for a surface, the first or the second that a ray meets, to be called without the bins."""
    refract = kernels.refract
    if surface.kind == kernels.surface.SPLINE:
        kind = refract.bicubics if surface.cells.shape[2] == 4 else refract.biquintics
    elif surface.kind == kernels.surface.CONIC:
        kind = refract.conics if surface.p[1:].any() else refract.spheres
    else:
        kind = refract.torics if surface.kind == kernels.surface.TORIC else refract.biconics
    bins = (None, None) if surface.even else (surface.bins_x, surface.bins_y)
    kernel = kernels.surface.compiled(kind, refract.signature(surface.even, second))
    return lambda posed, *rest: kernel(posed, *bins, *rest)


def _traced_rays(out: Floats, status: NDArray[np.int8]) -> TracedRays:
    out = out[:, : status.size]
    return TracedRays(out[:3].T, out[6:9].T, out[9:12].T, out[12:].reshape(4, 4, -1).transpose(2, 0, 1), status)


def trace(lens: Lens | None, wearer: Wearer, gaze: GazeGrid | ArrayLike, within_outline: bool = True) -> GazeField:
    """The gaze field of a worn lens (None: the naked eye) for a grid or a list of gaze directions (n, 3), wear frame.

    The chief ray starts at the centre of the entrance pupil of the eye turned to the gaze; see GazeField. Outside the
    outline a ray fails, unless within_outline is False: then the surfaces go on as far as they are defined.
    """
    shape = (gaze.ny, gaze.nx) if isinstance(gaze, GazeGrid) else None
    directions = gaze.directions() if isinstance(gaze, GazeGrid) else unit(np.asarray(gaze, dtype=float).reshape(-1, 3))
    return _field(lens, wearer, directions, shape or (len(directions),), within_outline)


def _field(
    lens: Lens | None, wearer: Wearer, directions: Floats, shape: tuple[int, ...], within_outline: bool = True
) -> GazeField:
    if lens is None:
        rays = _naked_rays(wearer, directions)
    else:
        rays = _traced_rays(*_through(lens, wearer.wear, _chief_rays(wearer, directions.T), within_outline))
    arrays = (rays.entry, rays.exit, rays.direction, rays.transfer, rays.status)
    return GazeField(lens, wearer, directions, *arrays, shape)


def _chief_rays(wearer: Wearer, gaze: Floats) -> _Rays:
    """The rays that leave the centre of the entrance pupil at gazes (3, n)."""
    points = np.broadcast_to(wearer.centre_of_rotation[:, None], gaze.shape)
    return _Rays(points, wearer.eye.pupil_from_rotation, gaze)


def _naked_rays(wearer: Wearer, directions: Floats) -> TracedRays:
    pupil = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * directions
    known = np.asarray(np.isfinite(directions).all(axis=1))
    status = np.where(known, np.int8(Status.OK), np.int8(Status.NOT_CONVERGED))
    return TracedRays(pupil, pupil, directions, np.where(known[:, None, None], np.eye(4), np.nan), status)


def look_at(lens: Lens | None, wearer: Wearer, points: ArrayLike, within_outline: bool = True) -> GazeField:
    """The gaze field of those gazes whose chief rays meet the points (n, 3), mm, wear frame.

    Newton's method with the field's own derivative; a gaze whose ray fails turns half-way back to the last one that
    passed. A point that no gaze meets to 1e-9 of its distance has the status of its first failing ray, or NOT_CONVERGED,
    as has a point behind the front surface or the eye. within_outline=False lets rays pass beyond the lens's edge, as far
    as its surfaces go.
    """
    line = np.asarray(points, dtype=float).reshape(-1, 3) - wearer.centre_of_rotation
    behind = line[:, 2] <= 0
    line[behind] = [0.0, 0.0, 1.0]
    target, gaze, distance = wearer.centre_of_rotation + line, unit(line), np.linalg.norm(line, axis=1)
    reason = np.zeros(len(gaze), dtype=np.int8)
    if lens is not None:
        gaze, reason = _aim(lens, wearer, target, gaze, CLOSE * distance)
    field = _field(lens, wearer, gaze, (len(gaze),), within_outline)
    along = field.distances_to(target)
    miss = np.linalg.norm(target - field.origin - along[:, None] * field.direction, axis=1)
    lost = behind | ~(along > -1e-6) | ~(miss <= 1e-9 * distance)
    field = field.with_status(lost & (field.status == Status.OK), Status.NOT_CONVERGED)
    return replace(field, status=np.where(lost & (reason != Status.OK), reason, field.status))


def _aim(
    lens: Lens, wearer: Wearer, points: Floats, straight: Floats, close: Floats
) -> tuple[Floats, NDArray[np.int8]]:
    """Gazes (n, 3) at the points (n, 3), from those (n, 3) straight at them, and each one's first failure (n,).

    Each is turned once more after its ray has come `close` (n,), mm.
    """
    target, gaze = np.ascontiguousarray(points.T), np.array(straight.T, order="C")
    passed = np.repeat([[0.0], [0.0], [1.0]], len(points), axis=1)
    miss, reason, seeking = np.empty(len(points)), np.zeros(len(points), dtype=np.int8), np.arange(len(points))
    for _ in range(MOST_STEPS):
        rays = _chief_rays(wearer, np.take(gaze, seeking, axis=1))
        out, status = _through(lens, wearer.wear, rays, within_outline=False)
        lever = wearer.eye.pupil_from_rotation
        kernels.aim.turn(out, status, seeking, target, lever, passed, gaze, miss, reason)
        seeking = seeking[~(miss[seeking] <= close[seeking])]
        if not seeking.size:
            break
    return gaze.T, reason


def look_through(lens: Lens, wearer: Wearer, x: ArrayLike, y: ArrayLike) -> GazeField:
    """The gaze field of those gazes whose chief rays leave the front surface at lens points x, y (n,), mm."""
    px, py = np.broadcast_arrays(np.asarray(x, dtype=float).ravel(), np.asarray(y, dtype=float).ravel())
    points = np.stack([px, py, lens.front_height(px, py)], axis=-1)
    return look_at(lens, wearer, worn_pose(lens, wearer.wear).to_wear(points))
