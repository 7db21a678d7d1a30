"""Large arrays used again: a system clears every page of a new one, which takes longer than a trace needs to fill it."""

import weakref
from collections import deque

import numpy as np

from .conventions import Floats

LEAST, MOST = (
    1 << 17,
    1 << 23,
)  # numbers: smaller ones come from pages that the heap keeps, larger ones are too much to keep
_spare: deque[Floats] = deque(maxlen=2)


def uninitialised(size: int) -> Floats:
    """An array (size,) of any content, over the memory of one that nothing refers to any more, if there is one of its size."""
    if not LEAST <= size <= MOST:
        return np.empty(size)
    block = _taken(size)
    if block is None:
        block = np.empty(size)
    array: Floats = np.frombuffer(block.data)  # views of it hold it, as its own base is no array
    weakref.finalize(array, _spare.append, block).atexit = False
    return array


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
