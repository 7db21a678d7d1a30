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
    return int(application.exec())


def _require_display() -> None:
    """Qt itself aborts where it finds no display."""
    named = os.environ.get("QT_QPA_PLATFORM", "")
    if (
        sys.platform.startswith("linux")
        and not named
        and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    ):
        raise LensBenchError(
            "the window needs a display, and neither DISPLAY nor WAYLAND_DISPLAY is set; `lensbench report` and `lensbench "
            "view` need none"
        )
