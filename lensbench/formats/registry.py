"""The table of file formats, and which of them a file is in: by its content first, by its extension second.

A format's module lensbench/formats/<module>.py holds, as far as the table says so:
    sniff(head, text) -> float    certainty, 0 to 1, that a file is in the format, from its first bytes and, if they are text,
                                  their text ("" otherwise)
    read(path) -> Sequence        everything that the file holds; raises InputError
    write(things, writing) -> Written
"""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from ..errors import InputError
from .orientation import Orientation
from .text import decoded, read_bytes

HEAD = 4096


class Format(NamedTuple):
    """One format: name as in messages, what it is, its extensions, its module, and whether it can be read and written.

    whole: it is written of whole lenses only.
    """

    name: str
    title: str
    extensions: tuple[str, ...]
    module: str
    reads: bool = True
    writes: bool = False
    whole: bool = False

    def load(self) -> Any:
        """The module with sniff, read and write."""
        return import_module(f".{self.module}", __package__)


class Contents(NamedTuple):
    """What a file holds: lenses, wearers, surfaces (SurfaceData) or whatever else its format has."""

    path: Path
    format: Format
    items: tuple[Any, ...]


class Writing(NamedTuple):
    """What the user fixes of a file to be written. pitch, size (width, height): mm; side, face: "" for all that there are."""

    pitch: float | None = None
    size: tuple[float, float] | None = None
    orientation: Orientation = Orientation()
    decimals: int = 6
    side: str = ""
    face: str = ""


class Written(NamedTuple):
    """A file's content and one line that says what was written: orientation, sign, pitch, units."""

    content: bytes | str
    said: str


FORMATS = (
    Format("TOML", "lens and wearer files of LensBench", (".toml",), "own_toml", writes=True, whole=True),
    Format("SDF", "surface matrix of the VCA/OMA standard", (".sdf",), "sdf", writes=True),
    Format("HMF", "height map", (".hmf",), "hmf", writes=True),
    Format("Zemax grid", "grid sag of Zemax", (".dat", ".grd"), "zemax_grid", writes=True),
    Format("Code V INT", "interferogram file of Code V with a surface", (".int",), "codev_int"),
    Format(
        "points", "x y z in mm, a point a line", (".xyz", ".txt", ".csv", ".asc", ".pts"), "point_list", writes=True
    ),
    Format(
        "VCA job", "order, frame and lens of the VCA/OMA standard", (".lms", ".lds", ".oma", ".vca", ".job"), "vca_job"
    ),
    Format("ZMX", "sequential file of Zemax", (".zmx",), "zmx"),
    Format("STEP", "CAD solid", (".step", ".stp"), "cad", writes=True, whole=True),
    Format("IGES", "CAD surfaces", (".igs", ".iges"), "cad"),
    Format("STL", "mesh of triangles", (".stl",), "mesh", writes=True, whole=True),
    Format("mesh", "OBJ and PLY", (".obj", ".ply"), "mesh"),
    Format("JSON", "B-spline surface of LensBench", (".json",), "bspline_file", writes=True),
    Format("power map", "CSV of a lens mapper", (".csv",), "power_map"),
    Format("VTK", "polygons with powers, for VTK programs", (".vtp",), "vtp", reads=False, writes=True, whole=True),
)


def read_file(path: str | Path) -> Contents:
    """Everything in a file of any format that is read. Raises InputError."""
    path = Path(path)
    found = format_of(path, read_bytes(path, HEAD))
    return Contents(path, found, tuple(found.load().read(path)))


def format_of(path: Path, head: bytes) -> Format:
    """The format that recognises the file's first bytes best; in a tie, or if none does, the one of its extension."""
    text = decoded(head) or ""
    suffix = path.suffix.lower()
    readable = [f for f in FORMATS if f.reads]
    scores = [(f.load().sniff(head, text), suffix in f.extensions) for f in readable]
    best = max(range(len(readable)), key=lambda k: scores[k])
    if not any(scores[best]):
        kind = path.suffix or "a file without extension"
        raise InputError(f"{path}: {kind} is not read, and its content is none of {_names(readable)}")
    return readable[best]


def write_format(path: Path) -> Format:
    """The format in which a file of this name is written. Raises InputError."""
    writable = [f for f in FORMATS if f.writes]
    for entry in writable:
        if path.suffix.lower() in entry.extensions:
            return entry
    kind = path.suffix or "a file without extension"
    raise InputError(f"{path}: cannot write {kind}; there are {_names(writable)}")


def _names(formats: Sequence[Format]) -> str:
    return ", ".join(f"{f.name} ({' '.join(f.extensions)})" for f in formats)
