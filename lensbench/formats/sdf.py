"""Surface matrix of the VCA/OMA Data Communication Standard (SURFMT and ZZ records, ISO 16284): text, one block a surface.

SURFMT=1;R;F;nx;ny;width;height;0 and then ny records ZZ= of nx sags in mm, "?" for an unknown one. The standard leaves the
order of the rows and the sign of z open; where nx and ny differ, the counts of the ZZ records tell which is which.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError
from .point_grid import PointGrid
from .registry import Writing, Written
from .sampling import sampled
from .text import MOST_POINTS, MOST_SIDE, digit_of, number, read_text, sags, shown, whole

_SIDES = {"R": "R", "L": "L", "RIGHT": "R", "LEFT": "L"}
_FACES = {"F": "F", "B": "B", "FRONT": "F", "BACK": "B", "": "", "?": ""}


class _Header(NamedTuple):
    """What SURFMT says: counts and extents (mm) as in fields 4 to 7."""

    line: int
    side: str
    face: str
    counts: tuple[int, int]
    extents: tuple[float, float]


def sniff(head: bytes, text: str) -> float:
    """Certain where there is a SURFMT record; possible where there are records of the standard."""
    upper = text.upper()
    if "SURFMT=" in upper or "SURFMT =" in upper:
        return 1.0
    return 0.5 if "REQ=SDF" in upper or "\nZZ=" in upper else 0.0


def read(path: Path) -> list[PointGrid]:
    """All surface blocks of an SDF file. Raises InputError with the line of what is wrong."""
    lines = [line.strip() for line in read_text(path).split("\n")]
    records = [(k + 1, *_record(line)) for k, line in enumerate(lines)]
    headers = [k for k, (_, label, _) in enumerate(records) if label == "SURFMT"]
    if not headers:
        raise InputError(
            f"{path}: no SURFMT record; an SDF file has a line SURFMT=1;R;F;nx;ny;width;height;0 and ZZ= lines"
        )
    ends = [*headers[1:], len(records)]
    return [_block(path, records[start:end]) for start, end in zip(headers, ends, strict=True)]


def _record(line: str) -> tuple[str, str]:
    label, _, value = line.partition("=")
    return label.strip().upper(), value.strip()


def _block(path: Path, records: Sequence[tuple[int, str, str]]) -> PointGrid:
    header = _header(path, records[0][0], records[0][2])
    rows = [(line, _fields(value)) for line, label, value in records if label == "ZZ"]
    columns, count, width, height = _laid_out(path, header, rows)
    for line, fields in rows[:count]:
        if len(fields) != columns:
            raise InputError(
                f"{path}, line {line}: {len(fields)} values in the ZZ record where SURFMT announces {columns}"
            )
    if len(rows) > count:
        raise InputError(f"{path}, line {rows[count][0]}: one ZZ record more than the {count} that SURFMT announces")
    if len(rows) < count:
        raise InputError(
            f"{path}: ends after {len(rows)} of the {count} ZZ records that SURFMT announces: the file is truncated"
        )
    values = np.array([sags(f"{path}, line {line}", fields) for line, fields in rows])
    digit = min(digit_of(fields, 8) for _, fields in rows)
    return PointGrid(path.name, values, width, height, digit, header.side, header.face)


def _fields(record: str) -> list[str]:
    """The values of a record; a closing separator ends the last one."""
    return (record[:-1] if record.endswith(";") else record).split(";")


def _laid_out(path: Path, h: _Header, rows: Sequence[tuple[int, list[str]]]) -> tuple[int, int, float, float]:
    """(columns, rows, width, height): fields 4 and 6 belong to the columns unless the records say the opposite."""
    (first, second), (width, height) = h.counts, h.extents
    turned = first != second and len(rows) == first and all(len(fields) == second for _, fields in rows)
    return (second, first, height, width) if turned else (first, second, width, height)


def _header(path: Path, line: int, record: str) -> _Header:
    fields = [f.strip() for f in record.split(";")]
    where = f"{path}, line {line}: SURFMT"
    if len(fields) < 7:
        raise InputError(f"{where} has {len(fields)} fields; it needs format;side;face;nx;ny;width;height")
    if fields[0] not in ("1", "ASCII"):
        raise InputError(f"{where}: format {shown(fields[0])} is not supported; only 1 (decimal text) is")
    side, face = fields[1].upper(), fields[2].upper()
    if side not in _SIDES or face not in _FACES:
        raise InputError(f"{where}: side {shown(side)} and face {shown(face)} must be R or L and F or B")
    nx, ny = (whole(f"{where}, field {k + 1}", fields[k], 2, MOST_SIDE) for k in (3, 4))
    width, height = (number(f"{where}, field {k + 1}", fields[k]) for k in (5, 6))
    if nx * ny > MOST_POINTS:
        raise InputError(f"{where}: {nx} x {ny} points; a grid has at most {MOST_POINTS} points")
    if not (0 < width <= 1000 and 0 < height <= 1000):
        raise InputError(f"{where}: the extent {width:g} x {height:g} mm must be positive, and at most 1000 mm")
    return _Header(line, _SIDES[side], _FACES[face], (nx, ny), (width, height))


def write(things: Sequence[Any], writing: Writing) -> Written:
    """Surface blocks of lenses (front and back, all sides), or of surfaces and points. Raises InputError."""
    blocks = sampled(things, writing)
    parts = ["REQ=SDF"]
    for b in blocks:
        rows, columns = b.values.shape
        parts.append(f"SURFMT=1;{b.side or 'R'};{b.face or 'F'};{columns};{rows};{b.width:.10g};{b.height:.10g};0")
        parts += ["ZZ=" + ";".join(row) for row in b.text(writing.decimals, "?")]
    return Written("\r\n".join(parts) + "\r\n", "; ".join(b.describe() for b in blocks))
