"""From a lens and a wearer to chief rays: pose of the worn lens, grids of gaze, and the trace itself."""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .conventions import Floats, Status, inverse_2x2, listing_frame, unit
from .eye import Wear, Wearer
from .field import GazeField
from .kernels import trace as kernel
from .lens import Lens
from .surfaces import Surface

MOST_STEPS = 30


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
        """Unit vectors (ny * nx, 3), wear frame, row by row."""
        u, v = (a.ravel() for a in np.meshgrid(*self.axes()))
        azimuth, elevation = self.centre
        if self.kind == "angles":
            return direction_from_angles(azimuth + u, elevation + v)
        frame = listing_frame(direction_from_angles(azimuth, elevation))
        return unit(np.stack([u, v, np.ones_like(u)], axis=-1) @ frame)


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
    pose = worn_pose(lens, wear)
    back = _posed(lens.back, pose, 0.0)
    front = _posed(lens.front, pose, lens.centre_thickness)
    d = np.ascontiguousarray(np.asarray(direction, dtype=float).reshape(-1, 3).T)
    s = np.ascontiguousarray(np.broadcast_to(np.asarray(start, dtype=float), d.T.shape).T)
    out, status = np.empty((25, d.shape[1])), np.empty(d.shape[1], dtype=np.int8)
    kernel.trace_rays(back, front, lens.index, s, d, out, status)
    return TracedRays(out[:3].T, out[3:6].T, out[6:9].T, np.moveaxis(out[9:].reshape(4, 4, -1), 2, 0), status)


def _posed(surface: Surface, pose: WornPose, height: float) -> tuple[Any, ...]:
    vertex = pose.to_wear([*surface.decentration, height])
    return *surface.shape_arrays(), np.concatenate([(pose.rotation @ surface.rotation).ravel(), vertex])


def trace(lens: Lens | None, wearer: Wearer, gaze: GazeGrid | ArrayLike) -> GazeField:
    """The gaze field of a worn lens (None: the naked eye) for a grid or a list of gaze directions (n, 3), wear frame.

    The chief ray starts at the centre of the entrance pupil of the eye turned to the gaze; see GazeField.
    """
    shape = (gaze.ny, gaze.nx) if isinstance(gaze, GazeGrid) else None
    directions = gaze.directions() if isinstance(gaze, GazeGrid) else unit(np.asarray(gaze, dtype=float).reshape(-1, 3))
    if lens is None:
        rays = _naked_rays(wearer, directions)
    else:
        rays = _within_outline(
            lens, wearer.wear, trace_rays(lens, wearer.wear, _pupils(wearer, directions), directions)
        )
    return _field(lens, wearer, directions, rays, shape)


def _pupils(wearer: Wearer, directions: Floats) -> Floats:
    return wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * directions


def _naked_rays(wearer: Wearer, directions: Floats) -> TracedRays:
    pupil = _pupils(wearer, directions)
    known = np.asarray(np.isfinite(directions).all(axis=1))
    status = np.where(known, np.int8(Status.OK), np.int8(Status.NOT_CONVERGED))
    return TracedRays(pupil, pupil, directions, np.where(known[:, None, None], np.eye(4), np.nan), status)


def _within_outline(lens: Lens, wear: Wear, rays: TracedRays) -> TracedRays:
    """The rays, of which those that enter or leave beyond the lens's edge have failed."""
    pose = worn_pose(lens, wear)
    outside = np.zeros(len(rays.status), dtype=bool)
    for points in (pose.to_lens(rays.entry), pose.to_lens(rays.exit)):
        outside |= ~lens.outline.contains(points[:, 0], points[:, 1])
    status = np.where((rays.status == Status.OK) & outside, np.int8(Status.OUTSIDE_OUTLINE), rays.status)
    for array in (rays.entry, rays.exit, rays.direction, rays.transfer):
        array[status != Status.OK] = np.nan
    return rays._replace(status=status)


def _field(
    lens: Lens | None, wearer: Wearer, directions: Floats, rays: TracedRays, shape: tuple[int, int] | None = None
) -> GazeField:
    arrays = (rays.entry, rays.exit, rays.direction, rays.transfer, rays.status)
    return GazeField(lens, wearer, directions, *arrays, shape or (len(directions),))


def look_at(lens: Lens | None, wearer: Wearer, points: ArrayLike, within_outline: bool = True) -> GazeField:
    """The gaze field of those gazes whose chief rays meet the points (n, 3), mm, wear frame.

    Newton's method with the field's own derivative; a gaze whose ray fails turns half-way back to the last one that
    passed. A point that no gaze meets to 1e-9 of its distance has the status of its first failing ray, or NOT_CONVERGED,
    as has a point behind the front surface or the eye. within_outline=False lets rays pass beyond the lens's edge, as far
    as its surfaces go.
    """
    line = np.asarray(points, dtype=float).reshape(-1, 3) - wearer.centre_of_rotation
    reach, behind = np.linalg.norm(line, axis=1), line[:, 2] <= 0
    line[behind] = [0.0, 0.0, 1.0]
    target, gaze = wearer.centre_of_rotation + line, unit(line)
    passed, reason = np.tile([0.0, 0.0, 1.0], (len(gaze), 1)), np.zeros(len(gaze), dtype=np.int8)
    seeking = np.arange(len(gaze))
    for _ in range(MOST_STEPS):
        rays = _outgoing(lens, wearer, gaze[seeking])
        ok = rays.status == Status.OK
        reason[seeking] = np.where(reason[seeking] == Status.OK, rays.status, reason[seeking])
        miss, step = _newton_step(rays, target[seeking], wearer.eye.pupil_from_rotation)
        far = ~ok | (miss > 1e-11 * reach[seeking])
        seeking, ok, step = seeking[far], ok[far, None], step[far]
        passed[seeking] = np.where(ok, gaze[seeking], passed[seeking])
        gaze[seeking] = np.where(ok, _turned(gaze[seeking], step), unit(gaze[seeking] + passed[seeking]))
        if not seeking.size:
            break
    rays = _outgoing(lens, wearer, gaze)
    miss, _ = _newton_step(rays, target, wearer.eye.pupil_from_rotation)
    if lens is not None and within_outline:
        rays = _within_outline(lens, wearer.wear, rays)
    field = _field(lens, wearer, gaze, rays)
    lost = behind | ~(miss <= 1e-9 * reach) | ~(field.distances_to(target) > -1e-6)
    field = field.with_status(lost & (field.status == Status.OK), Status.NOT_CONVERGED)
    return replace(field, status=np.where(lost & (reason != Status.OK), reason, field.status))


def _outgoing(lens: Lens | None, wearer: Wearer, directions: Floats) -> TracedRays:
    """The chief rays of gazes (n, 3), through the lens or of the naked eye; the outline is ignored."""
    if lens is None:
        return _naked_rays(wearer, directions)
    return trace_rays(lens, wearer.wear, _pupils(wearer, directions), directions)


def _newton_step(rays: TracedRays, target: Floats, lever: float) -> tuple[Floats, Floats]:
    """Distance (n,) by which each chief ray misses its target, mm, and the turn (n, 2) of the gaze that mends it, rad."""
    frame = listing_frame(rays.direction)
    local = np.einsum("nij,nj->ni", frame, target - rays.exit)
    t = rays.transfer
    per_distance = t[:, 2:, :2] * lever + t[:, 2:, 2:]
    turn_to_offset = t[:, :2, :2] * lever + t[:, :2, 2:] + local[:, 2, None, None] * per_distance
    step = np.einsum("nij,nj->ni", inverse_2x2(turn_to_offset), local[:, :2])
    size = np.linalg.norm(step, axis=1, keepdims=True)
    return np.linalg.norm(local[:, :2], axis=1), step * np.minimum(1.0, 0.2 / np.maximum(size, 1e-300))


def _turned(gaze: Floats, step: Floats) -> Floats:
    frame = listing_frame(gaze)
    return unit(gaze + step[:, :1] * frame[:, 0] + step[:, 1:] * frame[:, 1])


def look_through(lens: Lens, wearer: Wearer, x: ArrayLike, y: ArrayLike) -> GazeField:
    """The gaze field of those gazes whose chief rays leave the front surface at lens points x, y (n,), mm."""
    px, py = np.broadcast_arrays(np.asarray(x, dtype=float).ravel(), np.asarray(y, dtype=float).ravel())
    points = np.stack([px, py, lens.front_height(px, py)], axis=-1)
    return look_at(lens, wearer, worn_pose(lens, wearer.wear).to_wear(points))
