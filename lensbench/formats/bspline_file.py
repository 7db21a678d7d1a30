"""One surface as a tensor B-spline in JSON: format "lensbench-bspline/1", the keys of a lens file's bspline table."""

import json
from pathlib import Path
from typing import Any, Literal

from numpy import degrees

from ..errors import InputError
from ..optics.as_spline import as_bspline
from ..optics.surfaces import Surface
from .lens_file import BSpline, Face
from .toml_file import read_text, validated

BSPLINE_FORMAT = "lensbench-bspline/1"


class BSplineFile(BSpline):
    """The whole file: degree, knots_x, knots_y, coefficients, and, if wanted, decentration, tilt, name, side and face."""

    format: Literal["lensbench-bspline/1"]
    type: Literal["bspline"] = "bspline"
    name: str = ""
    side: Literal["R", "L", ""] = ""
    face: Literal["front", "back", ""] = ""


def read_bspline(path: Path) -> tuple[Surface, BSplineFile]:
    """The surface of a JSON B-spline file, and the file's own words on it. Raises InputError."""
    table = validated(path, read_json(path), BSplineFile)
    return table.build(Face(table.face, table.side, 1.0, path.parent)), table


def read_json(path: Path) -> Any:
    """The contents of a JSON file. Raises InputError with the line of a syntax error."""
    try:
        return json.loads(read_text(path))
    except json.JSONDecodeError as error:
        raise InputError(f"{path}, line {error.lineno}, column {error.colno}: not valid JSON: {error.msg}") from None
    except (RecursionError, ValueError) as error:
        raise InputError(f"{path}: not valid JSON: {error}") from None


def bspline_text(surface: Surface, box: tuple[float, float, float, float], **words: str) -> str:
    """The JSON text of a surface over a box (x min, x max, y min, y max; mm, surface frame); words: name, side, face.

    Splines come back to the last digit; closed forms are interpolated on a grid of 1 mm.
    """
    spline = as_bspline(surface, box)
    tilt = [float(value) for value in degrees(surface.tilt)]
    data = {"format": BSPLINE_FORMAT, **words, "degree": spline.degree}
    data |= {key: getattr(spline, key).tolist() for key in ("knots_x", "knots_y", "coefficients")}
    return json.dumps(data | {"decentration": list(surface.decentration), "tilt": tilt}) + "\n"
