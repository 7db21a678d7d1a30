"""Surface matrix of the VCA/OMA Data Communication Standard (SURFMT and ZZ records, ISO 16284): text, one block a side.

SURFMT=1;R;F;nx;ny;width;height;0 and then ny records ZZ= of nx sags in mm. The standard leaves the order of the rows and
the sign of z open: the lens file says them.
"""

from pathlib import Path

import numpy as np

from ..errors import InputError
from .point_grid import PointGrid
from .text import read_text

MOST_POINTS = 4_000_000


def sniff(head: bytes, text: str) -> float:
    """Certain where there is a SURFMT record; likely where the request is for one."""
    return 1.0 if "SURFMT=" in text.upper() else 0.0


def read(path: Path) -> list[PointGrid]:
    """All surface blocks of an SDF file. Raises InputError with the line of what is wrong."""
    lines = read_text(path).splitlines()
    headers = [k for k, line in enumerate(lines) if line.strip().upper().startswith("SURFMT=")]
    if not headers:
        raise InputError(
            f"{path}: no SURFMT record; an SDF file has a line SURFMT=1;R;F;nx;ny;width;height;0 and ZZ= lines"
        )
    return [_block(path, lines, k) for k in headers]


def _block(path: Path, lines: list[str], header: int) -> PointGrid:
    nx, ny, width, height, side, face = _header(path, header + 1, lines[header].split("=", 1)[1])
    rows: list[list[float]] = []
    decimals = 0
    for k in range(header + 1, len(lines)):
        text = lines[k].strip()
        if text.upper().startswith("SURFMT="):
            break
        if text.upper().startswith("ZZ=") and len(rows) < ny:
            values = text[3:].rstrip(";").split(";")
            rows.append(_row(path, k + 1, values, nx))
            decimals = max(decimals, *(_decimals(v) for v in values))
        elif text.upper().startswith("ZZ="):
            raise InputError(f"{path}, line {k + 1}: one ZZ record more than the {ny} that SURFMT announces")
    if len(rows) != ny:
        raise InputError(
            f"{path}: ends after {len(rows)} of the {ny} ZZ records that SURFMT announces: the file is truncated"
        )
    return PointGrid(path.name, np.array(rows), width, height, 10.0**-decimals, side, face)


def _header(path: Path, line: int, record: str) -> tuple[int, int, float, float, str, str]:
    fields = [f.strip() for f in record.split(";")]
    where = f"{path}, line {line}: SURFMT"
    if len(fields) < 7:
        raise InputError(f"{where} has {len(fields)} fields; it needs format;side;face;nx;ny;width;height")
    if fields[0] != "1":
        raise InputError(f"{where}: format {fields[0]!r} is not supported; only 1 (decimal text) is")
    try:
        nx, ny, width, height = int(fields[3]), int(fields[4]), float(fields[5]), float(fields[6])
    except ValueError:
        raise InputError(f"{where}: nx;ny;width;height must be numbers, not {';'.join(fields[3:7])!r}") from None
    if min(nx, ny) < 2 or nx * ny > MOST_POINTS:
        raise InputError(f"{where}: {nx} x {ny} points; a grid has from 2 x 2 to {MOST_POINTS} points")
    if not (0 < width < np.inf and 0 < height < np.inf):
        raise InputError(f"{where}: the extent {width:g} x {height:g} mm must be positive")
    return nx, ny, width, height, fields[1].upper(), fields[2].upper()


def _row(path: Path, line: int, values: list[str], nx: int) -> list[float]:
    if len(values) != nx:
        raise InputError(f"{path}, line {line}: {len(values)} values in the ZZ record where SURFMT announces {nx}")
    row = []
    for column, text in enumerate(values, start=1):
        try:
            number = float(text)
        except ValueError:
            raise InputError(f"{path}, line {line}, value {column}: {text.strip()!r} is not a number") from None
        if not abs(number) <= 1000:
            raise InputError(f"{path}, line {line}, value {column}: {text.strip()!r} is not a sag in mm")
        row.append(number)
    return row


def _decimals(text: str) -> int:
    mantissa, _, exponent = text.strip().lower().partition("e")
    return max(0, len(mantissa.partition(".")[2]) - int(exponent or 0))
