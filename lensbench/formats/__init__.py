"""Lens, wearer and surface files to objects. One module a format; errors name the file, the key or line, and the reason."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..optics.eye import Wearer
from ..optics.lens import Lens
from .lens_file import build_lens, read_grids
from .point_grid import PointGrid
from .toml_file import read_toml
from .wearer_file import build_wearer

LENS_FORMAT, WEARER_FORMAT = "lensbench-lens/1", "lensbench-wearer/1"

READERS: dict[str, Callable[[Path, dict[str, Any]], Lens | Wearer]] = {
    LENS_FORMAT: build_lens,
    WEARER_FORMAT: build_wearer,
}


def load(path: str | Path) -> Lens | Wearer | PointGrid:
    """Whatever the file holds: a lens, a wearer, or the point grid of one surface. Raises InputError."""
    path = Path(path)
    if path.suffix.lower() != ".toml":
        return load_surface(path)
    data = read_toml(path)
    reader = READERS.get(str(data.get("format")))
    if reader is None:
        raise InputError(f"{path}: format: {data.get('format')!r} is not known; write one of {', '.join(READERS)}")
    return reader(path, data)


def load_lens(path: str | Path) -> Lens:
    """The lens in a lens file (TOML, format "lensbench-lens/1"). Raises InputError."""
    found = load(path)
    if isinstance(found, Lens):
        return found
    if isinstance(found, PointGrid):
        raise InputError(
            f'{path}: holds one surface ({found.side} {found.face}); name it in a lens file: [front] type = "grid", '
            f'file = "{Path(path).name}"'
        )
    raise InputError(f"{path}: holds a wearer, not a lens")


def load_wearer(path: str | Path) -> Wearer:
    """The wearer in a wearer file (TOML, format "lensbench-wearer/1"). Raises InputError."""
    found = load(path)
    if not isinstance(found, Wearer):
        raise InputError(f"{path}: holds no wearer; a wearer file begins with format = {WEARER_FORMAT!r}")
    return found


def load_surface(path: str | Path) -> PointGrid:
    """The first point grid of a surface file (SDF). Raises InputError."""
    return read_grids(Path(path))[0]
