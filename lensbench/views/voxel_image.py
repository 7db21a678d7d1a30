"""The blur field of a view frustum as a VTK image (.vti), for ParaView and PyVista."""

from typing import Any

import numpy as np
import pyvista as pv
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from ..layers import VoxelField
from ..optics.conventions import Floats
from ..optics.field import ellipse
from ..output import to_json


def voxel_image(voxels: VoxelField, about: dict[str, Any]) -> pv.ImageData:
    """The frustum as a box of NDC: x to the wearer's left and y up from -1 to 1, z from 0 (near) to 1 (far).

    Point data: blur_mm and ndc (M11, M12, M21, M22), semi_major_mm, semi_minor_mm, depth_mm, status; field data: about (JSON).
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
    image.field_data["about"] = [to_json(about)]
    return image


def _by_point(matrices: Any) -> Floats:
    """Matrices (2, 2, ny, nx, nz) as (n, 4), x fastest, z slowest."""
    return np.moveaxis(matrices.reshape(4, *matrices.shape[2:]), (0, 3), (3, 0)).reshape(-1, 4)


def voxels_vti(voxels: VoxelField, about: dict[str, Any]) -> bytes:
    """The image as the bytes of a .vti file."""
    writer = vtkXMLImageDataWriter()
    writer.SetInputData(voxel_image(voxels, about))
    writer.WriteToOutputStringOn()
    writer.SetDataModeToBinary()
    writer.Write()
    return str(writer.GetOutputString()).encode()
