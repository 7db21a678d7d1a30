"""STL, OBJ and PLY meshes of a lens: the vertices of the two caps, refitted by smooth surfaces. Needs trimesh.

A facet has no curvature, so powers come from the surface through the vertices; what a mesh has no unit for is mm.
"""

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, LensBenchError
from ..optics.conventions import Floats
from ..optics.lens import Lens
from ..optics.polar_mesh import lens_triangles
from ..optics.scattered import PointFit, fitted_points
from .body import Body, BodySurface, Face, Place, body_of, the_lens
from .registry import HEAD, Writing, Written
from .text import decoded, read_bytes

FLATTEST_EDGE = np.radians(30.0)  # between the normals of two facets of one cap
STEEP = 0.5  # least |z| of a facet's unit normal to belong to a cap
CELLS = 4.0, 2.5, 1.6, 1.0  # mm
FEWEST_VERTICES = 60
NOISE = 9000.0  # power noise in D: NOISE (n - 1) rms spacing / cell^3, mm; the factor was found by fitting noisy points


def sniff(head: bytes, text: str) -> float:
    """PLY by its first line, ASCII STL by "solid" and "facet", OBJ by vertex lines, binary STL by its first facets."""
    return 0.9 if _kind(head, text) else 0.0


def read(path: Path) -> tuple[Body | BodySurface, ...]:
    """The lens body and its one or two surfaces. Raises InputError."""
    body = read_mesh(path)
    return body, *body.surfaces()


def write(things: tuple[Any, ...], writing: Writing) -> Written:
    """A lens as binary STL. Raises InputError."""
    return Written(
        stl_bytes(the_lens(things, "STL")), "closed mesh, mm, z towards the scene, back vertex at the origin"
    )


def _kind(head: bytes, text: str) -> str:
    if head.startswith(b"ply"):
        return "ply"
    if text.lstrip().startswith("solid") and "facet" in text:
        return "stl"
    if re.search(r"^v\s+\S+\s+\S+\s+\S+", text, re.MULTILINE) and not re.search(r"^\w+\s*=", text, re.MULTILINE):
        return "obj"
    normal = np.frombuffer(head[84:96], dtype="<f4").astype(float) if len(head) >= 134 else np.zeros(0)
    unit = normal.size == 3 and bool(np.abs(normal).max() <= 1.001) and abs(float(normal @ normal) - 1) < 1e-3
    return "stl" if unit and head[132:134] == b"\0\0" else ""


def read_mesh(path: Path) -> Body:
    """The lens body of a mesh file. Raises InputError."""
    points, faces = _mesh(path)
    size = np.ptp(points, axis=0)
    if not 5 <= size[:2].max() <= 300:
        raise InputError(
            f"{path}: the mesh is {size[0]:.4g} x {size[1]:.4g} across z; meshes have no unit, so write it in mm"
        )
    return body_of(path, lambda place: _caps(path, _moved(points, place), faces))


def _mesh(path: Path) -> tuple[Floats, NDArray[np.intp]]:
    try:
        import trimesh
    except ModuleNotFoundError:
        raise LensBenchError(f'{path}: meshes need another package: pip install "lensbench[scenes]"') from None
    data = read_bytes(path)
    kind = _kind(data[:HEAD], decoded(data[:HEAD]) or "") or path.suffix.lower().lstrip(".")
    try:
        mesh: Any = trimesh.load(io.BytesIO(data), file_type=kind, force="mesh", process=True)
        points, faces = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=np.intp)
    except Exception as error:  # each of trimesh's readers fails in its own way
        raise InputError(f"{path}: not a mesh that can be read: {type(error).__name__}: {error}") from None
    if not len(faces) or not np.isfinite(points).all():
        raise InputError(f"{path}: not a mesh that can be read: it has no facets, or vertices that are no numbers")
    return points, faces


def _moved(points: Floats, place: Place) -> Floats:
    return points * ([-1, 1, -1] if place.turned else [1, 1, 1]) - [place.x, place.y, 0.0]


def _caps(path: Path, points: Floats, faces: NDArray[np.intp]) -> list[Face]:
    """The largest smooth patch of facets across z and, if it is at least half as large, the next."""
    import trimesh

    mesh = trimesh.Trimesh(points, faces, process=False)
    across = np.abs(mesh.face_normals[:, 2]) >= STEEP
    smooth = across[mesh.face_adjacency].all(axis=1) & (mesh.face_adjacency_angles < FLATTEST_EDGE)
    patches = trimesh.graph.connected_components(mesh.face_adjacency[smooth], nodes=np.flatnonzero(across), min_len=1)
    patches = sorted(patches, key=lambda patch: -mesh.area_faces[patch].sum())[:2]
    if not patches:
        raise InputError(f"{path}: has no facets across z; a lens has its axis along z")
    areas = [float(mesh.area_faces[patch].sum()) for patch in patches]
    kept = [k for k in range(len(patches)) if areas[k] >= areas[0] / 2]
    return [_cap(path, points, faces[patches[k]], areas[k]) for k in kept]


def _cap(path: Path, points: Floats, faces: NDArray[np.intp], area: float) -> Face:
    vertices = points[np.unique(faces)]
    if len(vertices) < FEWEST_VERTICES:
        raise InputError(
            f"{path}: a cap has {len(vertices)} vertices; a smooth surface needs {FEWEST_VERTICES} or more: mesh it finer"
        )
    spacing = float(np.sqrt(area / len(vertices)))
    fit, pitch = _finest_worth_while(vertices, spacing)
    rms, worst = float(np.std(fit.residuals)), float(np.abs(fit.residuals).max())
    noise = NOISE * 0.6 * rms * spacing / pitch**3
    word = (
        f"{len(vertices)} vertices, {spacing:.2g} mm apart, refitted by a B-spline of {pitch:.2g} mm cells; residual "
        f"{rms * 1e3:.2g} um rms, {worst * 1e3:.2g} um at most: power noise about {noise:.2g} D rms at n = 1.6, more at "
        "the edge; what the mesh does not show between its vertices is not known"
    )
    return Face(fit.surface, fit.height, area, _rim(points, faces), word)


def _finest_worth_while(vertices: Floats, spacing: float) -> tuple[PointFit, float]:
    """The fit of the finest cells (mm), at least two vertices wide, that still lower the residual by a fifth at each step.

    Below that the cells would follow the noise of the vertices.
    """
    x, y, z = vertices.T
    pitch = max(CELLS[0], 2 * spacing)
    fit = fitted_points(x, y, z, pitch)
    for finer in CELLS[1:]:
        if finer < 2 * spacing:
            break
        other = fitted_points(x, y, z, finer)
        if np.std(other.residuals) > 0.8 * np.std(fit.residuals):
            break
        fit, pitch = other, finer
    return fit, pitch


def _rim(points: Floats, faces: NDArray[np.intp]) -> Floats:
    """Points (k, 2) of the edges that belong to one facet only, in the order of their angle about the middle."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    single, count = np.unique(edges, axis=0, return_counts=True)
    rim = points[np.unique(single[count == 1]), :2]
    middle = (rim.max(axis=0) + rim.min(axis=0)) / 2
    return np.asarray(rim[np.argsort(np.arctan2(*(rim - middle).T[::-1]))], dtype=float)


def stl_bytes(lens: Lens) -> bytes:
    """A closed lens as binary STL, mm, z towards the scene. Coordinates are rounded to 32-bit numbers (2e-6 mm)."""
    points, triangles = lens_triangles(lens)
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    record = np.zeros(len(triangles), dtype=[("vectors", "<f4", (4, 3)), ("spare", "<u2")])
    record["vectors"][:, 0] = normal / np.where(length > 0, length, 1.0)
    record["vectors"][:, 1:] = corners
    title = f"LensBench lens, mm, +z to the scene, {lens.side}".encode("ascii", "replace")[:80].ljust(80)
    return title + np.uint32(len(triangles)).tobytes() + record.tobytes()
