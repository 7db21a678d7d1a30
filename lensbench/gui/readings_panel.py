"""The table of reference points, the verification against the order, and what the probe reads."""

import math
from html import escape
from typing import NamedTuple

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QLabel,
    QScrollArea,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from ..layers import PointReading, Probe
from ..optics.conventions import Status, power_matrix
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..optics.tolerances import ToleranceLine, Verification
from ..report.facts import prescription_text
from ..report.verification import row_of, sentences

WITHIN, OUTSIDE = QColor("#1b7f4b"), QColor("#c0392b")


class _Table(QTableWidget):
    """A table to be read."""

    def __init__(self, columns: list[str]) -> None:
        super().__init__(0, len(columns))
        self.setHorizontalHeaderLabels(columns)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(22)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setAlternatingRowColors(True)
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)

    def fill(self, rows: list[list[str]]) -> None:
        """Show these cells."""
        self.setRowCount(len(rows))
        for j, row in enumerate(rows):
            for i, text in enumerate(row):
                item = QTableWidgetItem(text)
                side = Qt.AlignmentFlag.AlignLeft if i == 0 else Qt.AlignmentFlag.AlignRight
                item.setTextAlignment(side | Qt.AlignmentFlag.AlignVCenter)
                self.setItem(j, i, item)


class PointsTable(_Table):
    """Ordered, by focimeter and as worn, point by point."""

    def __init__(self) -> None:
        super().__init__(
            [
                "Point",
                "x, y (mm)",
                "Gaze left, up (°)",
                "Focimeter (D)",
                "As worn (D)",
                "Prism, base (cm/m, °)",
                "Less order (D)",
            ]
        )

    def show_readings(self, readings: tuple[PointReading, ...]) -> None:
        """Show what was read."""
        self.fill([_point_row(reading) for reading in readings])


def _point_row(r: PointReading) -> list[str]:
    place = [r.name.replace("_", " "), f"{r.x:.1f}, {r.y:.1f}"]
    if r.status != "OK":
        return [*place, f"no ray: {r.status.lower().replace('_', ' ')}"]
    return [
        *place,
        f"{r.azimuth:.1f}, {r.elevation:.1f}",
        prescription_text(power_matrix(r.lensmeter_sphere, r.lensmeter_cylinder, r.lensmeter_axis)),
        prescription_text(power_matrix(r.sphere, r.cylinder, r.axis)),
        f"{r.prism:.2f}, {r.prism_base:.0f}" if r.prism >= 0.005 else "0.00",
        "–" if r.mean_error is None else f"{r.mean_error:+.2f}",
    ]


class TolerancePanel(QWidget):
    """Focimeter readings against the order or the verification power, with tolerances, and what is to be said of them."""

    def __init__(self) -> None:
        super().__init__()
        self.table = _Table(["By focimeter", "Expected", "Measured", "Deviation", "Tolerance", ""])
        self.said = QLabel(textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse, wordWrap=True)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.table, 1)
        layout.addWidget(self.said)

    def show_verification(self, found: Verification | None) -> None:
        """Show a verification."""
        lines = found.lines if found else ()
        self.table.fill([_tolerance_row(line) for line in lines])
        for j, line in enumerate(lines):
            self.table.item(j, 5).setForeground(WITHIN if line.within else OUTSIDE)
        self.said.setText(" ".join(sentences(found)) if found else "")


def _tolerance_row(line: ToleranceLine) -> list[str]:
    name, unit, expected, measured, deviation, tolerance, verdict = row_of(line)
    return [f"{name} ({unit})", expected, measured, deviation, f"± {tolerance}", verdict]


class Reading(NamedTuple):
    """A gaze through a lens as it is worn; label, unit, value: of the map's quantity where one points at a map."""

    lens: Lens
    wearer: Wearer
    probe: Probe
    label: str = ""
    unit: str = ""
    value: float = math.nan


class ProbePanel(QWidget):
    """What is read where the pointer is."""

    def __init__(self) -> None:
        super().__init__()
        self.text = QLabel(textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse, wordWrap=True)
        self.text.setAlignment(Qt.AlignmentFlag.AlignTop)
        area = QScrollArea(widgetResizable=True)
        area.setFrameShape(QScrollArea.Shape.NoFrame)
        area.setWidget(self.text)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 0, 0, 0)
        layout.addWidget(area)
        self.show_reading(None)

    def show_reading(self, reading: Reading | None) -> None:
        """Show readings."""
        self.text.setText("Point at a lens or at the view." if reading is None else reading_text(reading))


def reading_text(reading: Reading) -> str:
    """The readings of a gaze as a small table in HTML."""
    p = reading.probe
    rows = [("Lens", escape(reading.lens.name)), ("Wearer", escape(reading.wearer.name or "unnamed"))]
    if p.status != Status.OK:
        return _table([*rows, ("No ray", Status(p.status).name.lower().replace("_", " "))])
    if reading.label:
        value = f"{reading.value:.2f} {reading.unit}" if math.isfinite(reading.value) else "no value"
        rows.append((escape(reading.label), value))
    rows += [
        ("Gaze left, up", f"{p.azimuth:.1f}°, {p.elevation:.1f}°"),
        ("Lens x, y", f"{p.point[0]:.1f}, {p.point[1]:.1f} mm"),
    ]
    if math.isinf(p.distance):
        rows.append(("Object", "at infinity"))
    else:
        rows.append(("Object", f"{p.distance / 10:.1f} cm" if p.distance < 1000 else f"{p.distance / 1000:.2f} m"))
        rows.append(("Ellipse of confusion", f"{2 * p.semi_major:.2f} × {2 * p.semi_minor:.2f} mm"))
    rows += [
        ("Power as worn", f"{prescription_text(power_matrix(p.sphere, p.cylinder, p.axis))} D"),
        ("Mean power", f"{p.mean_power:+.2f} D"),
        ("Prism, base", f"{p.prism:.2f} cm/m, {p.prism_base:.0f}°"),
        ("Accommodation in use", f"{p.accommodation:.2f} D"),
        ("Rms blur diameter", f"{p.defocus:.1f}′"),
    ]
    return _table(rows)


def _table(rows: list[tuple[str, str]]) -> str:
    cells = "".join(
        f"<tr><td style='padding-right:12px'>{name}</td><td><b>{value}</b></td></tr>" for name, value in rows
    )
    return f"<table>{cells}</table>"
