"""HMF height maps: `Count`, `Interval` (mm) and, after [Data], one comma-separated line of sags (mm) a row.

The format says nothing of the order of rows, the sign and the side; programs that read it take the first row as the top.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from .point_grid import PointGrid
from .registry import Writing, Written
from .sampling import one_grid
from .text import MOST_POINTS, MOST_SIDE, digit_of, number, read_text, sags, side_in_name, whole


def sniff(head: bytes, text: str) -> float:
    """Certain where a [Data] section and a Count are there; likely with the first line of the format."""
    lower = text.lower()
    if re.search(r"^\s*count\s*=", lower, re.MULTILINE) and re.search(r"^\s*interval\s*=", lower, re.MULTILINE):
        return 1.0
    return 0.6 if lower.lstrip().startswith("file version=") else 0.0


def read(path: Path) -> list[PointGrid]:
    """The grid of an HMF file. Raises InputError with the line of what is wrong."""
    lines = [line.strip() for line in read_text(path).split("\n")]
    start = next((k for k, line in enumerate(lines) if line.lower() == "[data]"), None)
    if start is None:
        raise InputError(
            f"{path}: no line [Data]; an HMF file has Count=, Interval=, [Data] and one line of sags a row"
        )
    keys = {}
    for k, line in enumerate(lines[:start], start=1):
        key, equals, value = line.partition("=")
        if equals:
            keys[key.strip().lower()] = (f"{path}, line {k}: {key.strip()}", value.strip())
    columns, rows = (_count(path, keys, name) for name in ("countx", "county"))
    pitches = [_interval(path, keys, name) for name in ("intervalx", "intervaly")]
    data = [
        (k, line) for k, line in enumerate(lines[start + 1 :], start=start + 2) if line and not line.startswith("[")
    ]
    if rows * columns > MOST_POINTS:
        raise InputError(f"{path}: {columns} x {rows} points; a grid has at most {MOST_POINTS} points")
    if len(data) != rows:
        what = "the file is truncated" if len(data) < rows else "that is too many"
        raise InputError(f"{path}: {len(data)} lines of sags where Count announces {rows}: {what}")
    values = [_row(path, k, line, columns) for k, line in data]
    digit = min(digit_of(_fields(line), 8) for _, line in data)
    side = side_in_name(path)
    width, height = pitches[0] * (columns - 1), pitches[1] * (rows - 1)
    return [PointGrid(path.name, np.array(values), width, height, digit, side, remark=_remark(side))]


def _remark(side: str) -> str:
    return f"side {side} from the file's name" if side else ""


def _count(path: Path, keys: dict[str, tuple[str, str]], name: str) -> int:
    found = keys.get(name) or keys.get("count")
    if found is None:
        raise InputError(f"{path}: Count= is missing before [Data]")
    return whole(*found, 2, MOST_SIDE)


def _interval(path: Path, keys: dict[str, tuple[str, str]], name: str) -> float:
    found = keys.get(name) or keys.get("interval")
    if found is None:
        raise InputError(f"{path}: Interval= (mm) is missing before [Data]")
    value = number(*found)
    if not 0 < value <= 100:
        raise InputError(f"{found[0]}: {value:g} is no distance of points in mm")
    return value


def _fields(line: str) -> list[str]:
    return (line[:-1] if line.endswith(",") else line).split(",")


def _row(path: Path, line: int, text: str, columns: int) -> Any:
    fields = _fields(text)
    if len(fields) != columns:
        hint = "; values are separated by commas" if ";" in text or "\t" in text else ""
        raise InputError(f"{path}, line {line}: {len(fields)} values where Count announces {columns}{hint}")
    return sags(f"{path}, line {line}", fields)


def write(things: Sequence[Any], writing: Writing) -> Written:
    """One surface. Raises InputError where it is not square, has gaps, or where there are several."""
    grid = one_grid(things, writing)
    rows, columns = grid.values.shape
    if rows != columns:
        raise InputError(f"an HMF file holds a square grid, not {columns} x {rows} points: say --size W W")
    lines = [
        "File Version=1.2",
        "[Properties]",
        f"Count={rows}",
        f"Interval={grid.width / (columns - 1):.10g}",
        "[Data]",
    ]
    lines += [",".join(row) for row in grid.text(writing.decimals, "?")]
    return Written("\r\n".join(lines) + "\r\n", grid.describe())
