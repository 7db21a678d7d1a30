"""A design against a measured power map of it: differences at the measured points."""

import numpy as np

from .errors import InputError
from .layers import AgainstLayer, Deviation
from .optics.conventions import Floats, Status, astigmatism, mean_power, power_matrix, power_vector
from .optics.eye import Wearer
from .optics.gaze import look_through
from .optics.lens import Lens
from .optics.lensmeter import back_vertex_power


def deviation(lens: Lens, wearer: Wearer, layer: AgainstLayer) -> Deviation:
    """Measured less designed power at the measured points within the outline. Raises InputError where none lies there."""
    measured = layer.measured
    x, y = (a.ravel() for a in np.meshgrid(measured.x, measured.y))
    inside = lens.outline.contains(x, y)
    power, status = _designed(lens, wearer, layer, x[inside], y[inside])
    known = measured.mean.ravel()[inside], measured.astigmatism.ravel()[inside], measured.axis.ravel()[inside]
    mean, astigmatic = known[0] - mean_power(power), _astigmatic_difference(power, known[1], known[2])
    if not (np.isfinite(mean).any() or np.isfinite(astigmatic).any()):
        raise InputError(
            f"{measured.source}: no measured point lies where the lens has a power; do its x and y count from it?"
        )
    shape = measured.mean.shape
    all_status = np.full(inside.size, np.int8(Status.OUTSIDE_OUTLINE))
    all_status[inside] = status
    grids = (_spread(values, inside, shape) for values in (mean, astigmatic))
    return Deviation(layer, measured.x, measured.y, *grids, all_status.reshape(shape))


def _spread(values: Floats, inside: np.ndarray, shape: tuple[int, ...]) -> Floats:
    grid = np.full(inside.size, np.nan)
    grid[inside] = values
    return grid.reshape(shape)


def _designed(lens: Lens, wearer: Wearer, layer: AgainstLayer, x: Floats, y: Floats) -> tuple[Floats, np.ndarray]:
    """Power matrices (n, 2, 2), D, of the design as the map was measured, and their status."""
    if layer.by == "lensmeter":
        reading = back_vertex_power(lens, x, y)
        return reading.power, reading.status
    if layer.by == "worn":
        field = look_through(lens, wearer, x, y)
        return field.as_worn_matrix(layer.distance), field.status
    raise InputError(f"a map is measured by lensmeter or worn, not {layer.by!r}")


def _astigmatic_difference(power: Floats, amount: Floats, axis: Floats) -> Floats:
    """Magnitude (n,) D of the astigmatic difference; without an axis the difference of the two amounts."""
    other = power_matrix(amount / 2, -amount, np.nan_to_num(axis))
    _, j0, j45 = power_vector(other - power)
    return np.where(np.isfinite(axis), 2 * np.hypot(j0, j45), np.abs(amount - astigmatism(power)))
