"""Run by test_real_window.py on a screen of its own: open, edit, probe, save and close a window as a user does."""

import sys
import time
from pathlib import Path

import numpy as np
from PySide6.QtCore import QPointF, QSettings, Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from lensbench.gui.main_window import MainWindow


def settle(application, window):
    """Wait until every viewport shows what was asked last."""
    until = time.monotonic() + 150
    while time.monotonic() < until:
        application.processEvents()
        shown = window.viewports[: window.document.workbench.split]
        if not window.lane.busy and all(v.answered and v.state.text() == "" for v in shown):
            QTest.qWait(50)  # to paint it
            return
        time.sleep(0.002)
    raise SystemExit("the window did not come to rest within 150 s")


def on_screen(window, content, place):
    """The colour of the screen at a place of a map."""
    at = content.mapTo(window, content.pixel(*place).toPoint())
    grab = window.screen().grabWindow(window.winId()).toImage()
    return np.array(grab.pixelColor(at).getRgb()[:3])


def main(lens: Path, folder: Path) -> None:
    application = QApplication([])
    assert QGuiApplication.platformName() == "xcb", QGuiApplication.platformName()
    window = MainWindow(QSettings(str(folder / "a.ini"), QSettings.Format.IniFormat))
    window.resize(1400, 900)
    window.show()
    assert QTest.qWaitForWindowExposed(window)
    window.files.open([lens])
    settle(application, window)
    panes = window.document.workbench.panes
    k = next(k for k, pane in enumerate(panes) if pane.kind == "map")
    window.document.edit(
        "Scale", lambda bench: bench.with_pane(k, quantity="mean_power", low=-12.0, high=4.0, step=1.0)
    )
    settle(application, window)
    content = window.viewports[k].content
    lens_map, bands = content.drawn.banded.lens_map, content.bands
    value = lens_map.values[np.argmin(abs(lens_map.y + 9)), np.argmin(abs(lens_map.x - 11))]
    meant = 255 * bands.colours[np.searchsorted(bands.levels, value, side="right") - 1]
    found = on_screen(window, content, (11.0, -9.0))
    assert np.abs(found - meant).max() <= 4, f"the screen shows {found} where {value:.2f} D is {meant}"

    at = content.pixel(6.0, -8.0)
    QTest.mouseMove(content, (at + QPointF(1, 1)).toPoint())
    QTest.mouseMove(content, at.toPoint())
    until = time.monotonic() + 20
    while window.probe is None and time.monotonic() < until:
        application.processEvents()
        time.sleep(0.002)
    assert window.probe is not None, "pointing read nothing"
    assert np.abs(np.subtract(window.probe.point, (6.0, -8.0))).max() < 1, window.probe.point

    box = window.table.forms.widget(1).widget().rows["Vertex distance"].box
    window.table.forms.setCurrentIndex(1)
    application.processEvents()
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "20")
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert window.document.workbench.active_wearer.wear.vertex_distance == 20.0
    settle(application, window)
    assert window.files.save(folder / "a.lensbench.json")
    window.document.edit("Distance", lambda bench: bench.with_pane(k, quantity="astigmatism"))
    window.document.saved()
    assert window.lane.busy
    window.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
