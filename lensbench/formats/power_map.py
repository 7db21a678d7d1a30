"""Power maps as lens mappers export them: CSV with named columns, or a matrix of one quantity.

No maker's layout is published, so columns are known by their names: x, y (mm), sphere or mean power, cylinder, axis, and
prism. A matrix has the quantity's name in its corner, x along the first row and y down the first column.
"""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats, ReadOnlyArrays
from .text import read_text

NAMES = {
    "x": "x", "xpos": "x", "y": "y", "ypos": "y", "sphere": "sphere", "sph": "sphere", "s": "sphere", "mean": "mean",
    "meanpower": "mean", "meansphere": "mean", "sphericalequivalent": "mean", "se": "mean", "seq": "mean", "m": "mean",
    "power": "mean", "lensmetermeanpower": "mean", "cylinder": "cylinder", "cyl": "cylinder", "c": "cylinder",
    "astigmatism": "cylinder", "ast": "cylinder", "lensmeterastigmatism": "cylinder", "axis": "axis", "ax": "axis",
    "a": "axis", "prismh": "prism_x", "prismx": "prism_x", "prismhorizontal": "prism_x", "hprism": "prism_x",
    "prismv": "prism_y", "prismy": "prism_y", "prismvertical": "prism_y", "vprism": "prism_y",
}  # fmt: skip
UNITS = re.compile(r"[\[(].*?[\])]|(?<=[_ ])(mm|d|dpt|deg|degrees|cmm|pd|cm/m)$")
NOTHING = {"", "nan", "na", "n/a", "-", "--", "---", "*", "inf", "-inf", "null", "none"}
MOST_CELLS = 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class PowerMap(ReadOnlyArrays):
    """Measured powers on a grid seen from in front of the wearer: x (nx,), y (ny,) rising, mm; the rest (ny, nx).

    mean: D; astigmatism: D, >= 0; axis: degrees, of the minus cylinder; prism_x, prism_y: cm/m, towards the base. NaN where
    nothing was measured.
    """

    source: str
    x: Floats
    y: Floats
    mean: Floats
    astigmatism: Floats
    axis: Floats
    prism_x: Floats
    prism_y: Floats

    @property
    def measured(self) -> list[str]:
        """The quantities that have values."""
        names = ("mean", "astigmatism", "axis", "prism_x", "prism_y")
        return [name for name in names if np.isfinite(getattr(self, name)).any()]

    def mirrored(self) -> "PowerMap":
        """The map as seen from the other side: x, the axis and the horizontal prism change over."""
        turned = {n: getattr(self, n)[:, ::-1] for n in ("mean", "astigmatism", "prism_y")}
        axis, prism_x = (180 - self.axis[:, ::-1]) % 180, -self.prism_x[:, ::-1]
        return replace(self, x=-self.x[::-1], axis=axis, prism_x=prism_x, **turned)

    def facts(self) -> list[tuple[str, str, object]]:
        """Label, text and value of what the file holds."""
        size = f"{self.x.size} x {self.y.size} points, x {self.x[0]:g} to {self.x[-1]:g}, y {self.y[0]:g} to {self.y[-1]:g} mm"
        ranges = []
        for name in self.measured:
            values = getattr(self, name)
            ranges.append(
                (f"Measured {name}", f"{np.nanmin(values):.2f} to {np.nanmax(values):.2f}", np.nanmax(values))
            )
        return [
            ("File", f"a power map: {self.source}", "power map"),
            ("Points", size, [self.x.size, self.y.size]),
            *ranges,
        ]


def sniff(head: bytes, text: str) -> float:
    """A first line of known names with x, y and a power, or a matrix whose corner names one."""
    rows = [row for row in _table(text, 3) if row]
    if not rows:
        return 0.0
    names = [_name(cell) for cell in rows[0]]
    if {"x", "y"} <= set(names):
        return 0.95 if {"mean", "sphere", "cylinder"} & set(names) else 0.0
    return 0.9 if names[0] in ("mean", "cylinder", "axis", "sphere") and _is_number(rows[0][-1]) else 0.0


def read(path: Path) -> tuple[PowerMap]:
    """The power map. Raises InputError with line and column."""
    rows = _table(read_text(path))
    header = next((k for k, row in enumerate(rows) if row), None)
    if header is None:
        raise InputError(f"{path}: is empty")
    names = [_name(cell) for cell in rows[header]]
    if {"x", "y"} <= set(names):
        return (_from_columns(path, names, rows, header),)
    return (_from_matrix(path, names[0], rows, header),)


def _table(text: str, most: int = MOST_CELLS) -> list[list[str]]:
    """The rows of a table whose separator is the first of ; tab , or blanks that its first line has; comments (#) empty."""
    lines = [line if not line.lstrip().startswith(("#", "!")) else "" for line in text.splitlines()[:most]]
    first = next((line for line in lines if line.strip()), "")
    mark = next((m for m in (";", "\t", ",") if m in first), " ")
    if mark == " ":
        return [line.split() for line in lines]
    cells = [[cell.strip().strip('"') for cell in line.split(mark)] for line in lines]
    decimal = mark != ","
    return [[c.replace(",", ".") if decimal else c for c in row] if any(row) else [] for row in cells]


def _name(cell: str) -> str:
    plain = UNITS.sub("", cell.strip().lower())
    return NAMES.get(re.sub(r"[^a-z]", "", plain), "")


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _value(path: Path, line: int, column: int, cell: str) -> float:
    if cell.strip().lower() in NOTHING:
        return np.nan
    try:
        return float(cell)
    except ValueError:
        raise InputError(f"{path}, line {line}, column {column}: {cell[:40]!r} is not a number") from None


def _from_columns(path: Path, names: list[str], rows: list[list[str]], header: int) -> PowerMap:
    wanted = {name: k for k, name in enumerate(names) if name}
    if not {"mean", "sphere"} & set(wanted) and "cylinder" not in wanted:
        raise InputError(f"{path}, line {header + 1}: no column of sphere, mean power or cylinder")
    points: list[list[float]] = []
    for k, row in enumerate(rows[header + 1 :], start=header + 2):
        if not row:
            continue
        if len(row) <= max(wanted.values()):
            raise InputError(f"{path}, line {k}: {len(row)} columns where the first line names {len(names)}")
        points.append([_value(path, k, column + 1, row[column]) for column in wanted.values()])
    if len(points) < 4:
        raise InputError(f"{path}: {len(points)} points are no map")
    columns = dict(zip(wanted, np.array(points).T, strict=True))
    if not (np.isfinite(columns["x"]).all() and np.isfinite(columns["y"]).all()):
        raise InputError(f"{path}: a point has no x or no y")
    return _on_grid(path, columns)


def _on_grid(path: Path, columns: dict[str, Floats]) -> PowerMap:
    x, i = np.unique(np.round(columns["x"], 4), return_inverse=True)
    y, j = np.unique(np.round(columns["y"], 4), return_inverse=True)
    if min(x.size, y.size) < 2 or x.size * y.size > max(16, 8 * i.size):
        raise InputError(
            f"{path}: its {i.size} points have {x.size} different x and {y.size} different y: they lie on no grid"
        )
    grids = {}
    for name, values in columns.items():
        grids[name] = np.full((y.size, x.size), np.nan)
        grids[name][j, i] = values
    return _built(path, x, y, grids)


def _from_matrix(path: Path, quantity: str, rows: list[list[str]], header: int) -> PowerMap:
    if quantity not in ("mean", "sphere", "cylinder", "axis"):
        raise InputError(
            f"{path}, line {header + 1}: neither names columns x, y and a power, nor begins a matrix with mean, sphere, "
            "cylinder or axis in its corner"
        )
    table = [(k, row) for k, row in enumerate(rows[header:], start=header + 1) if row]
    width = len(table[0][1])
    for k, row in table:
        if len(row) != width:
            raise InputError(f"{path}, line {k}: {len(row)} columns where the first line has {width}")
    body = np.array(
        [[_value(path, k, c + 1, cell) for c, cell in enumerate(row) if c or k > header + 1] for k, row in table[1:]]
    )
    x = np.array([_value(path, header + 1, c + 2, cell) for c, cell in enumerate(table[0][1][1:])])
    if len(table) < 3 or width < 3 or not (np.isfinite(x).all() and np.isfinite(body[:, 0]).all()):
        raise InputError(f"{path}: a matrix needs two x and two y, each a number")
    order_x, order_y = np.argsort(x), np.argsort(body[:, 0])
    return _built(path, x[order_x], body[order_y, 0], {quantity: body[order_y][:, 1:][:, order_x]})


def _built(path: Path, x: Floats, y: Floats, grids: dict[str, Floats]) -> PowerMap:
    """Sphere, cylinder and axis as mean power, amount and axis of the minus cylinder."""
    none = np.full((y.size, x.size), np.nan)
    sphere, cylinder, axis = (grids.get(name, none) for name in ("sphere", "cylinder", "axis"))
    mean = grids.get("mean", sphere + cylinder / 2 if "cylinder" in grids else none)
    minus = np.where(cylinder > 0, axis + 90, axis) % 180
    prism = (grids.get(name, none) for name in ("prism_x", "prism_y"))
    return PowerMap(path.name, x, y, mean, np.abs(cylinder), minus, *prism)
