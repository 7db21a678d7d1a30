"""Pictures refine when nobody waits for the window; what is written on them stays legible."""

import gc
import math
import time
from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainter, QPixmap

from lensbench.errors import LensBenchError
from lensbench.gui import view_content
from lensbench.gui.stage_widget import StageWidget
from lensbench.gui.view_content import ViewContent
from lensbench.layers import Request, ViewLayer
from lensbench.optics.eye import Wearer
from lensbench.scenes.builtin import load_scene
from lensbench.session import Pane, Workbench
from lensbench.views.stage import FINENESS
from lensbench.workbench import run


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


SIZE = 1100, 800


@pytest.fixture
def wide(qtbot, monkeypatch):
    """A view with more pixels than can follow a hand; the sizes of the pictures that it shows, and their passes."""
    monkeypatch.setattr(view_content, "PASSES", 5)
    content, shown = ViewContent(), []
    qtbot.addWidget(content)
    content.resize(*SIZE)
    show = content._show_drawn
    content._show_drawn = lambda: (show(), shown.append((content._image.size().toTuple(), content.passes)))
    content.show()
    yield content, shown
    content.close_stage()


def test_a_view_at_rest_is_drawn_in_all_pixels_of_its_viewport(qtbot, wide):
    content, shown = wide
    for azimuth in (0.0, 0.1):
        shown.clear()
        seen = run(Request(None, Wearer(), ViewLayer("naked", azimuth), load_scene("chart")))
        content.show_answer((seen, None), Workbench(), Pane("view"))
        assert not content.at_rest
        qtbot.waitUntil(lambda: content.at_rest, timeout=20000)
        sizes, passes = zip(*shown, strict=True)
        assert sizes[0][0] * sizes[0][1] <= view_content.MOVING_PIXELS
        assert sizes[-1] == SIZE
        assert passes[-1] == 5
        first_fine = sizes.index(SIZE)
        assert passes[first_fine] >= passes[first_fine - 1], "the picture became coarser when it came to rest"
        assert content.light().shape[:2] == SIZE[::-1]
        assert content.seen.layer.size == SIZE


def test_a_view_that_cannot_be_drawn_leaves_no_window(wide, monkeypatch):
    content, _ = wide
    ended = []

    def refuse(window, *_, **__):
        window.AddObserver("DeleteEvent", lambda *_: ended.append(True))
        raise LensBenchError("no")

    monkeypatch.setattr(view_content, "JitterPass", refuse)
    seen = run(Request(None, Wearer(), ViewLayer("naked"), load_scene("chart")))
    for _ in range(2):
        with pytest.raises(LensBenchError, match="no"):
            content.show_answer((seen, None), Workbench(), Pane("view"))
    gc.collect()
    assert len(ended) == 2
    assert not content.at_rest


def test_a_stage_shows_the_picture_that_it_got(qtbot, monkeypatch):
    """Which may be smaller than asked for."""
    widget = StageWidget()
    qtbot.addWidget(widget)
    widget.resize(300, 200)
    widget.draw(lambda plotter: None)
    monkeypatch.setattr(widget.stage, "screenshot", lambda **_: np.full((50, 70, 3), 9, np.uint8))
    widget.render_stage(1)
    assert widget._image.size().toTuple() == (70, 50)
    assert widget._image.pixelColor(69, 49).red() == 9
    widget.close_stage()


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
