"""How far away the things are that an eye looks at: object distance as a function of how far the gaze is lowered.

Distances to objects count from the corneal apex (the wearer's near distance too); those of a gaze field from the front
surface along the outgoing ray. Source of the idea: the object distance models of progressive-lens design, e.g. Essilor's
ergorama; the default's smooth step is our choice.
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator

from .conventions import Floats
from .eye import Wear
from .field import GazeField

NEAR_LOWERING = np.radians(32.0)  # from here downwards the near distance


def proximity(wear: Wear, lowering: ArrayLike) -> Floats:
    """Object proximity (D, from the cornea) at gazes lowered by an angle (rad, any shape; negative: raised).

    Through the wearer's own points (`Wear.object_distances`: lowering in rad and distance in mm, rising in lowering) by
    monotone cubic interpolation of proximity, constant beyond them; without points 0 D above the horizontal, and a smooth
    step 3 u^2 - 2 u^3 down to the proximity of the near distance at NEAR_LOWERING.
    """
    angle = np.asarray(lowering, dtype=float)
    if wear.object_distances:
        at, distance = np.transpose(wear.object_distances)
        return np.asarray(PchipInterpolator(at, 1000 / distance)(np.clip(angle, at[0], at[-1])))
    u = np.clip(angle / NEAR_LOWERING, 0.0, 1.0)
    return 1000 / wear.near_distance * u * u * (3 - 2 * u)


def model_distance(field: GazeField) -> Floats:
    """Distance (n,) along each outgoing ray, mm, to the object that the wearer's model puts there; inf: far away."""
    near = proximity(field.wearer.wear, -np.arcsin(field.directions[:, 1]))
    with np.errstate(divide="ignore"):
        return from_cornea(field, 1000 / near)


def from_cornea(field: GazeField, distance: ArrayLike) -> Floats:
    """Distance (n,) along each outgoing ray to the point that is `distance` mm (a number or (n,)) from the corneal apex."""
    away = np.asarray(distance, dtype=float)
    origin = field.origin + np.array([0.0, 0.0, field.wearer.wear.vertex_distance])
    along = np.einsum("nj,nj->n", origin, field.direction)
    return np.sqrt(along**2 + away**2 - np.sum(origin**2, axis=1)) - along
