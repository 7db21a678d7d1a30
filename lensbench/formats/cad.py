"""STEP and IGES: the two large faces of a lens solid, or a single face. Needs the extra "cad".

The lens's axis is taken along z; lengths come in mm whatever the file's unit. Planes, spheres and tori are taken over
exactly, as are B-spline faces that are graphs over x and y; any other face is sampled and refitted by a smooth B-spline.
"""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError, LensBenchError
from ..optics import surfaces
from ..optics.as_spline import knot_averages
from ..optics.conventions import Floats
from ..optics.scattered import fitted_points
from ..optics.surfaces import Surface
from .body import Body, BodySurface, Face, Place, body_of, joined, the_lens
from .registry import Writing, Written
from .text import read_bytes

SAMPLES = 161  # along u and along v, where a face is refitted
KNOT_PITCH = 1.5  # mm, of the refitted B-spline
STEEP = 0.6  # least |z| of the unit normal in a face's middle for it to be the front or the back of a lens
MOST_MISFIT = 0.01  # mm, of a sample from the refitted B-spline


def sniff(head: bytes, text: str) -> float:
    """STEP begins with its standard's number; an IGES start record has an S in column 73."""
    return 1.0 if text.lstrip().startswith("ISO-10303-21") else 0.9 if _is_iges(text) else 0.0


def read(path: Path) -> tuple[Body | BodySurface, ...]:
    """The lens body and its one or two surfaces. Raises InputError."""
    body = read_cad(path)
    return body, *body.surfaces()


def write(things: tuple[Any, ...], writing: Writing) -> Written:
    """A lens as a STEP solid. Raises InputError."""
    from .cad_writer import step_text

    lens = the_lens(things, "STEP")
    return Written(
        step_text(lens), "closed solid of B-spline faces, mm, z towards the scene, back vertex at the origin"
    )


def read_cad(path: Path) -> Body:
    """The lens body of a STEP or IGES file. Raises InputError."""
    shape = _shape(path)
    return body_of(path, lambda place: _lens_faces(path, _moved(shape, place)))


def _is_iges(text: str) -> bool:
    return re.match(r".{72}S[ 0]*1\s", text) is not None


def _lens_faces(path: Path, shape: Any) -> list[Face]:
    """The largest face across z and, if it is at least half as large, the next; pieces of one surface count as one."""
    pieces: dict[tuple[object, ...], list[Face]] = {}
    for face in (_face(path, f) for f in _faces_across_z(shape)):
        pieces.setdefault(face.identity(), []).append(face)
    found = sorted((joined(group) for group in pieces.values()), key=lambda face: -face.area)
    if not found:
        raise InputError(f"{path}: holds no face across z; a lens has its axis along z")
    return found[:2] if len(found) > 1 and found[1].area >= found[0].area / 2 else found[:1]


# ---- reading ----


def needs_cad(what: str) -> LensBenchError:
    """The sentence for an installation without the CAD package."""
    return LensBenchError(f'{what}: STEP and IGES need another package: pip install "lensbench[cad]"')


def quiet() -> None:
    """No words of the CAD package on standard output."""
    from OCP.Message import Message

    Message.DefaultMessenger_s().ChangePrinters().Clear()


def _shape(path: Path) -> Any:
    try:
        from OCP.IFSelect import IFSelect_ReturnStatus
        from OCP.IGESControl import IGESControl_Reader
        from OCP.STEPControl import STEPControl_Reader
    except ModuleNotFoundError:
        raise needs_cad(str(path)) from None
    quiet()
    iges = _is_iges(read_bytes(path, 200).decode("latin-1"))
    reader, kind = (IGESControl_Reader(), "IGES") if iges else (STEPControl_Reader(), "STEP")
    try:
        good = reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone and reader.TransferRoots() > 0
        shape = reader.OneShape() if good else None
    except Exception as error:  # the kernel's own failures have no common class in Python
        raise InputError(f"{path}: not a {kind} file that can be read: {type(error).__name__}") from None
    if shape is None or shape.IsNull():
        raise InputError(f"{path}: not a {kind} file that can be read, or it holds no surface")
    return shape


def _moved(shape: Any, place: Place) -> Any:
    from OCP.gp import gp, gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    turned, shifted = gp_Trsf(), gp_Trsf()
    if place.turned:
        turned.SetRotation(gp.OY_s(), np.pi)
    shifted.SetTranslation(gp_Vec(-place.x, -place.y, 0.0))
    return shape.Moved(TopLoc_Location(shifted.Multiplied(turned)))


def _faces_across_z(shape: Any) -> Iterator[Any]:
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.gp import gp_Pnt, gp_Vec
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        face = TopoDS.Face(explorer.Current())
        explorer.Next()
        adaptor = BRepAdaptor_Surface(face)
        point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
        u0, u1, v0, v1 = _bounds(face)
        adaptor.D1((u0 + u1) / 2, (v0 + v1) / 2, point, along_u, along_v)
        normal = along_u.Crossed(along_v)
        if normal.Magnitude() > 0 and abs(normal.Z()) >= STEEP * normal.Magnitude():
            yield face


def _bounds(face: Any) -> tuple[float, float, float, float]:
    from OCP.BRepTools import BRepTools

    u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
    return u0, u1, v0, v1


def _face(path: Path, face: Any) -> Face:
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepGProp import BRepGProp
    from OCP.GeomAbs import GeomAbs_SurfaceType as Kind
    from OCP.GProp import GProp_GProps

    adaptor, properties = BRepAdaptor_Surface(face), GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties)
    exact = {Kind.GeomAbs_Plane: _plane, Kind.GeomAbs_Sphere: _sphere, Kind.GeomAbs_Torus: _torus}
    exact[Kind.GeomAbs_BSplineSurface] = _graph
    points = _sampled(face, adaptor)
    found = exact.get(adaptor.GetType(), lambda *_: None)(adaptor, points) or _refitted(path, points)
    surface, height, word = found
    return Face(surface, height, properties.Mass(), _edge(face), word)


Found = tuple[Surface, float, str]


def _plane(adaptor: Any, points: Floats) -> Found | None:
    normal = adaptor.Plane().Axis().Direction()
    if abs(normal.Z()) < 1 - 1e-12:
        return None
    return surfaces.plane(), float(points[0, 2]), "plane, exact"


def _sphere(adaptor: Any, points: Floats) -> Found:
    ball = adaptor.Sphere()
    centre = _coordinates(ball.Location())
    radius = ball.Radius() * (1.0 if points[:, 2].mean() > centre[2] else -1.0)
    surface = surfaces.sphere(radius, decentration=(float(centre[0]), float(centre[1])))
    return surface, float(centre[2] + radius), f"sphere, radius {radius:.7g} mm, exact"


def _torus(adaptor: Any, points: Floats) -> Found | None:
    """A torus whose axis of revolution lies across z: the arc along that axis, turned about it."""
    ring = adaptor.Torus()
    axis, centre = ring.Axis().Direction(), _coordinates(ring.Location())
    if abs(axis.Z()) > 1e-9:
        return None
    lowest = points[np.argmin(np.hypot(points[:, 0] - centre[0], points[:, 1] - centre[1]))]
    arcs = [s * ring.MajorRadius() for s in (1, -1)]
    reach, arc = min(
        ((arc + s * ring.MinorRadius(), arc) for arc in arcs for s in (1, -1)),
        key=lambda pair: abs(centre[2] + pair[0] - lowest[2]),
    )
    angle = float(np.degrees(np.arctan2(axis.Y(), axis.X())) % 180)
    along, across = 1 / (reach - arc), 1 / reach
    surface = surfaces.toric(along, across, angle, decentration=(float(centre[0]), float(centre[1])))
    word = f"torus, radius {1 / along:.7g} mm along {angle:.4g} degrees, {1 / across:.7g} mm across, exact"
    return surface, float(centre[2] + reach), word


def _graph(adaptor: Any, points: Floats) -> Found | None:
    """A B-spline face whose x grows evenly with u and whose y with v (or the other way round): taken over as it is."""
    patch = adaptor.BSpline()
    if patch.IsURational() or patch.IsVRational() or patch.IsUPeriodic() or patch.IsVPeriodic():
        return None
    degree = patch.UDegree()
    if patch.VDegree() != degree or not 2 <= degree <= 5:
        return None
    shape = patch.NbUPoles(), patch.NbVPoles()
    poles = np.array([_coordinates(patch.Pole(i + 1, j + 1)) for i in range(shape[0]) for j in range(shape[1])])
    poles = poles.reshape(*shape, 3)
    u, v = (
        np.array([knots.Value(k) for k in range(knots.Lower(), knots.Upper() + 1)])
        for knots in (patch.UKnotSequence(), patch.VKnotSequence())
    )
    if np.ptp(poles[..., 0], axis=0).max() < np.ptp(poles[..., 1], axis=0).max():
        poles, u, v = np.swapaxes(poles, 0, 1), v, u
    x, y = (_even(poles[..., 0], u, degree), _even(poles[..., 1].T, v, degree))
    if x is None or y is None:
        return None
    knots_x, knots_y, z = x, y, poles[..., 2].T
    if knots_x[0] > knots_x[-1]:
        knots_x, z = knots_x[::-1], z[:, ::-1]
    if knots_y[0] > knots_y[-1]:
        knots_y, z = knots_y[::-1], z[::-1]
    height = float(np.nan_to_num(surfaces.bspline(knots_x, knots_y, z, degree).sag(0.0, 0.0)))
    word = f"B-spline of degree {degree} with {z.shape[1]} x {z.shape[0]} poles, exact"
    return surfaces.bspline(knots_x, knots_y, z - height, degree, note=word), height, word


def _even(poles: Floats, knots: Floats, degree: int) -> Floats | None:
    """The knots in mm, if the coordinate poles (n, m) grow evenly with the parameter and alike for all m; else None."""
    greville = knot_averages(knots, degree)
    slope = (poles[-1, 0] - poles[0, 0]) / (greville[-1] - greville[0])
    wanted = poles[0, 0] + slope * (greville - greville[0])
    if slope == 0 or np.abs(poles - wanted[:, None]).max() > 1e-9:
        return None
    return np.asarray(poles[0, 0] + slope * (knots - greville[0]), dtype=float)


def _refitted(path: Path, points: Floats) -> Found:
    fit = fitted_points(points[:, 0], points[:, 1], points[:, 2], KNOT_PITCH)
    rms, worst = float(np.std(fit.residuals)), float(np.abs(fit.residuals).max())
    if not worst <= MOST_MISFIT:
        raise InputError(
            f"{path}: a large face is not a smooth sag along z: it misses a smooth surface by {worst:.2g} mm"
        )
    word = f"refitted B-spline, residual {rms * 1e6:.2g} nm rms, {worst * 1e6:.2g} nm at most"
    return replace(fit.surface, note=word), fit.height, word


def _sampled(face: Any, adaptor: Any) -> Floats:
    """Points (SAMPLES^2, 3) of the face's surface over its range of u and v."""
    u0, u1, v0, v1 = _bounds(face)
    grid = [(u, v) for u in np.linspace(u0, u1, SAMPLES).tolist() for v in np.linspace(v0, v1, SAMPLES).tolist()]
    return np.array([_coordinates(adaptor.Value(u, v)) for u, v in grid])


def _edge(face: Any) -> Floats:
    """Points (k, 2), mm, along the outer edge of a face."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
    from OCP.TopAbs import TopAbs_Orientation

    explorer = BRepTools_WireExplorer(BRepTools.OuterWire_s(face), face)
    points: list[Floats] = []
    while explorer.More():
        edge = explorer.Current()
        curve = BRepAdaptor_Curve(edge)
        steps = np.linspace(curve.FirstParameter(), curve.LastParameter(), 361)[:-1]
        forward = edge.Orientation() == TopAbs_Orientation.TopAbs_FORWARD
        ordered = steps if forward else np.linspace(curve.LastParameter(), curve.FirstParameter(), 361)[:-1]
        points.extend(_coordinates(curve.Value(float(t)))[:2] for t in ordered)
        explorer.Next()
    return np.array(points)


def _coordinates(point: Any) -> Floats:
    return np.array([point.X(), point.Y(), point.Z()])
