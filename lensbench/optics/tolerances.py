"""A finished lens by focimeter against its order, or the verification power stated with it, within a table of tolerances.

Powers are read at the distance reference point (without one: at the prism reference point), the addition as the
difference of the vertex powers at near and distance reference point, with the surface on the stop that holds more of it,
and the prism at the prism reference point; all by focimeter, none as worn. The tables are files: formats.tolerance_file.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats, mean_power, sphere_cylinder_axis
from .lens import Lens, Order
from .lensmeter import back_vertex_power, front_vertex_power, surface_power


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a table: for sizes up to `up_to` (D) of a lens of up to `power_up_to` (D) the tolerance (D or degrees),
    and a share of the size.
    """

    up_to: float = np.inf
    power_up_to: float = np.inf
    tolerance: float = 0.0
    share: float = 0.0


@dataclass(frozen=True, slots=True)
class Limits:
    """Tolerances of a kind of lens, in steps. prism: cm/m, or what `decentration` mm make in the meridian of highest power."""

    power: tuple[Step, ...]
    cylinder: tuple[Step, ...]
    axis: tuple[Step, ...]
    addition: tuple[Step, ...]
    prism: float
    decentration: float


@dataclass(frozen=True, slots=True)
class Tolerances:
    """A table of tolerances for unmounted lenses. power: what of it is judged, the "sphere" in minus-cylinder form or the
    "highest meridian" (of highest absolute power). axis_from: ordered cylinder (D) from which the axis is judged.
    """

    edition: str
    source: str
    power: str
    axis_from: float
    single_vision: Limits
    progressive: Limits

    def limits(self, order: Order) -> Limits:
        """Those for the kind of lens that an order is for: progressive where it has an addition."""
        return self.progressive if order.addition else self.single_vision


@dataclass(frozen=True, slots=True)
class ToleranceLine:
    """One line of a verification: expected and measured value, deviation (measured less expected; axis: the smaller angle;
    prism: magnitude of the difference) and the greatest deviation allowed, in `unit`; excess over it, 0 when within.

    bases: of a prism, directions of the base (degrees) of the expected and the measured one and of their difference.
    """

    name: str
    unit: str
    expected: float
    measured: float
    deviation: float
    tolerance: float
    within: bool
    excess: float
    bases: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Verification:
    """Focimeter readings against `expected`, line by line, and what could not be read, a sentence each.

    by_verification_power: whether the lens is judged against its verification power rather than its order. compensated:
    the verification power that the order has in a position of wear, where one is known (see optics.compensation).
    """

    edition: str
    source: str
    expected: Order
    by_verification_power: bool
    lines: tuple[ToleranceLine, ...]
    remarks: tuple[str, ...]
    compensated: Order | None = None


def verification(lens: Lens, tolerances: Tolerances) -> Verification | None:
    """Focimeter readings against the verification power or else the order; None for a lens that has neither."""
    expected, points = lens.expected_by_focimeter, lens.points
    if expected is None:
        return None
    limits, remarks = tolerances.limits(expected), []
    lines = power_lines(tolerances, expected, back_vertex_power(lens, *lens.power_point).power[0])
    if expected.addition and points.distance_reference_point is None:
        remarks.append("no distance reference point is named: power read at the prism reference point")
    if expected.addition and points.near_reference_point is None:
        remarks.append(f"addition {expected.addition:.2f} D not read: no near reference point is named")
    elif expected.addition and points.near_reference_point is not None:
        allowed = _allowed(limits.addition, abs(expected.addition), _highest(expected.power()))
        found = measured_addition(lens, points.near_reference_point)
        lines.append(_line("addition", "D", expected.addition, found, allowed))
    at_prism = back_vertex_power(lens, *points.prism_reference_point)
    lines.append(_prism_line(limits, expected, at_prism.prism[0], at_prism.power[0]))
    by_verification_power = lens.verification_power is not None
    return Verification(
        tolerances.edition, tolerances.source, expected, by_verification_power, tuple(lines), tuple(remarks)
    )


def power_lines(tolerances: Tolerances, order: Order, power: Floats) -> list[ToleranceLine]:
    """Lines for the power that the table judges, the cylinder and its axis, of a power matrix (2, 2) in D."""
    limits, size = tolerances.limits(order), _highest(order.power())
    ordered, read = sphere_cylinder_axis(order.power()), sphere_cylinder_axis(power)
    lines = [_judged_power(tolerances, order, power)]
    cylinder = abs(float(ordered.cylinder))
    allowed = _allowed(limits.cylinder, cylinder, size)
    lines.append(_line("cylinder", "D", 0.0 - cylinder, float(read.cylinder), allowed))
    if cylinder and cylinder >= tolerances.axis_from:
        axis, found = float(ordered.axis), float(read.axis)
        deviation = (found - axis + 90) % 180 - 90
        lines.append(_line("axis", "deg", axis, found, _allowed(limits.axis, cylinder, size), deviation))
    return lines


def _judged_power(tolerances: Tolerances, order: Order, power: Floats) -> ToleranceLine:
    ordered, read = sphere_cylinder_axis(order.power()), sphere_cylinder_axis(power)
    by_sphere = tolerances.power == "sphere"
    k = 0 if by_sphere else int(np.argmax(np.abs([ordered.sphere, ordered.sphere + ordered.cylinder])))
    wanted, found = (float(p.sphere + k * p.cylinder) for p in (ordered, read))
    name = "sphere" if by_sphere else "power in the meridian of highest power"
    allowed = _allowed(tolerances.limits(order).power, abs(wanted), _highest(order.power()))
    return _line(name, "D", wanted, found, allowed)


def measured_addition(lens: Lens, near: tuple[float, float]) -> float:
    """Addition (D): mean vertex power at the near less that at the distance reference point, read on the surface that
    holds more of the addition."""
    x, y = np.transpose([lens.power_point, near])
    on_front, on_back = (
        abs(float(np.diff(mean_power(surface_power(s, x, y, lens.index)))[0])) for s in (lens.front, lens.back)
    )
    read = front_vertex_power if on_front > on_back else back_vertex_power
    return float(np.diff(mean_power(read(lens, x, y).power))[0])


def _prism_line(limits: Limits, order: Order, prism: ArrayLike, power: Floats) -> ToleranceLine:
    """The table's prism, or what its decentration makes in the meridian of highest power (D, matrix (2, 2))."""
    read, ordered = np.asarray(prism, dtype=float), order.prism_components()
    allowed = max(limits.prism, limits.decentration / 10 * _highest(np.nan_to_num(power)))
    wanted, found, off = (float(np.linalg.norm(p)) for p in (ordered, read, read - ordered))
    bases = _base(ordered), _base(read), _base(read - ordered)
    return replace(_line("prism", "cm/m", wanted, found, allowed, off), bases=bases)


def _base(prism: Floats) -> float:
    """Direction (degrees, 0 to 360) of the base of a prism (2,)."""
    return float(np.degrees(np.arctan2(prism[1], prism[0])) % 360)


def _highest(power: Floats) -> float:
    """Highest absolute power (D) of a power matrix (2, 2)."""
    return float(np.abs(np.linalg.eigvalsh(power)).max())


def _allowed(steps: tuple[Step, ...], size: float, power: float) -> float:
    """The tolerance of the first step that neither a size (D) nor the lens's power (D) passes."""
    step = next(s for s in steps if size <= s.up_to and power <= s.power_up_to)
    return step.tolerance + step.share * size


def _line(
    name: str, unit: str, expected: float, measured: float, tolerance: float, deviation: float | None = None
) -> ToleranceLine:
    off = measured - expected if deviation is None else deviation
    excess = abs(off) - tolerance
    within = excess <= 1e-9
    return ToleranceLine(name, unit, expected, measured, off, tolerance, within, 0.0 if within else excess)
