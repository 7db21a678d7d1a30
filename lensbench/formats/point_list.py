"""Point lists (.xyz, .csv, .txt, .asc, .pts): x y z a line, in mm, separated by spaces, tabs, semicolons or commas.

A header may name the columns (x, y, z or sag, in any order; mm, cm, m or um in brackets); further columns are left out.
"#", "!", "%" and "//" start comments. Points on a regular grid become one, gaps included; others are scattered points.
x is taken to run to the right and y upwards, seen from in front of the wearer, unless the shape or an option says otherwise.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats
from .orientation import Orientation
from .point_grid import PointCloud, PointGrid, grid_of
from .registry import Writing, Written
from .sampling import one_grid
from .text import MOST_POINTS, MOST_SAG, UNKNOWN, digit_of, number, read_text, shown, side_in_name

COMMENTS = ("#", "!", "%", "//")
UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 0.001, "µm": 0.001, "micron": 0.001, "in": 25.4, "inch": 25.4}
NAMES = {"x": ("x",), "y": ("y",), "z": ("z", "sag", "height", "sagitta", "elevation")}


class _Layout(NamedTuple):
    """separator (None: any blanks); places of x, y, z among a line's fields, and their units in mm; fields a line has."""

    separator: str | None
    places: tuple[int, int, int]
    units: tuple[float, float, float]
    fields: int


def sniff(head: bytes, text: str) -> float:
    """Likely where three numbers or more stand in each of the first lines."""
    lines = [line for line in text.split("\n")[:-1] if line.strip() and not line.strip().startswith(COMMENTS)][:12]
    if len(lines) < 4:
        return 0.0
    numeric = [_numbers(line) for line in lines]
    if _header_names(lines[0]) and all(n >= 3 for n in numeric[1:]):
        return 0.8
    return 0.3 if all(n >= 3 and n == numeric[-1] for n in numeric[1:]) and numeric[-1] <= 8 else 0.0


def _numbers(line: str) -> int:
    """How many numbers a line consists of; 0 if it holds anything else."""
    fields = [f for f in re.split(r"[\s;,]+", line.strip()) if f]
    return len(fields) if all(re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|\?", f) for f in fields) else 0


def _header_names(line: str) -> dict[str, int]:
    """Where x, y and z stand in a header line; empty if it names them not all."""
    names = [_name(f) for f in _split(line, _separator(line))]
    found = {key: next((k for k, n in enumerate(names) if n in known), -1) for key, known in NAMES.items()}
    return found if min(found.values()) >= 0 else {}


def _name(field: str) -> str:
    return re.split(r"[\s(\[_/]", field.strip().strip('"').lower())[0]


def _unit(field: str) -> float:
    unit = re.search(r"[\s(\[_/]([a-zµ]+)[)\]]?\s*\"?$", field.strip().lower())
    return UNITS.get(unit[1], 1.0) if unit else 1.0


def _separator(line: str) -> str | None:
    return next((s for s in (";", "\t", ",") if s in line.strip()), None)


def _split(line: str, separator: str | None) -> list[str]:
    return [f.strip() for f in line.strip().split(separator)]


def read(path: Path) -> list[PointGrid | PointCloud]:
    """The points of a list. Raises InputError with the line of what is wrong."""
    lines = [(k, line.strip()) for k, line in enumerate(read_text(path).split("\n"), start=1)]
    lines = [(k, line) for k, line in lines if line and not line.startswith(COMMENTS)]
    if not lines:
        raise InputError(f"{path}: is empty; a point list has lines of x y z in mm")
    layout, data = _layout(path, lines)
    if len(data) > MOST_POINTS:
        raise InputError(f"{path}: {len(data)} points; at most {MOST_POINTS} are read")
    points = _quickly(data, layout)
    if points is None:
        points = np.array([_point(path, k, line, layout) for k, line in data]).reshape(-1, 3)
    x, y, z = points.T * np.array(layout.units)[:, None]
    sample = [_split(line, layout.separator)[layout.places[2]] for _, line in data[:: max(1, len(data) // 400)]]
    return [_points(path, x, y, z, digit_of(sample) * layout.units[2])]


def _points(path: Path, x: Floats, y: Floats, z: Floats, digit: float) -> PointGrid | PointCloud:
    side = side_in_name(path)
    remark = f"side {side} from the file's name" if side else ""
    found = grid_of(x, y, z)
    if found is None:
        known = np.isfinite(z)
        return PointCloud(path.name, x[known], y[known], z[known], digit, side, "", Orientation(), remark)
    values, (x0, x1, y0, y1) = found
    centre = -(x0 + x1) / 2, (y0 + y1) / 2
    return PointGrid(path.name, values, x1 - x0, y1 - y0, digit, side, "", Orientation(), centre, remark)


def _layout(path: Path, lines: list[tuple[int, str]]) -> tuple[_Layout, list[tuple[int, str]]]:
    """How the lines are to be read, and the lines that hold points."""
    first = lines[0][1]
    separator = _separator(lines[-1][1] if len(lines) > 1 else first)
    count = len(_split(lines[-1][1], separator))
    header = _header_names(first)
    if header:
        fields = _split(first, _separator(first))
        places = header["x"], header["y"], header["z"]
        return _Layout(separator, places, tuple(_unit(fields[p]) for p in places), max(count, 3)), lines[1:]  # type: ignore[arg-type]
    if re.search(r"[a-z]{2}|^[xyz]\b", re.sub(r"\b(nan|inf)\b", "", first.lower())):
        raise InputError(f"{path}, line {lines[0][0]}: the header {shown(first)} does not name x, y and z (or sag)")
    if count < 3:
        hint = "; write decimal points, not commas" if re.search(r"\d,\d", lines[-1][1]) else ""
        raise InputError(f"{path}, line {lines[-1][0]}: {count} values; a point needs x y z{hint}")
    return _Layout(separator, (0, 1, 2), (1.0, 1.0, 1.0), count), lines


def _quickly(data: list[tuple[int, str]], layout: _Layout) -> Floats | None:
    """All points at once, if nothing is unusual in any line."""
    joined = (layout.separator or " ").join(line for _, line in data)
    try:
        values = np.array(joined.split(layout.separator), dtype=float)
    except ValueError:
        return None
    if values.size != len(data) * layout.fields or not np.all(np.abs(values) <= MOST_SAG) or "_" in joined:
        return None
    if any(len(line.split(layout.separator)) != layout.fields for _, line in data):
        return None
    return values.reshape(-1, layout.fields)[:, list(layout.places)]


def _point(path: Path, line: int, text: str, layout: _Layout) -> list[float]:
    fields = _split(text, layout.separator)
    if len(fields) != layout.fields and not (len(fields) == layout.fields + 1 and not fields[-1]):
        wrong = "" if _separator(text) == layout.separator else "; its separator is not that of the other lines"
        raise InputError(f"{path}, line {line}: {len(fields)} values where the other lines have {layout.fields}{wrong}")
    point = []
    for name, place, unit in zip("xyz", layout.places, layout.units, strict=True):
        where = f"{path}, line {line}, {name}"
        if name == "z" and fields[place] in UNKNOWN:
            point.append(float("nan"))
            continue
        value = number(where, fields[place])
        if abs(value * unit) > MOST_SAG:
            raise InputError(f"{where}: {shown(fields[place])} is no length on a lens in mm")
        point.append(value)
    return point


def write(things: Sequence[Any], writing: Writing) -> Written:
    """One surface as x y z; points without surface are left out. x to the right, y up, seen from in front of the wearer."""
    grid = one_grid(things, writing)
    x, y = np.meshgrid(grid.x, grid.y)
    o, d = grid.orientation, writing.decimals
    order = [o.to_file(a).ravel() for a in (x, y)]
    lines = [
        f"{px:.6g} {py:.6g} {pz:.{d}f}"
        for px, py, pz in zip(*order, grid.values.ravel(), strict=True)
        if not np.isnan(pz)
    ]
    said = f"{grid.describe()}; x to the right and y up, seen from in front of the wearer"
    return Written("\n".join(lines) + "\n", said)
