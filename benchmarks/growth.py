"""How the cost of a gaze field grows with the number of gazes."""

from functools import partial

import numpy as np

import lensbench as lb

from .figures import Figure
from .timing import ROOT, rounds

SIZES = (32, 64, 128, 256, 512)


def growth() -> list[Figure]:
    """Fields of n x n gazes through the regular sample lens, and the exponent of n that fits their cost."""
    lens = lb.load_lens(ROOT / "sample_lenses" / "regular_R.toml")
    wearer = lb.load_wearer(ROOT / "sample_lenses" / "presbyope_60.toml")
    seconds = rounds(*(partial(lb.trace, lens, wearer, lb.GazeGrid(n, n)) for n in SIZES))
    exponent = np.polyfit(np.log(SIZES), np.log(seconds), 1)[0]
    figures = [Figure(f"field of {n} x {n} gazes", s * 1e3, "ms") for n, s in zip(SIZES, seconds, strict=True)]
    return [*figures, Figure("growth of the field's cost with n: exponent", float(exponent), "", at_most=2.1)]
