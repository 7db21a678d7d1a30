"""One surface as a tensor B-spline in JSON: format "lensbench-bspline/1", the keys of a lens file's bspline table."""

import json
from pathlib import Path
from typing import Any, Literal

from numpy import degrees

from ..errors import InputError
from ..optics.as_spline import as_bspline
from ..optics.lens import Lens
from ..optics.surfaces import Surface
from .body import BodySurface
from .lens_file import BSpline, Face
from .registry import Writing, Written
from .surface_data import Reading
from .text import read_text
from .toml_file import validated

BSPLINE_FORMAT = "lensbench-bspline/1"


class BSplineFile(BSpline):
    """The whole file: degree, knots_x, knots_y, coefficients, and, if wanted, decentration, tilt, name, side and face."""

    format: Literal["lensbench-bspline/1"]
    type: Literal["bspline"] = "bspline"
    name: str = ""
    side: Literal["R", "L", ""] = ""
    face: Literal["front", "back", ""] = ""


def sniff(head: bytes, text: str) -> float:
    """A JSON object whose format says so."""
    return 1.0 if text.lstrip().startswith("{") and '"lensbench-bspline/' in text else 0.0


def read(path: Path) -> tuple[BodySurface]:
    """The surface. Raises InputError."""
    table = validated(path, read_json(path), BSplineFile)
    surface = table.build(Face(table.face, table.side, 1.0, path.parent))
    return (BodySurface(path.name, surface, table.side, table.face[:1].upper()),)


def write(things: tuple[Any, ...], writing: Writing) -> Written:
    """One face of a lens, or one surface, over the lens's outline or the surface's own box. Raises InputError."""
    surface, box, words = _chosen(things, writing)
    told = "degree, knots in mm, coefficients in mm, positive towards the scene"
    return Written(bspline_text(surface, box, **words), f"{words.get('face') or 'surface'} as B-spline: {told}")


def _chosen(
    things: tuple[Any, ...], writing: Writing
) -> tuple[Surface, tuple[float, float, float, float], dict[str, str]]:
    for thing in things:
        if isinstance(thing, Lens) and writing.face in ("F", "B"):
            surface = thing.front if writing.face == "F" else thing.back
            x0, x1, y0, y1 = thing.outline.box
            dx, dy = surface.decentration
            face = "front" if writing.face == "F" else "back"
            return surface, (x0 - dx - 1, x1 - dx + 1, y0 - dy - 1, y1 - dy + 1), {"side": thing.side, "face": face}
        if hasattr(thing, "fitted"):
            half = (writing.size or (60.0, 60.0))[0] / 2, (writing.size or (60.0, 60.0))[1] / 2
            return thing.fitted(Reading(thing.side, thing.face)).surface, (-half[0], half[0], -half[1], half[1]), {}
    raise InputError("a JSON B-spline holds one surface: choose one with --face front or --face back")


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
