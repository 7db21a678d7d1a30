"""What the workbench finds, as PyVista meshes with their numbers: lenses, maps, rays, focal lines, ellipses, scenes.

Lengths in mm. A lens lies in its own frame or, for a position of wear, where it is worn; everything else lies in the wear
frame. The name of an array ends in its unit; NaN where there is no value.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pyvista as pv
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import RegularGridInterpolator
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter, vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

from ..formats.vtp import lens_arrays
from ..layers import EllipseSheet, LensMap, VoxelField
from ..optics.bundle import trace_pupil
from ..optics.conventions import Floats, Status
from ..optics.eye import Wear, Wearer
from ..optics.field import Accommodation, GazeField, ellipse
from ..optics.foci import Foci, foci
from ..optics.gaze import angles_from_direction, worn_pose
from ..optics.lens import Lens
from ..optics.polar_mesh import polar_faces, polar_points
from ..optics.pupil import Pupil, gauss_pupil
from ..output import to_json
from ..scenes.scene import Part, Scene
from .bands import extended, is_cyclic

# ---- the lens ----


class LensMesh(NamedTuple):
    """The lens's skin, mm: front and back surface and the edge between them (back rim first, then front rim).

    points (n, 2): x, y in the lens frame of the vertices of front and of back; faces: their polygons (m, k).
    """

    front: pv.PolyData
    back: pv.PolyData
    edge: pv.PolyData
    points: Floats
    faces: tuple[NDArray[np.intp], ...]


def lens_mesh(lens: Lens, wear: Wear | None = None, rings: int = 40, around: int = 240) -> LensMesh:
    """Meshes of a lens on a polar grid within its outline; in the lens frame, or as worn in the wear frame."""
    points = polar_points(lens.outline, rings, around)
    heights = lens.front_height(*points.T), lens.back_height(*points.T)
    front, back = (np.column_stack([points, z]) for z in heights)
    if wear is not None:
        pose = worn_pose(lens, wear)
        front, back = pose.to_wear(front), pose.to_wear(back)
    exists = np.isfinite(front[:, 2]) & np.isfinite(back[:, 2])
    faces = tuple(f[exists[f].all(axis=1)] for f in polar_faces(rings, around))
    here = np.arange(around)
    strip = np.stack([here, np.roll(here, -1), np.roll(here, -1) + around, here + around], axis=-1)
    edge = np.concatenate([back[-around:], front[-around:]])
    strip = strip[np.tile(exists[-around:], 2)[strip].all(axis=1)]
    return LensMesh(*(_skin(p, f) for p, f in ((front, faces), (back, faces), (edge, (strip,)))), points, faces)


def lens_blocks(lens: Lens, wearer: Wearer | None = None, distance: float = np.inf) -> pv.MultiBlock:
    """Blocks front, back and edge of a lens; front and back with its thickness and powers: see formats.vtp.lens_arrays.

    For a wearer as worn, with the as-worn powers for objects at `distance` mm; else in the lens frame.
    """
    mesh = lens_mesh(lens, wearer.wear if wearer else None)
    for name, values in lens_arrays(lens, *mesh.points.T, wearer, distance).items():
        mesh.front.point_data[name] = mesh.back.point_data[name] = values
    return pv.MultiBlock({"front": mesh.front, "back": mesh.back, "edge": mesh.edge})


def _polygons(points: Floats, faces: Iterable[NDArray[np.intp]]) -> pv.PolyData:
    """A mesh of polygons (m, k); points that do not exist (NaN) belong to no polygon."""
    used = np.concatenate([np.insert(f, 0, f.shape[1], axis=1).ravel() for f in faces])
    return pv.PolyData(np.where(np.isfinite(points), points, 0.0), faces=used)


def _skin(points: Floats, faces: Iterable[NDArray[np.intp]]) -> pv.PolyData:
    """The same with normals at its points."""
    mesh = _polygons(points, faces)
    return mesh.compute_normals(cell_normals=False, consistent_normals=False) if mesh.n_cells else mesh


# ---- maps ----


def map_mesh(lens: Lens, lens_map: LensMap, wear: Wear | None = None) -> pv.PolyData:
    """The front surface where a map has values, with them in the map's unit as the point array `lens_map.column`.

    An axis is a cell array: between two points of it nothing may be interpolated.
    """
    return map_and_rest(lens_mesh(lens, wear), lens_map)[0].clean(point_merging=False)


def map_and_rest(mesh: LensMesh, lens_map: LensMap) -> tuple[pv.PolyData, pv.PolyData]:
    """The part of a front surface where a map has values, with them (see map_mesh), and the part where it has none."""
    values = sampled(lens_map, mesh.points)
    covered = [np.isfinite(values)[f].all(axis=1) for f in mesh.faces]
    layer, rest = (
        _skin(mesh.front.points, [f[c == wanted] for f, c in zip(mesh.faces, covered, strict=True)])
        for wanted in (True, False)
    )
    if is_cyclic(lens_map.quantity):
        faces = [f[c] for f, c in zip(mesh.faces, covered, strict=True)]
        layer.cell_data[lens_map.column] = sampled(lens_map, _middles(mesh.points, faces))
    else:
        layer.point_data[lens_map.column] = values
    return layer, rest


def sampled(lens_map: LensMap, points: Floats) -> Floats:
    """The map's values (n,) at lens points (n, 2): bilinear, or the nearest sample of a cyclic quantity."""
    grid, method = (lens_map.y, lens_map.x), "nearest" if is_cyclic(lens_map.quantity) else "linear"
    values = RegularGridInterpolator(grid, extended(lens_map), method=method)
    return values(np.clip(points, [lens_map.x[0], lens_map.y[0]], [lens_map.x[-1], lens_map.y[-1]])[:, ::-1])


def _middles(points: Floats, faces: Sequence[NDArray[np.intp]]) -> Floats:
    return np.concatenate([points[f].mean(axis=1) for f in faces])


def map_solid(lens: Lens, lens_map: LensMap, wear: Wear | None = None) -> pv.UnstructuredGrid:
    """The body of the lens, wedges and hexahedra from back to front, with a map's values at the x and y of the front."""
    mesh = lens_mesh(lens, wear)
    half = len(mesh.points)
    cells = [np.concatenate([f, f + half], axis=1) for f in mesh.faces]
    points = np.concatenate([np.asarray(mesh.back.points), np.asarray(mesh.front.points)])
    solid = pv.UnstructuredGrid(dict(zip((pv.CellType.WEDGE, pv.CellType.HEXAHEDRON), cells, strict=True)), points)
    if is_cyclic(lens_map.quantity):
        solid.cell_data[lens_map.column] = sampled(lens_map, _middles(mesh.points, mesh.faces))
    else:
        solid.point_data[lens_map.column] = np.tile(sampled(lens_map, mesh.points), 2)
    return solid


def map_image(lens_map: LensMap) -> pv.ImageData:
    """A map's own samples as an image in the plane z = 0 of the lens frame, with the status of each (optics Status)."""
    axes = lens_map.x, lens_map.y
    spacing = [float(np.ptp(a)) / max(a.size - 1, 1) for a in axes]
    image = pv.ImageData(
        dimensions=(axes[0].size, axes[1].size, 1), spacing=(*spacing, 1.0), origin=(axes[0][0], axes[1][0], 0.0)
    )
    image.point_data[lens_map.column] = lens_map.values.ravel()
    image.point_data["status"] = lens_map.status.ravel()
    return image


# ---- rays ----


def rays(field: GazeField, distance: ArrayLike) -> pv.PolyData:
    """Chief rays that passed: from the pupil's centre through the lens to `distance` mm (a number or (n,)) beyond it.

    Cell arrays: azimuth_deg and elevation_deg of the gaze, gaze (its number in the field).
    """
    pupil = field.wearer.centre_of_rotation + field.wearer.eye.pupil_from_rotation * field.directions
    end = field.origin + np.broadcast_to(distance, field.status.shape)[:, None] * field.direction
    bends = [pupil, end] if field.lens is None else [pupil, field.entry, field.origin, end]
    return _gaze_lines(field, np.stack(bends, axis=1), np.arange(len(end)))


def pupil_rays(
    field: GazeField, distance: float, accommodation: Accommodation = 0.0, pupil: Pupil | None = None
) -> pv.PolyData:
    """Real rays that the eye, by default relaxed, sends through the whole pupil, to `distance` mm beyond the lens.

    accommodation: D, or the rule for an object at that distance. pupil: see optics.pupil. Cell arrays as of `rays`.
    """
    start, traced = trace_pupil(field, field.vergence(distance, accommodation), pupil or gauss_pupil())
    end = traced.exit + distance * traced.direction
    bends = [start, end] if field.lens is None else [start, traced.entry, traced.exit, end]
    gaze = np.repeat(np.arange(start.shape[0]), start.shape[1])
    return _gaze_lines(field, np.stack(bends, axis=2).reshape(len(gaze), -1, 3), gaze)


def focal_lines(field: GazeField, accommodation: Accommodation = 0.0) -> pv.PolyData:
    """The focal lines before the lens of the eye's pencils (see optics.foci), each as long as the pupil makes it.

    Cell arrays: distance_mm from the lens's front along the ray; focus (0: the more convergent one); those of `rays`.
    """
    found = foci(field, accommodation)
    centre = field.origin[:, None] + found.distance[..., None] * field.direction[:, None]
    shape = ellipse(found.blur)
    along = np.stack([np.cos(shape.orientation), np.sin(shape.orientation)], axis=-1)
    half = shape.semi_major[..., None] * (along @ field.frame[:, :2])
    ends = np.stack([centre - half, centre + half], axis=2)
    ahead = np.where((found.distance > 0)[..., None, None], ends, np.nan).reshape(-1, 2, 3)
    lines = _gaze_lines(field, ahead, np.repeat(np.arange(len(centre)), 2))
    there = np.isfinite(ahead).all(axis=(1, 2))
    lines.cell_data["distance_mm"] = found.distance.ravel()[there]
    lines.cell_data["focus"] = np.tile([0, 1], len(centre))[there]
    return lines


def caustic(field: GazeField, accommodation: Accommodation = 0.0, farthest: float = np.inf) -> pv.MultiBlock:
    """The two sheets on which the foci of a grid of gazes lie, as far as `farthest` mm along the rays.

    Blocks "first" (the more convergent focus) and "second"; point arrays distance_mm and interval_D, the difference of the
    two vergences. Raises ValueError for a field that is no grid.
    """
    if len(field.shape) != 2:
        raise ValueError("a caustic has sheets over a grid of gazes only: trace a GazeGrid")
    found = foci(field, accommodation)
    number = np.arange(len(field.status)).reshape(field.shape)
    corners = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    quads = np.stack([c.ravel() for c in corners], axis=-1)
    return pv.MultiBlock({name: _sheet(field, found, k, quads, farthest) for k, name in enumerate(("first", "second"))})


def _sheet(field: GazeField, found: Foci, k: int, quads: NDArray[np.intp], farthest: float) -> pv.PolyData:
    distance = found.distance[:, k]
    there = (distance > 0) & np.isfinite(distance) & (distance <= farthest)
    sheet = _skin(field.origin + distance[:, None] * field.direction, [quads[there[quads].all(axis=1)]])
    sheet.point_data["distance_mm"] = distance
    sheet.point_data["interval_D"] = 1000 * np.abs(np.subtract(*(1 / found.distance.T)))
    return sheet.clean(point_merging=False)


def _gaze_lines(field: GazeField, paths: Floats, gaze: NDArray[np.intp]) -> pv.PolyData:
    """Those lines (n, k, 3) that exist, with the numbers (n,) and angles of the gazes to which they belong."""
    there = np.isfinite(paths).all(axis=(1, 2))
    count = paths.shape[1]
    index = np.arange(there.sum() * count).reshape(-1, count)
    lines = pv.PolyData(paths[there].reshape(-1, 3), lines=np.insert(index, 0, count, axis=1).ravel())
    azimuth, elevation = angles_from_direction(field.directions[gaze[there]])
    lines.cell_data["azimuth_deg"], lines.cell_data["elevation_deg"] = np.degrees(azimuth), np.degrees(elevation)
    lines.cell_data["gaze"] = gaze[there]
    return lines


# ---- ellipses of confusion ----


def ellipses(sheets: Iterable[EllipseSheet], wearer: Wearer, exaggeration: float = 1.0) -> pv.MultiBlock:
    """Ellipses of confusion, a block a depth ("270 mm"); see ellipse_mesh."""
    return pv.MultiBlock({f"{sheet.depth:g} mm": ellipse_mesh(sheet, wearer, exaggeration) for sheet in sheets})


def ellipse_mesh(sheet: EllipseSheet, wearer: Wearer, exaggeration: float = 1.0) -> pv.PolyData:
    """The ellipses of one depth, a polygon each, exaggerated about their true centres.

    Cell arrays, of the ellipses in their true size: semi_major_mm, semi_minor_mm, orientation_deg, accommodation_D,
    diameter_arcmin (the major one seen from the eye's centre of rotation), gaze (number in the sheet).
    """
    outlines, passed = ellipse_outlines(sheet, exaggeration), passing(sheet)
    index = np.arange(outlines.shape[0] * outlines.shape[1]).reshape(outlines.shape[:2])
    mesh = _polygons(outlines.reshape(-1, 3), [index])
    numbers = {
        "semi_major_mm": sheet.semi_major,
        "semi_minor_mm": sheet.semi_minor,
        "orientation_deg": np.degrees(sheet.orientation),
        "accommodation_D": sheet.accommodation,
        "diameter_arcmin": angular_diameters(sheet, wearer),
        "gaze": np.arange(passed.size),
    }
    for name, values in numbers.items():
        mesh.cell_data[name] = values[passed]
    return mesh


def angular_diameters(sheet: EllipseSheet, wearer: Wearer) -> Floats:
    """Major diameter of each ellipse (n,) seen from the eye's centre of rotation, arcmin."""
    away = np.linalg.norm(sheet.centre - wearer.centre_of_rotation, axis=1)
    return np.degrees(2 * np.arctan(sheet.semi_major / away)) * 60


def ellipse_outlines(sheet: EllipseSheet, exaggeration: float = 1.0, corners: int = 24) -> Floats:
    """Outlines (m, corners, 3) of the ellipses of the rays that passed, mm, wear frame, about their true centres."""
    turn = np.arange(corners) * 2 * np.pi / corners
    rim = exaggeration * sheet.spokes @ np.stack([np.cos(turn), np.sin(turn)])
    outlines = sheet.centre[:, None] + np.swapaxes(rim, 1, 2)
    return outlines[passing(sheet)]


def passing(sheet: EllipseSheet) -> NDArray[np.bool_]:
    """Which rays (n,) passed and meet the sheet."""
    numbers = np.column_stack([sheet.centre, sheet.spokes.reshape(-1, 6), sheet.semi_major])
    return (sheet.status == Status.OK) & np.isfinite(numbers).all(axis=1)


def voxel_image(voxels: VoxelField) -> pv.ImageData:
    """The frustum as a box of NDC: x to the wearer's left and y up from -1 to 1, z from 0 (near) to 1 (far).

    Point data: blur_mm and ndc (M11, M12, M21, M22), semi_major_mm, semi_minor_mm, depth_mm, status.
    """
    shape = np.array([voxels.u.size, voxels.v.size, voxels.depth.size])
    size = np.array([2.0, 2.0, 1.0])
    image = pv.ImageData(dimensions=shape, spacing=size / np.maximum(shape - 1, 1), origin=(-1.0, -1.0, 0.0))
    matrices = _by_point(voxels.blur)
    shapes = ellipse(matrices.reshape(-1, 2, 2))
    image.point_data["blur_mm"] = matrices
    if voxels.ndc is not None:
        image.point_data["ndc"] = _by_point(voxels.ndc)
    image.point_data["semi_major_mm"] = shapes.semi_major.astype(np.float32)
    image.point_data["semi_minor_mm"] = shapes.semi_minor.astype(np.float32)
    image.point_data["depth_mm"] = np.repeat(voxels.depth, shape[0] * shape[1]).astype(np.float32)
    image.point_data["status"] = np.tile(voxels.status.ravel(), shape[2])
    return image


def _by_point(matrices: Any) -> Floats:
    """Matrices (2, 2, ny, nx, nz) as (n, 4), x fastest, z slowest."""
    return np.moveaxis(matrices.reshape(4, *matrices.shape[2:]), (0, 3), (3, 0)).reshape(-1, 4)


# ---- scenes and files ----


def scene_blocks(scene: Scene) -> pv.MultiBlock:
    """A block for each part of a scene, with texture coordinates; `texture` gives what is painted on it."""
    return pv.MultiBlock({part.name: _part_mesh(part) for part in scene.parts})


def _part_mesh(part: Part) -> pv.PolyData:
    mesh = _polygons(part.points, (part.triangles,))
    mesh.active_texture_coordinates = part.uv
    return mesh


def texture(part: Part) -> pv.Texture:
    """What is painted on a part of a scene."""
    return pv.Texture(np.asarray(part.image))


_WRITERS = {
    pv.PolyData: vtkXMLPolyDataWriter,
    pv.UnstructuredGrid: vtkXMLUnstructuredGridWriter,
    pv.ImageData: vtkXMLImageDataWriter,
}


def vtk_file(mesh: pv.DataSet, about: Mapping[str, Any]) -> bytes:
    """A mesh as the bytes of a VTK XML file (.vtp, .vtu, .vti: by its kind). about: what the field array "about" says, JSON."""
    told = mesh.copy(deep=False)
    told.field_data["about"] = [to_json(about, ascii_only=True)]
    writer = _WRITERS[type(mesh)]()
    writer.SetInputData(told)
    writer.WriteToOutputStringOn()
    writer.SetDataModeToBinary()
    writer.Write()
    return str(writer.GetOutputString()).encode()
