"""Flat pictures that keep up with a slider: axes and marks, painted by Qt."""

import math
from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QEvent, QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QMouseEvent, QPainter, QPaintEvent, QPalette, QPen, QPixmap, QPolygonF
from PySide6.QtWidgets import QWidget

from .content import MARK, Content


class Plot(Content):
    """A rectangle of data, box (x0, x1, y0, y1), with axes; subclasses paint into it and say what pointing at it means.

    equal: x and y have one scale. flip: x rises to the left. margins: left, top, right, bottom, pixels. marked: what is
    marked, in data.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMouseTracking(True)
        self.setMinimumSize(80, 60)
        self.box = (0.0, 1.0, 0.0, 1.0)
        self.equal = self.flip = False
        self.margins = (56.0, 8.0, 14.0, 40.0)
        self.marked: tuple[float, float] | None = None
        self._drawing: QPixmap | None = None

    # ---- places ----

    def area(self) -> QRectF:
        """Where the data are painted."""
        left, top, right, bottom = self.margins
        room = QRectF(self.rect()).adjusted(left, top, -right, -bottom)
        if not self.equal or room.width() <= 0 or room.height() <= 0:
            return room
        x0, x1, y0, y1 = self.box
        scale = min(room.width() / (x1 - x0), room.height() / (y1 - y0))
        size = (scale * (x1 - x0), scale * (y1 - y0))
        centre = room.center()
        return QRectF(centre.x() - size[0] / 2, centre.y() - size[1] / 2, *size)

    def pixel(self, x: float, y: float) -> QPointF:
        """Where a place of the data is painted."""
        area, (x0, x1, y0, y1) = self.area(), self.box
        u, v = (x - x0) / (x1 - x0), (y - y0) / (y1 - y0)
        return QPointF(area.left() + (1 - u if self.flip else u) * area.width(), area.bottom() - v * area.height())

    def data(self, place: QPointF) -> tuple[float, float] | None:
        """Which place of the data is painted there; None outside."""
        area, (x0, x1, y0, y1) = self.area(), self.box
        if not area.contains(place):
            return None
        u, v = (place.x() - area.left()) / area.width(), (area.bottom() - place.y()) / area.height()
        return x0 + (1 - u if self.flip else u) * (x1 - x0), y0 + v * (y1 - y0)

    # ---- painting ----

    def paintEvent(self, _: QPaintEvent) -> None:
        if self._drawing is None or self._drawing.size() != self.size() * self.devicePixelRatioF():
            self._drawing = self._drawn_anew()
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._drawing)
        if self.marked is not None:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            self.draw_mark(painter, self.pixel(*self.marked))

    def _drawn_anew(self) -> QPixmap:
        """All but the mark, kept for as long as the data, the size and the theme stay."""
        pixmap = QPixmap(self.size() * self.devicePixelRatioF())
        pixmap.setDevicePixelRatio(self.devicePixelRatioF())
        pixmap.fill(self.palette().color(QPalette.ColorRole.Base))
        painter = QPainter(pixmap)
        painter.setFont(self.font())
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        self.draw(painter)
        painter.end()
        return pixmap

    def draw_again(self) -> None:
        """The data have changed."""
        self._drawing = None
        self.update()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        self.draw_again()

    def draw(self, painter: QPainter) -> None:
        """Paint the data."""
        raise NotImplementedError

    def draw_mark(self, painter: QPainter, at: QPointF) -> None:
        """The cross of the probed gaze."""
        for colour, width in ((QColor(255, 255, 255, 220), 4.0), (MARK, 1.8)):
            painter.setPen(QPen(colour, width))
            painter.drawLine(QLineF(at.x() - 9, at.y(), at.x() + 9, at.y()))
            painter.drawLine(QLineF(at.x(), at.y() - 9, at.x(), at.y() + 9))

    def pointed_at(self, x: float, y: float) -> None:
        """The pointer is at a place of the data."""

    def polygon(self, points: np.ndarray) -> QPolygonF:
        """Places (n, 2) of the data as painted."""
        area, (x0, x1, y0, y1) = self.area(), self.box
        u, v = (points[:, 0] - x0) / (x1 - x0), (points[:, 1] - y0) / (y1 - y0)
        across = area.left() + (1 - u if self.flip else u) * area.width()
        return QPolygonF(list(map(QPointF, across.tolist(), (area.bottom() - v * area.height()).tolist())))

    def ink(self, alpha: float = 1.0) -> QColor:
        """The theme's text colour."""
        colour = self.palette().color(QPalette.ColorRole.Text)
        colour.setAlphaF(alpha)
        return colour

    def draw_axes(self, painter: QPainter, x_title: str, y_title: str) -> None:
        """Grid, ticks and titles."""
        area, (x0, x1, y0, y1) = self.area(), self.box
        metrics = QFontMetricsF(self.font())
        high = metrics.height()
        painter.setPen(QPen(self.ink(0.12), 1))
        steps = step_for(x1 - x0, area.width() / 60), step_for(y1 - y0, area.height() / 40)
        across, up = ticks(x0, x1, steps[0]), ticks(y0, y1, steps[1])
        for x in across:
            painter.drawLine(QLineF(self.pixel(x, y0), self.pixel(x, y1)))
        for y in up:
            painter.drawLine(QLineF(self.pixel(x0, y), self.pixel(x1, y)))
        painter.drawRect(area)
        painter.setPen(self.ink(0.7))
        for x in across:
            box = QRectF(self.pixel(x, y0).x() - 40, area.bottom() + 2, 80, high)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, number(x, steps[0]))
        for y in up:
            box = QRectF(area.left() - 64, self.pixel(x0, y).y() - high / 2, 60, high)
            painter.drawText(box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, number(y, steps[1]))
        title = QRectF(area.left() - 40, area.bottom() + high, area.width() + 80, high + 2)
        painter.drawText(title, Qt.AlignmentFlag.AlignCenter, x_title)
        painter.save()
        painter.translate(area.left() - 34, area.center().y())
        painter.rotate(-90)
        painter.drawText(QRectF(-80, -high, 160, high), Qt.AlignmentFlag.AlignCenter, y_title)
        painter.restore()

    def halo_text(self, painter: QPainter, box: QRectF, text: str, align: Qt.AlignmentFlag | None = None) -> None:
        """Text that stays legible on any colour."""
        where = Qt.AlignmentFlag.AlignCenter if align is None else align
        ground = self.palette().color(QPalette.ColorRole.Base)
        ground.setAlphaF(0.85)
        painter.setPen(ground)
        for dx, dy in ((-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, 1), (-1, 1), (1, -1)):
            painter.drawText(box.translated(dx, dy), where, text)
        painter.setPen(self.ink())
        painter.drawText(box, where, text)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        place = self.data(event.position())
        if place is not None:
            self.pointed_at(*place)

    def mark(self, place: tuple[float, float] | None) -> None:
        """Mark a place (None: none)."""
        if place != self.marked:
            self.marked = place
            self.update()


def step_for(span: float, most: float) -> float:
    """A round step (1, 2, 5 times a power of ten) that divides a span into at most `most` parts."""
    least = span / max(most, 1.0)
    power = 10.0 ** math.floor(math.log10(max(least, 1e-9)))
    return next(m * power for m in (1, 2, 5, 10) if m * power >= least * (1 - 1e-9))


def ticks(low: float, high: float, step: float) -> Sequence[float]:
    """Multiples of the step within the range."""
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def number(value: float, step: float) -> str:
    """A tick as printed, with the digits that its step needs."""
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    return f"{value + 0.0:.{digits}f}".replace("-0", "0" if abs(value) < 1e-12 else "-0")
