"""Large arrays used again: a system clears every page of a new one, which takes longer than a trace needs to fill it."""

import weakref
from collections import deque
from contextlib import suppress

import numpy as np

from .conventions import Floats

LEAST = 1 << 17  # numbers: smaller arrays come from pages that the heap keeps
MOST = 1 << 25  # numbers in all that are kept spare, 268 MB: the 1024 x 1024 gazes of a trace and no more
_spare: deque[Floats] = deque(maxlen=4)


def uninitialised(size: int) -> Floats:
    """An array (size,) of any content, over the memory of one that nothing refers to any more, if there is one of its size."""
    if not LEAST <= size <= MOST:
        return np.empty(size)
    block = _taken(size)
    if block is None:
        block = np.empty(size)
    array: Floats = np.frombuffer(block.data)  # views of it hold it, as its own base is no array
    weakref.finalize(array, _keep, block).atexit = False
    return array


def _keep(block: Floats) -> None:
    _spare.append(block)
    while sum(spare.size for spare in list(_spare)) > MOST:
        with suppress(IndexError):  # another thread may have taken it
            _spare.popleft()


def _taken(size: int) -> Floats | None:
    for _ in range(len(_spare)):
        try:
            block = _spare.popleft()
        except IndexError:
            return None
        if block.size == size:
            return block
        _spare.append(block)
    return None
