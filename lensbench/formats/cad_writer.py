"""A lens as a STEP solid: front, back and edge as B-spline faces, in mm, z towards the scene. Needs the extra "cad"."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import LensBenchError
from ..optics.as_spline import as_bspline, knot_averages
from ..optics.conventions import Floats
from ..optics.lens import Lens, surface_height
from ..optics.surfaces import Surface
from .cad import needs_cad, quiet

EDGE_POINTS = 360
SEAM = 1e-3  # mm, within which edges are one
MARGIN = 1.0  # mm, by which a face's surface reaches past the edge


def step_text(lens: Lens) -> bytes:
    """The STEP file (AP214) of a lens: a closed solid whose faces are the lens's surfaces within its outline.

    Splines are taken over exactly; closed forms are interpolated on a grid of 1 mm (misfit below 1e-6 mm on any lens).
    Raises LensBenchError where the kernel of the CAD package fails.
    """
    try:
        from OCP.IFSelect import IFSelect_ReturnStatus
        from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer
    except ModuleNotFoundError:
        raise needs_cad(lens.name) from None
    quiet()
    writer = STEPControl_Writer()
    status = writer.Transfer(_solid(lens), STEPControl_StepModelType.STEPControl_AsIs)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "lens.step"
        if status != IFSelect_ReturnStatus.IFSelect_RetDone or writer.Write(str(path)) != status:
            raise LensBenchError(f"{lens.name}: the CAD package cannot write this lens as STEP")
        return path.read_bytes()


def _solid(lens: Lens) -> Any:
    """The closed solid: both faces, trimmed by the outline, and the ruled face between their edges, sewn together."""
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakeSolid,
        BRepBuilderAPI_MakeWire,
        BRepBuilderAPI_Sewing,
    )
    from OCP.BRepFill import BRepFill
    from OCP.BRepLib import BRepLib
    from OCP.TopoDS import TopoDS

    sewing, edges = BRepBuilderAPI_Sewing(SEAM), []
    for surface, offset in ((lens.back, 0.0), (lens.front, lens.centre_thickness)):
        rim = _rim(lens, surface)
        patch = _patch(surface, rim, offset)
        edges.append(_edge(patch, rim))
        sewing.Add(BRepBuilderAPI_MakeFace(patch, BRepBuilderAPI_MakeWire(edges[-1]).Wire(), True).Face())
    sewing.Add(BRepFill.Face_s(*edges))
    sewing.Perform()
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(sewing.SewedShape())).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def _rim(lens: Lens, surface: Surface) -> Floats:
    """Points (EDGE_POINTS, 2) of the outline in a surface's own frame, mm."""
    x, y = lens.outline.points(EDGE_POINTS)
    from_vertex = np.stack([x, y, surface_height(surface, x, y)], axis=-1) - [*surface.decentration, 0.0]
    return np.asarray((from_vertex @ surface.rotation)[:, :2], dtype=float)


def _patch(surface: Surface, rim: Floats, offset: float) -> Any:
    """The surface over the rim's box as a B-spline patch in the lens frame; u is the surface's x, v its y."""
    from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    (x0, y0), (x1, y1) = rim.min(axis=0) - MARGIN, rim.max(axis=0) + MARGIN
    spline = as_bspline(surface, (x0, x1, y0, y1))
    shift = np.array([*surface.decentration, offset])
    poles = Array2_gp_Pnt(1, spline.coefficients.shape[1], 1, spline.coefficients.shape[0])
    x, y = (knot_averages(k, spline.degree) for k in (spline.knots_x, spline.knots_y))
    for j, i in np.ndindex(*spline.coefficients.shape):
        at = surface.rotation @ [x[i], y[j], spline.coefficients[j, i]] + shift
        poles.SetValue(i + 1, j + 1, gp_Pnt(*at.tolist()))
    arrays: list[Any] = []
    for kind, column in ((Array1_double, 0), (Array1_int, 1)):
        for knots in (spline.knots_x, spline.knots_y):
            values = np.unique(knots, return_counts=True)[column].tolist()
            array = kind(1, len(values))
            for k, value in enumerate(values, start=1):
                array.SetValue(k, value)
            arrays.append(array)
    return Geom_BSplineSurface(poles, *arrays, spline.degree, spline.degree)


def _edge(patch: Any, rim: Floats) -> Any:
    """The rim as a closed edge on the patch: a smooth curve through its points in u and v."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.BRepLib import BRepLib
    from OCP.collections import HArray1_gp_Pnt2d
    from OCP.Geom2dAPI import Geom2dAPI_Interpolate
    from OCP.gp import gp_Pnt2d

    points = HArray1_gp_Pnt2d(1, len(rim))
    for k, point in enumerate(rim.tolist(), start=1):
        points.SetValue(k, gp_Pnt2d(*point))
    curve = Geom2dAPI_Interpolate(points, True, 1e-9)
    curve.Perform()
    edge = BRepBuilderAPI_MakeEdge(curve.Curve(), patch).Edge()
    BRepLib.BuildCurves3d_s(edge)
    return edge
