"""On the terminal: which kernel is being compiled, while it is; a first use takes seconds."""

import sys
import time

from numba.core import event

CLEAR = "\r\x1b[K"


class Progress(event.Listener):
    """One line on a terminal (standard error) that names the function of this package that numba compiles, and goes again.

    Numba tells of what it compiles, not of what it takes from the cache; a kernel's callees come within the kernel.
    """

    def __init__(self) -> None:
        self.under_way: list[str] = []
        self.kernels, self.since, self.seconds = 0, 0.0, 0.0

    def on_start(self, event: event.Event) -> None:
        """A function's compilation begins."""
        if not _is_ours(event):
            return
        if not self.under_way:
            self.kernels, self.since = self.kernels + 1, time.perf_counter()
        self.under_way.append(event.data["dispatcher"].py_func.__name__)
        seconds = self.seconds + time.perf_counter() - self.since
        names = " < ".join(dict.fromkeys((self.under_way[0], self.under_way[-1])))
        _say(f"{CLEAR}LensBench: compiling for this processor, once: kernel {self.kernels}, {names}, {seconds:.0f} s")

    def on_end(self, event: event.Event) -> None:
        """It has ended."""
        if not _is_ours(event):
            return
        self.under_way.pop()
        if not self.under_way:
            self.seconds += time.perf_counter() - self.since
            _say(CLEAR)


def _is_ours(event: event.Event) -> bool:
    return bool(event.data["dispatcher"].py_func.__module__.startswith(__package__))


def _say(text: str) -> None:
    if sys.stderr is not None and sys.stderr.isatty():
        print(text, end="", file=sys.stderr, flush=True)
