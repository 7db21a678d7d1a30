"""What every reader of surfaces hands over: one surface of a file, before it is known how it lies in a lens."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from ..errors import InputError
from ..optics.surfaces import Surface
from .orientation import Corner, Rows, Towards


@dataclass(frozen=True, slots=True)
class Reading:
    """What is known beside the file of how a surface is meant; None: to be found from its shape.

    side "R" | "L" | "", face "F" | "B" | "" of the lens it is for; index: of the lens, for powers in D; flip_z turns the sign
    that was found or stated; pose: decentration, tilt (see Surface).
    """

    side: str = ""
    face: str = ""
    index: float = 1.6
    first_point: Corner | None = None
    rows: Rows | None = None
    z_towards: Towards | None = None
    flip_z: bool = False
    pose: dict[str, Any] = field(default_factory=dict)


class Fitted(NamedTuple):
    """A surface ready to be traced (its note says in one line how it was understood), and what there is to say of the fit.

    facts: label, text with units, and the JSON-ready value behind it. reach: radius about the origin, mm, within which there
    are points.
    """

    surface: Surface
    facts: tuple[tuple[str, str, object], ...]
    reach: float = float("inf")


class SurfaceData(Protocol):
    """One surface of a file. source: the file's name; side "R" | "L" | "", face "F" | "B" | "": as the file says."""

    @property
    def source(self) -> str: ...

    @property
    def side(self) -> str: ...

    @property
    def face(self) -> str: ...

    def fitted(self, reading: Reading) -> Fitted:
        """The smooth surface. Raises InputError where it cannot be told how the surface lies."""


def chosen(path: Path, surfaces: Sequence[SurfaceData], side: str, face: str) -> SurfaceData:
    """The first surface of a file that may be of this side and face ("" matches any). Raises InputError."""
    for surface in surfaces:
        if {surface.side, side} != {"R", "L"} and {surface.face, face} != {"F", "B"}:
            return surface
    held = ", ".join(f"side {s.side or '?'} face {s.face or '?'}" for s in surfaces) or "no surface"
    raise InputError(f"{path}: holds {held}; wanted is side {side or 'any'} face {face or 'any'}")
