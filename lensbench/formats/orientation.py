"""How a file's order of points lies on the lens: eight orientations, and the side to which z counts positive."""

from typing import Literal, NamedTuple, get_args

Corner = Literal["top-left", "top-right", "bottom-left", "bottom-right"]
Rows = Literal["horizontal", "vertical"]
Towards = Literal["eye", "scene"]

NAMES = tuple(f"{corner}-{rows}" for corner in get_args(Corner) for rows in ("rows", "columns"))


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
