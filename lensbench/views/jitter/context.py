"""The one place that makes a window's OpenGL context current for what we upload, draw, read and free between its renderings."""

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

_P, _R = ParamSpec("_P"), TypeVar("_R")


def in_own_context(method: Callable[Concatenate[Any, _P], _R]) -> Callable[Concatenate[Any, _P], _R]:
    """A method that runs in the context of its object's window; afterwards the one from before is current again.

    Textures belong to the context in which they are made. VTK makes a window's own current when it renders; between two of
    its renderings that of any other window may be.
    """

    @wraps(method)
    def run(self: Any, *args: _P.args, **kwargs: _P.kwargs) -> _R:
        self.window.PushContext()
        try:
            return method(self, *args, **kwargs)
        finally:
            self.window.PopContext()

    return run
