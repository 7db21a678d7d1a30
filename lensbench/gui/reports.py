"""Report and comparison from the window: the command line's own, in a process of its own, with progress and cancel."""

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QProcess, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog, QProgressDialog

from ..session import save_session

if TYPE_CHECKING:
    from .main_window import MainWindow


class ReportRunner:
    """Runs one command at a time on the session as it is on the screen."""

    def __init__(self, window: "MainWindow") -> None:
        self.window = window
        self.process: QProcess | None = None
        self._dialog: QProgressDialog | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._heard = ""

    def ask_report(self) -> None:
        """Ask for a folder and write the active lens's report there."""
        self._ask("report", 1, "a report needs a lens: open one")

    def ask_comparison(self) -> None:
        """Ask for a folder and compare all lenses on the table there."""
        self._ask("compare", 2, "a comparison needs two lenses: open another one")

    def _ask(self, verb: str, needed: int, otherwise: str) -> None:
        if len(self.window.document.workbench.lenses) < needed:
            self.window.say(otherwise)
            return
        folder = QFileDialog.getExistingDirectory(self.window, "Folder for the pages")
        if folder:
            self.start(verb, Path(folder))

    def start(self, verb: str, folder: Path) -> None:
        """Write the pages of "report" or "compare" into a folder."""
        if self.process is not None:
            self.window.say("one report at a time: wait for the other, or cancel it")
            return
        self._folder = tempfile.TemporaryDirectory()
        session = Path(self._folder.name) / "now.lensbench.json"
        if not self.window.attempt(lambda: save_session(self.window.document.workbench, session)):
            return
        self._heard = ""
        self._dialog = QProgressDialog("Starting…", "Cancel", 0, 0, self.window, minimumDuration=0)
        self._dialog.setWindowTitle({"report": "Report", "compare": "Comparison"}[verb])
        self._dialog.canceled.connect(self.cancel)
        self._dialog.show()
        self.process = QProcess(self.window)
        self.process.readyReadStandardError.connect(self._listen)
        self.process.finished.connect(lambda code, _status: self._over(code, folder))
        self.process.errorOccurred.connect(lambda error: self._not_started(error, folder))
        self.process.start(sys.executable, self._command(verb, session, folder))

    def _command(self, verb: str, session: Path, folder: Path) -> Sequence[str]:
        scene = ["--scene", self.window.document.workbench.scene] if verb == "report" else []
        return ["-m", "lensbench", verb, str(session), "-o", str(folder), "--progress", *scene]

    def cancel(self) -> None:
        """Stop the command; what it writes, it writes only when it is complete."""
        if self.process is not None:
            self.process.kill()

    def _listen(self) -> None:
        assert self.process is not None
        self._heard += bytes(self.process.readAllStandardError().data()).decode(errors="replace")
        last = self._heard.strip().splitlines()[-1:] or [""]
        if self._dialog is not None:
            self._dialog.setLabelText(last[0])

    def _not_started(self, error: QProcess.ProcessError, folder: Path) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self._heard = f"{sys.executable} cannot be started"
            self._over(2, folder)

    def _over(self, code: int, folder: Path) -> None:
        self._listen()
        if self._dialog is not None:
            self._dialog.canceled.disconnect()
            self._dialog.close()
            self._dialog.deleteLater()
        assert self.process is not None
        self.process.deleteLater()
        self.process = self._dialog = None
        if self._folder is not None:
            self._folder.cleanup()
        if code == 0:
            page = folder / "index.html"
            self.window.say(f"written: {page}")
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(page)))
        else:
            last = self._heard.strip().splitlines()[-1:]
            self.window.say("cancelled" if code != 2 or not last else last[0].removeprefix("lensbench: "))
