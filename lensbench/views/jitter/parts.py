"""A scene's parts as VTK actors: unlit, textures as they are."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataObject, vtkImageData, vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkTexture

from ...errors import LensBenchError
from ...layers import SeenPart
from ...optics.conventions import Floats, unit
from ...optics.lens_edge import LensEdge
from ...scenes.scene import Part
from .light import Pixels

RIM_COLOUR, RIM_WIDTH = (46, 48, 52), 0.012


def part_actor(part: Part, texture: vtkTexture) -> vtkActor:
    """The part where it stands in the scene."""
    return _actor(_mesh(part.points, part.triangles, part.uv), texture)


def vertex_actor(seen: SeenPart, texture: vtkTexture) -> vtkActor:
    """The part with each vertex's gaze and spread, without the triangles that have a vertex which no ray meets."""
    part = seen.part
    known = np.isfinite(seen.gaze).all(axis=1) & np.isfinite(seen.spread).all(axis=(1, 2))
    mesh = _mesh(part.points, part.triangles[known[part.triangles].all(axis=1)], part.uv)
    actor = _actor(mesh, texture)
    values = {"jitGaze": seen.gaze, "jitSpreadX": seen.spread[..., 0], "jitSpreadY": seen.spread[..., 1]}
    for name, array in values.items():
        mesh.GetPointData().AddArray(_vtk_array(name, np.nan_to_num(array)))
        actor.GetMapper().MapDataArrayToVertexAttribute(name, name, vtkDataObject.FIELD_ASSOCIATION_POINTS, -1)
    return actor


def twin_of(actor: Any) -> vtkActor:
    """An actor like another, with a mapper of its own. Raises LensBenchError for one that does not draw polygons."""
    mesh = actor.GetMapper().GetInput()
    if not isinstance(mesh, vtkPolyData):
        raise LensBenchError("only actors that draw a vtkPolyData are seen through the lens")
    mapper, twin = vtkPolyDataMapper(), vtkActor()
    mapper.ShallowCopy(actor.GetMapper())
    mapper.SetInputData(mesh)
    twin.ShallowCopy(actor)
    twin.SetMapper(mapper)
    return twin


def rim_actor(edge: LensEdge) -> vtkActor:
    """A dark line of even width along the lens's edge, as directions in the head's frame."""
    curve = unit(edge.directions())
    outwards = unit(np.cross(np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0), curve))
    points = np.concatenate([curve - RIM_WIDTH / 2 * outwards, curve + RIM_WIDTH / 2 * outwards])
    n = edge.radius.size
    inner, after = np.arange(n), (np.arange(n) + 1) % n
    triangles = np.concatenate([np.stack([inner, after, n + after], 1), np.stack([inner, n + after, n + inner], 1)])
    actor = _actor(_mesh(points, triangles, np.zeros((2 * n, 2))), None)
    actor.GetProperty().SetColor(*(code / 255 for code in RIM_COLOUR))
    return actor


def _actor(mesh: vtkPolyData, texture: vtkTexture | None) -> vtkActor:
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(mesh)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    actor.SetTexture(texture)
    return actor


def _mesh(points: Floats, triangles: NDArray[np.int64], uv: Floats) -> vtkPolyData:
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtk(np.arange(0, triangles.size + 1, 3, dtype=np.int64), deep=True),
        numpy_to_vtk(triangles.astype(np.int64).ravel(), deep=True),
    )
    places = vtkPoints()
    places.SetData(_vtk_array("points", points))
    mesh = vtkPolyData()
    mesh.SetPoints(places)
    mesh.SetPolys(cells)
    mesh.GetPointData().SetTCoords(_vtk_array("uv", uv))
    return mesh


def _vtk_array(name: str, values: Floats) -> Any:
    array = numpy_to_vtk(np.ascontiguousarray(values, dtype=np.float32), deep=True)
    array.SetName(name)
    return array


def image_texture(image: Pixels) -> vtkTexture:
    """The image (h, w, 3) as it is: no mipmaps, whose blur no number of passes would remove."""
    height, width = image.shape[:2]
    data = vtkImageData()
    data.SetDimensions(width, height, 1)
    data.GetPointData().SetScalars(numpy_to_vtk(image[::-1].reshape(-1, image.shape[2]), deep=True))
    texture = vtkTexture()
    texture.SetInputData(data)
    texture.InterpolateOn()
    texture.MipmapOff()
    texture.RepeatOff()
    texture.EdgeClampOn()
    return texture
