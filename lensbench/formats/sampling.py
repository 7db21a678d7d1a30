"""Surfaces sampled on regular grids, in the order and sign in which a file is to hold them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats
from ..optics.lens import Lens, surface_height
from ..optics.surfaces import Surface
from .orientation import Orientation
from .registry import Writing
from .surface_data import Reading

DEFAULT_PITCH = 1.0
MOST_SIDE = 2001


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """A grid to be written: values (rows, columns) in the file's order and sign, mm, NaN where there is no surface.

    x (nx,), y (ny,): rising, mm, in the lens frame; z (ny, nx): mm, +z to the scene; width, height: along columns, rows.
    slopes (3, ny, nx): along x, along y, and the mixed second derivative (1/mm), in the lens frame.
    """

    name: str
    side: str
    face: str
    x: Floats
    y: Floats
    z: Floats
    orientation: Orientation
    slopes: Floats

    @property
    def values(self) -> Floats:
        """The sags in the file's order and sign, mm."""
        return self.orientation.sign * self.orientation.to_file(self.z)

    @property
    def width(self) -> float:
        """Extent along the file's columns, mm."""
        return float(np.ptp(self.x if self.orientation.rows == "horizontal" else self.y))

    @property
    def height(self) -> float:
        """Extent along the file's rows, mm."""
        return float(np.ptp(self.y if self.orientation.rows == "horizontal" else self.x))

    def text(self, decimals: int, missing: str) -> list[list[str]]:
        """The values as text, row by row; `missing` where there is none."""
        return [[missing if np.isnan(v) else f"{v:.{decimals}f}" for v in row] for row in self.values]

    def describe(self) -> str:
        """One line: what was written and how."""
        o = self.orientation
        face = {"F": "front ", "B": "back ", "": ""}[self.face]
        pitch = np.ptp(self.x) / (self.x.size - 1), np.ptp(self.y) / (self.y.size - 1)
        empty = int(np.count_nonzero(np.isnan(self.z)))
        return (
            f"{self.side or ''} {face}surface, {self.x.size} x {self.y.size} points, pitch {pitch[0]:g} x {pitch[1]:g} mm, "
            f"first point {o.first_point}, rows {o.rows}, z positive towards the {o.z_towards}"
            + (f", {empty} points without surface" if empty else "")
        ).strip()


def sampled(things: Sequence[Any], writing: Writing) -> list[Sampled]:
    """Grids of every surface among the things that the writing asks for. Raises InputError where there is none."""
    found = [grid for thing in things for grid in _grids(thing, writing)]
    if not found:
        wanted = f"side {writing.side or 'any'}, face {writing.face or 'any'}"
        raise InputError(f"there is no surface of {wanted} to be written")
    return found


def one_grid(things: Sequence[Any], writing: Writing) -> Sampled:
    """The only surface that the writing asks for. Raises InputError where there are several."""
    found = sampled(things, writing)
    if len(found) > 1:
        held = ", ".join(f"{g.side or '?'} {g.face or '?'}" for g in found)
        raise InputError(
            f"this format holds one surface, and there are {held}: say --face front or back, or --side R or L"
        )
    return found[0]


def _grids(thing: Any, writing: Writing) -> list[Sampled]:
    if isinstance(thing, Lens):
        if writing.side and thing.side != writing.side:
            return []
        width, height = _size_of(thing)
        faces = [("F", thing.front), ("B", thing.back)]
        return [
            _sample(s, thing.name, thing.side, f, writing, (width, height)) for f, s in faces if writing.face in ("", f)
        ]
    if isinstance(thing, Surface):
        return [_sample(thing, "", writing.side, writing.face, writing, _domain(thing))]
    if hasattr(thing, "fitted"):
        if {thing.side, writing.side} == {"R", "L"} or {thing.face, writing.face} == {"F", "B"}:
            return []
        side, face = thing.side or writing.side, thing.face or writing.face
        surface = thing.fitted(Reading(side, face)).surface
        return [_sample(surface, thing.source, side, face, writing, _domain(surface))]
    raise InputError(f"a {type(thing).__name__.lower()} has no surface to be written")


def _size_of(lens: Lens) -> tuple[float, float]:
    x0, x1, y0, y1 = lens.outline.box
    return 2 * max(abs(x0), abs(x1)), 2 * max(abs(y0), abs(y1))


def _domain(surface: Surface) -> tuple[float, float]:
    """Width and height about (0, 0) over which a spline is defined; 60 mm for surfaces without limits."""
    if surface.breaks_x.size == 2 and not surface.breaks_x.any():
        return 60.0, 60.0
    x, y = surface.breaks_x, surface.breaks_y
    return 2 * min(-float(x[0]), float(x[-1])), 2 * min(-float(y[0]), float(y[-1]))


def _sample(surface: Surface, name: str, side: str, face: str, writing: Writing, size: tuple[float, float]) -> Sampled:
    pitch = writing.pitch or DEFAULT_PITCH
    axes: list[Floats] = []
    for length in writing.size or size:
        half = int(length / 2 / pitch + 1e-6)
        if not 2 <= half <= (MOST_SIDE - 1) // 2:
            raise InputError(
                f"{length:g} mm at a pitch of {pitch:g} mm: a grid has from 5 to {MOST_SIDE} points a side"
            )
        axes.append(pitch * np.arange(-half, half + 1.0))
    x, y = axes
    z, slopes = _heights(surface, *np.meshgrid(x, y))
    return Sampled(name, side, face, x, y, z, writing.orientation, slopes)


def _heights(surface: Surface, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """z (mm) over the vertex plane and its slopes (3, ...): exact for a surface without tilt, else by central differences."""
    if not any(surface.tilt):
        f, fx, fy, _, fxy, _ = surface.derivatives(x - surface.decentration[0], y - surface.decentration[1])
        return f, np.array([fx, fy, fxy])
    h = 1e-3
    east, west, north, south = (
        surface_height(surface, x + a * h, y + b * h) for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))
    )
    corners = [surface_height(surface, x + a * h, y + b * h) * a * b for a in (1, -1) for b in (1, -1)]
    mixed = sum(corners) / (4 * h * h)
    return surface_height(surface, x, y), np.array([(east - west) / (2 * h), (north - south) / (2 * h), mixed])
