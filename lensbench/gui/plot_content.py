"""Plots in a viewport: power along the main meridian, and the distortion grid."""

from functools import partial
from typing import Any

import numpy as np
import pyqtgraph as pg
from PySide6.QtWidgets import QVBoxLayout

from ..layers import DistortionGrid, DistortionLayer, Probe, Profile, ProfileLayer
from ..optics.lens import Lens
from ..session import Pane, Workbench
from ..views.comparison import COLOURS
from .content import Content
from .map_content import MARK
from .scene_source import answer_with_scene


class PlotContent(Content):
    """One or more plots side by side."""

    def __init__(self) -> None:
        super().__init__()
        self.plots = pg.GraphicsLayoutWidget()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.plots)
        self._shown: tuple[Any, ...] | None = None

    def _plot(self, column: int, bottom: str, left: str = "") -> pg.PlotItem:
        plot = self.plots.addPlot(0, column)
        plot.setMenuEnabled(False)
        plot.hideButtons()
        plot.showGrid(x=True, y=True, alpha=0.15)
        plot.setLabel("bottom", bottom)
        for side in ("bottom", "left"):
            plot.getAxis(side).enableAutoSIPrefix(False)
        if left:
            plot.setLabel("left", left)
        return plot


class ProfileContent(PlotContent):
    """Mean power and astigmatism against height, of every lens on the table; the shown one is drawn strongest."""

    def __init__(self) -> None:
        super().__init__()
        self.power = self._plot(0, "as-worn mean power, D", "y, mm")
        self.astigmatism = self._plot(1, "astigmatism, D")
        self.astigmatism.setYLink(self.power)
        self.legend = self.power.addLegend(offset=(8, 4), labelTextSize="8pt")
        self.levels = [pg.InfiniteLine(angle=0, pen=pg.mkPen(MARK, width=1.5)) for _ in range(2)]
        for plot, line in zip((self.power, self.astigmatism), self.levels, strict=True):
            line.setVisible(False)
            plot.addItem(line, ignoreBounds=True)
            plot.scene().sigMouseMoved.connect(partial(self._moved, plot))

    def question(self, bench: Workbench, pane: Pane) -> Any:
        if not bench.lenses:
            return None
        lenses, layer = tuple(entry.lens for entry in bench.lenses), ProfileLayer(bench.distance)
        shown = bench.lens_of(pane)
        scene = bench.scene if bench.distance == "scene" else ""
        return (lenses, shown, bench.active_wearer, layer, scene), partial(
            _profiles, lenses, bench.active_wearer, layer, scene
        )

    def show_answer(self, answer: list[Profile], bench: Workbench, pane: Pane) -> None:
        shown = bench.lens_of(pane)
        self._shown = shown, answer[next(k for k, entry in enumerate(bench.lenses) if entry.lens is shown)]
        for plot in (self.power, self.astigmatism):
            for item in plot.listDataItems():
                plot.removeItem(item)
        for k, (entry, profile) in enumerate(zip(bench.lenses, answer, strict=True)):
            strong = entry.lens is shown
            pen = pg.mkPen(COLOURS[k % len(COLOURS)], width=2.6 if strong else 1.2)
            self.power.plot(profile.mean_power, profile.y, pen=pen, name=entry.lens.name[:38])
            self.astigmatism.plot(profile.astigmatism, profile.y, pen=pen)

        self.legend.setVisible(len(answer) > 1)

    def show_probe(self, probe: Probe | None) -> None:
        known = probe is not None and np.isfinite(probe.point).all()
        for line in self.levels:
            line.setVisible(bool(known))
            if known:
                line.setValue(probe.point[1])

    def figure(self) -> Any:
        from ..views.maps import profile_figure

        return None if self._shown is None else profile_figure(*self._shown)

    def _moved(self, plot: pg.PlotItem, position: Any) -> None:
        if self._shown is None or not plot.sceneBoundingRect().contains(position):
            return
        y = plot.vb.mapSceneToView(position).y()
        profile = self._shown[1]
        if profile.y[0] <= y <= profile.y[-1]:
            self.pointed.emit((float(np.interp(y, profile.y, profile.x)), float(y)), None)


def _profiles(lenses: tuple[Lens, ...], wearer: Any, layer: ProfileLayer, scene: str) -> list[Profile]:
    return [answer_with_scene(lens, wearer, layer, scene) for lens in lenses]


class DistortionContent(PlotContent):
    """A chart of upright lines (pale) and how the turning eye sees it, as the wearer looks at it: his left on the left."""

    def __init__(self) -> None:
        super().__init__()
        self.plot = self._plot(0, "wearer's left  ←  direction, °  →  right", "up, °")
        self.plot.setAspectLocked(True)
        self.chart, self.image = (
            pg.PlotDataItem(pen=pg.mkPen(c, width=w), connect="finite") for c, w in (("#aab2b9", 1), ("#1f6aa5", 2))
        )
        self.spot = pg.ScatterPlotItem(size=12, pen=pg.mkPen(MARK, width=2), brush=None)
        for item in (self.chart, self.image, self.spot):
            self.plot.addItem(item)
        self.plot.scene().sigMouseMoved.connect(self._moved)

    def question(self, bench: Workbench, pane: Pane) -> Any:
        lens, wearer = bench.lens_of(pane), bench.active_wearer
        depth = np.inf if isinstance(bench.distance, str) else bench.distance
        layer = DistortionLayer(depth)
        return (lens, wearer, layer), partial(answer_with_scene, lens, wearer, layer, "")

    def show_answer(self, answer: DistortionGrid, bench: Workbench, pane: Pane) -> None:
        self._shown = bench.lens_of(pane), answer
        for item, points in ((self.chart, answer.object), (self.image, answer.apparent)):
            item.setData(*_lines(points, answer.layer.fineness))

    def show_probe(self, probe: Probe | None) -> None:
        if probe is None or not np.isfinite(probe.direction).all():
            self.spot.clear()
        else:
            x, y, z = probe.direction
            self.spot.setData([-np.degrees(np.arctan2(x, z))], [np.degrees(np.arctan2(y, z))])

    def _moved(self, position: Any) -> None:
        if self._shown is not None and self._shown[0] is not None and self.plot.sceneBoundingRect().contains(position):
            at = self.plot.vb.mapSceneToView(position)
            right, up = np.tan(np.radians(np.clip([at.x(), at.y()], -70, 70)))
            direction = np.array([-right, up, 1.0])
            self.pointed.emit(None, tuple(float(v) for v in direction / np.linalg.norm(direction)))

    def figure(self) -> Any:
        from ..views.distortion import distortion_figure

        return None if self._shown is None else distortion_figure(*self._shown)


def _lines(points: Any, step: int) -> tuple[Any, Any]:
    """Rows and columns of a chart (n, n, 2), tangents, as one broken line in degrees, the wearer's left to the left."""
    degrees = np.degrees(np.arctan(points)) * [-1.0, 1.0]
    gap = np.full((1, 2), np.nan)
    lines = [*degrees[::step], *degrees[:, ::step].swapaxes(0, 1)]
    return tuple(np.concatenate([part for line in lines for part in (line, gap)]).T)  # type: ignore[return-value]
