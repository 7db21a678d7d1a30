"""A flat map in its viewport: the report's bands, isolines, marks and scale, seen from in front of the wearer."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPainterPath, QPen, QWheelEvent

from ..layers import MapLayer, Probe
from ..report.tables import map_words
from ..session import Pane, Workbench
from ..views.bands import Bands
from ..views.maps import INK
from ..views.raster import Isoline, band_pixels, isolines
from .map_source import BandedMap, map_question
from .plot import Plot

BAR = 74.0
_WIDTHS = (0.6, 1.2, 2.0)
CLOSER, CLOSEST = 1.25, 16.0  # of a notch of the wheel; at most


class Drawn(NamedTuple):
    """A map made ready to be painted: its bands as pixels and its isolines."""

    banded: BandedMap
    pixels: NDArray[np.uint8]
    lines: list[Isoline]


def _prepared(found: Callable[[], BandedMap]) -> Drawn:
    banded = found()
    return Drawn(banded, band_pixels(banded.lens_map, banded.bands), isolines(banded.lens_map, banded.bands))


class MapContent(Plot):
    """x to the right, y up, mm. Wheel: closer to what is under the pointer; drag: shift; double click: the whole lens."""

    def __init__(self) -> None:
        super().__init__()
        self.equal = True
        self.margins = (56.0, 8.0, BAR + 14, 40.0)
        self.drawn: Drawn | None = None
        self._pane = Pane()
        self._words: dict[str, Any] = {}
        self._whole = self.box
        self._last: QPointF | None = None

    def question(self, bench: Workbench, pane: Pane) -> Any:
        question = map_question(bench, pane)
        if question is None:
            return None
        key, found = question
        return key, partial(_prepared, found)

    def show_answer(self, answer: Drawn, bench: Workbench, pane: Pane) -> None:
        x0, x1, y0, y1 = answer.banded.lens.outline.box
        whole = x0 - 1.5, x1 + 1.5, y0 - 1.5, y1 + 1.5
        if whole != self._whole:
            self._whole = self.box = whole
        self.drawn, self._pane = answer, pane
        layer = MapLayer(pane.quantity, bench.distance, bench.accommodation)
        self._words = map_words(answer.banded.lens, answer.banded.wearer, layer)
        self.draw_again()

    @property
    def bands(self) -> Bands | None:
        """The scale that is shown."""
        return None if self.drawn is None else self.drawn.banded.bands

    def show_probe(self, probe: Probe | None) -> None:
        self.mark(probe.point if probe is not None and np.isfinite(probe.point).all() else None)

    def pointed_at(self, x: float, y: float) -> None:
        if self.drawn is not None and self.drawn.banded.lens.outline.contains(x, y):
            self.pointed.emit((x, y), None)

    def wheelEvent(self, event: QWheelEvent) -> None:
        place = self.data(event.position())
        if place is None or self.drawn is None:
            return
        width, whole = self.box[1] - self.box[0], self._whole[1] - self._whole[0]
        share = np.clip(width * CLOSER ** (-event.angleDelta().y() / 120), whole / CLOSEST, whole) / width
        self._show_box([at + (end - at) * share for end, at in zip(self.box, np.repeat(place, 2), strict=True)])

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._last = event.position()

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        self._last = None

    def mouseDoubleClickEvent(self, _event: QMouseEvent) -> None:
        self._show_box(self._whole)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._last is None or not event.buttons() & Qt.MouseButton.LeftButton:
            super().mouseMoveEvent(event)
            return
        step, self._last = event.position() - self._last, event.position()
        per_pixel = (self.box[1] - self.box[0]) / self.area().width()
        across, up = -step.x() * per_pixel, step.y() * per_pixel
        self._show_box([end + move for end, move in zip(self.box, (across, across, up, up), strict=True)])

    def _show_box(self, box: Sequence[float]) -> None:
        """Show a part of the data, shifted so that it lies within the whole."""
        parts = []
        for (low, high), (first, last) in zip((box[:2], box[2:]), (self._whole[:2], self._whole[2:]), strict=True):
            shift = max(first - low, 0.0) + min(last - high, 0.0)
            parts += [float(low + shift), float(high + shift)]
        self.box = parts[0], parts[1], parts[2], parts[3]
        self.draw_again()

    def figure(self) -> Any:
        from ..views.maps import map_figure

        if self.drawn is None:
            return None
        banded = self.drawn.banded
        return map_figure(banded.lens, banded.lens_map, self._pane.step, banded.limits, **self._words)

    def draw(self, painter: QPainter) -> None:
        """Axes, bands within the outline, isolines, marks, colour bar."""
        if self.drawn is None:
            return
        lens, _, lens_map, bands, _ = self.drawn.banded
        sides = ("temporal", "nasal") if lens.side == "R" else ("nasal", "temporal")
        self.draw_axes(painter, f"{sides[0]}  ←   x, mm   →  {sides[1]}", "y, mm")
        outline = QPainterPath()
        outline.addPolygon(self.polygon(np.transpose(lens.outline.points())))
        outline.closeSubpath()
        painter.save()
        painter.setClipRect(self.area())
        painter.save()
        painter.setClipPath(outline, Qt.ClipOperation.IntersectClip)
        corners = self.pixel(lens_map.x[0], lens_map.y[-1]), self.pixel(lens_map.x[-1], lens_map.y[0])
        painter.drawImage(QRectF(*corners), _qimage(self.drawn.pixels))
        self._draw_isolines(painter, bands)
        painter.restore()
        painter.setPen(QPen(self.ink(), 1.6))
        painter.drawPath(outline)
        self._draw_marks(painter)
        painter.restore()
        self._draw_bar(painter, bands, f"{lens_map.label}, {lens_map.unit}")

    def _draw_isolines(self, painter: QPainter, bands: Bands) -> None:
        assert self.drawn is not None
        colours = bands.line_colours()
        longest: dict[int, Any] = {}
        for line in self.drawn.lines:
            weight = int(bands.weight[line.level])
            painter.setPen(QPen(QColor(colours[line.level]), _WIDTHS[weight]))
            painter.drawPolyline(self.polygon(line.points))
            if weight and len(line.points) > max(12, len(longest.get(line.level, ()))):
                longest[line.level] = line.points
        self._name_levels(painter, bands, longest)

    def _name_levels(self, painter: QPainter, bands: Bands, longest: dict[int, Any]) -> None:
        """Name each level on its longest line, where no other name stands."""
        taken, area = list[QRectF](), self.area()
        for level, points in longest.items():
            places = [self.pixel(*points[len(points) * k // 8]) for k in (4, 2, 6, 3, 5, 1, 7)]
            boxes = [QRectF(at.x() - 20, at.y() - 8, 40, 16) for at in places]
            free = (b for b in boxes if area.contains(b) and not any(b.intersects(t) for t in taken))
            box = next(free, None)
            if box is not None:
                taken.append(box)
                self.halo_text(painter, box, bands.text[level])

    def _draw_marks(self, painter: QPainter) -> None:
        """A cross for the fitting point, rings for far and near, a dot for the prism reference point."""
        assert self.drawn is not None
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for name, place in self.drawn.banded.lens.points.named().items():
            at = self.pixel(*place)
            for colour, width in ((QColor(255, 255, 255, 230), 4.0), (QColor(INK), 1.7)):
                painter.setPen(QPen(colour, width))
                if name == "fitting_point":
                    painter.drawLine(at + QPointF(-7, 0), at + QPointF(7, 0))
                    painter.drawLine(at + QPointF(0, -7), at + QPointF(0, 7))
                else:
                    radius = {"distance_reference_point": 7.0, "near_reference_point": 5.0}.get(name, 1.5)
                    painter.drawEllipse(at, radius, radius)

    def _draw_bar(self, painter: QPainter, bands: Bands, label: str) -> None:
        """The bands from low to high, with their levels, and beside them what is shown."""
        count = len(bands.colours)
        top, height = 16.0, max(20.0, self.height() - 48.0)
        left, each = self.width() - BAR, height / count
        for k, colour in enumerate(bands.colours):
            band = QRectF(left, top + height - (k + 1) * each, 16, each + 0.5)
            painter.fillRect(band, QColor.fromRgbF(*(float(c) for c in colour)))
        painter.setPen(self.ink(0.85))
        named = (
            np.flatnonzero(bands.weight) if bands.weight.any() and 16 * (count + 1) > height else np.arange(count + 1)
        )
        for k in named[:: max(1, int(np.ceil(16 * named.size / height)))]:
            y = top + height - k * each
            painter.drawText(QRectF(left + 21, y - 9, BAR - 22, 18), Qt.AlignmentFlag.AlignVCenter, bands.text[k])
        painter.save()
        painter.translate(left - 4, top + height / 2)
        painter.rotate(-90)
        painter.drawText(QRectF(-height / 2, -17, height, 16), Qt.AlignmentFlag.AlignCenter, label)
        painter.restore()


def _qimage(pixels: NDArray[np.uint8]) -> QImage:
    """Pixels (h, w, 4), blue, green, red, alpha, as an image; the memory is shared."""
    height, width, _ = pixels.shape
    return QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_ARGB32)
