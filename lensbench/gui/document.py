"""The document: one frozen Workbench, every edit of which can be undone."""

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, Signal

from ..session import Workbench

MOST_STEPS = 200


class Document(QObject):
    """Holds the workbench. changed(old, new): whoever shows a part of it starts with `if new.part is old.part: return`.

    Steps in a row with the same name (a slider's) are undone as one, until `rest` ends the row.
    """

    changed = Signal(object, object)
    history = Signal()

    def __init__(self, workbench: Workbench | None = None) -> None:
        super().__init__()
        self.workbench = workbench or Workbench()
        self._past: list[tuple[str, Workbench]] = []
        self._future: list[tuple[str, Workbench]] = []
        self._saved, self._row = self.workbench, ""

    def edit(self, name: str, make: Callable[[Workbench], Workbench], row: str = "") -> None:
        """Replace the workbench by what `make` makes of it. row: edits of one row are one step. Errors leave all as it is."""
        new, old = make(self.workbench), self.workbench
        if new is old:
            return
        if not (row and row == self._row and self._past):
            self._past = [*self._past, (name, old)][-MOST_STEPS:]
        self._row, self._future = row, []
        self._put(old, new)

    def rest(self) -> None:
        """The row of edits is over."""
        self._row = ""

    def open(self, workbench: Workbench) -> None:
        """Another workbench, with no past, as saved."""
        old, self._past, self._future, self._row, self._saved = self.workbench, [], [], "", workbench
        self._put(old, workbench)

    def undo(self) -> None:
        """The workbench before the last step."""
        self._step(self._past, self._future)

    def redo(self) -> None:
        """The workbench before the last undo."""
        self._step(self._future, self._past)

    @property
    def undo_name(self) -> str:
        """The last step, or nothing."""
        return self._past[-1][0] if self._past else ""

    @property
    def redo_name(self) -> str:
        """The step that was undone last, or nothing."""
        return self._future[-1][0] if self._future else ""

    @property
    def modified(self) -> bool:
        """Whether there is something that is not in the session file."""
        return self.workbench is not self._saved

    def saved(self) -> None:
        """The workbench is now in the session file."""
        self._saved = self.workbench
        self.history.emit()

    def _step(self, source: list[Any], target: list[Any]) -> None:
        if not source:
            return
        name, new = source.pop()
        old, self._row = self.workbench, ""
        target.append((name, old))
        self._put(old, new)

    def _put(self, old: Workbench, new: Workbench) -> None:
        self.workbench = new
        self.changed.emit(old, new)
        self.history.emit()
