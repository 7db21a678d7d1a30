"""The same surface with more or less curvature at its vertex: how a back surface is made for another power."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from .as_spline import as_bspline
from .conventions import Floats
from .kernels import surface as kernel
from .surfaces import Surface, biconic, bspline, toric

Box = tuple[float, float, float, float]


def with_curvature_added(surface: Surface, added: Floats, box: Box) -> Surface:
    """A surface whose vertex has another curvature matrix: `added` (2, 2) more, symmetric, 1/mm, in the surface frame.

    Spheres and tori become tori, biconics biconics with their conic constants; on a spline, and on any other closed form
    as a spline over the box (x min, x max, y min, y max, mm, lens frame), a paraboloid is laid, sag -p.added.p / 2.
    """
    pose = {"decentration": surface.decentration, "tilt": surface.tilt, "note": surface.note}
    if surface.kind in (kernel.TORIC, kernel.BICONIC):
        return _with_meridians(surface, added, pose)
    if surface.kind == kernel.CONIC and not surface.p[1:].any():
        return _with_meridians(toric(surface.p[0], surface.p[0], 0.0), added, pose)
    if surface.kind != kernel.SPLINE:
        dx, dy = surface.decentration
        arrays = as_bspline(surface, (box[0] - dx, box[1] - dx, box[2] - dy, box[3] - dy))
        surface = bspline(arrays.knots_x, arrays.knots_y, arrays.coefficients, arrays.degree, **pose)
    return _with_paraboloid(surface, added)


def _with_meridians(surface: Surface, added: Floats, pose: Mapping[str, Any]) -> Surface:
    """Of a torus or biconic; the first meridian stays the first, as nearly as the new curvatures let it."""
    along, across, cos, sin = surface.p[:4]
    first = np.array([cos, sin])
    second = np.array([-sin, cos])
    curvature = along * np.outer(first, first) + across * np.outer(second, second) + added
    values, vectors = np.linalg.eigh(curvature)
    k = int(np.argmax(np.abs(first @ vectors)))
    axis = float(np.degrees(np.arctan2(vectors[1, k], vectors[0, k])) % 180)
    if surface.kind == kernel.TORIC:
        return toric(values[k], values[1 - k], axis, **pose)
    return biconic(values[k], values[1 - k], axis, surface.p[4], surface.p[5], **pose)


def _with_paraboloid(surface: Surface, added: Floats) -> Surface:
    """Of a spline: exact in its cells, which are polynomials about their middles."""
    (a, b), (_, c) = -added
    x, y = ((breaks[:-1] + breaks[1:]) / 2 for breaks in (surface.breaks_x, surface.breaks_y))
    x, y = np.meshgrid(x, y)
    cells = surface.cells.copy()
    cells[..., 0, 0] += (a * x * x + c * y * y) / 2 + b * x * y
    cells[..., 0, 1] += a * x + b * y
    cells[..., 1, 0] += b * x + c * y
    cells[..., 0, 2] += a / 2
    cells[..., 1, 1] += b
    cells[..., 2, 0] += c / 2
    return replace(surface, p=surface.p + np.array([np.trace(added) / 2, *[0.0] * 7]), cells=cells)
