"""The colour scale of a map: bands with their levels and unit."""

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from ..views.bands import Bands


class ColourBar(QWidget):
    """A horizontal bar under a map, its label to the left."""

    def __init__(self) -> None:
        super().__init__()
        self.bands: Bands | None = None
        self.label = ""
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        return QSize(200, 40)

    def show_bands(self, bands: Bands, label: str, unit: str) -> None:
        """Show the scale of a map."""
        self.bands, self.label = bands, f"{label}, {unit}"
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        if self.bands is None:
            return
        painter = QPainter(self)
        font = painter.font()
        font.setPointSizeF(8.5)
        painter.setFont(font)
        painter.setPen(self.palette().text().color())
        left, width = 10.0, self.width() - 20.0
        painter.drawText(QRectF(left, 0, width, 14), Qt.AlignmentFlag.AlignLeft, self.label)
        step = width / len(self.bands.colours)
        for k, colour in enumerate(self.bands.colours):
            painter.fillRect(QRectF(left + k * step, 15, step + 0.5, 9), QColor.fromRgbF(*map(float, colour)))
        self._draw_levels(painter, left, step)

    def _draw_levels(self, painter: QPainter, left: float, step: float) -> None:
        assert self.bands is not None
        beyond = -1e9
        for k, (weight, text) in enumerate(zip(self.bands.weight, self.bands.text, strict=True)):
            wide = painter.fontMetrics().horizontalAdvance(text)
            x = min(max(left + k * step, wide / 2 + 2), self.width() - wide / 2 - 2)
            if (weight or len(self.bands.weight) <= 6) and x - wide / 2 > beyond:
                painter.drawText(QRectF(x - wide / 2, 25, wide + 1, 14), Qt.AlignmentFlag.AlignLeft, text)
                beyond = x + wide / 2 + 6
