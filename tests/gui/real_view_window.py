"""Run by test_real_window.py on a screen of its own: whatever is edited, the simulated view is what a fresh one shows."""

import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSettings
from PySide6.QtGui import QGuiApplication, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from real_window import settle
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow

from lensbench.gui.main_window import MainWindow
from lensbench.gui.view_content import PASSES
from lensbench.views.jitter import JitterPass


def at_rest(application, window):
    """Settle, and wait for all passes of the view; the view's content."""
    settle(application, window)
    content = next(v.content for v in window.viewports if window.document.workbench.panes[v.k].kind == "view")
    until = time.monotonic() + 60
    while content.passes < PASSES and time.monotonic() < until:
        application.processEvents()
    assert content.passes == PASSES
    QTest.qWait(400)  # stages grow fine when all rests
    return content


def fresh(seen):
    """The light of a view that has shown nothing else."""
    window, renderer = vtkRenderWindow(), vtkRenderer()
    window.SetOffScreenRendering(True)
    window.AddRenderer(renderer)
    window.SetSize(*seen.layer.size)
    view = JitterPass(window, renderer, PASSES)
    view.show(seen)
    while not view.done:
        window.Render()
    light = view.light()
    view.close()
    window.Finalize()
    return light


def wear(bench, **changes):
    """The table with the active wearer's position of wear changed."""
    wearer = bench.active_wearer
    wearers = list(bench.wearers)
    wearers[bench.wearer] = replace(wearer, wear=replace(wearer.wear, **changes))
    return replace(bench, wearers=tuple(wearers))


EDITS = {
    "vertex distance": lambda bench: wear(bench, vertex_distance=18.0),
    "scene": lambda bench: replace(bench, scene="desk"),
    "gaze": lambda bench: bench.with_pane(2, elevation=-25.0),
    "head": lambda bench: replace(bench, head_turn=10.0),
    "naked eye": lambda bench: bench.with_pane(2, eye="naked"),
    "split": lambda bench: bench.with_pane(2, eye="lens", split=True),
    "thickness": lambda bench: replace(bench, lenses=(bench.lenses[0].edited(centre_thickness=4.0), *bench.lenses[1:])),
}


def pictures(window):
    """What every viewport shows, as arrays of codes."""
    grabs = [v.content.grab().toImage().convertToFormat(QImage.Format.Format_RGBA8888) for v in window.viewports]
    return [np.frombuffer(g.constBits(), np.uint8).reshape(g.height(), g.width(), 4).astype(int) for g in grabs]


def new_window(folder, name):
    window = MainWindow(QSettings(str(folder / f"{name}.ini"), QSettings.Format.IniFormat))
    window.resize(1200, 800)
    window.show()
    assert QTest.qWaitForWindowExposed(window)
    return window


def main(progressive: Path, sphere: Path, folder: Path) -> None:
    application = QApplication([])
    assert QGuiApplication.platformName() == "xcb", QGuiApplication.platformName()
    window = new_window(folder, "first")

    def check(after):
        content = at_rest(application, window)
        off = np.abs(content.light() - fresh(content.seen)).max()
        assert off < 1 / 255, f"after {after} the view is off by {off:.3f} of white"
        assert content.seen.layer.size == (content.width(), content.height()), f"after {after}: not the widget's size"

    window.files.open([sphere, progressive])
    check("opening")
    for name, make in EDITS.items():
        window.document.edit(name, make)
        check(name)
    for _ in EDITS:
        window.document.undo()
    check("undo")
    for lens in (0, 1):
        window.document.edit("flip", lambda bench, lens=lens: replace(bench, lens=lens))
        check("flip")
    before = pictures(window)
    assert window.files.save(folder / "a.lensbench.json")
    window.close()

    window = new_window(folder, "second")
    window.files.open([folder / "a.lensbench.json"])
    check("opening the session")
    for pane, was, now in zip(window.document.workbench.panes, before, pictures(window), strict=True):
        assert was.shape == now.shape, f"{pane.kind}: {was.shape} became {now.shape}"
        assert np.abs(was - now).max() <= 2, (
            f"{pane.kind} is off by {np.abs(was - now).max()} codes in a session opened anew"
        )
    window.document.saved()
    window.close()


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
