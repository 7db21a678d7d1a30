"""Starts the window."""

import os
import sys
from pathlib import Path

from ..errors import LensBenchError


def start(files: list[Path]) -> int:
    """Open the window with files (the regular sample lens, if none is named and it is at hand); returns the exit code.

    Raises LensBenchError where there is no display or no OpenGL.
    """
    _require_display()
    from ..views.offscreen import require_gl

    require_gl()
    from PySide6.QtWidgets import QApplication

    from .main_window import MainWindow

    application = QApplication.instance() or QApplication(sys.argv[:1])
    application.setApplicationName("LensBench")
    window = MainWindow()
    window.show()
    window.files.open(files)
    code = application.exec()
    window.lane.wait()
    return int(code)


def _require_display() -> None:
    """Qt itself aborts where it finds no display."""
    if not sys.platform.startswith("linux") or os.environ.get("QT_QPA_PLATFORM", "xcb") != "xcb":
        return
    from ..views.offscreen import display_answers

    screen, wayland = os.environ.get("DISPLAY"), os.environ.get("WAYLAND_DISPLAY")
    if display_answers() or (wayland and "QT_QPA_PLATFORM" not in os.environ):
        return
    why = f"no X server answers at DISPLAY={screen}" if screen else "neither DISPLAY nor WAYLAND_DISPLAY is set"
    raise LensBenchError(f"the window needs a display, and {why}; `lensbench report` and `lensbench view` need none")
