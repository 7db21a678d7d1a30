"""The one compute thread: the newest question of each asker is answered, an older one is dropped."""

import os
import threading
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, Signal

from ..errors import LensBenchError

NICENESS = 10


class Lane(QObject):
    """Answers questions one after the other in a thread of its own, which is niced before its first parallel kernel (OpenMP
    threads inherit it). Askers are named; while one waits or is being answered, a newer question of his takes its place.

    answered(asker, answer); failed(asker, sentence); idle(): nothing is left to do.
    """

    answered = Signal(str, object)
    failed = Signal(str, str)
    idle = Signal()
    _done = Signal(str, int, object, object)

    def __init__(self) -> None:
        super().__init__()
        self._waiting: dict[str, tuple[int, Callable[[], Any]]] = {}
        self._newest: dict[str, int] = {}
        self._running = 0
        self._wake = threading.Condition()
        self._open = True
        self._done.connect(self._deliver)
        self._thread = threading.Thread(target=self._work, name="lane", daemon=True)
        self._thread.start()

    def ask(self, asker: str, question: Callable[[], Any], first: bool = False) -> None:
        """Answer this question instead of any older one of the same asker; first: before those of all others."""
        with self._wake:
            generation = self._newest[asker] = self._newest.get(asker, 0) + 1
            self._waiting.pop(asker, None)
            self._waiting[asker] = generation, question
            if first:
                self._waiting = {asker: self._waiting.pop(asker), **self._waiting}
            self._wake.notify()

    def drop(self, asker: str | None = None) -> None:
        """Answer nothing more to this asker (None: to all) of what was asked so far."""
        with self._wake:
            for name in [asker] if asker is not None else list(self._newest):
                self._newest[name] = self._newest.get(name, 0) + 1
                self._waiting.pop(name, None)

    @property
    def busy(self) -> bool:
        """Whether something waits or is being answered."""
        with self._wake:
            return bool(self._waiting or self._running)

    def close(self) -> None:
        """Answer nothing more, and wait for the question in hand."""
        self.drop()
        with self._wake:
            self._open = False
            self._wake.notify()
        self._thread.join()

    def _work(self) -> None:
        if hasattr(os, "setpriority"):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICENESS)
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._waiting or not self._open)
                if not self._open:
                    return
                asker = next(iter(self._waiting))
                generation, question = self._waiting.pop(asker)
                self._running += 1
            answer, error = None, None
            try:
                answer = question()
            except Exception as found:
                error = found
            self._done.emit(asker, generation, answer, error)

    def _deliver(self, asker: str, generation: int, answer: Any, error: Exception | None) -> None:
        with self._wake:
            self._running -= 1
            late = self._newest.get(asker) != generation
        if not late:
            if error is None:
                self.answered.emit(asker, answer)
            else:
                self.failed.emit(asker, sentence(error))
        if not self.busy:
            self.idle.emit()


def sentence(error: Exception) -> str:
    """An error as one line for the reader; what nobody foresaw keeps its type."""
    if isinstance(error, OSError) and error.filename:
        return f"{error.filename}: {error.strerror}"
    return str(error) if isinstance(error, LensBenchError) else f"{type(error).__name__}: {error}"
