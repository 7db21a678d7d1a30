"""Plots in a viewport: power along the main meridian, and the distortion grid."""

from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from ..layers import DistortionGrid, DistortionLayer, Probe, Profile, ProfileLayer
from ..optics.conventions import mean_power
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..session import Pane, Workbench
from .content import MARK
from .plot import Plot, step_for
from .scene_source import answer_with_scene

MEAN, ASTIGMATISM, ORDERED = QColor("#2f6fb5"), QColor("#d9822b"), QColor("#8a4fa3")
Profiles = tuple[tuple[Lens, Profile], ...]


class ProfileContent(Plot):
    """Mean power with the span of powers, and astigmatism, against height; the other lenses on the table thin."""

    def __init__(self) -> None:
        super().__init__()
        self.margins = (56.0, 26.0, 14.0, 40.0)
        self.profiles: Profiles = ()

    def question(self, bench: Workbench, pane: Pane) -> Any:
        shown = bench.lens_of(pane)
        if shown is None:
            return None
        lenses = (shown, *(entry.lens for entry in bench.lenses if entry.lens is not shown))
        worn = tuple((lens, bench.worn_by(lens)) for lens in lenses)
        scene = bench.scene if bench.distance == "scene" else ""
        layer = ProfileLayer(bench.distance)
        return (worn, layer, scene), partial(_profiles, worn, layer, scene)

    def show_answer(self, answer: Profiles, bench: Workbench, pane: Pane) -> None:
        self.profiles = answer
        powers = np.concatenate(
            [np.r_[p.least_power, p.greatest_power, p.astigmatism, 0.0] for _, p in answer if p.y.size]
        )
        low, high = float(powers.min()), float(powers.max())
        step = step_for(high - low + 0.2, 8)
        _, _, y0, y1 = answer[0][0].outline.box
        self.box = (step * np.floor(low / step - 0.1), step * np.ceil(high / step + 0.1), y0, y1)
        self.draw_again()

    def show_probe(self, probe: Probe | None) -> None:
        self.mark((0.0, probe.point[1]) if probe is not None and np.isfinite(probe.point).all() else None)

    def pointed_at(self, x: float, y: float) -> None:
        if self.profiles:
            profile = self.profiles[0][1]
            if profile.y[0] <= y <= profile.y[-1]:
                self.pointed.emit((float(np.interp(y, profile.y, profile.x)), y), None)

    def figure(self) -> Any:
        from ..views.maps import profile_figure

        return profile_figure(*self.profiles[0]) if self.profiles else None

    def draw(self, painter: QPainter) -> None:
        """Curves over the axes."""
        if not self.profiles:
            return
        self.draw_axes(painter, "as-worn power, D", "y, mm")
        painter.save()
        painter.setClipRect(self.area())
        self._draw_ordered(painter, self.profiles[0][0])
        for k, (_, profile) in reversed(list(enumerate(self.profiles))):
            self._draw_curves(painter, profile, strong=k == 0)
        painter.restore()
        self._draw_key(painter)

    def draw_mark(self, painter: QPainter, at: QPointF) -> None:
        """The height of the probed gaze."""
        painter.setPen(QPen(MARK, 1.6))
        painter.drawLine(QLineF(self.area().left(), at.y(), self.area().right(), at.y()))

    def _draw_curves(self, painter: QPainter, profile: Profile, strong: bool) -> None:
        if strong:
            band = QColor(MEAN)
            band.setAlphaF(0.18)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(band)
            ring = np.r_[profile.least_power, profile.greatest_power[::-1]], np.r_[profile.y, profile.y[::-1]]
            painter.drawPolygon(self.polygon(np.column_stack(ring)))
            painter.setBrush(Qt.BrushStyle.NoBrush)
        for values, colour in ((profile.mean_power, MEAN), (profile.astigmatism, ASTIGMATISM)):
            pen = QPen(colour, 2.2) if strong else QPen(colour, 1.1, Qt.PenStyle.DashLine)
            painter.setPen(pen)
            painter.drawPolyline(self.polygon(np.column_stack([values, profile.y])))

    def _draw_ordered(self, painter: QPainter, lens: Lens) -> None:
        painter.setPen(QPen(self.ink(0.35), 1, Qt.PenStyle.DotLine))
        for _, y in set(lens.points.named().values()):
            painter.drawLine(self.pixel(self.box[0], y), self.pixel(self.box[1], y))
        if lens.ordered is None:
            return
        painter.setPen(QPen(ORDERED, 1.3, Qt.PenStyle.DashDotLine))
        for near in (False, True):
            x = float(mean_power(lens.ordered.power(near)))
            painter.drawLine(self.pixel(x, self.box[2]), self.pixel(x, self.box[3]))

    def _draw_key(self, painter: QPainter) -> None:
        """Names of the curves in one line above the plot."""
        names = [("mean power", MEAN, Qt.PenStyle.SolidLine), ("astigmatism", ASTIGMATISM, Qt.PenStyle.SolidLine)]
        if self.profiles[0][0].ordered is not None:
            names.append(("ordered", ORDERED, Qt.PenStyle.DashDotLine))
        if len(self.profiles) > 1:
            names.append(("other lenses", self.ink(0.7), Qt.PenStyle.DashLine))
        x = self.area().left()
        for name, colour, style in names:
            painter.setPen(QPen(colour, 2.2, style))
            painter.drawLine(QPointF(x, 14), QPointF(x + 22, 14))
            painter.setPen(self.ink(0.85))
            width = painter.fontMetrics().horizontalAdvance(name)
            painter.drawText(QRectF(x + 27, 4, width + 6, 20), Qt.AlignmentFlag.AlignVCenter, name)
            x += width + 44


def _profiles(worn: tuple[tuple[Lens, Wearer], ...], layer: ProfileLayer, scene: str) -> Profiles:
    return tuple((lens, answer_with_scene(lens, wearer, layer, scene)) for lens, wearer in worn)


class DistortionContent(Plot):
    """A chart of upright lines (pale) and how the turning eye sees it, as the wearer looks at it, in degrees."""

    def __init__(self) -> None:
        super().__init__()
        self.equal = self.flip = True
        self.shown: tuple[Lens | None, DistortionGrid] | None = None

    def question(self, bench: Workbench, pane: Pane) -> Any:
        lens = bench.lens_of(pane)
        wearer = bench.worn_by(lens)
        layer = DistortionLayer(np.inf if isinstance(bench.distance, str) else bench.distance)
        return (lens, wearer, layer), partial(answer_with_scene, lens, wearer, layer, "")

    def show_answer(self, answer: DistortionGrid, bench: Workbench, pane: Pane) -> None:
        self.shown = bench.lens_of(pane), answer
        both = np.concatenate([answer.object.ravel(), answer.apparent.ravel()])
        reach = 1.04 * float(np.degrees(np.arctan(np.nanmax(np.abs(both)))))
        self.box = (-reach, reach, -reach, reach)
        self.draw_again()

    def show_probe(self, probe: Probe | None) -> None:
        known = probe is not None and np.isfinite(probe.direction).all() and probe.direction[2] > 0
        self.mark(tuple(np.degrees(np.arctan(probe.direction[:2] / probe.direction[2])).tolist()) if known else None)

    def pointed_at(self, x: float, y: float) -> None:
        if self.shown is not None and self.shown[0] is not None:
            direction = np.array([*np.tan(np.radians([x, y])), 1.0])
            self.pointed.emit(None, tuple((direction / np.linalg.norm(direction)).tolist()))

    def figure(self) -> Any:
        from ..views.distortion import distortion_figure

        return None if self.shown is None else distortion_figure(*self.shown)

    def draw(self, painter: QPainter) -> None:
        """Both grids."""
        if self.shown is None:
            return
        self.draw_axes(painter, "wearer's left  ←   direction, °   →  right", "up, °")
        grid = self.shown[1]
        for points, colour, width in ((grid.object, self.ink(0.3), 1.0), (grid.apparent, MEAN, 1.8)):
            painter.setPen(QPen(colour, width))
            degrees = np.degrees(np.arctan(points))
            for row in (*degrees[:: grid.layer.fineness], *degrees[:, :: grid.layer.fineness].swapaxes(0, 1)):
                for part in _unbroken(row):
                    painter.drawPolyline(self.polygon(part))


def _unbroken(row: Any) -> list[Any]:
    """The parts of a line (n, 2) whose points are known."""
    known = np.isfinite(row).all(axis=1)
    parts = np.split(row, np.flatnonzero(np.diff(known.astype(int))) + 1)
    return [part for part in parts if len(part) > 1 and np.isfinite(part[0]).all()]
