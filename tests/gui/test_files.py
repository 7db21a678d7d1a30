"""Files of the window: all kinds, wrong ones, recent ones, dropped ones, and reading beside the window."""

import threading
from pathlib import Path

import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication

from lensbench.formats import registry
from lensbench.gui import files
from lensbench.gui.files import MOST_RECENT
from lensbench.gui.main_window import MainWindow

SAMPLES = Path(__file__).parents[2] / "sample_lenses"
PLUS, PROGRESSIVE, WEARER = (SAMPLES / name for name in ("sphere_plus_4_R.toml", "regular_R.toml", "presbyope_60.toml"))


def logged(window):
    return window.log.toPlainText().splitlines()


def test_files_of_every_kind_are_opened_together(ready, tmp_path, open_files):
    open_files(ready, [PLUS, WEARER])
    bench = ready.document.workbench
    assert len(bench.lenses) == 2
    assert bench.active_wearer.age == 60
    assert not logged(ready)


@pytest.mark.parametrize("text", ["", "format = 3", "nonsense\x00"])
@pytest.mark.parametrize("name", ["a.toml", "a.lensbench.json", "a.sdf", "a.stl", "a.xyz"])
def test_a_bad_file_is_one_sentence_and_changes_nothing(ready, tmp_path, name, text, open_files):
    path, before = tmp_path / name, ready.document.workbench
    path.write_text(text)
    open_files(ready, [path])
    assert ready.document.workbench is before
    (line,) = logged(ready)
    assert str(path) in line
    open_files(ready, [tmp_path / "gone.toml"])
    assert len(logged(ready)) == 2
    assert ready.document.workbench is before


def test_only_what_could_be_opened_is_a_recent_file(qtbot, ready, tmp_path, settings, open_files):
    (tmp_path / "bad.toml").write_text("format = 3")
    open_files(ready, [tmp_path / "bad.toml", PLUS])
    assert [action.text() for action in ready.files.recent.actions()] == [PLUS.name]
    for k in range(MOST_RECENT + 2):
        copy = tmp_path / f"{k}.toml"
        copy.write_bytes(PLUS.read_bytes())
        open_files(ready, [copy])
    assert len(settings.value("recent")) == MOST_RECENT
    count = len(ready.document.workbench.lenses)
    ready.files.recent.actions()[0].trigger()
    qtbot.waitUntil(lambda: len(ready.document.workbench.lenses) == count + 1)


def test_dropped_files_are_opened(qtbot, ready):
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(PLUS)), QUrl("https://example.org/lens.toml")])
    left, none = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    QApplication.sendEvent(ready, QDragEnterEvent(QPoint(5, 5), Qt.DropAction.CopyAction, data, left, none))
    QApplication.sendEvent(ready, QDropEvent(QPointF(5, 5), Qt.DropAction.CopyAction, data, left, none))
    qtbot.waitUntil(lambda: [entry.path for entry in ready.document.workbench.lenses[1:]] == [PLUS])


def test_files_are_read_beside_the_window_and_all_arrive_in_order(qtbot, ready, tmp_path, monkeypatch):
    """The window's thread never waits for a reader; a file that cannot be read stops none of the others."""
    gate, threads = threading.Event(), []
    read_slowly = files.read

    def slow(path):
        threads.append(threading.get_ident())
        gate.wait(10)
        return read_slowly(path)

    monkeypatch.setattr(files, "read", slow)
    (tmp_path / "bad.toml").write_text("format = 3")
    ready.files.open([PROGRESSIVE, tmp_path / "bad.toml", PLUS])
    assert "Reading" in ready.statusBar().currentMessage()
    assert len(ready.document.workbench.lenses) == 1
    gate.set()
    qtbot.waitUntil(lambda: len(ready.document.workbench.lenses) == 3, timeout=60000)
    assert [entry.path for entry in ready.document.workbench.lenses[1:]] == [PROGRESSIVE, PLUS]
    assert len(logged(ready)) == 1
    assert threading.get_ident() not in threads


def test_closing_while_a_file_is_read(qtbot, ready, monkeypatch):
    gate, begun = threading.Event(), threading.Event()
    monkeypatch.setattr(files, "read", lambda path: begun.set() or gate.wait(10))
    ready.files.open([PLUS])
    assert begun.wait(10)
    threading.Timer(0.1, gate.set).start()
    assert ready.close()


def test_an_emmetrope_stands_in_only_until_a_wearer_is_known(qtbot, settings, open_files):
    window = MainWindow(settings)
    qtbot.addWidget(window, before_close_func=lambda window: window.document.saved())
    assert [wearer.name for wearer in window.document.workbench.wearers] == ["emmetrope"]
    open_files(window, [PROGRESSIVE])
    assert [wearer.name for wearer in window.document.workbench.wearers] == ["as ordered"]
    open_files(window, [WEARER])
    assert len(window.document.workbench.wearers) == 2


def test_a_file_is_read_once(ready, open_files, monkeypatch):
    """A big STEP or point file is not parsed a second time to put its lens on the table."""
    heads, read_head = [], registry.read_bytes
    monkeypatch.setattr(registry, "read_bytes", lambda path, *size: heads.append(path) or read_head(path, *size))
    open_files(ready, [PLUS])
    assert len(ready.document.workbench.lenses) == 2
    assert heads == [PLUS]
