"""How figures are taken: medians of actions that take turns, so that a noisy machine is noisy for all of them."""

import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).parent.parent
TURN = 0.02  # s, about, that a quick action is repeated for


def rounds(*actions: Callable[[], Any], count: int = 7) -> list[float]:
    """Median seconds of each action, the actions taking turns after a warm-up; a quick one is repeated within its turn."""
    repeats = [max(1, round(TURN / _seconds(action, 2))) for action in actions]
    turns = [[_seconds(action, n) for action, n in zip(actions, repeats, strict=True)] for _ in range(count)]
    return [median(kept) for kept in zip(*turns, strict=True)]


def _seconds(action: Callable[[], Any], repeats: int) -> float:
    """Seconds of an action, the mean of so many after one that is not counted."""
    action()
    since = time.perf_counter()
    for _ in range(repeats):
        action()
    return (time.perf_counter() - since) / repeats
