"""The main window as it is used: open, edit, probe, compare, flip, save and restore; nothing wrong changes anything."""

import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QApplication, QFileDialog, QMessageBox

from lensbench.compare import difference
from lensbench.gui.main_window import MainWindow
from lensbench.gui.map_source import SAMPLES as MAP_SAMPLES
from lensbench.layers import MapLayer, PointsLayer, ProbeLayer, Request
from lensbench.session import Pane
from lensbench.workbench import run

SAMPLES = Path(__file__).parents[2] / "sample_lenses"
PLUS, PROGRESSIVE, WEARER = (SAMPLES / name for name in ("sphere_plus_4_R.toml", "regular_R.toml", "presbyope_60.toml"))


def logged(window):
    return window.log.toPlainText().splitlines()


def test_an_opened_lens_is_shown_and_read(ready, settle, open_files):
    open_files(ready, [PROGRESSIVE])
    settle(ready)
    bench = ready.document.workbench
    names = ready.table.tree.findItems(bench.active_lens.name, Qt.MatchFlag.MatchContains | Qt.MatchFlag.MatchRecursive)
    assert len(names) == 1
    readings = run(Request(bench.active_lens, bench.active_wearer, PointsLayer()))
    assert [ready.readings.points.item(k, 0).text() for k in range(ready.readings.points.rowCount())] == [
        reading.name.replace("_", " ") for reading in readings
    ]
    assert ready.readings.tolerances.table.rowCount() > 0
    shown = ready.viewports[0].content.drawn.banded.lens_map
    alone = run(
        Request(bench.active_lens, bench.active_wearer, MapLayer("mean_power", bench.distance, samples=MAP_SAMPLES))
    )
    np.testing.assert_array_equal(shown.values, alone.values)


def test_an_edit_shows_everywhere_and_is_undone(ready, settle):
    shown = ready.viewports[0].content.drawn.banded.lens_map.values
    form = ready.table.forms.widget(1).findChild(type(ready.table.forms.widget(1).widget().rows["Vertex distance"]))
    form.box.setValue(20.0)
    settle(ready)
    changed = ready.viewports[0].content.drawn.banded.lens_map.values
    assert not np.array_equal(changed, shown, equal_nan=True)
    ready.undo.trigger()
    settle(ready)
    np.testing.assert_array_equal(ready.viewports[0].content.drawn.banded.lens_map.values, shown)
    assert not ready.undo.isEnabled()
    assert "vertex distance" in ready.redo.text()


def test_the_newest_of_many_moves_is_shown(ready, settle):
    slider = ready.table.forms.widget(1).widget().rows["Vertex distance"].slider
    slider.setSliderDown(True)
    for step in range(0, slider.maximum(), 3):
        slider.setValue(step)
        QApplication.processEvents()
    slider.setValue(slider.maximum())
    slider.setSliderDown(False)
    settle(ready)
    bench = ready.document.workbench
    assert bench.active_wearer.wear.vertex_distance == 25.0
    last = run(
        Request(bench.active_lens, bench.active_wearer, MapLayer("mean_power", bench.distance, samples=MAP_SAMPLES))
    )
    np.testing.assert_array_equal(ready.viewports[0].content.drawn.banded.lens_map.values, last.values)
    ready.document.undo()
    assert not ready.document.undo_name


def test_a_probe_is_marked_in_every_view(window, settle, qtbot, mouse):
    panes = (Pane("map"), Pane("lens"), Pane("profile"), Pane("view"))
    window.document.edit("Panes", lambda bench: replace(bench, panes=panes, split=4))
    settle(window)
    plot = window.viewports[0].content
    at = plot.pixel(5.0, -7.0)
    mouse(plot, QEvent.Type.MouseMove, at.x(), at.y())
    qtbot.waitUntil(lambda: window.probe is not None, timeout=10000)
    bench, probe = window.document.workbench, window.probe
    assert probe.point == pytest.approx((5.0, -7.0), abs=0.2)
    alone = run(Request(bench.active_lens, bench.active_wearer, ProbeLayer(probe.point, None, bench.distance)))
    assert alone.mean_power == pytest.approx(probe.mean_power, abs=1e-9)
    assert f"{probe.mean_power:+.2f} D" in window.readings.probe_panel.text.text()
    map_, lens, profile, view = (viewport.content for viewport in window.viewports)
    assert map_.marked == pytest.approx(probe.point)
    np.testing.assert_array_equal(lens.stage.mark, probe.exit)
    assert profile.marked[1] == pytest.approx(probe.point[1])
    spot = view._on_widget(probe)
    assert spot is not None
    mouse(view, QEvent.Type.MouseMove, spot.x(), spot.y())
    qtbot.waitUntil(lambda: window.probe is not probe, timeout=10000)
    assert window.probe.point == pytest.approx(probe.point, abs=0.05), "the view's way back to the lens"


def test_two_lenses_flip_and_differ(ready, settle, open_files):
    open_files(ready, [PLUS])
    ready.flip()
    assert ready.document.workbench.lens == 0
    ready.flip()
    ready.flip()
    assert ready.document.workbench.lens == 0
    ready._difference()
    settle(ready)
    bench = ready.document.workbench
    one, two = (entry.lens for entry in bench.lenses)
    assert (bench.panes[0].lens, bench.panes[0].minus) == (0, 1)
    layer = MapLayer("mean_power", bench.distance, samples=MAP_SAMPLES)
    meant = difference(*(Request(lens, bench.active_wearer, layer) for lens in (one, two)))
    np.testing.assert_array_equal(ready.viewports[0].content.drawn.banded.lens_map.values, meant.values)
    assert np.nanmean(meant.values) == pytest.approx(-8.0, abs=0.5)


def test_two_lenses_side_by_side_have_one_scale(ready, settle, open_files):
    open_files(ready, [PLUS])
    ready._side_by_side()
    settle(ready)
    one, two, less = (viewport.content for viewport in ready.viewports[:3])
    np.testing.assert_array_equal(one.bands.levels, two.bands.levels)
    assert less.drawn.banded.lens_map.quantity != one.drawn.banded.lens_map.quantity
    ready.document.undo()
    assert ready.document.workbench.split == 2


def test_a_difference_and_a_comparison_need_two_lenses_and_say_so(ready):
    for needy in (ready._difference, ready._side_by_side, ready.flip, ready.reports.ask_comparison):
        needy()
    assert len(logged(ready)) == 4
    assert all("two lenses" in line for line in logged(ready))
    assert not ready.document.undo_name


def test_a_lens_is_taken_off_the_table(ready, settle):
    ready.table.tree.setCurrentItem(ready.table.tree.topLevelItem(0).child(0))
    ready._remove_lens()
    assert not ready.document.workbench.lenses
    assert "Open a lens" in ready.viewports[0]._stack.currentWidget().text()
    ready.undo.trigger()
    settle(ready)
    assert len(ready.document.workbench.lenses) == 1


def test_a_session_is_saved_and_restored_whole(ready, tmp_path, settings, qtbot, settle, open_files):
    path = tmp_path / "design.lensbench.json"
    open_files(ready, [PLUS])
    ready.document.edit(
        "Panes", lambda bench: replace(bench.with_pane(0, low=-6.0, high=0.0, step=0.5), distance=400.0)
    )
    table = next(
        dock for dock in ready.findChildren(type(ready.readings.probe_panel.parent())) if dock.objectName() == "Table"
    )
    table.hide()
    assert ready.files.save(path)
    assert not ready.document.modified
    assert not ready.isWindowModified()
    saved = ready.document.workbench
    other = MainWindow(settings)
    qtbot.addWidget(other)
    other.show()
    open_files(other, [path])
    bench = other.document.workbench
    assert (bench.panes, bench.split, bench.distance, bench.lens) == (saved.panes, saved.split, 400.0, 1)
    assert [entry.lens.name for entry in bench.lenses] == [entry.lens.name for entry in saved.lenses]
    assert other.findChild(type(table), "Table").isHidden()
    assert "design.lensbench.json" in other.windowTitle()
    settle(other)
    settle(ready)
    for one, two in zip(ready.viewports[:2], other.viewports[:2], strict=True):
        np.testing.assert_allclose(
            one.content.drawn.banded.lens_map.values, two.content.drawn.banded.lens_map.values, atol=1e-6
        )


def test_a_folder_that_is_not_there_keeps_the_session_unsaved(ready, tmp_path):
    (tmp_path / "file").write_text("")
    ready.document.edit("Distance", lambda bench: replace(bench, distance=400.0))
    assert not ready.files.save(tmp_path / "file" / "a.lensbench.json")
    assert ready.document.modified
    assert len(logged(ready)) == 1


@pytest.mark.parametrize(
    ("answer", "closes"), [("Save", True), ("Save nowhere", False), ("Discard", True), ("Cancel", False)]
)
def test_closing_asks_about_a_session_that_has_no_name(ready, tmp_path, monkeypatch, answer, closes):
    path = tmp_path / "a.lensbench.json"
    ready.document.edit("Distance", lambda bench: replace(bench, distance=400.0))
    assert ready.files.session is None
    asked = []
    answer, *nowhere = answer.split()
    monkeypatch.setattr(
        QMessageBox, "question", lambda *_: asked.append(1) or getattr(QMessageBox.StandardButton, answer)
    )
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: ("" if nowhere else str(path), ""))
    assert ready.close() is closes
    assert asked == [1]
    assert path.exists() is (answer == "Save" and closes)


def test_files_on_an_empty_table_are_no_edit_yet(qtbot, settings, open_files, monkeypatch):
    """As `lensbench gui LENS WEARER` opens them; what is opened after an edit is one."""
    window = MainWindow(settings)
    qtbot.addWidget(window, before_close_func=lambda window: window.document.saved())
    window.show()
    asked = []
    monkeypatch.setattr(QMessageBox, "question", lambda *_: asked.append(1) or QMessageBox.StandardButton.Cancel)
    open_files(window, [PLUS, WEARER])
    assert len(window.document.workbench.lenses) == 1
    assert not window.isWindowModified()
    window.document.edit("Distance", lambda bench: replace(bench, distance=400.0))
    open_files(window, [PLUS])
    assert window.isWindowModified()
    assert not window.close()
    assert asked == [1]
    while window.document.undo_name:
        window.document.undo()
    window.document.redo()
    window.document.redo()
    assert not window.isWindowModified()
    assert window.close()
    window.lane.wait()


@pytest.mark.parametrize(
    ("answer", "closes", "written"),
    [("Save", True, True), ("Discard", True, False), ("Cancel", False, False)],
)
def test_closing_asks_about_changes_of_a_saved_session(ready, tmp_path, monkeypatch, answer, closes, written):
    path = tmp_path / "a.lensbench.json"
    ready.files.save(path)
    before = path.read_text()
    ready.document.edit("Distance", lambda bench: replace(bench, distance=400.0))
    monkeypatch.setattr(QMessageBox, "question", lambda *_: getattr(QMessageBox.StandardButton, answer))
    assert ready.close() is closes
    assert (path.read_text() != before) is written


def test_closing_does_not_wait_for_what_is_computed(ready):
    """As for kernels that are being compiled."""
    begun, gate, thread = threading.Event(), threading.Event(), ready.lane._thread
    ready.lane.ask("held", lambda: begun.set() or gate.wait(20))
    ready.document.edit("Distance", lambda bench: replace(bench, distance=300.0))
    ready.document.saved()
    assert begun.wait(10)
    start = time.monotonic()
    assert ready.close()
    assert time.monotonic() - start < 5
    assert not ready.isVisible()
    assert thread.is_alive()
    gate.set()
    thread.join(10)
    assert not thread.is_alive()


def test_layouts_show_as_many_viewports_as_they_say(ready, settle, qtbot):
    for split in (1, 4, 2):
        ready.splits[split].trigger()
        qtbot.waitUntil(lambda split=split: [v.isVisible() for v in ready.viewports] == [k < split for k in range(4)])
        assert ready.document.workbench.split == split
    ready._act("alone", 1)
    settle(ready)
    assert ready.document.workbench.panes[0].quantity == "astigmatism"
    assert ready.document.workbench.split == 1


def test_what_was_stopped_stays_marked_as_old(ready, qtbot):
    shown = ready.viewports[0].content.drawn
    ready.document.edit("Distance", lambda bench: replace(bench, distance=300.0))
    ready.stop()
    qtbot.waitUntil(lambda: not ready.lane.busy, timeout=10000)
    assert ready.viewports[0].content.drawn is shown
    assert all("older" in viewport.state.toolTip() for viewport in ready.viewports[:2])
    assert "stopped" in logged(ready)[-1]


def test_head_and_eye_are_turned_by_the_mouse(window, settle, mouse):
    panes = (Pane("view"), *window.document.workbench.panes[1:])
    window.document.edit("View", lambda bench: replace(bench, panes=panes, split=1))
    settle(window)
    view, left = window.viewports[0].content, Qt.MouseButton.LeftButton

    def drag(keys):
        mouse(view, QEvent.Type.MouseButtonPress, 100, 100, left, keys)
        for x in (110, 120, 130):
            mouse(view, QEvent.Type.MouseMove, x, 100 + (x - 100) // 2, left, keys)
        mouse(view, QEvent.Type.MouseButtonRelease, 130, 115, left, keys)

    before = window.document.workbench
    drag(Qt.KeyboardModifier.NoModifier)
    turned = window.document.workbench
    assert turned.head_turn != before.head_turn
    assert turned.head_tilt != before.head_tilt
    assert turned.panes == before.panes
    drag(Qt.KeyboardModifier.ControlModifier)
    looked = window.document.workbench
    assert looked.head_turn == turned.head_turn
    assert looked.panes[0].azimuth != turned.panes[0].azimuth
    window.document.undo()
    assert window.document.workbench is turned
    window.document.undo()
    assert window.document.workbench is before
    settle(window)


@pytest.mark.parametrize(("side", "towards"), [("the front", (0, 0, 1)), ("above", (0, 1, 0)), ("behind", (0, 0, -1))])
def test_stages_are_seen_from_a_side_and_again_as_at_first(window, settle, side, towards):
    window.document.edit("Kinds", lambda b: b.with_pane(0, kind="lens").with_pane(1, kind="ellipses"))
    settle(window)
    stages = [viewport.content.stage.stage for viewport in window.viewports[:2]]
    first = [np.array(stage.camera.direction) for stage in stages]
    next(a for a in window.findChildren(QAction) if a.text() == f"From {side}").trigger()
    for stage in stages:
        np.testing.assert_allclose(stage.camera.direction, -np.array(towards), atol=1e-9)
    next(a for a in window.findChildren(QAction) if a.text() == "As at first").trigger()
    for stage, direction in zip(stages, first, strict=True):
        np.testing.assert_allclose(stage.camera.direction, direction, atol=1e-9)


def test_cameras_of_stages_are_linked(window, settle, mouse):
    panes = (Pane("lens"), Pane("lens", "astigmatism"), *window.document.workbench.panes[2:])
    window.document.edit("Lenses", lambda bench: replace(bench, panes=panes, split=2))
    settle(window)
    one, two = (viewport.content.stage for viewport in window.viewports[:2])
    before = np.array(one.stage.camera.position)
    left = Qt.MouseButton.LeftButton
    mouse(one, QEvent.Type.MouseButtonPress, 80, 80, left)
    mouse(one, QEvent.Type.MouseMove, 120, 90, left)
    mouse(one, QEvent.Type.MouseButtonRelease, 120, 90, left)
    assert np.linalg.norm(np.array(one.stage.camera.position) - before) > 10
    np.testing.assert_allclose(one.stage.camera.position, two.stage.camera.position)
    np.testing.assert_allclose(one.stage.camera.up, two.stage.camera.up)


def test_dark_and_light_dress_the_window(ready, settings, qtbot):
    def lightness():
        return ready.palette().window().color().lightness()

    assert lightness() > 200
    ready.dark.trigger()
    qtbot.waitUntil(lambda: lightness() < 80)
    assert settings.value("dark", type=bool)
    ready.dark.trigger()
    qtbot.waitUntil(lambda: lightness() > 200)


def test_keys_do_what_the_menu_says(ready):
    keys = {
        action.shortcut().toString(): action.text()
        for menu in ready.menuBar().actions()
        for action in menu.menu().actions()
        if not action.shortcut().isEmpty()
    }
    assert {
        "Ctrl+O",
        "Ctrl+S",
        "Ctrl+Z",
        "Ctrl+R",
        "Ctrl+D",
        "Space",
        "Esc",
        "F11",
        "Ctrl+1",
        "Ctrl+2",
        "Ctrl+4",
    } <= set(keys)
