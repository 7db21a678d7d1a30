"""One part of the window that asks the lane, and a mark that says how what it shows stands to what was asked last."""

from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from .lane import Lane

UPDATING = "<span style='color:#d98200'>● updating</span>"
STOPPED = "<a href='again' style='color:#c0392b'>■ stopped</a>"
OLDER = "What is shown is older than the settings; "


class Asker(QObject):
    """Asks under a name when what an answer depends on has changed. What is shown stays, marked, until its successor is there;
    what was stopped is asked again at a click on the mark, by `again`, or at the next change.

    answered(answer, context): as it was asked; failed(sentence).
    """

    answered = Signal(object, object)
    failed = Signal(str)

    def __init__(self, parent: QObject, lane: Lane, name: str, first: bool = False) -> None:
        super().__init__(parent)
        self.lane, self.name, self.first = lane, name, first
        self.mark = QLabel(visible=False)
        self._key: tuple[Any, ...] | None = None
        self._last: tuple[Any, ...] = ()
        self._waiting = self._was_stopped = False
        self.mark.linkActivated.connect(lambda _: self.again())
        lane.answered.connect(self._answered)
        lane.failed.connect(self._failed)
        lane.stopped.connect(self._stopped)

    def ask(self, key: tuple[Any, ...], find: Callable[[], Any], context: Any = None) -> None:
        """Ask, unless the last question depended on just the same (key)."""
        if key == self._key:
            return
        self._key, self._last = key, (key, find, context)
        self._waiting, self._was_stopped = True, False
        self._say(UPDATING, OLDER + "the new one is being computed")
        self.lane.ask(self.name, partial(_with_question, key, context, find), self.first)

    def forget(self) -> None:
        """Nothing is to be shown: whatever was asked is of no interest."""
        self.lane.drop(self.name)
        self._key, self._waiting, self._was_stopped = None, False, False
        self._say("", "")

    def again(self) -> None:
        """Ask once more what was stopped."""
        if self._was_stopped:
            self.ask(*self._last)

    def fail(self, sentence: str) -> None:
        """Mark and say what is wrong."""
        self._say("⚠", sentence)
        self.failed.emit(sentence)

    def _answered(self, name: str, answer: Any) -> None:
        if name != self.name:
            return
        key, context, found = answer
        if key == self._key:
            self._waiting = False
            self._say("", "")
        self.answered.emit(found, context)

    def _failed(self, name: str, sentence: str) -> None:
        if name == self.name:
            self._waiting = False
            self.fail(sentence)

    def _stopped(self) -> None:
        if self._waiting:
            self._key, self._waiting, self._was_stopped = None, False, True
            self._say(STOPPED, OLDER + "a click computes the new one")

    def _say(self, text: str, why: str) -> None:
        self.mark.setText(text)
        self.mark.setToolTip(why)
        self.mark.setVisible(bool(text))


def _with_question(key: tuple[Any, ...], context: Any, find: Callable[[], Any]) -> tuple[tuple[Any, ...], Any, Any]:
    """An answer with what it answers."""
    return key, context, find()


def marks(*askers: Asker) -> QWidget:
    """The marks of some askers in a line, whose height does not change with them."""
    line = QWidget()
    line.setFixedHeight(line.fontMetrics().height())
    layout = QHBoxLayout(line, spacing=8)
    layout.setContentsMargins(0, 0, 6, 0)
    layout.addStretch(1)
    for asker in askers:
        layout.addWidget(asker.mark)
    return line
