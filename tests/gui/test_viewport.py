"""A viewport with a lane whose answers we give: stale until answered, failures shown, asked only when something matters."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QObject, Signal

from lensbench.gui.document import Document
from lensbench.gui.viewport import CONTENTS, Viewport
from lensbench.layers import ProbeLayer, Request
from lensbench.session import KINDS, Workbench
from lensbench.workbench import run


class HeldLane(QObject):
    """Keeps the questions; the test answers."""

    answered = Signal(str, object)
    failed = Signal(str, str)
    stopped = Signal()

    def __init__(self):
        super().__init__()
        self.questions, self.dropped, self.haste = [], 0, 0.0

    def ask(self, asker, question, first=False):
        self.questions.append(question)

    def drop(self, asker=None):
        self.dropped += 1


@pytest.fixture
def lane(qtbot):
    return HeldLane()


@pytest.fixture
def document(qtbot, sphere):
    return Document(sphere)


@pytest.fixture
def viewport(qtbot, document, lane):
    viewport = Viewport(document, lane, 0)
    qtbot.addWidget(viewport)
    viewport.resize(420, 380)
    viewport.show()
    viewport.show_bench(None, document.workbench)
    return viewport


def stale(viewport):
    return "older than the settings" in viewport.state.toolTip() and viewport.state.text() != ""


def test_every_kind_has_a_content():
    assert set(CONTENTS) == set(KINDS)


def test_the_conoid_follows_the_probe_and_keeps_a_turned_camera(viewport, document, lane):
    document.edit("Kind", lambda bench: bench.with_pane(0, kind="conoid"))
    lane.answered.emit("viewport 1", lane.questions[-1]())
    content = viewport.content
    assert content.found.across[2] == pytest.approx([0, 0, 1], abs=1e-9)
    asked = len(lane.questions)
    probe = run(Request(document.workbench.lenses[0].lens, document.workbench.active_wearer, ProbeLayer((8.0, -10.0))))
    viewport.show_probe(probe)
    assert len(lane.questions) == asked + 1
    assert stale(viewport)
    lane.answered.emit("viewport 1", lane.questions[-1]())
    assert content.found.frame[2] == pytest.approx(probe.outgoing, abs=1e-9)
    assert content.found.exit == pytest.approx(probe.exit, abs=1e-6)
    viewport.show_probe(probe)
    assert len(lane.questions) == asked + 1
    content.camera_moved.emit()
    content.stage.stage.camera.position = (500.0, 0.0, 0.0)
    viewport.show_probe(replace(probe, direction=np.array([0.0, 0.0, 1.0])))
    lane.answered.emit("viewport 1", lane.questions[-1]())
    assert content.stage.stage.camera.position == (500.0, 0.0, 0.0)
    content.look("")
    assert content.stage.stage.camera.position != (500.0, 0.0, 0.0)


def test_the_conoid_says_when_no_ray_passes(viewport, document, lane):
    document.edit("Kind", lambda bench: bench.with_pane(0, kind="conoid"))
    viewport.content.gaze = (1.3, 0.0)
    viewport.show_bench(None, document.workbench)
    lane.answered.emit("viewport 1", lane.questions[-1]())
    assert viewport.answered
    assert viewport.content.found is None


def test_a_picture_is_stale_until_its_successor_is_there(viewport, document, lane):
    assert len(lane.questions) == 1
    assert stale(viewport)
    lane.answered.emit("viewport 1", lane.questions[-1]())
    assert viewport.state.text() == ""
    assert viewport.answered
    picture = viewport.content.picture()
    document.edit("Step", lambda bench: bench.with_pane(0, step=0.5, low=-8.0, high=0.0))
    assert stale(viewport)
    assert viewport.content.picture().size() == picture.size()
    lane.answered.emit("viewport 1", lane.questions[-1]())
    assert viewport.state.text() == ""
    assert viewport.content.picture() != picture


def test_an_older_answer_is_shown_and_marked_as_old(viewport, document, lane):
    """So that the picture follows a slider that is dragged without a rest."""
    document.edit("Distance", lambda bench: replace(bench, distance=500.0))
    old, new = lane.questions
    lane.answered.emit("viewport 1", old())
    assert viewport.answered
    assert stale(viewport)
    lane.answered.emit("viewport 1", new())
    assert not stale(viewport)


def test_the_answer_of_another_kind_is_not_shown(viewport, document, lane):
    document.edit("Kind", lambda bench: bench.with_pane(0, kind="profile"))
    lane.answered.emit("viewport 1", lane.questions[0]())
    assert not viewport.answered
    assert stale(viewport)


def test_only_what_matters_is_asked(viewport, document, lane):
    document.edit("Another pane", lambda bench: bench.with_pane(1, quantity="prism"))
    document.edit("Head", lambda bench: replace(bench, head_turn=5.0))
    document.edit("Depths", lambda bench: replace(bench, depths=(400.0,)))
    assert len(lane.questions) == 1
    document.edit("Distance", lambda bench: replace(bench, distance=500.0))
    assert len(lane.questions) == 2
    document.undo()
    assert len(lane.questions) == 3


def test_answers_to_others_are_not_shown(viewport, lane):
    lane.answered.emit("viewport 2", "nonsense")
    lane.failed.emit("viewport 2", "nonsense")
    assert stale(viewport)
    assert not viewport.answered


def test_a_failure_is_marked_and_said_and_the_old_picture_stays(viewport, document, lane):
    heard = []
    viewport.said.connect(heard.append)
    lane.answered.emit("viewport 1", lane.questions[-1]())
    picture = viewport.content.picture()
    document.edit("Distance", lambda bench: replace(bench, distance=500.0))
    lane.failed.emit("viewport 1", "no ray passes")
    assert "⚠" in viewport.state.text()
    assert viewport.state.toolTip() == "no ray passes"
    assert heard == ["no ray passes"]
    assert viewport.content.picture() == picture


def test_an_answer_that_cannot_be_drawn_is_a_failure(viewport, lane):
    heard = []
    viewport.said.connect(heard.append)
    key, context, _ = lane.questions[-1]()
    lane.answered.emit("viewport 1", (key, context, None))
    assert "⚠" in viewport.state.text()
    assert len(heard) == 1


def test_choosing_edits_the_pane(viewport, document):
    viewport.quantity.setCurrentIndex(viewport.quantity.findData("astigmatism"))
    viewport.quantity.activated.emit(viewport.quantity.currentIndex())
    assert document.workbench.panes[0].quantity == "astigmatism"
    viewport.kind.setCurrentIndex(viewport.kind.findData("profile"))
    viewport.kind.activated.emit(viewport.kind.currentIndex())
    assert document.workbench.panes[0].kind == "profile"
    assert viewport.quantity.isHidden()
    document.undo()
    assert viewport.kind.currentData() == "map"
    assert not viewport.quantity.isHidden()


def test_another_kind_drops_what_was_known(viewport, document, lane):
    lane.answered.emit("viewport 1", lane.questions[-1]())
    old = viewport.content
    document.edit("Kind", lambda bench: bench.with_pane(0, kind="distortion"))
    assert viewport.content is not old
    assert not viewport.answered
    lane.answered.emit("viewport 1", lane.questions[-1]())
    assert viewport.answered


def test_lenses_and_differences_are_offered(viewport, document, lane, sphere):
    assert viewport.lens.isHidden()
    document.edit("Open", lambda bench: bench.with_lens(sphere.lenses[0].path.with_name("sphere_plus_4_R.toml")))
    names = [viewport.lens.itemText(k) for k in range(viewport.lens.count())]
    one, two = (entry.lens.name for entry in document.workbench.lenses)
    assert names == ["active lens", one, two, f"{one} − {two}", f"{two} − {one}"]
    viewport.lens.setCurrentIndex(4)
    viewport.lens.activated.emit(4)
    assert (document.workbench.panes[0].lens, document.workbench.panes[0].minus) == (1, 0)
    lane.answered.emit("viewport 1", lane.questions[-1]())
    assert np.nanmean(viewport.content.drawn.banded.lens_map.values) == pytest.approx(8.0, abs=0.5)


def test_without_a_lens_it_says_what_to_do(qtbot, lane):
    document = Document(Workbench())
    viewport = Viewport(document, lane, 1)
    qtbot.addWidget(viewport)
    viewport.show()
    viewport.show_bench(None, document.workbench)
    assert lane.questions == []
    assert "Open a lens" in viewport._stack.currentWidget().text()


def test_a_viewport_that_is_not_shown_asks_nothing(qtbot, document, lane):
    viewport = Viewport(document, lane, 3)
    qtbot.addWidget(viewport)
    document.edit("Distance", lambda bench: replace(bench, distance=500.0))
    assert lane.questions == []
