"""What a viewport can show: the common part of maps, profiles, the lens in space, ellipses and the simulated view."""

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QWidget

from ..layers import Probe
from ..session import Pane, Workbench

MARK = QColor("#e6007e")  # of the probed gaze, in every viewport


class Content(QWidget):
    """Shows one kind of pane. pointed(point, direction): at a lens point (x, y) mm or along a gaze (3,), the other is None.

    wants_edit(name, make, row): as Document.edit.
    """

    pointed = Signal(object, object)
    wants_edit = Signal(str, object, str)
    haste: Callable[[], float] = staticmethod(lambda: 0.0)  # as Lane.haste

    def question(self, bench: Workbench, pane: Pane) -> tuple[tuple[Any, ...], Callable[[], Any]] | None:
        """What the answer depends on, and how it is found (in the lane); None when there is nothing to show."""
        raise NotImplementedError

    def show_answer(self, answer: Any, bench: Workbench, pane: Pane) -> None:
        """Show an answer, with what it was asked for."""
        raise NotImplementedError

    def show_probe(self, probe: Probe | None) -> None:
        """Mark a gaze."""

    @property
    def at_rest(self) -> bool:
        """Whether the picture of the last answer is as it stays."""
        return True

    def picture(self) -> QImage:
        """The pane as it is seen."""
        return self.grab().toImage()

    def figure(self) -> Any:
        """The same as a figure of the report, for SVG; None where there is none."""
        return None

    def close_stage(self) -> None:
        """Free what is held on the graphics card."""


def say_nothing(widget: QWidget, painter: QPainter, text: str) -> None:
    """A sentence in the middle of an empty pane."""
    painter.setPen(widget.palette().placeholderText().color())
    flags = int(Qt.AlignmentFlag.AlignCenter) | int(Qt.TextFlag.TextWordWrap)
    painter.drawText(widget.rect().adjusted(20, 20, -20, -20), flags, text)
