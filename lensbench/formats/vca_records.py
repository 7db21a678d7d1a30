"""Records of the VCA/OMA Data Communication Standard (ISO 16284): labels, chiral values, traced shapes.

A record is LABEL=value;value;... Chiral records hold the right and then the left value; an empty one and "?" say nothing.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats
from .text import read_text

SIDES = ("R", "L")
SEPARATORS = re.compile("[\x1c\x1d\x1e\x1f]")
TRACE_FORMATS = {"2": "binary absolute", "3": "binary differential", "4": "packed binary"}
MOST_TRACED = 10_000


@dataclass(frozen=True, slots=True)
class Record:
    """One record: its line, label in capitals, and values."""

    line: int
    label: str
    values: tuple[str, ...]


@dataclass(slots=True)
class Shape:
    """A traced or measured shape: what its format record says, and its integers (0.01 mm, 0.01 degrees) by label."""

    record: Record
    count: int
    equal: bool
    side: str
    integers: dict[str, list[int]] = field(default_factory=dict)

    def column(self, path: Path, label: str) -> Floats:
        """The `count` values of a label in mm or degrees. Raises InputError when there are more or fewer."""
        found = self.integers.get(label, [])
        if len(found) != self.count:
            where = f"{path}, line {self.record.line}: {self.record.label}"
            raise InputError(f"{where} announces {self.count} values, but {label}= has {len(found)}")
        return np.array(found) / 100.0

    def angles(self, path: Path) -> Floats:
        """Angles (count,) in rad, anticlockwise from 3 o'clock, seen from in front of the wearer. Raises InputError."""
        if self.equal:
            return np.linspace(0.0, 2 * np.pi, self.count, endpoint=False)
        angle = self.column(path, "A")
        if np.any(np.diff(angle) <= 0) or np.ptp(angle) >= 360:
            raise InputError(
                f"{path}, line {self.record.line}: {self.record.label}: the angles A= must rise within one turn"
            )
        return np.radians(angle)


class Records:
    """A file's records: values by label and side, and its shapes (TRCFMT, STHKFMT)."""

    def __init__(self, path: Path):
        self.path = path
        self.by_label: dict[str, Record] = {}
        self.shapes: list[Shape] = []
        self.has_surface = False
        for record in _records(path):
            self._take(record)

    def _take(self, record: Record) -> None:
        if record.label in ("TRCFMT", "STHKFMT"):
            if record.values[0] or len(record.values) > 1:
                self.shapes.append(_shape(self.path, record))
        elif record.label in ("R", "A", "T"):
            if self.shapes:
                self.shapes[-1].integers.setdefault(record.label, []).extend(_integers(self.path, record))
        elif record.label == "SURFMT":
            self.has_surface = True
        elif record.label not in ("ZZ", "Z", "ZA"):
            self.by_label[record.label] = record

    def text(self, label: str, side: str = "R") -> str:
        """The value of a label for a side, "" if there is none: of one value for both sides, else of the side's own."""
        record = self.by_label.get(label)
        if record is None:
            return ""
        k = SIDES.index(side) if len(record.values) > 1 else 0
        value = record.values[k].strip() if k < len(record.values) else ""
        return "" if value == "?" else value

    def number(self, label: str, side: str, low: float, high: float) -> float | None:
        """The number of a label for a side, None if there is none. Raises InputError for no number and outside low to high."""
        text = self.text(label, side)
        if not text:
            return None
        where = f"{self.path}, line {self.by_label[label].line}: {label}"
        try:
            value = float(text)
        except ValueError:
            hint = "; write a decimal point" if re.fullmatch(r"[-+]?\d+,\d+", text) else ""
            raise InputError(f"{where}: {text[:40]!r} is not a number{hint}") from None
        if not low <= value <= high:
            raise InputError(f"{where}: {text} is outside {low:g} to {high:g}")
        return value

    def shape(self, label: str, side: str) -> Shape | None:
        """The last shape of a kind for a side."""
        return next((s for s in reversed(self.shapes) if s.record.label == label and s.side in (side, "B")), None)


def _records(path: Path) -> list[Record]:
    records: list[Record] = []
    for line, text in enumerate(SEPARATORS.sub("\n", read_text(path)).split("\n"), start=1):
        label, found, rest = text.strip().partition("=")
        if found and re.fullmatch(r"[A-Za-z0-9_]+", label.strip()):
            records.append(Record(line, label.strip().upper(), tuple(rest.split(";"))))
        elif records and re.fullmatch(r"[-+\d;?. ]+", text.strip()):  # the standard lets a long record go on
            records.append(Record(line, records[-1].label, tuple(text.strip().split(";"))))
    return records


def _shape(path: Path, record: Record) -> Shape:
    where = f"{path}, line {record.line}: {record.label}"
    fields = [value.strip().upper() for value in record.values] + [""] * 4
    if fields[0] != "1":
        kind = TRACE_FORMATS.get(fields[0], "not known")
        raise InputError(f"{where}: format {fields[0]!r} ({kind}) is not read; only 1 (decimal text) is")
    if not fields[1].isdecimal() or not 8 <= int(fields[1]) <= MOST_TRACED:
        raise InputError(f"{where}: {fields[1]!r} points; a shape has 8 to {MOST_TRACED}")
    if fields[2] not in ("E", "U") or fields[3] not in ("R", "L", "B"):
        raise InputError(f"{where}: needs 1;count;E or U;R or L;..., not {';'.join(record.values)[:40]!r}")
    return Shape(record, int(fields[1]), fields[2] == "E", fields[3])


def _integers(path: Path, record: Record) -> list[int]:
    values = [value.strip() for value in record.values if value.strip()]
    for value in values:
        if not re.fullmatch(r"[-+]?\d{1,6}(\.0*)?", value):
            raise InputError(
                f"{path}, line {record.line}: {record.label}: {value[:40]!r} is not a whole number of hundredths"
            )
    return [int(float(value)) for value in values]
