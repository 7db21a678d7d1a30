"""Progress on a terminal, and where the time went."""

import time
from typing import TextIO


class Progress:
    """Named steps on one line of a terminal; elsewhere silent, or (lines) each on a line of its own. `seconds`: by step."""

    def __init__(self, stream: TextIO, lines: bool = False):
        self._lines = lines and not stream.isatty()
        self.seconds: dict[str, float] = {}
        self._stream, self._name, self._since = stream, "", 0.0

    def step(self, name: str) -> None:
        """The next step begins."""
        self._close()
        self._name, self._since = name, time.perf_counter()
        if self._stream.isatty():
            print(f"\r\033[K{name} ...", end="", file=self._stream, flush=True)
        elif self._lines:
            print(name, file=self._stream, flush=True)

    def done(self) -> None:
        """All steps are over: say how long each took."""
        self._close()
        if self._stream.isatty():
            total = sum(self.seconds.values())
            split = ", ".join(f"{name} {seconds:.1f}" for name, seconds in self.seconds.items())
            print(f"\r\033[K{total:.1f} s ({split})", file=self._stream)

    def _close(self) -> None:
        if self._name:
            self.seconds[self._name] = self.seconds.get(self._name, 0.0) + time.perf_counter() - self._since
            self._name = ""
