"""The pictures of docs/gui.md, from a window drawn into memory: python docs/make_gui_pictures.py. Look at them afterwards."""

import os
import time
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PIL import Image
from PySide6.QtCore import QSettings
from PySide6.QtGui import QFont
from PySide6.QtWidgets import QApplication

from lensbench.gui.main_window import MainWindow

DOCS = Path(__file__).parent
SAMPLES = DOCS.parent / "sample_lenses"
WIDTH, COLOURS = 980, 160


def until(app: QApplication, holds, most: float = 120.0) -> None:
    """Run the window until something holds."""
    end = time.monotonic() + most
    while not holds() and time.monotonic() < end:
        app.processEvents()
        time.sleep(0.003)


def stands(window: MainWindow) -> bool:
    """Whether all pictures are there and as fine as they get."""
    shown = window.viewports[: window.document.workbench.split]
    return not window.lane.busy and all(v.answered and getattr(v.content, "passes", 48) >= 48 for v in shown)


def take(app: QApplication, window: MainWindow, name: str) -> None:
    """The window as a picture of few colours."""
    until(app, lambda: stands(window))
    rest = time.monotonic() + 1.0
    until(app, lambda: time.monotonic() > rest)
    path = DOCS / f"{name}.png"
    window.grab().save(str(path))
    with Image.open(path) as picture:
        small = picture.convert("RGB").resize((WIDTH, round(picture.height * WIDTH / picture.width)), Image.LANCZOS)
    small.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(path, optimize=True)
    print(path, path.stat().st_size // 1000, "kB")


def main() -> None:
    """A design review: one lens, a gaze, a second lens with the difference, the head turned."""
    app = QApplication([])
    app.setFont(QFont("DejaVu Sans", 10))
    settings = QSettings(str(DOCS.parent / "reports" / "docs.ini"), QSettings.Format.IniFormat)
    window = MainWindow(settings)
    window.resize(1400, 900)
    window.show()
    window.files.open([SAMPLES / "regular_R.toml", SAMPLES / "presbyope_60.toml"])
    until(app, lambda: stands(window))
    window.viewports[1].pointed.emit((6.0, -14.0), None)
    take(app, window, "gui_lens")
    window.files.open([SAMPLES / "back_progressive_R.toml"])
    until(app, lambda: stands(window))
    window._side_by_side()
    take(app, window, "gui_compare")
    window.document.edit("split", lambda b: replace(b.with_pane(0, kind="view", split=True, elevation=-25.0), split=1))
    take(app, window, "gui_view")
    window.document.saved()
    window.close()


if __name__ == "__main__":
    main()
