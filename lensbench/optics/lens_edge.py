"""The lens's edge as the turning eye sees it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .conventions import Floats, ReadOnlyArrays, Status, listing_frame, unit
from .eye import Wearer
from .gaze import look_at, worn_pose
from .lens import Lens

EDGE_STEPS = 1024


@dataclass(frozen=True, slots=True, eq=False)
class LensEdge(ReadOnlyArrays):
    """The lens's edge as the eye sees it: a closed curve about an axis, within which the lens is seen.

    frame (3, 3), wear frame: rows across (two) and along the axis. radius (n,): tangent of the angle between the axis and
    the edge, at n equal steps of the angle about the axis, counted from row 0 towards row 1.
    """

    frame: Floats
    radius: Floats

    def directions(self, factor: float = 1.0) -> Floats:
        """Directions (n, 3) to the edge, wear frame, not normalised. factor: on the tangents about the axis."""
        angle = 2 * np.pi * np.arange(self.radius.size) / self.radius.size
        across = factor * self.radius * np.stack([np.cos(angle), np.sin(angle)])
        return np.column_stack([*across, np.ones(self.radius.size)]) @ self.frame

    def bounds(self, sides: int) -> tuple[Floats, Floats]:
        """Inward normals (sides, 3), wear frame, of two cones with flat sides: one about the edge, one within it.

        What lies within the edge lies on the inner side of all of the first; what does so of all of the second lies within.
        """
        angle = 2 * np.pi * np.arange(sides) / sides
        turn = 2 * np.pi * np.arange(self.radius.size)[:, None] / self.radius.size
        across = np.cos(turn - angle)
        reach = np.max(self.radius[:, None] * across, axis=0)
        inner = reach * np.min(self.radius * np.max(across / reach, axis=1))
        normals = -np.stack([np.cos(angle), np.sin(angle)], axis=1)
        about, within = (np.column_stack([normals, r]) @ self.frame for r in (1.001 * reach, 0.999 * inner))
        return about, within

    def within(self, directions: Floats, factor: float = 1.0) -> NDArray[np.bool_]:
        """Whether directions (..., 3), wear frame, point inside the edge. factor: as in `directions`."""
        x, y, z = np.moveaxis(directions @ self.frame.T, -1, 0)
        turn = np.arctan2(y, x) % (2 * np.pi) * self.radius.size / (2 * np.pi)
        limit = np.interp(turn, np.arange(self.radius.size + 1), np.append(self.radius, self.radius[0]))
        return (z > 0) & (np.hypot(x, y) < factor * limit * z)


def lens_edge(lens: Lens, wearer: Wearer) -> LensEdge:
    """The edges of the back and of the front surface as the turning eye sees them: whichever is the nearer to the axis.

    The axis points to the middle of the back surface's edge, about which both edges are taken to be star-shaped.
    """
    x, y = lens.outline.points()
    pose = worn_pose(lens, wearer.wear)
    back = pose.to_wear(np.stack([x, y, lens.back_height(x, y)], axis=-1))
    front = pose.to_wear(np.stack([x, y, lens.front_height(x, y)], axis=-1))
    through = look_at(lens, wearer, _finite(front), within_outline=False)
    curves = (
        unit(_finite(back) - wearer.centre_of_rotation),
        through.directions[through.status == Status.OK],
    )
    middle = next((curve for curve in curves if len(curve) > 2), None)
    if middle is None:
        raise InputError("the lens's edge cannot be seen: its surfaces do not reach its outline")
    frame = listing_frame(unit(middle.mean(axis=0)))
    radii = [_radius(curve @ frame.T) for curve in curves if len(curve) > 2]
    return LensEdge(frame, np.min(radii, axis=0))


def _finite(rows: Floats) -> Floats:
    return rows[np.isfinite(rows).all(axis=1)]


def _radius(local: Floats) -> Floats:
    """Tangents (EDGE_STEPS,) of the angles to the axis of a closed curve of directions (k, 3), the axis along z."""
    ahead = local[local[:, 2] > 0.05]
    turn = np.arctan2(ahead[:, 1], ahead[:, 0])
    steps = 2 * np.pi * np.arange(EDGE_STEPS) / EDGE_STEPS
    order = np.argsort(turn)
    return np.interp(steps, turn[order], np.hypot(ahead[:, 0], ahead[:, 1])[order] / ahead[order, 2], period=2 * np.pi)
