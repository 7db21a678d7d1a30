"""The code's one page of truth: frames, signs, units, power matrices and ray status.

Lens and wear frame: right-handed, +z straight ahead (eye to scene), +y up, +x to the wearer's left, so that somebody
facing the wearer sees x to the right and a TABO axis (ISO 8429) is atan2(y, x) mod 180 degrees for either eye.
Nasal is +x for a right lens and -x for a left lens. Lengths in mm and angles in rad inside; dioptres where a name says
so; degrees only in files, on the command line and in the window.

Wear frame: its origin lies on the line of sight straight ahead, one vertex distance before the cornea.
A depth counts straight ahead from the corneal apex of the eye looking straight ahead; a distance along a ray from the
front surface (naked eye: from the pupil's centre).
Lens frame: its origin is the back vertex. Surface frame: its origin is that surface's vertex.

Power and vergence: symmetric 2x2 matrices in dioptres, [[m + j0, j45], [j45, m - j0]]; cylinders are printed as minus
cylinders with 0 < axis <= 180 degrees. Myopia is a negative refraction.

Frame across a ray: the world x and y carried by the minimal (Listing) rotation of +z onto the ray.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

VERSION = "lensbench-conventions/1"

Floats = NDArray[np.float64]


class Status(IntEnum):
    """What became of a ray; every array that travels with a status holds NaN where it is not OK."""

    OK = 0
    MISSED_BACK = 1
    MISSED_FRONT = 2
    OUTSIDE_OUTLINE = 3
    NOT_CONVERGED = 4
    TOTAL_INTERNAL_REFLECTION = 5
    BUNDLE_CUT = 6  # in maps by real rays: the chief ray passes, but not the whole bundle through the pupil
    NO_VALUE = 7  # in maps: the ray passes, but the quantity has no value there


class SphereCylinderAxis(NamedTuple):
    """A power as printed: sphere (D), minus cylinder (D, <= 0), axis (degrees TABO, 0 < axis <= 180); any shape."""

    sphere: Floats
    cylinder: Floats
    axis: Floats


def listing_frame(direction: ArrayLike) -> Floats:
    """Frame across each ray: rows e1, e2, d, the world axes carried by the minimal rotation of +z onto d.

    direction: (..., 3) unit vectors, not -z. Returns (..., 3, 3) orthonormal, right-handed.
    """
    d = np.asarray(direction, dtype=float)
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    k = 1.0 / (1.0 + z)
    rows = [1 - x * x * k, -x * y * k, -x, -x * y * k, 1 - y * y * k, -y, x, y, z]
    return np.stack(rows, axis=-1).reshape(*d.shape[:-1], 3, 3)


def unit(vectors: ArrayLike) -> Floats:
    """The vectors (..., 3) scaled to length 1. Raises ValueError for a vector of length zero."""
    v = np.asarray(vectors, dtype=float)
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    if np.any(length == 0):
        raise ValueError("a vector of length zero has no direction")
    return v / length


def rotation_xy(about_x: float, about_y: float) -> Floats:
    """Rotation R_y(about_y) R_x(about_x), rad, right-handed; acts on column vectors."""
    cx, sx, cy, sy = np.cos(about_x), np.sin(about_x), np.cos(about_y), np.sin(about_y)
    r_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    r_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    return r_y @ r_x


def power_matrix(sphere: ArrayLike, cylinder: ArrayLike = 0.0, axis: ArrayLike = 0.0) -> Floats:
    """Power matrix (..., 2, 2) in D of sphere (D), cylinder (D) and axis (degrees TABO). Source: Long 1976."""
    s, c, a = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (sphere, cylinder, axis)))
    m, j0, j45 = s + c / 2, -c / 2 * np.cos(2 * np.radians(a)), -c / 2 * np.sin(2 * np.radians(a))
    return np.stack([m + j0, j45, j45, m - j0], axis=-1).reshape(*s.shape, 2, 2)


def power_vector(matrix: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Power vector (m, j0, j45) in D of power matrices (..., 2, 2). Source: Thibos, Wheeler & Horner 1997."""
    f = np.asarray(matrix, dtype=float)
    return (f[..., 0, 0] + f[..., 1, 1]) / 2, (f[..., 0, 0] - f[..., 1, 1]) / 2, (f[..., 0, 1] + f[..., 1, 0]) / 2


def mean_power(matrix: ArrayLike) -> Floats:
    """Mean power (spherical equivalent), D, of power matrices (..., 2, 2)."""
    return power_vector(matrix)[0]


def astigmatism(matrix: ArrayLike) -> Floats:
    """Astigmatism (magnitude of the cylinder, >= 0), D, of power matrices (..., 2, 2)."""
    _, j0, j45 = power_vector(matrix)
    return 2 * np.hypot(j0, j45)


def sphere_cylinder_axis(matrix: ArrayLike) -> SphereCylinderAxis:
    """Power matrices (..., 2, 2) in D as printed: sphere, minus cylinder, axis (180 where there is no cylinder)."""
    m, j0, j45 = power_vector(matrix)
    cylinder = -2 * np.hypot(j0, j45)
    axis = np.degrees(np.arctan2(j45, j0)) / 2 % 180
    return SphereCylinderAxis(m - cylinder / 2, cylinder, np.where(axis == 0, 180.0, axis))


def inverse_2x2(m: ArrayLike) -> Floats:
    """Inverse of matrices (..., 2, 2); singular ones give inf or NaN, not an error."""
    m = np.asarray(m, dtype=float)
    a, b, c, d = m[..., 0, 0], m[..., 0, 1], m[..., 1, 0], m[..., 1, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        adjugate = np.stack([d, -b, -c, a], axis=-1) / (a * d - b * c)[..., None]
    return adjugate.reshape(m.shape)


def carry_vergence(vergence: ArrayLike, distance: ArrayLike) -> Floats:
    """Vergence V (..., 2, 2) in D after the light has gone `distance` mm in air: V (I - d V)^-1.

    In the same way a prescription at the spectacle plane is carried to the eye (distance > 0: towards the eye).
    """
    v = np.asarray(vergence, dtype=float)
    d = np.asarray(distance, dtype=float)[..., None, None] / 1000.0
    return v @ inverse_2x2(np.eye(2) - d * v)


class ReadOnlyArrays:
    """Base of the frozen types: nobody can write to their arrays through them."""

    __slots__ = ()

    def __post_init__(self) -> None:
        for name in self.__dataclass_fields__:  # type: ignore[attr-defined]
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                view = value.view()
                view.flags.writeable = False
                object.__setattr__(self, name, view)
