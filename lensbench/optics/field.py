"""GazeField: one trace of the lens, from which everything seen follows by small matrix algebra.

For each gaze the chief ray leaves the entrance pupil's centre, passes the lens and goes out into the scene. Around it the
4x4 transfer matrix [[A, B], [C, D]] takes (offset mm, slope rad) at the pupil to the exit point on the front surface
(naked eye: identity, the exit point is the pupil centre). The eye emits slopes S x, S = R - a I; at the distance s along
the outgoing ray a pupil vector d of the unit disc lands at M(s) d, M(s) = r_p [(A + B S) + s (C + D S)]. All methods
take the object distance s in mm from the exit point: a number, an array (n,) or (k, 1); infinity is allowed.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .conventions import (
    Floats,
    ReadOnlyArrays,
    SphereCylinderAxis,
    Status,
    carry_vergence,
    inverse_2x2,
    listing_frame,
    sphere_cylinder_axis,
)
from .eye import Eye, Wearer

if TYPE_CHECKING:
    from .bundle import Bundle
    from .lens import Lens
    from .pupil import Pupil

ACCOMMODATION_RULES = ("retina", "object", "paper")

Accommodation = str | float | Floats


class Ellipse(NamedTuple):
    """Ellipse of confusion: semi-axes (mm, or rad of an angular blur) and orientation of the major axis (rad, 0 to pi)."""

    semi_major: Floats
    semi_minor: Floats
    orientation: Floats


class Prism(NamedTuple):
    """Prism (cm/m) and direction of its base (degrees, 0 to 360, TABO)."""

    prism: Floats
    base: Floats


@dataclass(frozen=True, slots=True, eq=False)
class GazeField(ReadOnlyArrays):
    """Chief rays and transfer matrices of n gazes, wear frame; NaN where status is not OK.

    directions (n, 3): gaze, unit. entry, origin (n, 3): back-surface point and exit point, mm. direction (n, 3): into the
    scene, unit. transfer (n, 4, 4): pupil to exit point, between the Listing frames of gaze and outgoing ray; mm, rad.
    status (n,): Status. shape: of the grid that was asked for, () arrays reshape to it.
    """

    lens: "Lens | None"
    wearer: Wearer
    directions: Floats
    entry: Floats
    origin: Floats
    direction: Floats
    transfer: Floats
    status: NDArray[np.int8]
    shape: tuple[int, ...]

    @property
    def frame(self) -> Floats:
        """Frames (n, 3, 3) across the outgoing rays: rows e1, e2, direction."""
        return listing_frame(self.direction)

    @property
    def gaze_frame(self) -> Floats:
        """Frames (n, 3, 3) across the gazes: rows e1, e2, gaze."""
        return listing_frame(self.directions)

    def with_eye(self, eye: Eye) -> "GazeField":
        """The same rays seen by an eye of another refraction, accommodation or pupil diameter; nothing is traced again.

        Raises ValueError when the eye's centre of rotation or entrance pupil lies elsewhere: that needs a new trace.
        """
        old = self.wearer.eye
        if (eye.centre_of_rotation, eye.entrance_pupil) != (old.centre_of_rotation, old.entrance_pupil):
            raise ValueError("an eye with another centre of rotation or entrance pupil needs a new trace")
        return replace(self, wearer=replace(self.wearer, eye=eye))

    def take(self, which: NDArray[Any] | slice) -> "GazeField":
        """The field of some of its rays, by an index array, a mask or a slice."""
        arrays = ("directions", "entry", "origin", "direction", "transfer", "status")
        picked = {name: getattr(self, name)[which] for name in arrays}
        return replace(self, **picked, shape=picked["status"].shape)

    def with_status(self, where: NDArray[np.bool_], status: Status) -> "GazeField":
        """The field with the rays `where` (n,) failed with the given status."""
        if not where.any():
            return self

        def blank(array: Floats) -> Floats:
            return np.where(where.reshape(-1, *[1] * (array.ndim - 1)), np.nan, array)

        return replace(
            self,
            entry=blank(self.entry),
            origin=blank(self.origin),
            direction=blank(self.direction),
            transfer=blank(self.transfer),
            status=np.where(where, np.int8(status), self.status),
        )

    # -- the two matrices per unit distance: everything below is made of these ---------------------------------------

    def _pair(self, distance: ArrayLike) -> tuple[Floats, Floats]:
        """P = A/s + C (1/mm) and Q = B/s + D: an offset x and slope p at the pupil arrive at the angle P x + Q p."""
        s = np.asarray(distance, dtype=float)
        if np.any(s <= 0):
            raise ValueError("object distances must be positive (mm from the lens's front surface)")
        w = (1.0 / s)[..., None, None]
        t = self.transfer
        return t[:, :2, :2] * w + t[:, 2:, :2], t[:, :2, 2:] * w + t[:, 2:, 2:]

    def required_vergence(self, distance: ArrayLike = np.inf) -> Floats:
        """Vergence S* (..., n, 2, 2) in D at the pupil, gaze frame, that an eye needs to see the object sharply."""
        p, q = self._pair(distance)
        return -1000.0 * inverse_2x2(q) @ p

    def accommodation(self, distance: ArrayLike, rule: Accommodation = "retina") -> Floats:
        """Accommodation in use, D (..., n), for an object at `distance`.

        rule "retina": smallest rms blur on the retina; "object": smallest |M| in the Frobenius norm at the object;
        "paper": the sum of the signed semi-axes of the ellipse vanishes, interpolated between the relaxed and the
        tensed eye (our reading of Kakimoto, Tatsukawa & Nishita 2010, eq. 12); a number or array: that many D.
        """
        if not isinstance(rule, str):
            return np.broadcast_to(rule, np.broadcast_shapes(np.shape(distance), self.status.shape)).astype(float)
        limit = self.wearer.eye.accommodation
        if rule == "retina":
            gap = self.wearer.eye.pupil_refraction - self.required_vergence(distance)
            wanted = (gap[..., 0, 0] + gap[..., 1, 1]) / 2
        elif rule == "object":
            wanted = self._least_blur_at_object(distance)
        elif rule == "paper":
            relaxed, tense = (signed_mean_axis(self.angular_blur(distance, a)) for a in (0.0, limit))
            with np.errstate(divide="ignore", invalid="ignore"):
                wanted = np.where(relaxed == tense, 0.0, limit * relaxed / (relaxed - tense))
        else:
            raise ValueError(f"unknown accommodation rule {rule!r}; there are {', '.join(ACCOMMODATION_RULES)}")
        return np.clip(wanted, 0.0, limit)

    def _least_blur_at_object(self, distance: ArrayLike) -> Floats:
        p, q = self._pair(distance)
        relaxed = p + q @ self.wearer.eye.pupil_refraction / 1000
        per_dioptre = -q / 1000
        square = np.sum(per_dioptre**2, axis=(-2, -1))
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(square == 0, 0.0, -np.sum(relaxed * per_dioptre, axis=(-2, -1)) / square)

    def vergence(self, distance: ArrayLike, accommodation: Accommodation = "retina") -> Floats:
        """Vergence S = R - a I (..., n, 2, 2) in D at the pupil, of the eye as it accommodates for `distance`."""
        a = self.accommodation(distance, accommodation)
        return self.wearer.eye.pupil_refraction - a[..., None, None] * np.eye(2)

    def angular_blur(self, distance: ArrayLike, accommodation: Accommodation = "retina") -> Floats:
        """Blur matrices M(s) / s (..., n, 2, 2), rad, frame across the outgoing ray; finite at infinity."""
        p, q = self._pair(distance)
        s = self.vergence(distance, accommodation) / 1000
        return self.wearer.eye.pupil_diameter / 2 * (p + q @ s)

    def blur(self, distance: ArrayLike, accommodation: Accommodation = "retina") -> Floats:
        """Blur matrices M(s) (..., n, 2, 2), mm across the outgoing ray: the unit disc's image is the ellipse of confusion.

        Raises ValueError at infinity, where angular_blur stays finite.
        """
        s = np.asarray(distance, dtype=float)
        if np.isinf(s).any():
            raise ValueError("at infinity an ellipse of confusion has no size in mm; ask for angular_blur")
        return self.angular_blur(s, accommodation) * s[..., None, None]

    def eoc(self, distance: ArrayLike, accommodation: Accommodation = "retina") -> Ellipse:
        """Ellipse of confusion at `distance`: semi-axes (mm) and orientation (rad) in the frame across the outgoing ray."""
        return ellipse(self.blur(distance, accommodation))

    def residual_defocus(self, distance: ArrayLike, accommodation: Accommodation = "retina") -> Floats:
        """Residual defocus S - S* (..., n, 2, 2) in D at the pupil, gaze frame, after accommodation."""
        return self.vergence(distance, accommodation) - self.required_vergence(distance)

    def retinal_blur(self, distance: ArrayLike, accommodation: Accommodation = "retina") -> Floats:
        """Blur (..., n, 2, 2), rad at the pupil as the retina receives it: r_p (S - S*). M = s Q r_p (S - S*)."""
        return self.wearer.eye.pupil_diameter / 2000 * self.residual_defocus(distance, accommodation)

    def defocus(self, distance: ArrayLike, accommodation: Accommodation = "retina") -> Floats:
        """Rms blur diameter (..., n), rad: of the blur that the eye receives the rms of the two axes, sqrt(2) |r_p (S - S*)|.

        A sphere's blur disc has this diameter; the paper's defocus map shows another measure, see ellipse_diagonal.
        """
        return ellipse_diagonal(self.retinal_blur(distance, accommodation)) / np.sqrt(2.0)

    def bundle(
        self, distance: ArrayLike, accommodation: Accommodation = "retina", pupil: "Pupil | None" = None
    ) -> "Bundle":
        """Real rays through the whole pupil to objects at `distance` (a number or (n,)): what the first order leaves out.

        pupil: sample points, see optics.pupil; 4 rings of 14 points if left out. Traces the lens again.
        """
        from .bundle import trace_bundle

        return trace_bundle(self, distance, accommodation, pupil)

    # -- what a lens designer reads ------------------------------------------------------------------------------------

    def as_worn_matrix(self, distance: ArrayLike = np.inf) -> Floats:
        """As-worn power (..., n, 2, 2) in D, gaze frame: vergence at the vertex sphere less the object vergence -1/s."""
        w = self.wearer
        to_sphere = w.vertex_sphere_radius - w.eye.pupil_from_rotation
        s = np.asarray(distance, dtype=float)
        near = 1000.0 / (s if self.lens is not None else s - to_sphere)
        return carry_vergence(self.required_vergence(distance), -to_sphere) + near[..., None, None] * np.eye(2)

    def as_worn_power(self, distance: ArrayLike = np.inf) -> SphereCylinderAxis:
        """As-worn sphere, minus cylinder (D) and axis (degrees TABO), each (..., n); see as_worn_matrix."""
        return sphere_cylinder_axis(self.as_worn_matrix(distance))

    def power_error(self, distance: ArrayLike = np.inf) -> Floats:
        """As-worn power less the wearer's prescription at the vertex sphere (..., n, 2, 2), D."""
        return self.as_worn_matrix(distance) - self.wearer.prescription

    def prism_components(self) -> Floats:
        """Prism (n, 2), cm/m, along e1 and e2 of the gaze frame, positive towards the base: 100 tan of the deviation."""
        local = np.einsum("nij,nj->ni", self.gaze_frame, self.direction)
        return 100.0 * local[:, :2] / local[:, 2:]

    def prism(self) -> Prism:
        """Prism in cm/m and base direction in degrees, each (n,): light is bent towards the base."""
        h, v = self.prism_components().T
        return Prism(np.hypot(h, v), np.degrees(np.arctan2(v, h)) % 360)

    def gaze_derivative(self, distance: ArrayLike) -> Floats:
        """J / s (..., n, 2, 2): turn of the gaze (rad) to offset of the chief ray's point at s, per distance."""
        p, q = self._pair(distance)
        return p * self.wearer.eye.pupil_from_rotation + q

    def apparent_blur(self, distance: ArrayLike, accommodation: Accommodation = "retina") -> Floats:
        """Blur J^-1 M (..., n, 2, 2), rad in the gaze frame: the ellipse in which a point at s appears to the turning eye."""
        return inverse_2x2(self.gaze_derivative(distance)) @ self.angular_blur(distance, accommodation)

    def magnification(self, distance: ArrayLike = np.inf) -> Floats:
        """Angular magnification for the turning eye (..., n, 2, 2): turn of the gaze with the lens over that without.

        From the Listing frame of the line from the centre of rotation to the point at s, to the gaze frame. The point turns
        about the centre of rotation: its distance from there is kept, that from the lens is not.
        """
        s = np.asarray(distance, dtype=float)
        w = np.where(np.isfinite(s), 1.0 / s, 0.0)[..., None]
        to_point = self.direction + w * (self.origin - self.wearer.centre_of_rotation)
        per_distance = np.linalg.norm(to_point, axis=-1, keepdims=True)
        naked = listing_frame(to_point / per_distance)
        across = self.frame[:, :2] @ np.swapaxes(naked[..., :2, :], -1, -2)
        return per_distance[..., None] * inverse_2x2(self.gaze_derivative(distance)) @ across

    def distances_to(self, points: ArrayLike) -> Floats:
        """Distance s (n,) in mm along each outgoing ray to the foot of its own point (n, 3), wear frame."""
        return np.einsum("nj,nj->n", np.asarray(points, dtype=float) - self.origin, self.direction)


def ellipse(blur: ArrayLike) -> Ellipse:
    """Ellipse that matrices (..., 2, 2) make of the unit disc: their singular values and left direction, in closed form."""
    m = np.asarray(blur, dtype=float)
    e, f = (m[..., 0, 0] + m[..., 1, 1]) / 2, (m[..., 0, 0] - m[..., 1, 1]) / 2
    g, h = (m[..., 1, 0] + m[..., 0, 1]) / 2, (m[..., 1, 0] - m[..., 0, 1]) / 2
    turning, stretching = np.hypot(e, h), np.hypot(f, g)
    orientation = (np.arctan2(g, f) + np.arctan2(h, e)) / 2 % np.pi
    return Ellipse(turning + stretching, np.abs(turning - stretching), orientation)


def ellipse_diagonal(blur: ArrayLike) -> Floats:
    """2|eps| = 2 sqrt(eps1^2 + eps2^2) (...,) of the ellipses of blur matrices (..., 2, 2), in their unit.

    Kakimoto, Tatsukawa & Nishita 2010, section 5.3: the measure of its defocus map, sqrt 2 times a circle's diameter.
    """
    return 2 * np.linalg.norm(np.asarray(blur, dtype=float), axis=(-2, -1))


def signed_mean_axis(blur: ArrayLike) -> Floats:
    """Half the sum (...,) of the signed semi-axes of blur matrices (..., 2, 2): positive before the focus of the conoid."""
    m = np.asarray(blur, dtype=float)
    e, h = (m[..., 0, 0] + m[..., 1, 1]) / 2, (m[..., 1, 0] - m[..., 0, 1]) / 2
    return np.copysign(np.hypot(e, h), e)
