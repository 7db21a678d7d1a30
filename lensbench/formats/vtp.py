"""A lens as VTK XML polygons (.vtp) with its powers, for any program that reads VTK files; written without VTK."""

import base64
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from ..optics.conventions import Floats, astigmatism, mean_power
from ..optics.eye import Wearer
from ..optics.gaze import look_at, worn_pose
from ..optics.lens import Lens, Order
from ..optics.ordered import wearer_as_ordered
from ..optics.polar_mesh import lens_triangles
from ..optics.surfaces import Surface
from .body import the_lens
from .registry import Writing, Written

RINGS, AROUND = 60, 360
FRONT, BACK, EDGE = 0, 1, 2
VTK_TYPES = {"f8": "Float64", "i8": "Int64"}


def write(things: tuple[Any, ...], writing: Writing) -> Written:
    """A lens with its powers, before the wearer among the things or, without one, the wearer whom its order suggests."""
    lens = the_lens(things, "VTK")
    wearer = next((thing for thing in things if isinstance(thing, Wearer)), None)
    text = vtp_text(lens, wearer or wearer_as_ordered(lens.ordered or Order()))
    said = "polygons in mm, z towards the scene, with thickness, surface and as-worn powers for far objects"
    return Written(text, said)


def vtp_text(lens: Lens, wearer: Wearer, distance: float = np.inf) -> str:
    """The closed skin of a lens in its own frame, mm, as VTK XML PolyData.

    Point arrays: lens_arrays at the point's x and y. Cell array part: 0 front, 1 back, 2 edge.
    """
    points, triangles = lens_triangles(lens, RINGS, AROUND)
    x, y = points[: len(points) // 2, :2].T
    arrays = lens_arrays(lens, x, y, wearer, distance)
    caps = (len(triangles) - 2 * AROUND) // 2
    part = np.repeat([FRONT, BACK, EDGE], [caps, caps, 2 * AROUND])
    return _polydata(points, triangles, {name: np.tile(values, 2) for name, values in arrays.items()}, {"part": part})


def lens_arrays(
    lens: Lens, x: Floats, y: Floats, wearer: Wearer | None = None, distance: float = np.inf
) -> dict[str, Floats]:
    """What a lens is and does at lens points x, y (n,) mm, by name with its unit; NaN where there is no value.

    thickness_mm along the lens's axis; front_ and back_ mean_power_D and astigmatism_D (surface powers); for a wearer
    as_worn_mean_power_D and as_worn_astigmatism_D through that point of the front, for objects at `distance` mm.
    """
    arrays = {"thickness_mm": lens.thickness(x, y)}
    for name, surface, sign in (("front", lens.front, 1), ("back", lens.back, -1)):
        power = sign * _surface_power(surface, x, y, lens.index)
        arrays |= {f"{name}_mean_power_D": mean_power(power), f"{name}_astigmatism_D": astigmatism(power)}
    if wearer is not None:
        front = worn_pose(lens, wearer.wear).to_wear(np.column_stack([x, y, lens.front_height(x, y)]))
        worn = look_at(lens, wearer, front, within_outline=False).as_worn_matrix(distance)
        arrays |= {"as_worn_mean_power_D": mean_power(worn), "as_worn_astigmatism_D": astigmatism(worn)}
    return arrays


def _surface_power(surface: Surface, x: Floats, y: Floats, index: float) -> Floats:
    return surface.surface_power(x - surface.decentration[0], y - surface.decentration[1], index)


def _polydata(
    points: Floats, triangles: NDArray[np.intp], point_data: dict[str, Floats], cell_data: dict[str, NDArray[np.intp]]
) -> str:
    offsets = 3 * np.arange(1, len(triangles) + 1)
    return f"""<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData>
<Piece NumberOfPoints="{len(points)}" NumberOfPolys="{len(triangles)}">
<Points>{_array("Points", points)}</Points>
<Polys>{_array("connectivity", triangles)}{_array("offsets", offsets)}</Polys>
<PointData>{"".join(_array(name, values) for name, values in point_data.items())}</PointData>
<CellData>{"".join(_array(name, values) for name, values in cell_data.items())}</CellData>
</Piece>
</PolyData>
</VTKFile>
"""


def _array(name: str, values: NDArray[np.generic]) -> str:
    """One DataArray: base64 of its length in bytes and its values, little-endian."""
    kind = "i8" if values.dtype.kind in "iu" else "f8"
    raw = np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()
    text = base64.b64encode(np.uint64(len(raw)).astype("<u8").tobytes() + raw).decode()
    columns = values.shape[1] if values.ndim == 2 and name == "Points" else 1
    return (
        f"<DataArray type={quoteattr(VTK_TYPES[kind])} Name={quoteattr(name)} "
        f'NumberOfComponents="{columns}" format="binary">{text}</DataArray>\n'
    )
