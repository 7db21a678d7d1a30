"""How figures are taken: medians of actions that take turns, so that a noisy machine is noisy for all of them."""

import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).parent.parent


def rounds(*actions: Callable[[], Any], count: int = 7) -> list[float]:
    """Median seconds of each action, the actions taking turns after one warm-up."""
    times: list[list[float]] = [[] for _ in actions]
    for k in range(count + 1):
        for action, kept in zip(actions, times, strict=True):
            since = time.perf_counter()
            action()
            if k:
                kept.append(time.perf_counter() - since)
    return [median(kept) for kept in times]
