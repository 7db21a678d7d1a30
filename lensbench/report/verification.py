"""A verification in words: the same cells and sentences in the terminal, the report and the window."""

from typing import NamedTuple

from ..optics.tolerances import ToleranceLine, Verification
from .facts import order_text


class Row(NamedTuple):
    """A line of a verification as text; unit: of its numbers."""

    name: str
    unit: str
    expected: str
    measured: str
    deviation: str
    tolerance: str
    verdict: str


def row_of(line: ToleranceLine) -> Row:
    """A line as text. Prisms are written with their bases, the deviation with that of the difference."""
    unit, digits = ("°", 1) if line.unit == "deg" else (line.unit, 2)
    values = [_number(line.expected, digits), _number(line.measured, digits), _number(line.deviation, digits, "+")]
    if line.bases:
        sizes = line.expected, line.measured, line.deviation
        values = [_prism(size, base) for size, base in zip(sizes, line.bases, strict=True)]
    off = f"outside by {line.excess:.{digits}f}"
    verdict = "within" if line.within else off if line.excess == line.excess else "no reading"
    return Row(line.name, unit, *values, _number(line.tolerance, digits), verdict)


def _number(value: float, digits: int, sign: str = "") -> str:
    return f"{round(value, digits) + 0.0:{sign}.{digits}f}"


def _prism(size: float, base: float) -> str:
    return f"{size:.2f} base {base:.0f}°" if size >= 0.005 else f"{size:.2f}"


def sentences(found: Verification) -> list[str]:
    """What the lines were judged against and by which edition, what could not be read, and what the order is as worn."""
    against = "the verification power of its file" if found.by_verification_power else "the order"
    return [
        f"Judged by {found.edition} against {against}: {order_text(found.expected)}.",
        *(f"{remark[0].upper()}{remark[1:]}." for remark in found.remarks),
        *([f"In the wearer's position of wear the order is met by a lens that reads {order_text(found.compensated)}."]
          if found.compensated else []),
    ]  # fmt: skip
