"""The conoid of one gaze: how light from the pupil spreads in the scene, its focal lines, its circle of least confusion.

To first order M(s) = M0 + s M' at the distance s along the outgoing ray, in each state of accommodation.
Source of the name: Kakimoto, Tatsukawa & Nishita 2010, figures 6 to 10.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats, ReadOnlyArrays, Status
from .field import Accommodation, Ellipse, GazeField, ellipse
from .foci import foci

NO_OBJECT = 1000.0  # mm, how far to look along the ray where the object is at infinity
FARTHEST = 1e9  # mm: what lies farther is at infinity


@dataclass(frozen=True, slots=True, eq=False)
class Conoid(ReadOnlyArrays):
    """One state of accommodation (D): the blur matrix where the ray leaves the front surface (2, 2), mm, and its growth
    (2, 2), mm per mm along the ray, both across the ray. focal_lines: distances, mm, as in optics.foci; inf for parallel light.
    """

    accommodation: float
    at_exit: Floats
    growth: Floats
    focal_lines: tuple[float, float]

    def blur(self, distance: ArrayLike) -> Floats:
        """Blur matrices (..., 2, 2), mm, at distances (...,) mm from the front surface; NaN at infinity."""
        s = np.where(np.isfinite(distance), distance, np.nan)
        return self.at_exit + s[..., None, None] * self.growth

    def eoc(self, distance: ArrayLike) -> Ellipse:
        """Ellipse of confusion at distances (...,) mm."""
        return ellipse(self.blur(distance))

    def signed_axes(self, distance: ArrayLike) -> tuple[Floats, Floats]:
        """Signed semi-axes (...,), mm, at distances (...,) mm: each passes zero at a focal line; the greater one first."""
        (e0, h0), (e, h) = _rotation(self.at_exit), _rotation(self.blur(distance))
        turning = np.copysign(np.hypot(e, h), e * e0 + h * h0)
        m = self.blur(distance)
        stretching = np.hypot(m[..., 0, 0] - m[..., 1, 1], m[..., 0, 1] + m[..., 1, 0]) / 2
        return turning + stretching, turning - stretching

    @property
    def least_confusion(self) -> float:
        """Distance, mm, of the circle of least confusion: where the sum of the signed semi-axes changes its sign; negative
        or inf as for focal lines.
        """
        start, growth = np.array(_rotation(self.at_exit)), np.array(_rotation(self.growth))
        flat = abs(start @ growth) * FARTHEST < start @ start
        return float("inf") if flat else -float(start @ start) / float(start @ growth)


def _rotation(m: Floats) -> tuple[Floats, Floats]:
    """Of matrices (..., 2, 2) the part that is a turn times a factor: factor times cosine and sine."""
    return (m[..., 0, 0] + m[..., 1, 1]) / 2, (m[..., 1, 0] - m[..., 0, 1]) / 2


@dataclass(frozen=True, slots=True, eq=False)
class GazeConoids(ReadOnlyArrays):
    """A gaze's conoids: relaxed, tense (all amplitude in use), and used for the object at `distance` mm.

    pupil, exit (3,): where the chief ray starts and where it leaves the front surface, mm. across, frame (3, 3): rows e1, e2,
    direction of the gaze and of the outgoing ray, wear frame. pupil_radius: mm. status: of the ray; conoids hold NaN where it
    is not OK.
    """

    distance: float
    pupil: Floats
    exit: Floats
    across: Floats
    frame: Floats
    pupil_radius: float
    relaxed: Conoid
    tense: Conoid
    used: Conoid
    status: int

    @property
    def states(self) -> dict[str, Conoid]:
        """The conoids by name."""
        return {"relaxed": self.relaxed, "tense": self.tense, "used": self.used}

    def reach(self) -> float:
        """Distance, mm, along the ray within which there is something to see: the object and what focal lines are near it."""
        near = self.distance if np.isfinite(self.distance) else NO_OBJECT
        foci = [line for conoid in self.states.values() for line in conoid.focal_lines if 0 < line < 2.5 * near]
        return 1.15 * max(near, *foci, 0.0)


def gaze_conoids(field: GazeField, distance: float, rule: Accommodation = "retina") -> GazeConoids:
    """The conoids of the only ray of a field, for an object at a distance (mm, inf)."""
    wearer = field.wearer
    passed = field.status[0] == Status.OK
    used = float(field.accommodation(distance, rule)[0]) if passed else float("nan")
    relaxed, tense, now = (conoid(field, a) for a in (0.0, wearer.eye.accommodation, used))
    pupil = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * field.directions[0]
    return GazeConoids(
        distance,
        pupil,
        field.origin[0],
        field.gaze_frame[0],
        field.frame[0],
        wearer.eye.pupil_diameter / 2,
        relaxed,
        tense,
        now,
        int(field.status[0]),
    )


def conoid(field: GazeField, accommodation: float) -> Conoid:
    """The conoid of the only ray of a field by an eye that accommodates so many D."""
    eye, t = field.wearer.eye, field.transfer[0]
    vergence = (eye.pupil_refraction - accommodation * np.eye(2)) / 1000
    radius = eye.pupil_diameter / 2
    near, far = (float(line) if abs(line) < FARTHEST else np.inf for line in foci(field, accommodation).distance[0])
    at_exit, growth = (radius * (t[rows, :2] + t[rows, 2:] @ vergence) for rows in (slice(0, 2), slice(2, 4)))
    return Conoid(accommodation, at_exit, growth, (near, far))
