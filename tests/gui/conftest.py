"""Windows without a screen: Qt draws into memory; stages are drawn off screen anyhow."""

import os
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import pytest
from PySide6.QtCore import QEvent, QPointF, QSettings, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication

from lensbench.session import Pane, Workbench

SAMPLES = Path(__file__).parents[2] / "sample_lenses"
SPHERE = SAMPLES / "sphere_minus_4_R.toml"
PANES = (Pane("map", "mean_power"), Pane("map", "astigmatism"), Pane("profile"), Pane("lens"))


@pytest.fixture(scope="session")
def sphere():
    """A table with a lens of one power, two maps shown; the sample lens is read once."""
    return replace(Workbench(panes=PANES, split=2).with_lens(SPHERE), panes=PANES, split=2)


@pytest.fixture
def settings(tmp_path):
    """Settings of this test alone."""
    return QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat)


@pytest.fixture
def window(qtbot, settings, sphere):
    """A shown window with the sphere on the table, before anything is answered."""
    from lensbench.gui.main_window import MainWindow

    window = MainWindow(settings)
    qtbot.addWidget(window, before_close_func=lambda window: window.document.saved())
    window.resize(1000, 700)
    window.lane.stop()
    window.document.open(sphere)
    window.show()
    yield window
    window.document.saved()
    window.close()
    window.lane.wait()


@pytest.fixture
def settle(qtbot):
    """Wait until every shown viewport of a window shows what was asked last, and nothing is computed."""

    def settled(window):
        shown = window.viewports[: window.document.workbench.split]
        return not window.lane.busy and all(v.answered and v.state.text() == "" for v in shown)

    return lambda window: qtbot.waitUntil(lambda: settled(window), timeout=150000)


@pytest.fixture
def ready(window, settle):
    """The window with all its pictures."""
    settle(window)
    return window


@pytest.fixture
def open_files(qtbot):
    """Open files in a window, and wait until they are read."""

    def opened(window, paths):
        window.files.open(paths)
        qtbot.waitUntil(lambda: not window.lane.busy, timeout=60000)

    return opened


@pytest.fixture(scope="session")
def mouse():
    """Send a widget one mouse event; the pointer of the screen stays where it is."""

    def send(widget, kind, x, y, buttons=Qt.MouseButton.NoButton, keys=Qt.KeyboardModifier.NoModifier):
        at = QPointF(x, y)
        button = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseMove else buttons
        event = QMouseEvent(kind, at, QPointF(widget.mapToGlobal(at)), button, buttons, keys)
        QApplication.sendEvent(widget, event)

    return send
