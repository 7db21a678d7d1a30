"""The readings at the reference points in words: a row a reading, a column a point, so that the table fits any page."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..layers import PointReading
from ..optics.conventions import power_matrix
from ..optics.lens import Lens
from .facts import prescription_text

NOTHING = "–"


class Group(NamedTuple):
    """Rows under one heading: label with its unit, and a cell a reference point."""

    title: str
    rows: list[tuple[str, list[str]]]


def reading_groups(lens: Lens, readings: Sequence[PointReading]) -> list[Group]:
    """What was ordered, what the lensmeter finds and what the wearer gets at each reference point."""

    def row(label: str, cell: Callable[[PointReading], str]) -> tuple[str, list[str]]:
        return label, [cell(reading) for reading in readings]

    def worn(label: str, cell: Callable[[PointReading], str]) -> tuple[str, list[str]]:
        return row(label, lambda r: cell(r) if r.status == "OK" else NOTHING)

    lost = any(r.status != "OK" for r in readings)
    return [
        Group("Point", [row("x, y on the lens (mm)", lambda r: f"{r.x:.1f}, {r.y:.1f}")]),
        Group("Ordered", [row("power (D, °)", lambda r: _ordered(lens, r))]),
        Group(
            "Lensmeter",
            [
                row("power (D, °)", lambda r: _power(r.lensmeter_sphere, r.lensmeter_cylinder, r.lensmeter_axis)),
                row("prism, base (cm/m, °)", lambda r: _prism(r.lensmeter_prism, r.lensmeter_prism_base)),
            ],
        ),
        Group(
            "As worn",
            [
                *([row("ray", lambda r: r.status.lower().replace("_", " "))] if lost else []),
                worn("gaze to the left, up (°)", lambda r: f"{r.azimuth:.1f}, {r.elevation:.1f}"),
                worn("object", lambda r: "∞" if r.distance == np.inf else f"{r.distance:.0f} mm"),
                worn("power (D, °)", lambda r: _power(r.sphere, r.cylinder, r.axis)),
                worn("mean power (D)", lambda r: f"{r.mean_power:+.2f}"),
                worn("prism, base (cm/m, °)", lambda r: _prism(r.prism, r.prism_base)),
                worn("mean power less order (D)", lambda r: _given(r.mean_error, "+.2f")),
                worn("astigmatic difference to the order (D)", lambda r: _given(r.astigmatic_error, ".2f")),
            ],
        ),
    ]


def _ordered(lens: Lens, reading: PointReading) -> str:
    if lens.ordered is None or reading.mean_error is None:
        return NOTHING
    return prescription_text(lens.ordered.power(near="near" in reading.name))


def _power(sphere: float, cylinder: float, axis: float) -> str:
    return prescription_text(power_matrix(sphere, cylinder, axis))


def _prism(size: float, base: float) -> str:
    return f"{size:.2f}, {base:.0f}" if size >= 0.005 else "0.00"


def _given(value: float | None, form: str) -> str:
    return NOTHING if value is None else f"{value:{form}}"
