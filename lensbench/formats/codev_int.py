"""Code V interferogram files (.int) that hold a surface: `GRD nx ny SUR WVL w SSZ s [NDA n] [XSC k]` and whole numbers.

Deviation in um = w * number / s (SSZ is the number that stands for one wavelength, w in um); rows run from the top, from left
to right. The file holds no pitch: XSC, where it is given, scales x against y. Numbers have 16 bits, so a full progressive sag
of 5 mm is resolved to about 0.1 um only, which is too coarse for its powers; deviations from a base surface are fine.
"""

from pathlib import Path

import numpy as np

from ..errors import InputError
from .orientation import Orientation
from .point_grid import PointGrid
from .text import MOST_POINTS, MOST_SIDE, number, read_text, shown, side_in_name, whole

USUAL_WIDTH = 60.0
MOST_LINES_BEFORE = 200


def sniff(head: bytes, text: str) -> float:
    """Certain where a line GRD nx ny with a kind of data and a wavelength stands near the top."""
    upper = text.upper()
    return 1.0 if any(line.split()[:1] == ["GRD"] and " WVL " in f"{line} " for line in upper.split("\n")) else 0.0


def read(path: Path) -> list[PointGrid]:
    """The grid of an interferogram file. Raises InputError with the line of what is wrong."""
    lines = [line.strip() for line in read_text(path).split("\n")]
    at = next((k for k, line in enumerate(lines[:MOST_LINES_BEFORE]) if line.upper().startswith("GRD")), None)
    if at is None:
        raise InputError(f"{path}: no line GRD nx ny SUR WVL w SSZ s; only grids are read, not Zernike files")
    where = f"{path}, line {at + 1}: GRD"
    fields = lines[at].upper().split()
    if len(fields) < 4 or fields[3] != "SUR":
        raise InputError(f"{where}: holds {shown(' '.join(fields[3:4]))}; only SUR (a surface) is read")
    nx, ny = (whole(f"{where}, field {k + 1}", fields[k], 5, MOST_SIDE) for k in (1, 2))
    if nx * ny > MOST_POINTS:
        raise InputError(f"{where}: {nx} x {ny} points; a grid has at most {MOST_POINTS} points")
    said = {key: number(f"{where}, {key}", _after(where, fields, key)) for key in ("WVL", "SSZ")}
    if said["WVL"] <= 0 or said["SSZ"] == 0:
        raise InputError(f"{where}: WVL (um) must be positive and SSZ not zero")
    nodata = number(f"{where}, NDA", _after(where, fields, "NDA")) if "NDA" in fields else 32767.0
    scale = number(f"{where}, XSC", _after(where, fields, "XSC")) if "XSC" in fields else 1.0
    counts = _numbers(path, lines, at + 1, nx * ny)
    step = abs(said["WVL"] / said["SSZ"]) / 1000
    values = np.where(counts == nodata, np.nan, counts * said["WVL"] / said["SSZ"] / 1000).reshape(ny, nx)
    height = USUAL_WIDTH * (ny - 1) / (nx - 1) / (scale if scale > 0 else 1.0)
    remark = f"the file has no pitch: taken as {USUAL_WIDTH:g} mm wide"
    if step > 2e-5:
        remark += f"; 16-bit numbers step by {step * 1e6:.0f} nm, too coarse for a full sag"
    return [
        PointGrid(path.name, values, USUAL_WIDTH, height, step, side_in_name(path), "", Orientation(), remark=remark)
    ]


def _after(where: str, fields: list[str], key: str) -> str:
    if key not in fields or fields.index(key) + 1 >= len(fields):
        raise InputError(f"{where}: the value of {key} is missing")
    return fields[fields.index(key) + 1]


def _numbers(path: Path, lines: list[str], start: int, count: int) -> np.ndarray:
    numbers: list[float] = []
    for k in range(start, len(lines)):
        if not lines[k].startswith("!"):
            numbers += [float(whole(f"{path}, line {k + 1}", f, -32768, 32767)) for f in lines[k].split()]
        if len(numbers) > count:
            raise InputError(f"{path}, line {k + 1}: more numbers than the {count} that GRD announces")
    if len(numbers) < count:
        raise InputError(
            f"{path}: ends after {len(numbers)} of the {count} numbers that GRD announces: it is truncated"
        )
    return np.array(numbers)
