"""A flat map in its viewport: the report's bands, isolines and marks, drawn fast enough to follow a slider."""

from typing import Any

import contourpy
import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainterPath, QPolygonF
from PySide6.QtWidgets import QGraphicsPathItem, QVBoxLayout

from ..layers import LensMap, Probe
from ..optics.conventions import Floats
from ..optics.lens import Lens
from ..session import Pane, Workbench
from ..views.bands import Bands, extended
from .colour_bar import ColourBar
from .content import Content
from .map_source import BandedMap, map_question

_FINE = 5  # pixels of the picture a sample
_WIDTHS = (0.6, 1.1, 2.0)
_APART = 5.0  # mm between the names of levels
MARK = "#d81b60"


class MapContent(Content):
    """Seen from in front of the wearer: +x to the right, y up, mm."""

    def __init__(self) -> None:
        super().__init__()
        self.plot = pg.PlotWidget()
        self.plot.setMenuEnabled(False)
        self.plot.hideButtons()
        self.plot.setAspectLocked(True)
        for side in ("bottom", "left"):
            self.plot.getAxis(side).enableAutoSIPrefix(False)
        self.bar = ColourBar()
        layout = QVBoxLayout(self, spacing=0)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.plot, 1)
        layout.addWidget(self.bar)
        self.picture_item = pg.ImageItem()
        self.plot.addItem(self.picture_item)
        self.lines: list[QGraphicsPathItem] = []
        self.labels: list[pg.TextItem] = []
        self.cross = pg.TargetItem(movable=False, size=16, pen=pg.mkPen(MARK, width=2))
        self.cross.setVisible(False)
        self.plot.addItem(self.cross)
        self.plot.scene().sigMouseMoved.connect(self._moved)
        self._shown: tuple[BandedMap, Pane] | None = None
        self._framed: Lens | None = None

    def question(self, bench: Workbench, pane: Pane) -> Any:
        return map_question(bench, pane)

    def show_answer(self, answer: BandedMap, bench: Workbench, pane: Pane) -> None:
        self._shown = answer, pane
        self._draw_bands(*answer[:3])
        self._draw_lines(*answer[:3])
        self.bar.show_bands(answer.bands, answer.lens_map.label, answer.lens_map.unit)
        self._frame(answer.lens)

    def show_probe(self, probe: Probe | None) -> None:
        known = probe is not None and np.isfinite(probe.point).all()
        if known:
            self.cross.setPos(*probe.point)
        self.cross.setVisible(bool(known))

    def figure(self) -> Any:
        from ..views.maps import map_figure

        if self._shown is None:
            return None
        banded, pane = self._shown
        return map_figure(banded.lens, banded.lens_map, pane.step, banded.limits)

    def _draw_bands(self, lens: Lens, lens_map: LensMap, bands: Bands) -> None:
        image, box = band_image(lens, lens_map, bands)
        self.picture_item.setImage(image, levels=None)
        self.picture_item.setRect(QRectF(box[0], box[2], box[1] - box[0], box[3] - box[2]))

    def _draw_lines(self, lens: Lens, lens_map: LensMap, bands: Bands) -> None:
        for item in (*self.lines, *self.labels):
            self.plot.removeItem(item)
        self.lines, self.labels = [], []
        outline = np.transpose(lens.outline.points())
        clip = _polygon_path(outline)
        if not (bands.cyclic or bands.constant):
            contours = contourpy.contour_generator(lens_map.x, lens_map.y, extended(lens_map))
            for level, weight, colour, text in zip(
                bands.shifted, bands.weight, bands.line_colours(), bands.text, strict=True
            ):
                self._draw_level(contours.lines(level), (int(weight), colour, text), lens)
        self._add_path(clip, "#202428", 1.5)
        for name, (x, y) in lens.points.named().items():
            self._add_path(_mark_path(name, x, y), "#202428", 1.6)

    def _draw_level(self, curves: list[Floats], look: tuple[int, str, str], lens: Lens) -> None:
        weight, colour, text = look
        path, longest = QPainterPath(), np.empty((0, 2))
        for curve in curves:
            within = lens.outline.contains(curve[:, 0], curve[:, 1])
            _add_curve(path, curve, within)
            if within.sum() > len(longest):
                longest = curve[within]
        self._add_path(path, colour, _WIDTHS[weight])
        if weight and len(longest) > 40:
            self._add_label(longest, text)

    def _add_label(self, curve: Floats, text: str) -> None:
        """Name a level at the place of its longest line that is farthest from the names that there are."""
        taken = np.array([[label.pos().x(), label.pos().y()] for label in self.labels]).reshape(-1, 2)
        away = np.linalg.norm(curve[:, None] - taken, axis=2).min(axis=1, initial=np.inf)
        if away.max() < _APART:
            return
        at = curve[len(curve) // 2 if np.isinf(away).all() else int(np.argmax(np.minimum(away, 3 * _APART)))]
        label = pg.TextItem(text, color="#202428", anchor=(0.5, 0.5), fill=(255, 255, 255, 130))
        font = self.font()
        font.setPointSizeF(7.0)
        label.setFont(font)
        label.setPos(*at)
        self.plot.addItem(label)
        self.labels.append(label)

    def _add_path(self, path: QPainterPath, colour: str, width: float) -> None:
        item = QGraphicsPathItem(path)
        pen = pg.mkPen(QColor(colour), width=width)
        pen.setCosmetic(True)
        item.setPen(pen)
        self.plot.addItem(item, ignoreBounds=True)
        self.lines.append(item)

    def _frame(self, lens: Lens) -> None:
        """Fit the view to the lens when it is a new one; zoom and shift stay otherwise."""
        if self._framed is not None and self._framed.outline is lens.outline and self._framed.side == lens.side:
            return
        self._framed = lens
        x0, x1, y0, y1 = lens.outline.box
        self.plot.setRange(QRectF(x0, y0, x1 - x0, y1 - y0), padding=0.03)
        words = ("temporal", "nasal") if lens.side == "R" else ("nasal", "temporal")
        self.plot.setLabel("bottom", f"{words[0]}  ←  x, mm  →  {words[1]}")
        self.plot.setLabel("left", "y, mm")

    def _moved(self, position: Any) -> None:
        if self._shown is None or not self.plot.sceneBoundingRect().contains(position):
            return
        point = self.plot.plotItem.vb.mapSceneToView(position)
        if self._shown[0].lens.outline.contains(point.x(), point.y()):
            self.pointed.emit((point.x(), point.y()), None)


def band_image(lens: Lens, lens_map: LensMap, bands: Bands) -> tuple[np.ndarray, tuple[float, float, float, float]]:
    """A map as RGBA pixels (w, h, 4), clear beyond the outline, and its box (x0, x1, y0, y1) mm; bands cut to the pixel."""
    x, y, values = (
        _finer(lens_map.x),
        _finer(lens_map.y),
        extended(lens_map) if bands.cyclic else _finer_grid(extended(lens_map)),
    )
    if bands.cyclic:
        values = np.repeat(np.repeat(values, _FINE, 0), _FINE, 1)[: y.size, : x.size]
    inside = lens.outline.contains(x[None, :], y[:, None]) & np.isfinite(values)
    rank = np.searchsorted(bands.shifted, np.nan_to_num(values), side="right") - 1
    pixels = np.zeros((*values.shape, 4), np.uint8)
    pixels[..., :3] = np.round(255 * bands.colours)[np.clip(rank, 0, len(bands.colours) - 1)]
    pixels[..., 3] = np.where(inside, 255, 0)
    half = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    return pixels.transpose(1, 0, 2), (x[0] - half[0], x[-1] + half[0], y[0] - half[1], y[-1] + half[1])


def _finer(axis: Floats) -> Floats:
    return np.linspace(axis[0], axis[-1], (axis.size - 1) * _FINE + 1)


def _finer_grid(values: Floats) -> Floats:
    """Values (ny, nx) between the samples, linear along both axes."""
    share = np.arange(_FINE) / _FINE
    for _ in range(2):
        steps = values[:-1, None, :] + share[None, :, None] * (values[1:] - values[:-1])[:, None, :]
        values = np.concatenate([steps.reshape(-1, values.shape[1]), values[-1:]]).T
    return values


def _polygon_path(points: Floats) -> QPainterPath:
    path = QPainterPath()
    path.addPolygon(QPolygonF([QPointF(*p) for p in (*points, points[0])]))
    return path


def _add_curve(path: QPainterPath, curve: Floats, within: np.ndarray) -> None:
    """The parts of a curve (k, 2) that lie within."""
    for run_ in np.split(np.arange(len(curve)), np.flatnonzero(np.diff(within.astype(int))) + 1):
        if run_.size > 1 and within[run_[0]]:
            path.addPolygon(QPolygonF([QPointF(*p) for p in curve[run_]]))


def _mark_path(name: str, x: float, y: float) -> QPainterPath:
    """A cross for the fitting point, rings for far and near, a dot for the prism reference point."""
    path = QPainterPath()
    if name == "fitting_point":
        for dx, dy in ((1.8, 0.0), (0.0, 1.8)):
            path.moveTo(x - dx, y - dy)
            path.lineTo(x + dx, y + dy)
        return path
    radius = {"distance_reference_point": 1.4, "near_reference_point": 1.0}.get(name, 0.25)
    path.addEllipse(QPointF(x, y), radius, radius)
    return path
