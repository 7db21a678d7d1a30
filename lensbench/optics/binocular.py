"""Two lenses before one face: both eyes fixate a point, each through its own lens.

Face frame: axes as in the wear frame, origin midway along the line through both centres of rotation at the nose's
midline (the cyclopean eye), mm; the right eye lies at x = -PD, the left one at x = +PD (each its own monocular distance).
Both centres of rotation are taken to lie in the frontal plane z = 0. Helmholtz angles: elevation of the plane that holds
the line through both eyes, then azimuth within it, so that naked eyes on one point have one elevation.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .conventions import Floats, Status, astigmatism, listing_frame, mean_power
from .distortion import FAR, area_magnification
from .eye import Wearer
from .field import GazeField
from .gaze import look_at, worn_pose
from .lens import Lens
from .object_distance import proximity

_SIDE = {"R": -1.0, "L": 1.0}


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """A right and a left lens and how each eye wears its own."""

    right: Lens
    left: Lens
    right_wearer: Wearer
    left_wearer: Wearer

    def __post_init__(self) -> None:
        if (self.right.side, self.left.side) != ("R", "L"):
            raise ValueError("a pair is a right lens (side R) and a left lens (side L)")

    def eye_position(self, side: str) -> Floats:
        """Centre of rotation (3,) of the eye "R" or "L" in the face frame, mm."""
        wearer = self.right_wearer if side == "R" else self.left_wearer
        return np.array([_SIDE[side] * wearer.wear.pupillary_distance, 0.0, 0.0])

    def points(self, directions: ArrayLike, distance: ArrayLike | str) -> Floats:
        """Points (n, 3), mm, in cyclopean directions (n, 3), unit. distance: mm from the cyclopean eye, a number or (n,);
        inf: far away; "model": the right wearer's object distances by lowering of the direction, see optics.object_distance.
        """
        d = np.asarray(directions, dtype=float)
        if isinstance(distance, str):
            wearer = self.right_wearer
            near = proximity(wearer.wear, -np.arcsin(d[:, 1]))
            with np.errstate(divide="ignore"):
                distance = 1000 / near + wearer.eye.centre_of_rotation
        away = np.minimum(np.asarray(distance, dtype=float), FAR)
        return d * np.broadcast_to(away, len(d))[:, None]


class Balance(NamedTuple):
    """What differs between the eyes at n fixated points; see Fixation.balance. Each (n,)."""

    vertical_imbalance: Floats
    induced_vergence: Floats
    mean_power_difference: Floats
    astigmatic_difference: Floats
    magnification_difference: Floats
    cyclo_difference: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Fixation:
    """Both eyes on the same n points (n, 3), mm, face frame: right and left hold the gaze fields of either eye."""

    pair: Pair
    points: Floats
    right: GazeField
    left: GazeField

    @property
    def status(self) -> NDArray[np.int8]:
        """Status (n,): the right eye's failure, else the left one's."""
        return np.where(self.right.status != Status.OK, self.right.status, self.left.status)

    def vergence(self) -> Floats:
        """Convergence (n,) of the gazes, rad: Helmholtz azimuth of the right less that of the left."""
        return helmholtz_angles(self.right.directions)[0] - helmholtz_angles(self.left.directions)[0]

    def vertical_imbalance(self) -> Floats:
        """Vertical imbalance (n,), cm/m: 100 tan of how much lower the right eye's gaze is than the left one's.

        Positive: more base up before the right eye than before the left.
        """
        lower = helmholtz_angles(self.left.directions)[1] - helmholtz_angles(self.right.directions)[1]
        return 100 * np.tan(lower)

    def induced_vergence(self) -> Floats:
        """Convergence that the lenses add to that of naked eyes (n,), cm/m; positive: as base out does."""
        naked = (helmholtz_angles(self.points - self.pair.eye_position(side))[0] for side in "RL")
        right, left = naked
        return 100 * np.tan(self.vergence() - (right - left))

    def cyclo_difference(self, l2: float = 0.0) -> Floats:
        """Torsion of the right less that of the left eye (n,), rad, about their gazes; positive: excyclo.

        Each eye obeys Listing's law; torsion counts from the plane that holds both eyes and the gaze (Helmholtz). l2: by
        what part of the convergence each eye's plane of rotation vectors turns outward: about 0.25 in near vision, which
        leaves the horizontal meridians in the plane of regard to the second order. Sources: van Rijn & van den Berg 1993;
        Tweed 1997.
        """
        outward = l2 * self.vergence()
        return listing_torsion(self.right.directions, -outward) - listing_torsion(self.left.directions, outward)

    def balance(self, l2: float = 0.0) -> Balance:
        """All differences, right less left: imbalance and vergence (cm/m); mean and astigmatic difference of the power errors
        (as-worn power less the eye's own prescription, at the points; D); magnification of the right over that of the
        left, less 1; torsion (rad)."""
        distances = [
            np.where(field.status == Status.OK, field.distances_to(self.points - position + centre), np.nan)
            for field, position, centre in self._eyes()
        ]
        errors = self.right.power_error(distances[0]) - self.left.power_error(distances[1])
        enlarged = [
            area_magnification(field.magnification(s))
            for field, s in zip((self.right, self.left), distances, strict=True)
        ]
        return Balance(
            self.vertical_imbalance(),
            self.induced_vergence(),
            mean_power(errors),
            astigmatism(errors),
            enlarged[0] / enlarged[1] - 1,
            self.cyclo_difference(l2),
        )

    def lens_points(self) -> tuple[Floats, Floats]:
        """Where the lines of sight leave the front surfaces of the right and of the left lens: (n, 2) each, mm, lens frame."""
        right, left = (
            worn_pose(lens, field.wearer.wear).to_lens(field.origin)[:, :2]
            for lens, field in ((self.pair.right, self.right), (self.pair.left, self.left))
        )
        return right, left

    def _eyes(self) -> list[tuple[GazeField, Floats, Floats]]:
        return [
            (field, self.pair.eye_position(side), field.wearer.centre_of_rotation)
            for side, field in (("R", self.right), ("L", self.left))
        ]


def fixate(pair: Pair, points: ArrayLike) -> Fixation:
    """Turn both eyes to the points (n, 3), mm, face frame, each through its lens; rays within the outlines only."""
    p = np.asarray(points, dtype=float).reshape(-1, 3)
    fields = (
        look_at(lens, wearer, p - pair.eye_position(side) + wearer.centre_of_rotation)
        for lens, wearer, side in ((pair.right, pair.right_wearer, "R"), (pair.left, pair.left_wearer, "L"))
    )
    right, left = (_known(field) for field in fields)
    return Fixation(pair, p, right, left)


def _known(field: GazeField) -> GazeField:
    """The field without the last directions that were tried where no ray meets the point."""
    return replace(field, directions=np.where((field.status == Status.OK)[:, None], field.directions, np.nan))


def helmholtz_angles(directions: ArrayLike) -> tuple[Floats, Floats]:
    """Helmholtz azimuth (towards the wearer's left) and elevation, rad, of vectors (..., 3)."""
    d = np.asarray(directions, dtype=float)
    return np.arctan2(d[..., 0], np.hypot(d[..., 1], d[..., 2])), np.arctan2(d[..., 1], d[..., 2])


def listing_torsion(directions: ArrayLike, plane_turn: ArrayLike = 0.0) -> Floats:
    """Torsion (n,), rad, of an eye that obeys Listing's law, counter-clockwise seen from the front, against Helmholtz.

    directions (n, 3): gaze, unit. plane_turn: azimuth (rad, a number or (n,)) by which the plane of rotation vectors from
    straight ahead is turned; the primary direction turns by twice as much. With plane_turn 0 tan(torsion / 2) =
    tan(azimuth / 2) tan(elevation / 2).
    """
    gaze = np.asarray(directions, dtype=float)
    azimuth, elevation = helmholtz_angles(gaze)
    turn = np.broadcast_to(2 * np.asarray(plane_turn, dtype=float), azimuth.shape)
    primary = listing_frame(np.stack([np.sin(turn), np.zeros_like(turn), np.cos(turn)], axis=-1))
    eye = listing_frame(np.einsum("nij,nj->ni", primary, gaze)) @ primary
    sin, cos = np.sin, np.cos
    level = np.stack([cos(azimuth), -sin(azimuth) * sin(elevation), -sin(azimuth) * cos(elevation)], axis=-1)
    upright = np.stack([np.zeros_like(azimuth), cos(elevation), -sin(elevation)], axis=-1)
    return np.arctan2(np.sum(eye[:, 0] * upright, axis=1), np.sum(eye[:, 0] * level, axis=1))
