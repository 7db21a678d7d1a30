"""The wearer: the eye (refraction, accommodation, pupil) and how the lens sits before it."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats, ReadOnlyArrays, carry_vergence, rotation_xy


@dataclass(frozen=True, slots=True, eq=False)
class Eye(ReadOnlyArrays):
    """An eye to first order, behind the cornea's apex.

    refraction: (2, 2) D, far prescription at `refraction_vertex_distance` mm before the cornea (myopia negative).
    accommodation: amplitude, D, counted at the entrance pupil. pupil_diameter: entrance pupil, mm.
    centre_of_rotation, entrance_pupil: distances behind the corneal apex, mm.
    """

    refraction: Floats = field(default_factory=lambda: np.zeros((2, 2)))
    refraction_vertex_distance: float = 12.0
    accommodation: float = 0.0
    pupil_diameter: float = 4.0
    centre_of_rotation: float = 13.5
    entrance_pupil: float = 3.05

    def refraction_at(self, behind_cornea: float) -> Floats:
        """Refraction (2, 2) in D carried to a plane `behind_cornea` mm behind the corneal apex (negative: before it)."""
        return carry_vergence(self.refraction, self.refraction_vertex_distance + behind_cornea)

    @property
    def pupil_refraction(self) -> Floats:
        """Refraction (2, 2) in D at the entrance pupil."""
        return self.refraction_at(self.entrance_pupil)

    @property
    def pupil_from_rotation(self) -> float:
        """Distance from the centre of rotation to the entrance pupil, mm."""
        return self.centre_of_rotation - self.entrance_pupil


@dataclass(frozen=True, slots=True, eq=False)
class Wear:
    """Position of wear. Distances in mm, angles in rad.

    vertex_distance: corneal apex to the back surface along the line of sight straight ahead. pantoscopic_angle > 0:
    lower edge towards the cheek; of the lens's axis against the horizontal plane. face_form_angle > 0: temporal edge towards
    the face; of the axis against the vertical plane, seen from above. decentration: (x, y) of the lens's fitting point
    against that line of sight. pupillary_distance (monocular), near_distance (from the cornea).
    object_distances: the wearer's own (lowering of the gaze in rad, object distance in mm from the cornea), rising in
    lowering; empty: see optics.object_distance.
    """

    vertex_distance: float = 13.0
    pantoscopic_angle: float = 0.0
    face_form_angle: float = 0.0
    decentration: tuple[float, float] = (0.0, 0.0)
    pupillary_distance: float = 32.0
    near_distance: float = 400.0
    object_distances: tuple[tuple[float, float], ...] = ()

    @property
    def pantoscopic_angle_in_vertical_plane(self) -> float:
        """Pantoscopic angle, rad, of the lens's axis seen from the side: tan p / cos f for the face-form angle f."""
        return float(np.arctan(np.tan(self.pantoscopic_angle) / np.cos(self.face_form_angle)))

    def rotation(self, side: str) -> Floats:
        """Turn (3, 3) of a lens of side "R" or "L" from the lens frame to the wear frame: R_y(face form) R_x(pantoscopic)."""
        about_y = -self.face_form_angle if side == "R" else self.face_form_angle
        return rotation_xy(self.pantoscopic_angle, about_y)


@dataclass(frozen=True, slots=True, eq=False)
class Wearer:
    """An eye and the way the lens sits before it."""

    eye: Eye = field(default_factory=Eye)
    wear: Wear = field(default_factory=Wear)
    name: str = ""
    age: float | None = None

    @property
    def centre_of_rotation(self) -> Floats:
        """Centre of rotation (3,) in the wear frame, mm."""
        return np.array([0.0, 0.0, -self.vertex_sphere_radius])

    @property
    def corneal_apex(self) -> float:
        """z (mm, wear frame) of the corneal apex of the eye looking straight ahead: where depths count from."""
        return -self.wear.vertex_distance

    @property
    def vertex_sphere_radius(self) -> float:
        """Radius (mm) of the vertex sphere: from the centre of rotation to the back vertex."""
        return self.wear.vertex_distance + self.eye.centre_of_rotation

    @property
    def prescription(self) -> Floats:
        """Refraction (2, 2) in D at the vertex sphere: what an ideal far lens would give."""
        return self.eye.refraction_at(-self.wear.vertex_distance)


def hofstetter_amplitude(age: ArrayLike) -> Any:
    """Mean amplitude of accommodation, D, at the given age in years. Source: Hofstetter 1950, 18.5 - 0.30 age, >= 0."""
    return np.maximum(18.5 - 0.30 * np.asarray(age, dtype=float), 0.0)


def watson_yellott_pupil(luminance: ArrayLike, age: float, field_area: float = 3600.0, eyes: int = 2) -> Any:
    """Pupil diameter, mm, for a luminance (cd/m2) over field_area (deg2), seen by one or two eyes, at an age in years.

    Source: Watson & Yellott 2012, the unified formula on Stanley & Davies 1995; ages outside 20 to 83 are clipped.
    """
    flux = np.asarray(luminance, dtype=float) * field_area * (1.0 if eyes == 2 else 0.1)
    x = (flux / 846.0) ** 0.41
    stanley_davies = 7.75 - 5.75 * x / (x + 2)
    return stanley_davies + (np.clip(age, 20, 83) - 28.58) * (0.02132 - 0.009562 * stanley_davies)
