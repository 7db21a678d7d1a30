"""Files of the window: whatever somebody opens, drops or picks again is read in the lane; sessions are saved."""

import base64
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from PySide6.QtCore import QByteArray
from PySide6.QtWidgets import QFileDialog, QMenu

from ..errors import InputError
from ..formats import read_file
from ..formats.scene_file import KINDS as MESHES
from ..optics.eye import Wearer
from ..scenes.scene import Scene
from ..session import Workbench, lens_read, load_session, save_session

if TYPE_CHECKING:
    from .main_window import MainWindow

ASKER, ENDING = "file ", ".lensbench.json"
MOST_RECENT = 8
SESSION_FILES = f"Session (*{ENDING})"


class FileRead(NamedTuple):
    """A file as it was read: what it does to the table; of a session also the state of the window, as text."""

    path: Path
    put: Callable[[Workbench], Workbench]
    window: str | None = None


def read(path: Path) -> FileRead:
    """Read a file: a session, a wearer, a scene, or else a lens. Raises InputError."""
    if path.name.endswith(ENDING):
        workbench, window = load_session(path)
        return FileRead(path, lambda _bench: workbench, window)
    try:
        contents = read_file(path)
    except InputError:
        if path.suffix.lower() in MESHES:
            raise InputError(
                f"{path}: neither a lens; as a scene it needs a scene file that says its unit and place"
            ) from None
        raise
    first = contents.items[0]
    if isinstance(first, Wearer):
        return FileRead(path, lambda bench: bench.with_wearer(first))
    if isinstance(first, Scene):
        return FileRead(path, lambda bench: replace(bench, scene=str(path.absolute())))
    lens, told = lens_read(contents)
    return FileRead(path, lambda bench: bench.with_lens_read(lens, told))


class Files:
    """Opens and saves. session: the file of the session, once there is one; recent: the menu of what was opened last."""

    def __init__(self, window: "MainWindow") -> None:
        self.window, self.recent = window, QMenu("Open &recent", window)
        self.session: Path | None = None
        self._count = 0
        window.lane.answered.connect(self._answered)
        window.lane.failed.connect(self._failed)
        self._show_recent()

    def open(self, paths: list[Path]) -> None:
        """Open lenses, wearers, scenes and sessions, in this order; what cannot be read is said and changes nothing."""
        for path in paths:
            self._count += 1
            self.window.lane.ask(f"{ASKER}{self._count}", partial(read, path))
            self.window.statusBar().showMessage(f"Reading {path.name}…")

    def _answered(self, asker: str, answer: FileRead) -> None:
        if asker.startswith(ASKER) and self.window.attempt(partial(self._put, answer)):
            self.window.statusBar().clearMessage()
            self._remember(answer.path)
            self._say_what_was_assumed()

    def _failed(self, asker: str, sentence: str) -> None:
        if asker.startswith(ASKER):
            self.window.say(sentence)

    def _put(self, found: FileRead) -> None:
        document = self.window.document
        if found.window is None:
            untouched = self.session is None and not document.modified
            document.edit(f"Open {found.path.name}", found.put)
            if untouched:  # the files themselves still say all that lies on the table
                document.saved()
            return
        self.session = found.path
        document.open(found.put(document.workbench))
        if found.window:
            self.window.restoreState(QByteArray(base64.b64decode(found.window)))

    def _say_what_was_assumed(self) -> None:
        lens = self.window.document.workbench.active_lens
        if lens is not None and lens.note:
            self.window.say(f"{lens.name}: {lens.note}")

    def save(self, path: Path) -> bool:
        """Save the session; whether it is now in the file."""
        state = base64.b64encode(bytes(self.window.saveState().data())).decode()
        if not self.window.attempt(lambda: save_session(self.window.document.workbench, path, state)):
            return False
        self.session = path
        self.window.document.saved()
        self._remember(path)
        return True

    def ask_open(self) -> None:
        """Ask which files to open."""
        what = "Open lenses, wearers, scenes or a session"
        names, _ = QFileDialog.getOpenFileNames(self.window, what, self._folder())
        self.open([Path(name) for name in names])

    def ask_save(self, anew: bool = False) -> bool:
        """Save the session, asking where if it has no file yet; whether it was saved."""
        path = None if anew else self.session
        if path is None:
            name, _ = QFileDialog.getSaveFileName(self.window, "Save session", self._folder(), SESSION_FILES)
            if not name:
                return False
            path = Path(name if name.endswith(ENDING) else name + ENDING)
        return self.save(path)

    def _folder(self) -> str:
        return str(self.window.settings.value("folder", ""))

    def _remember(self, path: Path) -> None:
        known = [str(path.absolute()), *self._known()]
        self.window.settings.setValue("recent", list(dict.fromkeys(known))[:MOST_RECENT])
        self.window.settings.setValue("folder", str(path.absolute().parent))
        self._show_recent()

    def _known(self) -> list[str]:
        found = self.window.settings.value("recent", [])
        return [found] if isinstance(found, str) else list(found or [])

    def _show_recent(self) -> None:
        self.recent.clear()
        for name in self._known():
            self.recent.addAction(Path(name).name, partial(self.open, [Path(name)])).setToolTip(name)
        self.recent.setEnabled(bool(self._known()))
