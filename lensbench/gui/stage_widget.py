"""A stage of VTK in a widget: drawn off screen and shown as a picture, so that it needs no OpenGL of Qt's, works on any
platform of Qt, and can be grabbed, printed and overlaid as any widget.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QWidget

from ..optics.conventions import Floats
from ..views.lens3d import in_view
from ..views.stage import FINENESS, stage
from .content import MARK, say_nothing


class StageWidget(QWidget):
    """Holds a stage. Drag: turn; right drag or wheel: zoom; middle drag: shift. Coarse while it moves, fine when it rests.

    turned(): by the user. hovered(x, y): -1 to 1 over width and height, up positive.
    """

    turned = Signal()
    hovered = Signal(float, float)

    def __init__(self) -> None:
        super().__init__()
        self.stage: Any = None
        self.haste: Callable[[], float] = lambda: 0.0  # as Lane.haste
        self.mark: Floats | None = None
        self.words: list[tuple[Floats, str]] = []
        self.setMouseTracking(True)
        self.setMinimumSize(160, 120)
        self._image = QImage()
        self._last: QPointF | None = None
        self._empty = ""
        self._rest = QTimer(self, singleShot=True, interval=160)
        self._rest.timeout.connect(self._refine)

    def draw(self, put: Callable[[Any], None]) -> None:
        """Clear the stage and put something on it; the camera stays."""
        if self.stage is None:
            self.stage = stage((max(self.width(), 16), max(self.height(), 16)))
        self.stage.suppress_rendering = True
        self.stage.clear_actors()
        put(self.stage)
        self._empty = ""
        self.refresh()

    def show_nothing(self, text: str) -> None:
        """A sentence instead of a picture."""
        self._empty = text
        self.update()

    def refresh(self) -> None:
        """Draw coarsely now and finely when all rests."""
        self.render_stage(1)
        self._rest.start()

    @property
    def at_rest(self) -> bool:
        """Whether it is drawn finely."""
        return not self._rest.isActive()

    def _refine(self) -> None:
        if self.haste():
            self._rest.start()
        else:
            self.render_stage(FINENESS)

    def render_stage(self, fineness: int) -> None:
        """Draw the stage with so many pixels a pixel."""
        if self.stage is None:
            return
        ratio = self.devicePixelRatioF() * fineness
        size = max(16, round(self.width() * ratio)), max(16, round(self.height() * ratio))
        self.stage.suppress_rendering = False
        self.stage.window_size = size
        pixels = np.ascontiguousarray(self.stage.screenshot(return_img=True)[..., :3])
        height, width, _ = pixels.shape  # what a window manager or a driver gave
        self._image = QImage(pixels.data, width, height, 3 * width, QImage.Format.Format_RGB888).copy()
        self.update()

    def look_like(self, other: "StageWidget") -> None:
        """Take the other stage's camera."""
        if self.stage is not None and other.stage is not None:
            self.stage.camera.DeepCopy(other.stage.camera)
            self.stage.reset_camera_clipping_range()
            self.refresh()

    def look_from(self, direction: tuple[float, float, float], up: tuple[float, float, float]) -> None:
        """See all of the stage from a direction."""
        if self.stage is not None:
            camera = self.stage.camera
            camera.position = np.array(camera.focal_point) + camera.distance * np.array(direction)
            camera.up = up
            self.stage.renderer.ResetCamera()
            self.refresh()

    def close_stage(self) -> None:
        """Free what is held on the graphics card."""
        self._rest.stop()
        if self.stage is not None:
            self.stage.close()
            self.stage.deep_clean()
            self.stage = None

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHints(QPainter.RenderHint.SmoothPixmapTransform | QPainter.RenderHint.Antialiasing)
        if self._empty or self._image.isNull():
            say_nothing(self, painter, self._empty)
            return
        painter.drawImage(QRectF(self.rect()), self._image)
        self._draw_words(painter)
        if self.mark is not None and np.isfinite(self.mark).all():
            spot = self._on_widget(self.mark)
            painter.setPen(QPen(MARK, 2))
            painter.drawEllipse(spot, 6, 6)
            painter.drawLine(spot - QPointF(11, 0), spot + QPointF(11, 0))
            painter.drawLine(spot - QPointF(0, 11), spot + QPointF(0, 11))

    def _draw_words(self, painter: QPainter) -> None:
        """Each beside its point, or above what is written there."""
        painter.setPen(QColor("#566069"))
        taken: list[QRectF] = []
        for point, word in self.words:
            box = QRectF(painter.fontMetrics().boundingRect(word))
            box.moveBottomLeft(self._on_widget(point) + QPointF(6, -2))
            box.translate(min(0.0, self.width() - 2 - box.right()), 0)
            while any(box.intersects(other) for other in taken):
                box.translate(0, -box.height())
            taken.append(box)
            painter.fillRect(box, QColor(255, 255, 255, 190))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextDontClip, word)

    def _on_widget(self, point: Floats) -> QPointF:
        x, y = in_view(self.stage, np.asarray(point)[None])[0]
        return QPointF((x + 1) / 2 * self.width(), (1 - y) / 2 * self.height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if self.stage is not None:
            self.refresh()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._last = event.position()

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        self._last = None

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        here = event.position()
        if self._last is None or self.stage is None:
            across, up = 2 * here.x() / max(1, self.width()) - 1, 1 - 2 * here.y() / max(1, self.height())
            self.hovered.emit(across, up)
            return
        step, self._last = here - self._last, here
        camera = self.stage.camera
        if event.buttons() & Qt.MouseButton.LeftButton:
            camera.Azimuth(-0.5 * step.x())
            camera.Elevation(0.5 * step.y())
            camera.OrthogonalizeViewUp()
        elif event.buttons() & Qt.MouseButton.RightButton:
            camera.Zoom(1.01 ** -step.y())
        elif event.buttons() & Qt.MouseButton.MiddleButton:
            self._shift(step)
        self._moved()

    def wheelEvent(self, event: QWheelEvent) -> None:
        if self.stage is not None:
            self.stage.camera.Zoom(1.1 ** (event.angleDelta().y() / 120))
            self._moved()

    def _shift(self, step: QPointF) -> None:
        camera = self.stage.camera
        height = 2 * camera.GetDistance() * np.tan(np.radians(camera.GetViewAngle() / 2))
        right = np.cross(camera.GetDirectionOfProjection(), camera.GetViewUp())
        move = (-step.x() * right + step.y() * np.array(camera.GetViewUp())) * height / max(1, self.height())
        camera.SetFocalPoint(*(np.array(camera.GetFocalPoint()) + move))
        camera.SetPosition(*(np.array(camera.GetPosition()) + move))

    def _moved(self) -> None:
        self.stage.reset_camera_clipping_range()
        self.refresh()
        self.turned.emit()
