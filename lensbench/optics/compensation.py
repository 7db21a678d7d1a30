"""Verification power: what a focimeter must read of a lens that gives the ordered power as worn, and the other way round.

A tilted lens gives another power than on the focimeter, which looks at it squarely. The lens is made for a power by
changing the curvature of its back surface at the vertex (front surface, thickness, index, wedge and progression stay), until
the power at the distance reference point is the one wanted: Newton's method on the power matrix, three numbers, whose
derivative by the back surface's own power is taken as the identity. Prism stays as ordered: it is a focimeter's.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..errors import InputError
from .bending import with_curvature_added
from .conventions import Floats, mean_power, sphere_cylinder_axis
from .eye import Wearer
from .gaze import look_through
from .lens import Lens, Order
from .lensmeter import back_vertex_power
from .object_distance import from_cornea
from .tolerances import measured_addition

CLOSE = 1e-9  # D
MOST_STEPS = 60


@dataclass(frozen=True, slots=True, eq=False)
class Compensation:
    """A lens in a position of wear: the power that it gives as worn and the one that a focimeter reads of it."""

    as_worn: Order
    verification_power: Order
    lens: Lens


def verification_power(lens: Lens, wearer: Wearer, ordered: Order) -> Compensation:
    """The lens made so that it gives the ordered power as worn, and what a focimeter must read of it.

    Raises InputError where no such lens is found.
    """
    made = _made(lens, ordered.power(), lambda lens: power_worn(lens, wearer))
    by_focimeter = _written(ordered, power_by_focimeter(made), addition_added_by_wear(made, wearer, ordered))
    made = replace(made, ordered=ordered, verification_power=by_focimeter)
    return Compensation(ordered, by_focimeter, made)


def power_as_worn(lens: Lens, wearer: Wearer, by_focimeter: Order) -> Compensation:
    """The lens made so that a focimeter reads this power, and what it gives as worn. Raises InputError as above."""
    made = _made(lens, by_focimeter.power(), power_by_focimeter)
    as_worn = _written(by_focimeter, power_worn(made, wearer), -addition_added_by_wear(made, wearer, by_focimeter))
    return Compensation(as_worn, by_focimeter, replace(made, ordered=as_worn, verification_power=by_focimeter))


def power_by_focimeter(lens: Lens) -> Floats:
    """Back vertex power (2, 2), D, at the lens point of the ordered power."""
    return np.asarray(back_vertex_power(lens, *lens.power_point).power[0])


def power_worn(lens: Lens, wearer: Wearer) -> Floats:
    """As-worn power (2, 2), D, along the gaze through the lens point of the ordered power, for far objects."""
    x, y = lens.power_point
    return np.asarray(look_through(lens, wearer, [x], [y]).as_worn_matrix()[0])


def addition_added_by_wear(lens: Lens, wearer: Wearer, order: Order) -> float:
    """By how much (D) a focimeter's addition is more than the one as worn, at the wearer's near distance; 0 where no addition
    is ordered or no near reference point is named."""
    near = lens.points.near_reference_point
    if not order.addition or near is None:
        return 0.0
    field = look_through(lens, wearer, [near[0]], [near[1]])
    there = field.as_worn_matrix(from_cornea(field, wearer.wear.near_distance))[0]
    return measured_addition(lens, near) - float(mean_power(there) - mean_power(power_worn(lens, wearer)))


def _written(order: Order, power: Floats, more_addition: float) -> Order:
    """An order with another power (2, 2) and addition, D."""
    sphere, cylinder, axis = (float(v) for v in sphere_cylinder_axis(power))
    return replace(order, sphere=sphere, cylinder=cylinder, axis=axis, addition=order.addition + more_addition)


def _made(lens: Lens, wanted: Floats, read: Callable[[Lens], Floats]) -> Lens:
    """The lens with so much curvature more on its back that `read` gives the wanted power (2, 2), D."""
    added, made = np.zeros((2, 2)), lens
    for _ in range(MOST_STEPS):
        short = wanted - read(made)
        if not np.isfinite(short).all():
            break
        if np.abs(short).max() < CLOSE:
            return made
        added = added - (short + short.T) / (2000 * (lens.index - 1))
        made = replace(lens, back=with_curvature_added(lens.back, added, lens.outline.box))
    raise InputError(
        f"{lens.name or 'the lens'}: no back surface was found with which the lens gives {_text(wanted)} D in this position of "
        "wear; check the order, the tilts and the reference points"
    )


def _text(power: Floats) -> str:
    sphere, cylinder, axis = sphere_cylinder_axis(power)
    return f"{sphere:+.2f} / {cylinder:+.2f} x {axis:.0f}"
