"""How a file's order of points lies on the lens: eight orientations, and the side to which z counts positive."""

from typing import Literal, NamedTuple, get_args

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats

Corner = Literal["top-left", "top-right", "bottom-left", "bottom-right"]
Rows = Literal["horizontal", "vertical"]
Towards = Literal["eye", "scene"]


class Orientation(NamedTuple):
    """first_point: corner of a grid's first value, seen from in front of the wearer; rows: how its values run from there.

    z_towards: the side to which the file counts positive. Points with x and y of their own are taken as a grid whose first
    point has the least x and the greatest y, and whose rows run along x: "top-left" and "horizontal" leave them as they are.
    """

    first_point: Corner = "top-left"
    rows: Rows = "horizontal"
    z_towards: Towards = "eye"

    @property
    def name(self) -> str:
        """The order of the points in one word, as --orientation takes it: top-left-rows."""
        return f"{self.first_point}-{'rows' if self.rows == 'horizontal' else 'columns'}"

    @property
    def sign(self) -> float:
        """+1 where the file counts z as a Surface does (towards the scene), else -1."""
        return 1.0 if self.z_towards == "scene" else -1.0

    def matrix(self) -> Floats:
        """(2, 2): x, y on the lens of steps along the file's columns and along its rows."""
        vertical, horizontal = self.first_point.split("-")
        right, up = (1.0 if horizontal == "left" else -1.0), (-1.0 if vertical == "top" else 1.0)
        return np.array([[right, 0.0], [0.0, up]] if self.rows == "horizontal" else [[0.0, right], [up, 0.0]])

    def to_lens(self, values: Floats) -> Floats:
        """A grid in the file's order (or its last two axes) as rows of rising y and columns of rising x."""
        vertical, horizontal = self.first_point.split("-")
        z = values if self.rows == "horizontal" else np.swapaxes(values, -1, -2)
        z = z[..., ::-1, :] if vertical == "top" else z
        return z[..., ::-1] if horizontal == "right" else z

    def to_file(self, values: Floats) -> Floats:
        """The inverse of `to_lens`."""
        vertical, horizontal = self.first_point.split("-")
        z = values[..., ::-1, :] if vertical == "top" else values
        z = z[..., ::-1] if horizontal == "right" else z
        return z if self.rows == "horizontal" else np.swapaxes(z, -1, -2)


ALL = tuple(Orientation(corner, rows) for corner in get_args(Corner) for rows in get_args(Rows))
NAMES = tuple(o.name for o in ALL)


def named(name: str) -> Orientation:
    """The orientation of a name like top-left-rows. Raises InputError."""
    if name not in NAMES:
        raise InputError(f"{name!r} is no orientation; there are {', '.join(NAMES)}")
    return ALL[NAMES.index(name)]
