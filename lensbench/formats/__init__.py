"""Lens, wearer and surface files to objects and back. One module a format, one table of them (registry).

Errors name the file, the key or line, and the reason.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..optics.surfaces import Surface
from .lens_file import material_named
from .lone_surface import Completion, completed_lenses
from .own_toml import WEARER_FORMAT
from .power_map import PowerMap
from .registry import Contents, Writing, read_file, write_format
from .surface_data import Reading, chosen

__all__ = [
    "Completion",
    "Contents",
    "Reading",
    "Writing",
    "lenses_in",
    "load",
    "load_lens",
    "load_pair",
    "load_power_map",
    "load_surface",
    "load_wearer",
    "read_file",
    "write",
]


def load(path: str | Path) -> Any:
    """What the file holds: a lens, a wearer, a surface as read (SurfaceData) or what else there is; several as a tuple.

    Raises InputError.
    """
    items = read_file(path).items
    return items[0] if len(items) == 1 else items


def load_lens(path: str | Path, side: str = "", material: str = "", told: Completion | None = None) -> Lens:
    """The lens in a file; of a pair the one of a side "R" or "L" (the first, if none is named).

    material: its name, or "n_d/V_d", for files that say nothing of it or to put another in its place. told: what is
    known of a lens of which the file holds surfaces only; the rest is assumed and said in the lens's note. Raises InputError.
    """
    return load_pair(path, side, material, told)[0][0]


def load_pair(
    path: str | Path, side: str = "", material: str = "", told: Completion | None = None
) -> tuple[tuple[Lens, Wearer | None], ...]:
    """The lenses of a file (of one side, if it is named), each with its wearer if the file tells of one; see load_lens."""
    return lenses_in(read_file(path), side, material, told)


def lenses_in(
    contents: Contents, side: str = "", material: str = "", told: Completion | None = None
) -> tuple[tuple[Lens, Wearer | None], ...]:
    """The same of a file that was read."""
    chosen = material_named(material) if material else None
    path, items = contents.path, contents.items
    for item in items:
        if isinstance(item, Lens):
            _needs_no_more(path, told)
            if side not in ("", item.side):
                raise InputError(f"{path}: holds the lens of side {item.side}, not {side}; mirror it to get the other")
            return ((item if chosen is None else replace(item, material=chosen), None),)
        if hasattr(item, "wearer"):
            lie = told.reading if told else Reading()
            _needs_no_more(path, told and replace(told, reading=Reading()))
            sides = (side,) if side else item.sides or ("",)
            return tuple((item.lens(chosen, one, lie), item.wearer(one)) for one in sides)
        if hasattr(item, "lens") and None not in (item.front, item.back):
            _needs_no_more(path, told)
            return ((item.lens(chosen, side), None),)
    held = [item for item in items if hasattr(item, "fitted")]
    if held:
        told = told or Completion()
        told = replace(
            told, reading=replace(told.reading, side=side or told.reading.side), material=chosen or told.material
        )
        return tuple((lens, None) for lens in completed_lenses(path, held, told))
    raise InputError(f"{path}: holds a {type(items[0]).__name__.lower()}, not a lens")


def _needs_no_more(path: Path, told: Completion | None) -> None:
    if told is not None and told != Completion():
        raise InputError(
            f"{path}: holds a whole lens; thickness, radii, diameter, power and orientation are told of lone surface files only"
        )


def load_wearer(path: str | Path, side: str = "") -> Wearer:
    """The wearer in a file; of a pair the one of a side "R" or "L" (the first, if none is named). Raises InputError."""
    items = read_file(path).items
    holder = next((item for item in items if hasattr(item, "wearer")), None)
    if holder is not None:
        found: Wearer = holder.wearer(side)
        return found
    for item in items:
        if isinstance(item, Wearer):
            return item
    raise InputError(f"{path}: holds no wearer; a wearer file begins with format = {WEARER_FORMAT!r}")


def load_power_map(path: str | Path) -> PowerMap:
    """The measured power map in a file. Raises InputError."""
    for item in read_file(path).items:
        if isinstance(item, PowerMap):
            return item
    raise InputError(
        f"{path}: holds no power map; one is a .csv with columns x, y and sphere or mean power, cylinder, axis"
    )


def load_surface(path: str | Path, reading: Reading | None = None) -> Surface:
    """The first surface of a file that fits the reading's side and face, ready to be traced. Raises InputError."""
    reading = reading or Reading()
    items = [item for item in read_file(path).items if hasattr(item, "fitted")]
    return chosen(Path(path), items, reading.side, reading.face).fitted(reading).surface


def write(path: str | Path, *things: Any, writing: Writing | None = None) -> str:
    """Write lenses, surfaces or maps in the format that the file's name says; returns one line that says what was written.

    Raises InputError.
    """
    from ..output import write_file

    path = Path(path)
    content, said = write_format(path).load().write(things, writing or Writing())
    write_file(path, content)
    return f"{path}: {said}"
