"""What is read follows what lies on the table: nothing older is shown unmarked, and what was stopped asks again."""

import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QAction
from PySide6.QtTest import QTest

from lensbench.gui.asker import STOPPED, UPDATING
from lensbench.gui.map_source import SAMPLES as MAP_SAMPLES
from lensbench.gui.scene_source import scene_named
from lensbench.layers import MapLayer, PointsLayer, ProbeLayer, Request
from lensbench.session import Pane
from lensbench.workbench import run

SAMPLES = Path(__file__).parents[2] / "sample_lenses"
PLUS, PROGRESSIVE = (SAMPLES / name for name in ("sphere_plus_4_R.toml", "regular_R.toml"))


@pytest.fixture
def point(mouse, qtbot):
    """Point at a lens point of a viewport's map, and wait for what is read there."""

    def pointed(window, x, y, k=0):
        content, before = window.viewports[k].content, window.probe
        at = content.pixel(x, y)
        mouse(content, QEvent.Type.MouseMove, at.x(), at.y())
        qtbot.waitUntil(lambda: window.probe is not before and not window.lane.busy, timeout=20000)
        return window.probe

    return pointed


def read(window):
    """The text of the probe's panel."""
    return window.readings.probe_panel.text.text()


def rests(window):
    """Whether all that is shown is current."""
    marks = [asker.mark.text() for asker in window.readings.askers]
    return not window.lane.busy and not any(marks) and not any(v.state.text() for v in window.viewports[:2])


def less_plus(bench):
    """The first pane: the first lens less the second."""
    return bench.with_pane(0, lens=0, minus=1)


def test_the_probe_follows_wearer_object_and_lens(ready, settle, point, qtbot, open_files):
    first = point(ready, 6.0, -8.0)
    assert ready.document.workbench.active_lens.name in read(ready)
    eye = replace(ready.document.workbench.active_wearer.eye, refraction=np.diag([-8.0, -8.0]))
    other = replace(ready.document.workbench.active_wearer, eye=eye, name="short-sighted")
    ready.document.edit("Wearer", lambda bench: bench.with_wearer(other))
    assert ready.readings.of_probe.mark.text() == UPDATING
    assert f"{first.defocus:.1f}′" in read(ready), "the older reading stays until its successor is there"
    qtbot.waitUntil(lambda: rests(ready), timeout=30000)
    bench = ready.document.workbench
    meant = run(Request(bench.active_lens, other, ProbeLayer(first.point, None, bench.distance)))
    assert meant.defocus - first.defocus > 10
    assert f"{meant.defocus:.1f}′" in read(ready)
    assert "short-sighted" in read(ready)
    ready.document.edit("Distance", lambda bench: replace(bench, distance=400.0))
    qtbot.waitUntil(lambda: rests(ready), timeout=30000)
    assert "40.0 cm" in read(ready)
    open_files(ready, [PLUS])
    qtbot.waitUntil(lambda: rests(ready), timeout=30000)
    assert ready.document.workbench.active_lens.name in read(ready)
    assert ready.probe.mean_power == pytest.approx(4.0, abs=0.5)


def test_the_probe_reads_the_lens_and_the_quantity_of_the_map_it_stands_on(ready, settle, point, open_files):
    open_files(ready, [PLUS])
    ready.document.edit("Prism", lambda bench: bench.with_pane(1, quantity="prism", lens=0))
    settle(ready)
    bench, lens_map = ready.document.workbench, ready.viewports[1].content.drawn.banded.lens_map
    j, i = np.argmin(abs(lens_map.y - 5)), np.argmin(abs(lens_map.x - 10))
    probe = point(ready, lens_map.x[i], lens_map.y[j], k=1)
    assert probe.value == pytest.approx(lens_map.values[j, i], abs=0.01)
    assert f"Prism</td><td><b>{probe.value:.2f} cm/m" in read(ready)
    assert bench.lenses[0].lens.name in read(ready)
    assert bench.active_lens.name not in read(ready)


@pytest.mark.parametrize("distance", [np.inf, "scene"])
def test_a_difference_is_shown_and_read_for_every_object(ready, settle, point, open_files, distance, qtbot):
    open_files(ready, [PLUS])
    ready.document.edit("Less", lambda bench: replace(less_plus(bench), distance=distance, head_turn=10.0))
    settle(ready)
    bench, shown = ready.document.workbench, ready.viewports[0].content.drawn.banded.lens_map
    layer = MapLayer("mean_power", distance, samples=MAP_SAMPLES)
    scene = scene_named(bench.scene) if distance == "scene" else None
    one, two = (run(Request(e.lens, bench.worn_by(e.lens), layer, scene)) for e in bench.lenses)
    middle = tuple(size // 2 for size in shown.values.shape)
    assert shown.values[middle] == pytest.approx(one.values[middle] - two.values[middle], abs=1e-9)
    point(ready, float(shown.x[middle[1]]), float(shown.y[middle[0]]))
    assert "less that of" in read(ready)
    assert f"{shown.values[middle]:.2f} D" in read(ready)


def test_without_a_lens_nothing_is_read(ready, point):
    point(ready, 3.0, 3.0)
    assert ready.readings.points.rowCount() > 0
    assert ready.readings.tolerances.table.rowCount() > 0
    ready.document.edit("Take lens off the table", lambda bench: bench.without_lens(0))
    assert ready.readings.points.rowCount() == 0
    assert ready.readings.tolerances.table.rowCount() == 0
    assert "Point at" in read(ready)
    assert ready.probe is None


@pytest.fixture
def stopped(ready, point, qtbot):
    """The window, stopped while it was to compute for another wearer."""
    point(ready, 3.0, 3.0)
    gate = threading.Event()
    ready.lane.ask("held", lambda: gate.wait(20))
    wearer = ready.document.workbench.active_wearer
    moved = replace(wearer, wear=replace(wearer.wear, vertex_distance=19.0))
    ready.document.edit("Vertex distance", lambda bench: bench.with_active_wearer(moved, as_ordered=True))
    ready.stop()
    gate.set()
    qtbot.waitUntil(lambda: not ready.lane.busy, timeout=20000)
    return ready


def all_marks(window):
    return {a.mark.text() for a in (*(v.asker for v in window.viewports[:2]), *window.readings.askers)}


def test_what_was_stopped_says_so_and_is_asked_by_a_key(stopped, qtbot):
    assert all_marks(stopped) == {STOPPED}
    assert "older than the settings" in stopped.readings.of_points.mark.toolTip()
    next(action for action in stopped.findChildren(QAction) if action.shortcut().toString() == "F8").trigger()
    assert all_marks(stopped) == {UPDATING}
    qtbot.waitUntil(lambda: rests(stopped), timeout=30000)
    bench = stopped.document.workbench
    (reading, *_) = run(Request(bench.active_lens, bench.active_wearer, PointsLayer()))
    assert f"{reading.sphere:+.2f}" in stopped.readings.points.item(0, 4).text()


def test_what_was_stopped_is_asked_at_a_click(stopped, qtbot):
    stopped.viewports[0].state.linkActivated.emit("again")
    qtbot.waitUntil(lambda: not stopped.lane.busy, timeout=30000)
    assert stopped.viewports[0].state.text() == ""
    assert stopped.viewports[1].state.text() == STOPPED
    before = stopped.viewports[0].content.drawn
    stopped.viewports[0].state.linkActivated.emit("again")
    assert not stopped.lane.busy
    assert stopped.viewports[0].content.drawn is before


def test_what_was_stopped_is_asked_by_the_next_edit(stopped, qtbot):
    stopped.document.edit("Head", lambda bench: replace(bench, head_turn=3.0))
    qtbot.waitUntil(lambda: rests(stopped), timeout=30000)


def test_a_lens_shown_for_another_wearer_says_so(ready, settle, open_files):
    """Until somebody is chosen each lens is worn by the eye for which it was ordered."""
    open_files(ready, [PLUS])
    settle(ready)
    assert not any(v.misfit.isVisible() for v in ready.viewports)
    assert np.trace(ready.document.workbench.active_wearer.eye.refraction) / 2 == pytest.approx(4.0)
    ready.flip()
    assert np.trace(ready.document.workbench.active_wearer.eye.refraction) / 2 == pytest.approx(-4.0)
    ready.document.edit("Wearer", lambda bench: bench.with_wearer(replace(bench.active_wearer, name="mine")))
    assert not ready.viewports[0].misfit.isVisible()
    ready.document.edit("Other lens", lambda bench: bench.with_pane(0, lens=1))
    assert ready.viewports[0].misfit.isVisible()
    name = ready.document.workbench.lenses[1].lens.name
    assert ready.viewports[0].misfit.toolTip().startswith(f"{name} was ordered as +4.00")
    assert not ready.viewports[1].misfit.isVisible()
    ready.document.edit("Difference", lambda bench: bench.with_pane(1, lens=0, minus=1))
    assert ready.viewports[1].misfit.toolTip().startswith(name)


def test_space_flips_the_lenses_after_a_number_was_typed(ready, open_files, qtbot):
    open_files(ready, [PLUS])
    assert ready.document.workbench.lens == 1
    ready.activateWindow()
    qtbot.waitUntil(ready.isActiveWindow)
    ready.table.forms.setCurrentIndex(1)
    box = ready.table.forms.widget(1).widget().rows["Vertex distance"].box
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "17")
    QTest.keyClick(box, Qt.Key.Key_Return)
    QTest.keyClick(box, Qt.Key.Key_Space)
    bench = ready.document.workbench
    assert bench.lens == 0
    assert bench.active_wearer.wear.vertex_distance == 17.0
    assert box.text() == "17.0 mm"
    QTest.keyClicks(box, "14")
    QTest.keyClick(box, Qt.Key.Key_Space)
    assert ready.document.workbench.lens == 1
    assert ready.document.workbench.active_wearer.wear.vertex_distance == 14.0


def test_cleared_marks_leave_the_views(ready, point, settle):
    ready.document.edit(
        "Profile", lambda bench: replace(bench, panes=(*bench.panes[:1], Pane("profile"), *bench.panes[2:]))
    )
    settle(ready)
    point(ready, 3.0, 3.0)
    assert all(v.content.marked is not None for v in ready.viewports[:2])
    ready.document.edit("Take lens off the table", lambda bench: bench.without_lens(0))
    assert all(v.content.marked is None for v in ready.viewports[:2])
