"""Pictures refine when nobody waits for the window; what is written on them stays legible."""

import math
import time
from types import SimpleNamespace

import pytest
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainter, QPixmap

from lensbench.gui.stage_widget import StageWidget
from lensbench.gui.view_content import ViewContent
from lensbench.views.stage import FINENESS


def test_a_stage_is_drawn_finely_when_nobody_waits(qtbot, monkeypatch):
    widget, drawn = StageWidget(), []
    qtbot.addWidget(widget)
    monkeypatch.setattr(widget, "render_stage", drawn.append)
    widget.haste = lambda: 0.15
    widget.refresh()
    qtbot.wait(400)
    assert drawn == [1]
    widget.haste = lambda: 0.0
    qtbot.waitUntil(lambda: drawn == [1, FINENESS], timeout=2000)


class Drawn(Exception):
    """A pass was drawn."""


@pytest.fixture
def view(qtbot):
    def render():
        raise Drawn

    content = ViewContent()
    qtbot.addWidget(content)
    content._view, content._window = SimpleNamespace(done=False, close=lambda: None), SimpleNamespace(Render=render)
    yield content
    content._view = None


@pytest.mark.parametrize(
    ("haste", "since", "drawn"),
    [(0.0, 0.0, True), (0.15, 0.05, False), (0.15, 0.3, True), (math.inf, 10.0, False)],
)
def test_a_pass_of_the_view_stands_back(view, haste, since, drawn):
    view.haste, view._drawn = lambda: haste, time.monotonic() - since
    if drawn:
        with pytest.raises(Drawn):
            view._one_pass()
    else:
        view._one_pass()


def test_words_on_a_stage_do_not_cover_each_other(qtbot, monkeypatch):
    """As "nasal" and "temporal" where a lens is seen from its side."""
    widget, written = StageWidget(), []
    qtbot.addWidget(widget)
    monkeypatch.setattr(widget, "_on_widget", lambda point: QPointF(50.0, 80.0 + point))
    widget.words = [(0.0, "nasal"), (3.0, "temporal"), (60.0, "far")]
    pixmap = QPixmap(200, 200)
    painter = QPainter(pixmap)
    spy = SimpleNamespace(
        setPen=painter.setPen,
        fillRect=painter.fillRect,
        fontMetrics=painter.fontMetrics,
        drawText=lambda box, *_: written.append(QRectF(box)),
    )
    widget._draw_words(spy)
    painter.end()
    assert not any(a.intersects(b) for k, a in enumerate(written) for b in written[:k])
    assert written[0].bottom() == 78.0
    assert written[2].bottom() == 138.0
