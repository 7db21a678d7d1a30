"""Truth beyond the first order: bundles of real rays through the whole pupil, for each gaze of a field.

The eye emits rays from pupil points x with slopes S x, as an ideal eye of the vergence S = R - a I does (every such ray
of a spherical S meets the far point). `trace_bundle` follows them to the object: spots and second-moment ellipses of
confusion. `trace_wavefront` finds the rays by which an object point reaches each pupil point: the wave aberration of lens
and ideal eye, and the geometric point spread on the retina. No diffraction. The lens's outline is ignored.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats, ReadOnlyArrays, inverse_2x2, listing_frame, unit
from .field import Accommodation, Ellipse, GazeField, ellipse
from .gaze import TracedRays, trace_rays
from .pupil import Pupil, gauss_pupil, zernike

_STEPS, _LARGEST_MISS = 4, 1e-6  # of Newton's method; rad
_CHUNK = 8192  # rays at a time


@dataclass(frozen=True, slots=True, eq=False)
class Bundle(ReadOnlyArrays):
    """Real rays of an eye at its objects. distance (n,): mm from the front surface; vergence (n, 2, 2): S, D.

    landing (n, m, 2): where the ray of each pupil point cuts the plane across the chief ray at that distance, from the
    chief ray, per distance (rad; a slope at infinity), in the frame across the outgoing ray; NaN where a ray fails.
    """

    field: GazeField
    pupil: Pupil
    distance: Floats
    vergence: Floats
    landing: Floats

    def spot(self) -> Floats:
        """Spot points (n, m, 2), mm across the outgoing ray. Raises ValueError at infinity."""
        if np.isinf(self.distance).any():
            raise ValueError("at infinity a spot has no size in mm; `landing` stays finite")
        return self.landing * self.distance[:, None, None]

    def angular_blur(self) -> Floats:
        """Symmetric matrices (n, 2, 2), rad, that give a uniform disc the second moments of the landing points."""
        return _blur_of_moments(self.landing, self.pupil.weights)

    def angular_eoc(self) -> Ellipse:
        """Second-moment ellipse of confusion seen from the lens, rad; finite at infinity."""
        return ellipse(self.angular_blur())

    def eoc(self) -> Ellipse:
        """Second-moment ellipse of confusion at the objects: semi-axes (mm) and orientation (rad). ValueError at infinity."""
        major, minor, orientation = self.angular_eoc()
        if np.isinf(self.distance).any():
            raise ValueError("at infinity an ellipse of confusion has no size in mm; ask for angular_eoc")
        return Ellipse(major * self.distance, minor * self.distance, orientation)

    def wavefront(self) -> "Wavefront":
        """The wave aberration of the same lens, eye and objects, over the same pupil points."""
        return trace_wavefront(self.field, self.distance, self.vergence, self.pupil)


@dataclass(frozen=True, slots=True, eq=False)
class Wavefront(ReadOnlyArrays):
    """Wave aberration of lens and ideal eye for a point of the object on each chief ray.

    aberration (n, m): um at the pupil points, positive where the light is ahead; a myopic error has a positive defocus term.
    spread (n, m, 2): apparent direction of each ray for the resting eye, rad, gaze frame: the gradient of the aberration.
    NaN where a ray fails.
    """

    field: GazeField
    pupil: Pupil
    aberration: Floats
    spread: Floats

    def zernike(self, order: int = 6) -> Floats:
        """Zernike coefficients (n, k), um, for the pupil's radius, by single index j. OSA/ANSI Z80.28; weighted least squares.

        M = -4 sqrt(3) c_2^0 / r^2, J0 = -2 sqrt(6) c_2^2 / r^2, J45 = -2 sqrt(6) c_2^-2 / r^2 (D, with r in mm) make of
        the second order the residual defocus S - S* that GazeField.residual_defocus gives for a small pupil.
        """
        root = np.sqrt(self.pupil.weights)[:, None]
        fit = np.linalg.pinv(root * zernike(self.pupil.points, order)) * root.T
        return self.aberration @ fit.T

    def higher_order_rms(self, order: int = 6) -> Floats:
        """Root mean square (n,), um, of the Zernike terms from the third order up."""
        return np.sqrt(np.sum(self.zernike(order)[:, 6:] ** 2, axis=1))

    def retinal_blur(self) -> Floats:
        """Symmetric matrices (n, 2, 2), rad, that give a uniform disc the second moments of the spread."""
        return _blur_of_moments(self.spread, self.pupil.weights)

    def defocus(self) -> Floats:
        """Angular diameter (n,), rad, of the blur on the retina: as GazeField.defocus, by second moments of real rays."""
        return np.sqrt(2.0) * np.linalg.norm(self.retinal_blur(), axis=(-2, -1))

    def psf(self, pixel: float, size: int) -> Floats:
        """Geometric point spread (n, size, size): share of the light in square pixels of `pixel` rad about the chief ray.

        Rows rise along e2 (up), columns along e1 (to the wearer's left) of the gaze frame. What falls beyond is missing from
        the sum. For a smooth picture trace a Vogel pupil of some thousand points.
        """
        edges = (np.arange(size + 1) - size / 2) * pixel
        images = np.full((len(self.spread), size, size), np.nan)
        for image, spread in zip(images, self.spread, strict=True):
            if np.isfinite(spread).all():
                image[:] = np.histogram2d(spread[:, 1], spread[:, 0], (edges, edges), weights=self.pupil.weights)[0]
        return images


def trace_bundle(
    field: GazeField, distance: ArrayLike, accommodation: Accommodation = "retina", pupil: Pupil | None = None
) -> Bundle:
    """Trace the eye's rays from its pupil to objects at `distance` (mm, a number or (n,)); see GazeField.bundle."""
    samples, s = pupil or gauss_pupil(), np.broadcast_to(np.asarray(distance, dtype=float), field.status.shape)
    vergence = field.vergence(s, accommodation)
    landing = np.empty((len(s), len(samples.weights), 2))
    for part in _parts(len(s), samples):
        landing[part] = _landing(field.take(part), s[part], vergence[part], samples)
    return Bundle(field, samples, s, vergence, landing)


def trace_pupil(field: GazeField, vergence: Floats, pupil: Pupil) -> tuple[Floats, TracedRays]:
    """Real rays of an eye of vergence S (n, 2, 2), D, through the pupil's m points: starts (n, m, 3), mm, and rays (n, m, ...).

    Wear frame; a ray that fails holds NaN.
    """
    offsets = _offsets(field, pupil)
    return _starts(field, offsets), _traced(field, offsets, offsets @ vergence / 1000)


def _parts(gazes: int, pupil: Pupil) -> list[slice]:
    """Gazes by so many at a time that their rays are _CHUNK or fewer."""
    step = max(1, _CHUNK // len(pupil.weights))
    return [slice(first, first + step) for first in range(0, gazes, step)]


def _landing(field: GazeField, s: Floats, vergence: Floats, samples: Pupil) -> Floats:
    """Landing points (n, m, 2), rad: see Bundle."""
    offsets = _offsets(field, samples)
    rays = _traced(field, offsets, offsets @ vergence / 1000)
    away = rays.exit - field.origin[:, None]
    along, w = field.direction[:, None], (1 / s)[:, None, None]
    ahead = np.sum(rays.direction * along, axis=-1, keepdims=True)
    reach = (1 - w * np.sum(away * along, axis=-1, keepdims=True)) / ahead
    return (w * away + reach * rays.direction) @ np.swapaxes(field.frame[:, :2], 1, 2)


def trace_wavefront(field: GazeField, distance: ArrayLike, vergence: Floats, pupil: Pupil | None = None) -> Wavefront:
    """Find the rays from the object point at `distance` (mm, a number or (n,)) on each chief ray to the pupil points.

    vergence (n, 2, 2): S of the eye, D. Newton's method with each ray's own transfer matrix, backwards from the pupil, from
    the first order. What the last rays still miss by counts in the second order of the path, and is put right in the spread.
    """
    samples, s = pupil or gauss_pupil(), np.broadcast_to(np.asarray(distance, dtype=float), field.status.shape)
    aberration = np.empty((len(s), len(samples.weights)))
    spread = np.empty((*aberration.shape, 2))
    for part in _parts(len(s), samples):
        aberration[part], spread[part] = _aberration(field.take(part), s[part], vergence[part], samples)
    return Wavefront(field, samples, aberration, spread)


def _aberration(field: GazeField, s: Floats, vergence: Floats, samples: Pupil) -> tuple[Floats, Floats]:
    """Aberration (n, m), um, and spread (n, m, 2), rad: see Wavefront."""
    offsets, w = _offsets(field, samples), (1 / s)[:, None, None]
    slopes = offsets @ np.swapaxes(field.required_vergence(s), 1, 2) / 1000
    for _ in range(_STEPS):
        rays = _traced(field, offsets, slopes)
        still, miss = _correction(field, rays, w)
        missed = np.hypot(miss[..., 0], miss[..., 1]) > _LARGEST_MISS
        if not missed.any():
            break
        slopes = slopes + still
    emitted = offsets @ vergence / 1000
    ideal = -np.sum(offsets * emitted, axis=-1) / (1 + np.sqrt(1 + np.sum(emitted**2, axis=-1)))
    aberration = np.where(missed, np.nan, 1000 * (ideal - _path_beyond_chief(field, rays, offsets, w)))
    return aberration, np.where(missed[..., None], np.nan, slopes + still - emitted)


def _offsets(field: GazeField, pupil: Pupil) -> Floats:
    """Pupil points (n, m, 2), mm, in the gaze frame."""
    points = field.wearer.eye.pupil_diameter / 2 * pupil.points
    return np.broadcast_to(points, (len(field.status), *points.shape))


def _starts(field: GazeField, offsets: Floats) -> Floats:
    centre = field.wearer.centre_of_rotation + field.wearer.eye.pupil_from_rotation * field.directions
    return centre[:, None] + offsets @ field.gaze_frame[:, :2]


def _traced(field: GazeField, offsets: Floats, slopes: Floats) -> TracedRays:
    """The rays (n, m, ...) of an eye from pupil points with slopes (n, m, 2) in the gaze frame."""
    start = _starts(field, offsets)
    direction = unit(field.directions[:, None] + slopes @ field.gaze_frame[:, :2])
    shape = start.shape[:2]
    if field.lens is None:
        ones = np.broadcast_to(np.eye(4), (*shape, 4, 4))
        return TracedRays(start, start, direction, ones, np.zeros(shape, dtype=np.int8))
    rays = trace_rays(field.lens, field.wearer.wear, start.reshape(-1, 3), direction.reshape(-1, 3))
    entry, leave, out = (part.reshape(*shape, 3) for part in (rays.entry, rays.exit, rays.direction))
    return TracedRays(entry, leave, out, rays.transfer.reshape(*shape, 4, 4), rays.status.reshape(shape))


def _correction(field: GazeField, rays: TracedRays, w: Floats) -> tuple[Floats, Floats]:
    """Turn (n, m, 2) of the slopes at the pupil that leads each ray to its object point, and by how much it misses now, rad.

    w (n, 1, 1): reciprocal of the distance.
    """
    to_object = field.direction[:, None] + w * (field.origin[:, None] - rays.exit)
    local = np.einsum("nmij,nmj->nmi", listing_frame(rays.direction), to_object)
    per_slope = rays.transfer[..., :2, 2:] * w[..., None] + rays.transfer[..., 2:, 2:] * local[..., 2:, None]
    return np.einsum("nmij,nmj->nmi", inverse_2x2(per_slope), local[..., :2]), local[..., :2]


def _path_beyond_chief(field: GazeField, rays: TracedRays, offsets: Floats, w: Floats) -> Floats:
    """Optical path (n, m), mm, from each pupil point to the object less that of the chief ray."""
    index = 1.0 if field.lens is None else field.lens.index
    start = _starts(field, offsets)
    centre = _starts(field, np.zeros((len(offsets), 1, 2)))[:, 0]

    def inside(start: Floats, entry: Floats, leave: Floats) -> Floats:
        return np.linalg.norm(entry - start, axis=-1) + index * np.linalg.norm(leave - entry, axis=-1)

    gap = field.origin[:, None] - rays.exit
    along = field.direction[:, None]
    beyond = np.linalg.norm(along + w * gap, axis=-1) + 1
    outside = (w[..., 0] * np.sum(gap**2, axis=-1) + 2 * np.sum(gap * along, axis=-1)) / beyond
    return inside(start, rays.entry, rays.exit) - inside(centre, field.entry, field.origin)[:, None] + outside


def _blur_of_moments(points: Floats, weights: Floats) -> Floats:
    """Twice the root of the covariance matrix of points (n, m, 2)."""
    centred = points - np.einsum("nmi,m->ni", points, weights)[:, None]
    covariance = np.einsum("nmi,nmj,m->nij", centred, centred, weights)
    xx, xy, yy = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    root = np.sqrt(np.maximum(xx * yy - xy**2, 0.0))
    trace = xx + yy + 2 * root
    with np.errstate(invalid="ignore", divide="ignore"):
        blur = 2 * (covariance + root[:, None, None] * np.eye(2)) / np.sqrt(trace)[:, None, None]
    return np.where(trace[:, None, None] == 0, 0.0, blur)
