"""Zemax sequential files (.ZMX): the one spectacle lens in a sequence of surfaces.

Understood: STANDARD, EVENASPH, TOROIDAL, BICONICX, GRID_SAG and COORDBRK surfaces in either encoding. Zemax counts z along
the light, y up and x so that the axes are right-handed: light from the scene to the eye turns our axes by 180 degrees about y.
Sources: Ansys Zemax OpticStudio user guide, "Sequential Surfaces", "Coordinate Break", "Toroidal", "Grid Sag".
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..optics import surfaces
from ..optics.conventions import Floats
from ..optics.lens import circle_outline
from ..optics.materials import Material, material_from_abbe, named_material
from ..optics.scattered import fitted_points
from ..optics.surfaces import Surface
from .body import USUAL_DIAMETER, Body, BodySurface
from .registry import read_file
from .surface_data import Reading
from .text import read_text

UNITS = {"MM": 1.0, "CM": 10.0, "IN": 25.4, "METER": 1000.0}
SHAPES = ("STANDARD", "EVENASPH", "TOROIDAL", "BICONICX", "GRID_SAG")
REFIT_CELL = 2.0  # mm


@dataclass(slots=True)
class Row:
    """One SURF block, lengths in mm: its number and line in the file, and what its records say."""

    number: int
    line: int
    type: str = "STANDARD"
    curvature: float = 0.0
    conic_constant: float = 0.0
    thickness: float = 0.0
    glass: list[str] = field(default_factory=list)
    semi_diameter: float = 0.0
    parameters: dict[int, float] = field(default_factory=dict)
    comment: str = ""
    stop: bool = False


def sniff(head: bytes, text: str) -> float:
    """A list of SURF blocks; certain with a header's MODE."""
    if not re.search(r"^SURF \d+", text, re.MULTILINE):
        return 1.0 if re.search(r"^MODE (SEQ|NSC)", text, re.MULTILINE) else 0.0
    return 1.0 if re.search(r"^\s+(TYPE|CURV|DISZ) ", text, re.MULTILINE) else 0.5


def read(path: Path) -> tuple[Body | BodySurface, ...]:
    """The lens body and its two surfaces. Raises InputError."""
    body = _body(path)
    return body, *body.surfaces()


def _body(path: Path) -> Body:
    """The two surfaces round the only glass.

    The first of them is the front, unless the stop (the eye's pupil or centre of rotation) comes before it: then the light
    goes from the eye to the scene, and the first is the back.
    """
    rows = _rows(path)
    first, second = _round_the_glass(path, rows)
    from_eye = any(row.stop for row in rows if row.number < first.number)
    shift, turn = _relative_pose(path, rows, first.number, second.number)
    if not from_eye:
        turned = np.array([-1.0, 1.0, -1.0])
        shift, turn = shift * turned, turn * np.outer(turned, turned)
    diameters = [2 * row.semi_diameter for row in (first, second) if row.semi_diameter > 0]
    reach = max(diameters, default=USUAL_DIAMETER) / 2
    near, words_near = _surface(path, first, from_eye, reach, (np.zeros(3), np.eye(3)))
    far, words_far = _surface(path, second, from_eye, reach, (shift, turn))
    way = "from the eye to the scene, for the stop comes first" if from_eye else "from the scene to the eye"
    understood = [
        f"surface {first.number}: {words_near}",
        f"surface {second.number}: {words_far}",
        f"light {way}: surface {(second if from_eye else first).number} is the front",
        f"edge: {'circle of the smaller DIAM' if diameters else f'no DIAM; circle of {USUAL_DIAMETER:g} mm taken'}",
    ]
    if any(row.type == "COORDBRK" and any(row.parameters.values()) for row in rows if row.number < first.number):
        understood.append("coordinate breaks before the lens are its position of wear and are left out")
    back, front = (near, far) if from_eye else (far, near)
    outline, material = circle_outline(min(diameters, default=USUAL_DIAMETER)), _material(path, first)
    return Body(path, front, back, abs(float(shift[2])), tuple(understood), outline, material)


# ---- records ----


def _rows(path: Path) -> list[Row]:
    rows: list[Row] = []
    unit = 1.0
    for line, text in enumerate(read_text(path).split("\n"), start=1):
        words = text.split()
        if not words:
            continue
        where = f"{path}, line {line}"
        if words[0] == "SURF":
            rows.append(Row(int(_number(where, words, 1)), line))
        elif rows:
            _record(where, rows[-1], words, unit)
        elif words[0] == "UNIT":
            if len(words) < 2 or words[1] not in UNITS:
                raise InputError(f"{where}: UNIT {' '.join(words[1:2])}: not known; there are {', '.join(UNITS)}")
            unit = UNITS[words[1]]
        elif words[0] == "MODE" and words[1:2] != ["SEQ"]:
            raise InputError(f"{where}: MODE {' '.join(words[1:2])}: only sequential files are read")
    if not rows:
        raise InputError(f"{path}: no SURF record; a Zemax file lists its surfaces as SURF blocks")
    return rows


def _record(where: str, row: Row, words: list[str], unit: float) -> None:
    name = words[0]
    if name == "TYPE":
        row.type = words[1] if len(words) > 1 else ""
    elif name == "CURV":
        row.curvature = _number(where, words, 1) / unit
    elif name == "CONI":
        row.conic_constant = _number(where, words, 1)
    elif name == "DISZ":
        row.thickness = _number(where, words, 1, infinite=True) * unit
    elif name == "DIAM":
        row.semi_diameter = _number(where, words, 1) * unit
    elif name == "GLAS":
        row.glass = words[1:]
    elif name == "COMM":
        row.comment = " ".join(words[1:])
    elif name == "STOP":
        row.stop = True
    elif name == "PARM":
        row.parameters[int(_number(where, words, 1))] = _in_mm(
            row.type, int(float(words[1])), _number(where, words, 2), unit
        )


def _in_mm(kind: str, index: int, value: float, unit: float) -> float:
    """A parameter in mm: lengths grow with the unit, coefficients of r^2k (EVENASPH) and y^2k (TOROIDAL) as mm^(1 - 2k)."""
    if kind in ("EVENASPH", "GRID_SAG") and 1 <= index <= 8:
        return value * unit ** (1 - 2 * index)
    if kind == "TOROIDAL" and 2 <= index <= 8:
        return value * unit ** (1 - 2 * (index - 1))
    length = (kind in ("TOROIDAL", "BICONICX") and index == 1) or (kind == "COORDBRK" and index in (1, 2))
    return value * unit if length else value


def _number(where: str, words: list[str], k: int, infinite: bool = False) -> float:
    try:
        value = float(words[k])
    except IndexError:
        raise InputError(f"{where}: {words[0]}: value {k} is missing") from None
    except ValueError:
        raise InputError(f"{where}: {words[0]}: {words[k][:40]!r} is not a number") from None
    if np.isnan(value) or (np.isinf(value) and not infinite):
        raise InputError(f"{where}: {words[0]}: {words[k]} is not a finite number")
    return value


# ---- the lens in the sequence ----


def _round_the_glass(path: Path, rows: list[Row]) -> tuple[Row, Row]:
    """The surface before and the surface after the only glass that has air on both sides (a model eye has glass on glass)."""
    solid = [row for row in rows if row.type != "COORDBRK"]
    glass = [k for k, row in enumerate(solid) if row.glass]
    alone = [k for k in glass if k and not solid[k - 1].glass and not (k + 1 < len(solid) and solid[k + 1].glass)]
    if len(alone) != 1:
        held = f"glass after surfaces {', '.join(str(solid[k].number) for k in glass)}" if glass else "no glass (GLAS)"
        raise InputError(f"{path}: {held}; a spectacle lens is the only glass with air before and behind it")
    first = solid[alone[0]]
    if first.glass[0].upper() == "MIRROR":
        raise InputError(
            f"{path}, line {first.line}: surface {first.number} is a mirror; only a spectacle lens is read"
        )
    if alone[0] + 1 == len(solid):
        raise InputError(f"{path}, line {first.line}: surface {first.number}: no surface ends its glass")
    second = solid[alone[0] + 1]
    for row in (first, second):
        if row.type not in SHAPES:
            raise InputError(
                f"{path}, line {row.line}: surface {row.number} is of type {row.type}; there are {', '.join(SHAPES)}"
            )
    return first, second


def _material(path: Path, row: Row) -> Material:
    """The glass: a model glass by its n_d and V_d, or a name of the table of materials."""
    name, words = row.glass[0], row.glass
    where = f"{path}, line {row.line}: surface {row.number}: GLAS {name}"
    if words[1:2] == ["1"] or name.startswith("___"):
        n_d, abbe = _number(where, words, 3), _number(where, words, 4)
        if not (1.3 < n_d < 2.2 and 10 < abbe < 120):
            raise InputError(f"{where}: n_d {n_d:g} and Abbe number V_d {abbe:g} are no spectacle lens's")
        return material_from_abbe(f"model glass {n_d:g}/{abbe:g}", n_d, abbe)
    found = named_material(name)
    if found is None:
        raise InputError(f"{where} is not in the table of materials; name one that is (--material MR-8)")
    return found


def _relative_pose(path: Path, rows: list[Row], first: int, second: int) -> tuple[Floats, Floats]:
    """Vertex (3,) mm and axes (3, 3) of the second surface in the first one's frame, Zemax's axes.

    A break decentres along x and y, then turns about its x, the new y and the new z, or (order 1) does all that backwards.
    """
    at, turn = np.zeros(3), np.eye(3)
    for row in rows:
        if not first <= row.number < second:
            continue
        if row.type == "COORDBRK":
            p = [row.parameters.get(k, 0.0) for k in range(1, 7)]
            about = [_about(axis, np.radians(angle)) for axis, angle in enumerate(p[2:5])]
            shift = np.array([p[0], p[1], 0.0])
            if p[5] == 0:
                at, turn = at + turn @ shift, turn @ about[0] @ about[1] @ about[2]
            else:
                turn = turn @ about[2] @ about[1] @ about[0]
                at = at + turn @ shift
        if not np.isfinite(row.thickness):
            raise InputError(f"{path}, line {row.line}: surface {row.number}: the glass is endlessly thick")
        at = at + turn @ [0.0, 0.0, row.thickness]
    if at[2] <= 0:
        raise InputError(
            f"{path}: surface {second} lies {at[2]:g} mm behind surface {first}; the lens needs a thickness"
        )
    return at, turn


def _about(axis: int, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    turn = np.eye(3)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    turn[j, j], turn[j, k], turn[k, j], turn[k, k] = c, -s, s, c
    return turn


# ---- surfaces ----

Sag = Callable[[Floats, Floats], Floats]


def _surface(path: Path, row: Row, from_eye: bool, reach: float, place: tuple[Floats, Floats]) -> tuple[Surface, str]:
    """A row's surface at a place (vertex, axes) of the lens frame, and how it was understood.

    reach: mm about its vertex, for what is refitted.
    """
    shift, turn = place
    about_y, about_x = float(np.arctan2(turn[0, 2], turn[2, 2])), float(np.arcsin(np.clip(-turn[1, 2], -1, 1)))
    rolled = float(np.degrees(np.arctan2(turn[1, 0], turn[1, 1])))
    towards_eye = -1.0 if from_eye else 1.0

    def posed(surface: Surface, note: str = "") -> Surface:
        at = float(shift[0]), float(shift[1])
        return replace(surface, decentration=at, tilt=(about_x, about_y), note=note)

    exact = _exact(row, towards_eye, rolled)
    if exact is not None:
        return posed(exact), f"{row.type}, {posed(exact).describe()}"
    sag = _SAGS[row.type](path, row)
    side = np.arange(-reach, reach + 0.25, 0.5)
    x, y = np.meshgrid(side, side)
    z = sag(x, y)
    inside = (np.hypot(x, y) <= reach * 1.001) & np.isfinite(z)
    c, s = np.cos(np.radians(rolled)), np.sin(np.radians(rolled))
    x, y = (x if from_eye else -x), y
    fit = fitted_points((c * x - s * y)[inside], (s * x + c * y)[inside], -towards_eye * z[inside], REFIT_CELL)
    worst = float(np.abs(fit.residuals).max())
    word = f"{row.type}, refitted by a B-spline of {REFIT_CELL:g} mm cells, off by {worst * 1e6:.2g} nm at most"
    return posed(fit.surface, word), word


def _exact(row: Row, sign: float, rolled: float) -> Surface | None:
    """The row as one of our closed forms, unposed; sign: 1 where Zemax's z points to the eye. None where there is none."""
    p = row.parameters
    c, k = sign * row.curvature, row.conic_constant
    if row.type == "STANDARD":
        return surfaces.conic(c, k)
    if row.type == "EVENASPH" and p.get(1, 0.0) == 0 and p.get(8, 0.0) == 0:
        return surfaces.conic(c, k, [sign * p.get(i, 0.0) for i in range(2, 8)])
    across = sign / p[1] if p.get(1) else 0.0
    if row.type == "BICONICX":
        return surfaces.biconic(c, across, 90.0 + rolled, k, p.get(2, 0.0))
    if row.type == "TOROIDAL" and k == 0 and not any(p.get(i, 0.0) for i in range(2, 9)):
        return surfaces.toric(c, across, 90.0 + rolled)
    return None


def _conic_depth(c: float, k: float, q: Floats) -> Floats:
    with np.errstate(invalid="ignore"):
        return np.asarray(c * q / (1 + np.sqrt(1 - (1 + k) * c * c * q)))


def _asphere(path: Path, row: Row) -> Sag:
    """Even asphere: conic and terms of r^2, r^4, ... r^16."""
    terms = [row.parameters.get(i, 0.0) for i in range(1, 9)]

    def sag(x: Floats, y: Floats) -> Floats:
        q = x * x + y * y
        return _conic_depth(row.curvature, row.conic_constant, q) + sum(a * q**i for i, a in enumerate(terms, start=1))

    return sag


def _toroid(path: Path, row: Row) -> Sag:
    """An aspheric curve of y, turned about a line parallel to y at the radius of rotation (parameter 1; 0: none)."""
    if row.parameters.get(13):
        raise InputError(f"{path}, line {row.line}: surface {row.number}: TOROIDAL with Zernike terms is not read")
    radius, terms = row.parameters.get(1, 0.0), [row.parameters.get(i, 0.0) for i in range(2, 9)]

    def sag(x: Floats, y: Floats) -> Floats:
        curve = _conic_depth(row.curvature, row.conic_constant, y * y)
        curve = curve + sum(a * y ** (2 * i) for i, a in enumerate(terms, start=1))
        if radius == 0:
            return curve
        with np.errstate(invalid="ignore"):
            return np.asarray(radius - np.sign(radius) * np.sqrt((radius - curve) ** 2 - x * x))

    return sag


def _grid(path: Path, row: Row) -> Sag:
    """The even asphere and the grid of the data file that the comment names, which lies beside."""
    where = f"{path}, line {row.line}: surface {row.number}: GRID_SAG"
    if not row.comment:
        raise InputError(f"{where}: name its data file (.DAT, beside this one) in the surface's comment (COMM)")
    name = row.comment.replace("\\", "/").rpartition("/")[2]
    surfaces_there = [item for item in read_file(path.parent / name).items if hasattr(item, "fitted")]
    if not surfaces_there:
        raise InputError(f"{where}: {name} holds no grid")
    grid = surfaces_there[0].fitted(Reading(first_point="top-left", rows="horizontal", z_towards="scene")).surface
    base = _asphere(path, row)
    return lambda x, y: base(x, y) + grid.sag(x - grid.decentration[0], y - grid.decentration[1])


_SAGS: dict[str, Callable[[Path, Row], Sag]] = {"EVENASPH": _asphere, "TOROIDAL": _toroid, "GRID_SAG": _grid}
