"""The powers in a job file: as ordered, and as they are to be verified by focimeter."""

from dataclasses import asdict, replace
from typing import TYPE_CHECKING, NamedTuple

from ..optics.lens import Order

if TYPE_CHECKING:
    from .vca_job import Eyeside

POWER_RANGES = {
    "SPH": (-40, 40), "CYL": (-20, 20), "AX": (0, 180), "ADD": (0, 5), "PRVM": (0, 20), "PRVA": (0, 360),
    "LDDRSPH": (-40, 40), "LDDRCYL": (-20, 20), "LDDRAX": (0, 180), "LDNRSPH": (-40, 40), "LDADD": (-5, 5),
    "LDPRVM": (0, 20), "LDPRVA": (0, 360),
}  # fmt: skip
VERIFIED = {
    "sphere": "LDDRSPH", "cylinder": "LDDRCYL", "axis": "LDDRAX", "addition": "LDADD",
    "prism": "LDPRVM", "prism_base": "LDPRVA",
}  # fmt: skip


class Powers(NamedTuple):
    """Of one side: the order, and the verification power where one is stated."""

    order: Order
    verification_power: Order | None


def powers_of(eye: "Eyeside") -> Powers:
    """The powers of a side, said as facts."""
    order = _order(eye)
    return Powers(order, _verification_power(eye, order))


def _order(eye: "Eyeside") -> Order:
    axis = eye["AX"]
    order = Order(
        eye["SPH"] or 0.0, eye["CYL"] or 0.0, axis or 180.0, eye["ADD"] or 0.0, eye["PRVM"] or 0.0, (eye["PRVA"] or 0.0) % 360
    )  # fmt: skip
    text = f"SPH {order.sphere:+.2f}, CYL {order.cylinder:+.2f}, AX {order.axis:g}, ADD {order.addition:.2f} D"
    eye.say("Order", f"{text}, PRVM {order.prism:.2f} cm/m base PRVA {order.prism_base:g} degrees", str(order))
    return order


def _verification_power(eye: "Eyeside", order: Order) -> Order | None:
    """What a focimeter must read: LDDRSPH and its like; what is left out is as ordered. None where nothing is stated."""
    given = {name: value for name, label in VERIFIED.items() if (value := eye[label]) is not None}
    near = eye["LDNRSPH"]
    if near is not None:
        given.setdefault("addition", near - given.get("sphere", order.sphere))
    if not given:
        return None
    power = replace(order, **given)
    text = f"sphere {power.sphere:+.2f}, cylinder {power.cylinder:+.2f}, axis {power.axis:g}, addition {power.addition:.2f} D"
    eye.say("Power to verify", f"{text}, prism {power.prism:.2f} cm/m base {power.prism_base:g} degrees", asdict(power))
    return power
