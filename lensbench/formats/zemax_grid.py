"""Zemax grid sag (.dat, .grd): `nx ny delx dely unitflag xdec ydec`, then a line `z dz/dx dz/dy d2z/dxdy [nodata]` a point.

unitflag 0 mm, 1 cm, 2 in, 3 m: scales z, delx, dely, xdec, ydec and (inversely) the mixed derivative. "!" starts a comment.
The first point has the least x and the greatest y; x runs fastest. z is positive along the light that enters a front surface:
towards the eye. Derivatives that are given check the order of the points and the sign of y.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats
from ..optics.smoothing import derivatives, fit_grid
from .orientation import Orientation
from .point_grid import PointGrid
from .registry import Writing, Written
from .sampling import one_grid
from .text import MOST_POINTS, MOST_SAG, MOST_SIDE, digit_of, number, read_text, shown, side_in_name, whole

UNITS = (1.0, 10.0, 25.4, 1000.0)
LEAST_SIDE = 5


def sniff(head: bytes, text: str) -> float:
    """Likely where a line of seven numbers, the first two whole, is followed by lines of one to five."""
    lines = _lines(text)[:4]
    if len(lines) < 3:
        return 0.0
    fields = [line.split() for _, line in lines]
    try:
        numbers = [[float(f) for f in row] for row in fields]
    except ValueError:
        return 0.0
    whole_counts = len(numbers[0]) in (6, 7) and all(n.is_integer() for n in numbers[0][:2])
    return 0.9 if whole_counts and all(len(row) in (1, 4, 5) for row in numbers[1:]) else 0.0


def _lines(text: str) -> list[tuple[int, str]]:
    """Number and text of the lines that are no comments."""
    lines = ((k, line.strip()) for k, line in enumerate(text.split("\n"), start=1))
    return [(k, line) for k, line in lines if line and not line.startswith("!")]


def read(path: Path) -> list[PointGrid]:
    """The grid of a Zemax grid-sag file. Raises InputError with the line of what is wrong."""
    lines = _lines(read_text(path))
    if not lines:
        raise InputError(f"{path}: empty; a grid-sag file begins with nx ny delx dely unitflag xdec ydec")
    nx, ny, pitch, unit, centre = _header(path, *lines[0])
    data = lines[1:]
    if len(data) != nx * ny:
        what = "the file is truncated" if len(data) < nx * ny else "that is too many"
        raise InputError(f"{path}: {len(data)} points where line {lines[0][0]} announces {nx} x {ny}: {what}")
    table = _table(path, data)
    missing = table[:, 4] != 0
    z = np.where(missing, np.nan, table[:, 0] * unit).reshape(ny, nx)
    _check_sags(path, data, z)
    digit = digit_of([line.split()[0] for _, line in data[:: max(1, len(data) // 400)]]) * unit
    side = side_in_name(path)
    remark = f"side {side} from the file's name" if side else ""
    width, height = pitch[0] * (nx - 1), pitch[1] * (ny - 1)
    said = _check_slopes(path, z, table[:, 1:3].reshape(ny, nx, 2), (width, height))
    remark = "; ".join(r for r in (remark, said) if r)
    return [PointGrid(path.name, z, width, height, digit, side, "", Orientation(), centre, remark)]


def _header(path: Path, line: int, text: str) -> tuple[int, int, tuple[float, float], float, tuple[float, float]]:
    """nx, ny, pitch (mm), unit (mm), and where the origin lies from the middle of the grid along columns and rows (mm)."""
    fields, where = text.split(), f"{path}, line {line}"
    if len(fields) not in (5, 7):
        raise InputError(f"{where}: {len(fields)} values; it needs nx ny delx dely unitflag xdec ydec")
    nx, ny = (whole(f"{where}, {n}", f, LEAST_SIDE, MOST_SIDE) for n, f in zip(("nx", "ny"), fields, strict=False))
    if nx * ny > MOST_POINTS:
        raise InputError(f"{where}: {nx} x {ny} points; a grid has at most {MOST_POINTS} points")
    unit = UNITS[whole(f"{where}, unitflag", fields[4], 0, 3)]
    pitch = [number(f"{where}, {n}", f) * unit for n, f in zip(("delx", "dely"), fields[2:4], strict=True)]
    for name, value in zip(("delx", "dely"), pitch, strict=True):
        if not 0 < value <= 100:
            raise InputError(f"{where}, {name}: {value:g} mm is no distance of points")
    xdec, ydec = (
        number(f"{where}, {n}", f) * unit for n, f in zip(("xdec", "ydec"), fields[5:] or ("0", "0"), strict=True)
    )
    return nx, ny, (pitch[0], pitch[1]), unit, (-xdec, ydec)


def _table(path: Path, data: list[tuple[int, str]]) -> Floats:
    """Sag, slopes, mixed derivative and nodata flag (n, 5), 0 where a line leaves them out."""
    rows = [line.split() for _, line in data]
    counts = {len(row) for row in rows}
    if counts <= {1, 4, 5} and len(counts) == 1 and not any("_" in line for _, line in data):
        try:
            table = np.array(rows, dtype=float)
        except ValueError:
            table = np.array([np.nan])
        if np.all(np.isfinite(table)):
            return np.pad(table, ((0, 0), (0, 5 - table.shape[1])))
    return np.array([_row(path, k, row) for (k, _), row in zip(data, rows, strict=True)])


def _row(path: Path, line: int, fields: list[str]) -> list[float]:
    if len(fields) not in (1, 4, 5):
        raise InputError(f"{path}, line {line}: {len(fields)} values; a point has z dz/dx dz/dy d2z/dxdy [nodata]")
    values = [number(f"{path}, line {line}, value {k}", f) for k, f in enumerate(fields, start=1)]
    return values + [0.0] * (5 - len(values))


def _check_sags(path: Path, data: list[tuple[int, str]], z: Floats) -> None:
    far = np.flatnonzero(np.abs(np.nan_to_num(z.ravel())) > MOST_SAG)
    if far.size:
        line, text = data[far[0]]
        raise InputError(f"{path}, line {line}, value 1: {shown(text.split()[0])} is not a sag on a lens")


def _check_slopes(path: Path, z: Floats, slopes: Floats, size: tuple[float, float]) -> str:
    """How the slopes in the file agree with those of the sags in the order that the format states; "" without slopes."""
    if not slopes.any() or min(z.shape) < 6 or np.count_nonzero(np.isfinite(z)) < 36:
        return ""
    x, y = (np.linspace(-length / 2, length / 2, n) for length, n in zip(size, z.shape[::-1], strict=True))
    fit = fit_grid(x, y, z[::-1], 0.0)
    known = np.isfinite(z)
    off = [
        float(np.sqrt(np.mean((own[::-1] - given)[known] ** 2)))
        for own, given in zip(derivatives(fit, x, y), np.moveaxis(slopes, -1, 0), strict=True)
    ]
    steep = float(np.sqrt(np.mean(slopes[known] ** 2)))
    if max(off) > 0.05 * steep:
        return f"the slopes in the file do not fit its sags in this order (off by {off[0]:.2g}, {off[1]:.2g} rms along x, y)"
    return f"slopes in the file agree with the sags within {max(off):.1g} rms"


def write(things: Sequence[Any], writing: Writing) -> Written:
    """One surface with its slopes; x to the right and y up as seen from in front of the wearer, z towards the eye."""
    grid = one_grid(things, writing)
    if grid.orientation != Orientation():
        raise InputError("a Zemax grid has its first point at the top left, rows horizontal and z towards the eye")
    rows, columns = grid.values.shape
    pitch = grid.width / (columns - 1), grid.height / (rows - 1)
    empty = np.isnan(grid.values)
    fx, fy, fxy = (-d[::-1] for d in grid.slopes)
    columns_of = [np.where(empty, 0.0, a).ravel() for a in (grid.values, fx, fy, fxy)]
    d = writing.decimals
    lines = [f"{columns} {rows} {pitch[0]:.10g} {pitch[1]:.10g} 0 0 0"]
    lines += [
        f"{z:.{d}f} {sx:.8f} {sy:.8f} {sxy:.9f} {int(nodata)}"
        for z, sx, sy, sxy, nodata in zip(*columns_of, empty.ravel(), strict=True)
    ]
    return Written("\n".join(lines) + "\n", grid.describe())
