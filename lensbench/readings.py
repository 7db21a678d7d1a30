"""Readings at the reference points of a lens: as ordered, by focimeter and as worn."""

import numpy as np

from .layers import PointReading
from .optics.conventions import Floats, Status, astigmatism, mean_power, sphere_cylinder_axis
from .optics.eye import Wearer
from .optics.field import GazeField
from .optics.gaze import angles_from_direction, look_through
from .optics.lens import Lens
from .optics.lensmeter import VertexPower, back_vertex_power
from .optics.object_distance import from_cornea


def point_readings(lens: Lens, wearer: Wearer) -> tuple[PointReading, ...]:
    """Readings at the reference points that the lens names. As worn the near reference point is read at the wearer's near
    distance, the others at infinity."""
    points = lens.points.named()
    x, y = np.transpose(list(points.values()))
    field, by_focimeter = look_through(lens, wearer, x, y), back_vertex_power(lens, x, y)
    near = from_cornea(field, wearer.wear.near_distance)
    distances = np.where([name == "near_reference_point" for name in points], near, np.inf)
    return tuple(_reading(field, by_focimeter, k, name, float(distances[k])) for k, name in enumerate(points))


def _reading(field: GazeField, by_focimeter: VertexPower, k: int, name: str, distance: float) -> PointReading:
    """The reading of the k-th ray of a field, which passes a reference point of its lens."""
    lens = field.lens
    assert lens is not None
    x, y = lens.points.named()[name]
    power, prism = field.as_worn_matrix(distance)[k], field.prism()
    azimuth, elevation = (float(np.degrees(a[k])) for a in angles_from_direction(field.directions))
    mean_error, astigmatic_error = _against_order(lens, name, power)
    read, read_prism = by_focimeter.power[k], by_focimeter.prism[k]
    prism_error = None
    if lens.expected_by_focimeter is not None and name == "prism_reference_point":
        prism_error = float(np.linalg.norm(read_prism - lens.expected_by_focimeter.prism_components()))
    return PointReading(
        name,
        x,
        y,
        azimuth,
        elevation,
        distance,
        *(float(v) for v in sphere_cylinder_axis(power)),
        mean_power=float(mean_power(power)),
        astigmatism=float(astigmatism(power)),
        prism=float(prism.prism[k]),
        prism_base=float(prism.base[k]),
        mean_error=mean_error,
        astigmatic_error=astigmatic_error,
        prism_error=prism_error,
        lensmeter_sphere=float(sphere_cylinder_axis(read).sphere),
        lensmeter_cylinder=float(sphere_cylinder_axis(read).cylinder),
        lensmeter_axis=float(sphere_cylinder_axis(read).axis),
        lensmeter_prism=float(np.hypot(*read_prism)),
        lensmeter_prism_base=float(np.degrees(np.arctan2(*read_prism[::-1])) % 360),
        status=Status(field.status[k]).name,
    )


def _against_order(lens: Lens, name: str, power: Floats) -> tuple[float, float] | tuple[None, None]:
    """Mean and astigmatic difference (D) of a power matrix to the order at a reference point; None where none is ordered."""
    if lens.ordered is None or name not in ("distance_reference_point", "near_reference_point"):
        return None, None
    error = power - lens.ordered.power(near=name == "near_reference_point")
    return float(mean_power(error)), float(astigmatism(error))
