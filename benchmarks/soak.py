"""Long automated clicking and redrawing: python -m benchmarks.soak --minutes 60. Ends with counts; a crash ends it earlier.

Drags sliders, hovers, turns cameras and the head, splits, switches views, opens, compares, flips, undoes, saves and
restores, and opens and closes windows, in an order drawn from a seed. An exception in any slot ends it with an exit code.
"""

import argparse
import ctypes
import gc
import os
import random
import sys
import tempfile
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from lensbench.gui.form import Form
from lensbench.quantities import QUANTITIES
from lensbench.scenes.builtin import SCENES
from lensbench.session import KINDS

from .timing import ROOT

SLOW = ("defocus_by_real_rays", "defocus_left_out", "higher_order_rms", "coma", "trefoil", "spherical_aberration")
LENSES = [
    ROOT / "sample_lenses" / f"{name}_R.toml" for name in ("regular", "wide_near", "wide_far", "toric", "occupational")
]
WEARER = ROOT / "sample_lenses" / "presbyope_60.toml"


class Soak:
    """A user who never rests."""

    def __init__(self, seed: int) -> None:
        from PySide6.QtCore import QSettings
        from PySide6.QtWidgets import QApplication

        self.app = QApplication.instance() or QApplication([])
        self.dice, self.done = random.Random(seed), Counter()
        self.folder = Path(tempfile.mkdtemp(prefix="lensbench-soak-"))
        self.settings = QSettings(str(self.folder / "settings.ini"), QSettings.Format.IniFormat)
        self.open_window()

    def pump(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.app.processEvents()
            time.sleep(0.003)

    def settle(self, seconds: float = 60.0) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end and self.window.lane.busy:
            self.pump(0.02)

    def open_window(self) -> None:
        from lensbench.gui.main_window import MainWindow

        self.window = MainWindow(self.settings)
        self.window.show()
        self.window.files.open([self.dice.choice(LENSES), WEARER])
        self.pump(1.0)
        self.settle()

    # ---- what it does ----

    def slider(self) -> None:
        rows = [row for form in self.window.findChildren(Form) for row in form.rows.values() if row.field.slider]
        slider = self.dice.choice(rows).slider
        stride = max(1, slider.maximum() // 40)
        for _ in range(12):
            slider.setValue(slider.value() + stride * self.dice.randrange(-2, 3))
            self.pump(0.02)
        self.window.document.rest()

    def mouse(self, buttons: bool) -> None:
        from PySide6.QtCore import QEvent, QPointF, Qt
        from PySide6.QtGui import QMouseEvent

        shown = [v.content for v in self.window.viewports if v.isVisible() and v.content is not None]
        if not shown:
            return
        content = self.dice.choice(shown)
        picture = getattr(content, "stage", content)
        left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
        x, y = (self.dice.uniform(0.2, 0.8) * n for n in (picture.width(), picture.height()))

        def send(kind, button, held) -> None:
            at = QPointF(x, y)
            event = QMouseEvent(kind, at, picture.mapToGlobal(at), button, held, Qt.KeyboardModifier.NoModifier)
            self.app.sendEvent(picture, event)

        if buttons:
            send(QEvent.Type.MouseButtonPress, left, left)
        for _ in range(10):
            x, y = x + self.dice.uniform(-15, 15), y + self.dice.uniform(-15, 15)
            send(QEvent.Type.MouseMove, none, left if buttons else none)
            self.pump(0.015)
        if buttons:
            send(QEvent.Type.MouseButtonRelease, left, none)

    def hover(self) -> None:
        self.mouse(False)

    def drag(self) -> None:
        self.mouse(True)

    def view(self) -> None:
        k, names = self.dice.randrange(4), [name for name in QUANTITIES if name not in SLOW]
        change = {"kind": self.dice.choice(list(KINDS)), "quantity": self.dice.choice(names)}
        self.window.document.edit("view", lambda bench: bench.with_pane(k, **change))
        self.pump(0.3)

    def tiles(self) -> None:
        split = self.dice.choice((1, 2, 4, 4))
        self.window.document.edit("split", lambda bench: replace(bench, split=split))
        self.pump(0.2)

    def open(self) -> None:
        if len(self.window.document.workbench.lenses) > 5:
            self.window.document.edit("removal", lambda bench: bench.without_lens(0))
        self.window.files.open([self.dice.choice(LENSES)])
        self.pump(0.3)

    def flip(self) -> None:
        self.window.flip()
        self.pump(0.2)

    def undo(self) -> None:
        document = self.window.document
        for _ in range(self.dice.randrange(1, 6)):
            self.dice.choice((document.undo, document.undo, document.redo))()
            self.pump(0.03)

    def scene(self) -> None:
        name = self.dice.choice(SCENES)
        self.window.document.edit("scene", lambda bench: replace(bench, scene=name))
        self.pump(0.3)

    def session(self) -> None:
        self.settle()
        self.window.files.save(self.folder / "soak.lensbench.json")
        self.window.files.open([self.folder / "soak.lensbench.json"])
        self.pump(0.5)

    def theme(self) -> None:
        self.window._theme(self.dice.random() < 0.5)
        self.pump(0.1)

    def reopen(self) -> None:
        self.close_window()
        self.open_window()

    def close_window(self) -> None:
        from PySide6.QtCore import QEvent

        self.window.document.saved()
        self.window.close()
        self.window.deleteLater()
        self.app.sendPostedEvents(None, QEvent.Type.DeferredDelete)  # which processEvents leaves to a loop of exec's
        del self.window
        self.pump(0.1)
        gc.collect()


WEIGHTS = {"slider": 8, "hover": 8, "drag": 8, "view": 5, "tiles": 2, "open": 2, "flip": 2, "undo": 3, "scene": 1}
WEIGHTS |= {"session": 1, "theme": 1, "reopen": 1}


def main() -> int:
    """Run for a while, then say what was done and how memory grew over the second half."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    sys.excepthook = _end
    start, sizes = time.monotonic(), [(0, memory())]
    soak = Soak(args.seed)
    while (passed := (time.monotonic() - start) / 60) < args.minutes:
        action = soak.dice.choices(list(WEIGHTS), list(WEIGHTS.values()))[0]
        getattr(soak, action)()
        soak.done[action] += 1
        if passed > len(sizes) - 1:
            sizes.append((soak.done.total(), memory()))
            print(f"{passed:.1f} min, {sizes[-1][0]} actions, {sizes[-1][1]:.0f} MB", flush=True)
    soak.close_window()
    count, size = np.array(sizes[len(sizes) // 2 :]).T
    growth = f"{100 * np.polyfit(count, size, 1)[0]:.1f} MB per 100 actions" if count.size > 2 else "too short to tell"
    print(f"survived {passed:.1f} min: {dict(soak.done)}; growth over the second half: {growth}", flush=True)
    return 0


def memory() -> float:
    """Resident MB, after what is free was given back to the system (where the C library is glibc)."""
    gc.collect()
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).malloc_trim(0)
    return psutil.Process().memory_info().rss / 1e6


def _end(*error: Any) -> None:
    sys.__excepthook__(*error)
    os._exit(1)


if __name__ == "__main__":
    sys.exit(main())
