"""Lenses as LensBench's own TOML files: closed forms with their constants, splines as B-splines, all digits kept."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from ..errors import InputError
from ..optics.as_spline import as_bspline
from ..optics.kernels import surface as kernel
from ..optics.lens import Lens, Outline
from ..optics.materials import MATERIALS
from ..optics.surfaces import Surface
from .registry import Writing, Written


def write(things: Sequence[Any], writing: Writing) -> Written:
    """One lens. Raises InputError where there is none, or more than one."""
    lenses = [t for t in things if isinstance(t, Lens) and writing.side in ("", t.side)]
    if len(lenses) != 1:
        what = "and there is none" if not lenses else f"and there are {len(lenses)}: say --side R or L"
        raise InputError(f"a lens file holds one whole lens, {what}")
    lens = lenses[0]
    kinds = ", ".join(f"{name} {_table(s, lens)['type']}" for name, s in (("front", lens.front), ("back", lens.back)))
    return Written(_text(lens), f"lens of side {lens.side}: {kinds}")


def _text(lens: Lens) -> str:
    m = lens.material
    head: dict[str, Any] = {"format": "lensbench-lens/1", "name": lens.name, "side": lens.side}
    numbers = {"name": m.name, "n_d": m.n_d, "n_e": m.n_e, "abbe": m.abbe, "density": m.density}
    head["material"] = m.name if MATERIALS.get(m.name) == m else numbers
    head |= {
        "wavelength": lens.wavelength,
        "centre_thickness": lens.centre_thickness,
        "outline": _outline(lens.outline),
    }
    tables = {"front": _table(lens.front, lens), "back": _table(lens.back, lens), "points": _points(lens)}
    for name, power in (("ordered", lens.ordered), ("verification", lens.verification_power)):
        if power is not None:
            tables[name] = asdict(power)
    lines = [f"{key} = {_value(value)}" for key, value in head.items()]
    for name, table in tables.items():
        lines += ["", f"[{name}]", *(f"{key} = {_value(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def _value(value: Any) -> str:
    """A TOML value: text, number, list, or an inline table."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(v)}" for key, v in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value) if isinstance(value, int) else repr(float(value))


def _points(lens: Lens) -> dict[str, Any]:
    points: dict[str, Any] = dict(lens.points.named())
    return points if lens.points.near_inset is None else points | {"near_inset": lens.points.near_inset}


def _outline(outline: Outline) -> dict[str, Any]:
    if np.ptp(outline.radii) < 1e-9:
        return {"shape": "circle", "diameter": 2 * float(outline.radii[0]), "centre": outline.centre}
    x, y = outline.points()
    kept = np.append(True, np.hypot(np.diff(x), np.diff(y)) > 1e-9)
    return {"shape": "points", "points": np.stack([x[kept], y[kept]], axis=1).tolist(), "centre": outline.centre}


def _table(surface: Surface, lens: Lens) -> dict[str, Any]:
    p = surface.p
    table: dict[str, Any]
    if surface.kind == kernel.CONIC and not p.any():
        table = {"type": "plane"}
    elif surface.kind == kernel.CONIC:
        table = {"type": "conic", "curvature": p[0], "conic_constant": p[1], "asphere": p[2:].tolist()}
        if not p[1:].any():
            table = {"type": "sphere", "curvature": p[0]}
    elif surface.kind in (kernel.TORIC, kernel.BICONIC):
        axis = float(np.degrees(np.arctan2(p[3], p[2])) % 180)
        table = {"type": "toric", "axis": axis, "curvature": p[:2].tolist()}
        if surface.kind == kernel.BICONIC:
            table |= {"type": "biconic", "conic_constant": p[4:6].tolist()}
    else:
        x0, x1, y0, y1 = lens.outline.box
        spline = as_bspline(surface, (x0, x1, y0, y1))
        table = {"type": "bspline", "degree": spline.degree}
        table |= {key: getattr(spline, key).tolist() for key in ("knots_x", "knots_y", "coefficients")}
    pose = {"decentration": surface.decentration, "tilt": tuple(np.degrees(surface.tilt))}
    return table | {key: value for key, value in pose.items() if any(value)}
