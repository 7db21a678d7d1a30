"""The simulated view in its viewport: every pass is shown as it comes. Drag: turn the head; with Ctrl: the eye."""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, QTimer
from PySide6.QtGui import QHideEvent, QImage, QMouseEvent, QPainter, QPaintEvent, QPen, QResizeEvent, QShowEvent
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow

from ..errors import LensBenchError
from ..layers import Probe, SeenScene, ViewLayer
from ..seen import parts_by_zone
from ..session import Pane, Workbench
from ..views.jitter import JitterPass
from ..views.jitter.view_pass import VerticesNeeded, ZonesParts
from ..views.offscreen import require_gl
from .content import MARK, Content, say_nothing
from .scene_source import answer_with_scene

PASSES, TURN = 48, 0.15  # degrees a pixel of dragging
MOVING_PIXELS = 420_000  # more are too many to follow a hand
REST = 160  # ms until a picture counts as at rest


class ViewContent(Content):
    """What the wearer sees; the pointer tells what it meets. Coarse while it moves, in all pixels when it rests."""

    def __init__(self) -> None:
        super().__init__()
        self.setMouseTracking(True)
        self.setMinimumSize(160, 120)
        self.seen: SeenScene | None = None
        self._view: JitterPass | None = None
        self._by_vertices = False
        self._window: Any = None
        self._pixels = vtkUnsignedCharArray()
        self._image = QImage()
        self._passes = 0  # in the image that is shown
        self._drawn = 0.0
        self._last: QPointF | None = None
        self._probe: Probe | None = None
        self._next = QTimer(self, interval=0)
        self._next.timeout.connect(self._one_pass)
        self._rest = QTimer(self, singleShot=True, interval=REST)
        self._rest.timeout.connect(self._refine)

    def question(self, bench: Workbench, pane: Pane) -> Any:
        lens = bench.lens_of(pane)
        if lens is None:
            return None
        wearer = bench.worn_by(lens)
        layer = ViewLayer(
            pane.eye,
            *np.radians([pane.azimuth, pane.elevation, pane.width / 2]).tolist(),
            accommodation=bench.accommodation,
            head_turn=float(np.radians(bench.head_turn)),
            head_tilt=float(np.radians(bench.head_tilt)),
            split=pane.split,
        )
        found = partial(answer_with_scene, lens, wearer, layer, bench.scene)
        return (lens, wearer, layer, bench.scene, self._by_vertices), partial(_seen, found, self._by_vertices)

    def show_answer(self, answer: tuple[SeenScene, ZonesParts | None], bench: Workbench, pane: Pane) -> None:
        if self._view is None:
            self._open_stage()
        try:
            self._view.show(*answer)
        except VerticesNeeded:
            self.close_stage()
            self._by_vertices = True
            self.wants_edit.emit("", None, "vertices")
            return
        self.seen = answer[0]
        self._move()

    def _open_stage(self) -> None:
        """Raises LensBenchError where this machine cannot draw."""
        require_gl()
        window, renderer = vtkRenderWindow(), vtkRenderer()
        window.SetOffScreenRendering(True)
        window.AddRenderer(renderer)
        try:
            self._view = JitterPass(window, renderer, PASSES, by_vertices=self._by_vertices)
            self._view.traces = False
        except LensBenchError:
            window.Finalize()
            raise
        self._window = window

    def _move(self) -> None:
        """Begin anew, in few pixels until the picture rests."""
        self._passes = 0
        self._draw_in(MOVING_PIXELS)
        self._rest.start()

    def _refine(self) -> None:
        if self.haste():
            self._rest.start()
        else:
            self._draw_in(np.inf)

    def _draw_in(self, most: float) -> None:
        """Draw in the pixels of the widget, or in at most so many."""
        if self._view is None or self.seen is None:
            return
        width, height = (max(32, round(n * self.devicePixelRatioF())) for n in (self.width(), self.height()))
        scale = min(1.0, (most / (width * height)) ** 0.5)
        size = int(width * scale), int(height * scale)
        if size != self._window.GetSize():
            self._window.SetSize(*size)
            self._view.reset()
        self.seen = replace(self.seen, layer=replace(self.seen.layer, size=size))
        self._next.start()

    def show_probe(self, probe: Probe | None) -> None:
        self._probe = probe
        self.update()

    def close_stage(self) -> None:
        self._next.stop()
        self._rest.stop()
        if self._view is not None:
            self._view.close()
            self._window.Finalize()
            self._view = self._window = None

    def light(self) -> Any:
        """The mean light (h, w, 3) of the passes so far; None before there is a view."""
        if self._view is None:
            return None
        if not self._view.count:
            self._window.Render()
        return self._view.light()

    @property
    def passes(self) -> int:
        """Passes in the picture so far."""
        return self._passes

    @property
    def at_rest(self) -> bool:
        return self._view is not None and self._view.done and not self._rest.isActive()

    def _one_pass(self) -> None:
        if self._view is None or self._view.done:
            self._next.stop()
            return
        if time.monotonic() - self._drawn < self.haste():
            self._next.setInterval(5)
            return
        self._next.setInterval(0)
        self._window.Render()
        if self._view.count >= self._passes:  # the first of finer pixels are worse than what is shown
            self._show_drawn()
        self._drawn = time.monotonic()

    def _show_drawn(self) -> None:
        width, height = self._window.GetSize()
        self._window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, self._pixels)
        pixels = np.ascontiguousarray(vtk_to_numpy(self._pixels).reshape(height, width, 4)[::-1])
        self._image = QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_RGBX8888).copy()
        self._passes = self._view.count
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHints(QPainter.RenderHint.SmoothPixmapTransform | QPainter.RenderHint.Antialiasing)
        if self._image.isNull():
            say_nothing(self, painter, "")
            return
        painter.drawImage(QRectF(self.rect()), self._image)
        spot = self._on_widget(self._probe)
        if spot is not None:
            painter.setPen(QPen(MARK, 2))
            painter.drawEllipse(spot, 7, 7)
            painter.drawPoint(spot)

    def _on_widget(self, probe: Probe | None) -> QPointF | None:
        """Where a gaze of the worn lens is in the picture."""
        if probe is None or self.seen is None or not np.isfinite(probe.direction).all():
            return None
        local = self.seen.frame @ self.seen.head @ probe.direction
        if local[2] < 0.1:
            return None
        scale = self.width() / 2 / np.tan(self.seen.layer.half_width)
        return QPointF(self.width() / 2 - scale * local[0] / local[2], self.height() / 2 - scale * local[1] / local[2])

    def _direction(self, here: QPointF) -> tuple[float, ...]:
        """The gaze (3,) of a place on the widget, wear frame of the head."""
        assert self.seen is not None
        scale = self.width() / 2 / np.tan(self.seen.layer.half_width)
        local = np.array([(self.width() / 2 - here.x()) / scale, (self.height() / 2 - here.y()) / scale, 1.0])
        direction = self.seen.head.T @ self.seen.frame.T @ local
        return tuple(float(v) for v in direction / np.linalg.norm(direction))

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if self._view is not None:
            self._next.start()
            self._rest.start()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._next.stop()
        self._rest.stop()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._move()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._last = event.position()

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        self._last = None
        self.wants_edit.emit("", lambda bench: bench, "")

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        here = event.position()
        if self._last is None or not event.buttons() & Qt.MouseButton.LeftButton:
            if self.seen is not None and self.seen.layer.through_lens:
                self.pointed.emit(None, self._direction(here))
            return
        step, self._last = here - self._last, here
        left, up = -TURN * step.x(), TURN * step.y()
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.wants_edit.emit("Turn of the eye", partial(self._turn_eye, left, up), "eye")
        else:
            self.wants_edit.emit("Turn of the head", partial(_turn_head, left, up), "head")

    def _turn_eye(self, left: float, up: float, bench: Workbench, k: int = 0) -> Workbench:
        pane = bench.panes[k]
        azimuth, elevation = np.clip([pane.azimuth - left, pane.elevation + up], -80, 80).tolist()
        return bench.with_pane(k, azimuth=azimuth, elevation=elevation)


def _seen(found: Callable[[], SeenScene], by_vertices: bool) -> tuple[SeenScene, ZonesParts | None]:
    seen = found()
    return seen, parts_by_zone(seen) if by_vertices else None


def _turn_head(left: float, up: float, bench: Workbench) -> Workbench:
    turn, tilt = np.clip([bench.head_turn - left, bench.head_tilt + up], -60, 60).tolist()
    return replace(bench, head_turn=turn, head_tilt=tilt)
