"""The one compute thread: of what each asker still waits for, only the newest question is answered."""

import math
import os
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, Signal

from ..errors import LensBenchError

NICENESS = 19
SLICE = 5e-4  # s: for how long this thread keeps Python from the window's
MOMENT, PATIENCE = 0.02, 0.15  # s
_IN_TURN = threading.Lock()  # a lane that is closed may still be at its last question when another one begins


class Lane(QObject):
    """Answers questions one after the other in a thread of its own, which is niced before its first parallel kernel (OpenMP
    threads inherit it). Askers are named; while one waits, a newer question of his takes the place of the older one. One that
    is in hand is answered all the same, so that pictures follow a hand that does not rest.

    answered(asker, answer); failed(asker, sentence); stopped(): nothing of what was asked so far will be answered; idle():
    nothing is left to do.
    """

    answered = Signal(str, object)
    failed = Signal(str, str)
    stopped = Signal()
    idle = Signal()
    _done = Signal(str, int, object, object)

    def __init__(self) -> None:
        super().__init__()
        self._waiting: dict[str, tuple[int, Callable[[], Any]]] = {}
        self._count = 0
        self._dropped: dict[str | None, int] = {}  # up to which number; None: of all askers
        self._running = 0
        self._wake = threading.Condition()
        self._open = True
        self._delivered = 0.0
        self._done.connect(self._deliver)
        sys.setswitchinterval(SLICE)
        self._thread = threading.Thread(target=self._work, name="lane", daemon=True)
        self._thread.start()

    def ask(self, asker: str, question: Callable[[], Any], first: bool = False) -> None:
        """Answer this question instead of any older one that the same asker waits for; first: before those of all others."""
        with self._wake:
            self._count += 1
            self._waiting[asker] = self._count, question
            if first:
                self._waiting = {asker: self._waiting.pop(asker), **self._waiting}
            self._wake.notify()

    def drop(self, asker: str) -> None:
        """Answer nothing more to this asker of what was asked so far."""
        with self._wake:
            self._waiting.pop(asker, None)
            self._dropped[asker] = self._count

    def stop(self) -> None:
        """Answer nothing more to anybody of what was asked so far."""
        with self._wake:
            self._waiting.clear()
            self._dropped[None] = self._count
        self.stopped.emit()

    @property
    def busy(self) -> bool:
        """Whether something waits or is being answered."""
        with self._wake:
            return bool(self._waiting or self._running)

    @property
    def haste(self) -> float:
        """For how long after the last one (s) a refinement should stand back: while somebody waits, and above all while what
        was just answered is being drawn.
        """
        if time.monotonic() - self._delivered < MOMENT:
            return math.inf
        return PATIENCE if self.busy else 0.0

    def close(self) -> None:
        """Answer nothing more; the question in hand is left to itself."""
        with self._wake:
            self._waiting.clear()
            self._open = False
            self._wake.notify()

    def wait(self) -> None:
        """Wait until the thread has ended, after `close`."""
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
                number, question = self._waiting.pop(asker)
                self._running += 1
            answer, error = None, None
            try:
                with _IN_TURN:
                    answer = question()
            except BaseException as found:
                error = found
            with self._wake:
                if self._open:  # else the lane may be gone
                    self._done.emit(asker, number, answer, error)

    def _deliver(self, asker: str, number: int, answer: Any, error: BaseException | None) -> None:
        with self._wake:
            self._running -= 1
            dropped = number <= max(self._dropped.get(name, 0) for name in (asker, None))
        if not dropped:
            if error is None:
                self.answered.emit(asker, answer)
            else:
                self.failed.emit(asker, sentence(error))
        self._delivered = time.monotonic()
        if not self.busy:
            self.idle.emit()


def sentence(error: BaseException) -> str:
    """An error as one line for the reader; what nobody foresaw keeps its type."""
    if isinstance(error, OSError) and error.filename:
        return f"{error.filename}: {error.strerror}"
    return str(error) if isinstance(error, LensBenchError) else f"{type(error).__name__}: {error}"
