"""A finished lens against its order: focimeter readings and the tolerances of ANSI Z80.1-2015 for unmounted lenses.

Powers are read at the distance reference point (without one: at the prism reference point), the addition as the
difference of the vertex powers at near and distance reference point, with the surface on the stop that holds more of it,
and the prism at the prism reference point; all by focimeter, none as worn.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats, mean_power, sphere_cylinder_axis
from .lens import Lens, Order
from .lensmeter import back_vertex_power, front_vertex_power, surface_power

STANDARD = "ANSI Z80.1-2015"


@dataclass(frozen=True, slots=True)
class ToleranceLine:
    """One line of a verification: ordered and measured value, deviation (measured less ordered; axis: the smaller angle;
    prism: magnitude of the difference) and the greatest deviation allowed, in `unit`; excess over it, 0 when within.
    """

    name: str
    unit: str
    ordered: float
    measured: float
    deviation: float
    tolerance: float
    within: bool
    excess: float


def verification(lens: Lens) -> tuple[ToleranceLine, ...]:
    """Focimeter readings against the order, line by line; nothing for a lens without an order."""
    order, points = lens.ordered, lens.points
    if order is None:
        return ()
    x, y = points.distance_reference_point or points.prism_reference_point
    lines = power_lines(order, back_vertex_power(lens, x, y).power[0])
    if order.addition and points.near_reference_point is not None:
        tolerance = 0.12 if order.addition <= 4 else 0.18
        lines.append(
            _line("addition", "D", order.addition, measured_addition(lens, points.near_reference_point), tolerance)
        )
    at_prism = back_vertex_power(lens, *points.prism_reference_point)
    lines.append(_prism_line(order, at_prism.prism[0], at_prism.power[0]))
    return tuple(lines)


def power_lines(order: Order, power: Floats) -> list[ToleranceLine]:
    """Lines for the meridian of highest absolute power, the cylinder and its axis, of a power matrix (2, 2) in D."""
    progressive = order.addition > 0
    read = sphere_cylinder_axis(power)
    ordered = sphere_cylinder_axis(order.power())
    k = int(np.argmax(np.abs([ordered.sphere, ordered.sphere + ordered.cylinder])))
    highest, found = (float(p.sphere + k * p.cylinder) for p in (ordered, read))
    size = abs(float(ordered.cylinder))
    limit = _step(abs(highest), ((8.0, 0.16),) if progressive else ((6.5, 0.13),), 0.02)
    lines = [_line("power in the meridian of highest power", "D", highest, found, limit)]
    steps = ((2.0, 0.16), (3.5, 0.18)) if progressive else ((2.0, 0.13), (4.5, 0.15))
    lines.append(
        _line("cylinder", "D", 0.0 - size, float(read.cylinder), _step(size, steps, 0.05 if progressive else 0.04))
    )
    if size >= 0.12:
        allowed = next(degrees for most, degrees in _AXIS if size <= most)
        axis, found = float(ordered.axis), float(read.axis)
        lines.append(_line("axis", "deg", axis, found, allowed, (found - axis + 90) % 180 - 90))
    return lines


_AXIS = ((0.25, 14.0), (0.50, 7.0), (0.75, 5.0), (1.50, 3.0), (np.inf, 2.0))


def measured_addition(lens: Lens, near: tuple[float, float]) -> float:
    """Addition (D): mean vertex power at the near less that at the distance reference point, read on the surface that
    holds more of the addition."""
    far = lens.points.distance_reference_point or lens.points.prism_reference_point
    x, y = np.transpose([far, near])
    on_front, on_back = (
        abs(float(np.diff(mean_power(surface_power(s, x, y, lens.index)))[0])) for s in (lens.front, lens.back)
    )
    read = front_vertex_power if on_front > on_back else back_vertex_power
    return float(np.diff(mean_power(read(lens, x, y).power))[0])


def _prism_line(order: Order, prism: ArrayLike, power: Floats) -> ToleranceLine:
    """0.33 cm/m, or what 1 mm of decentration makes in the meridian of highest power (D, matrix (2, 2))."""
    read, ordered = np.asarray(prism, dtype=float), order.prism_components()
    highest = float(np.abs(np.linalg.eigvalsh(np.nan_to_num(power))).max())
    difference = float(np.linalg.norm(read - ordered))
    return _line("prism", "cm/m", order.prism, float(np.linalg.norm(read)), max(0.33, highest / 10), difference)


def _step(size: float, steps: tuple[tuple[float, float], ...], beyond: float) -> float:
    """The tolerance of the first step that a size (D) does not pass, or that fraction `beyond` of it."""
    return next((limit for most, limit in steps if size <= most), beyond * size)


def _line(
    name: str, unit: str, ordered: float, measured: float, tolerance: float, deviation: float | None = None
) -> ToleranceLine:
    off = measured - ordered if deviation is None else deviation
    excess = abs(off) - tolerance
    within = excess <= 1e-9
    return ToleranceLine(name, unit, ordered, measured, off, tolerance, within, 0.0 if within else excess)
