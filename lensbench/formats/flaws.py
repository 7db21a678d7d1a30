"""What may be wrong with the values of a grid of sags: the step to which they are rounded, and single values that stand out."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from ..optics.conventions import Floats

STANDS_OUT, OWN_STEPS, LEAST_MEDIANS = 10.0, 3.0, 7.0
MOST_ROUNDS = 12
_MADE = np.array([-0.05, 0.3, -0.75, 1.0, -0.75, 0.3, -0.05])  # errors around a value that is wrong by 1


def rounding_step(values: Floats, digit: float) -> float:
    """The step between the values, mm, where their last digit written is `digit`, mm: coarser if all share a larger one.

    Values of single precision written with more digits step by the spacing of their floating-point numbers.
    """
    given = values[np.isfinite(values)]
    if not given.size or digit <= 0:
        return digit
    single = given.astype(np.float32)
    spacing = float(np.spacing(np.abs(single).max()))
    if spacing > 2 * digit and np.all(np.abs(single - given) <= 0.51 * digit):
        return spacing
    counted = np.round((given - given[0]) / digit)
    if np.abs(counted).max() > 2**52:
        return digit
    common = int(np.gcd.reduce(np.abs(counted).astype(np.int64)))
    return digit * common if common > 1 else digit


def spikes(values: Floats, step: float) -> NDArray[np.bool_]:
    """Single values of a grid (NaN: missing) that stand out from their row and their column.

    Each value is compared with the one that the polynomial of degree 5 through three neighbours on each side predicts
    (of the two predictions, row and column, the nearer one counts). It stands out when it is off by more than 3 rounding
    steps plus 10 times the robust standard deviation (1.4826 times the median) of that error among its 11 x 11 neighbours,
    by more than 7 times its median over the grid, and when it alone explains the errors of its neighbours: what it leaves of
    them is less than a third.
    """
    left = values.copy()
    for _ in range(MOST_ROUNDS):
        errors = _prediction_error(left), _prediction_error(left.T).T
        least = np.nan_to_num(np.fmin(*(np.abs(e) for e in errors)))
        floor = max(OWN_STEPS * step, LEAST_MEDIANS * float(np.median(least)))
        peaks = np.argwhere((least > floor) & (least == maximum_filter(least, 7, mode="constant")))
        found = [
            (r, c)
            for r, c in peaks
            if least[r, c] > OWN_STEPS * step + STANDS_OUT * _typical(least, r, c)
            and _alone(errors[0][r], c)
            and _alone(errors[1][:, c], r)
        ]
        if not found:
            break
        left[tuple(np.transpose(found))] = np.nan
    return np.isnan(left) & ~np.isnan(values)


def _typical(errors: Floats, row: int, column: int) -> float:
    """Robust standard deviation of the errors in the 11 x 11 points around one."""
    around = errors[max(0, row - 5) : row + 6, max(0, column - 5) : column + 6]
    return 1.4826 * float(np.median(around))


def _alone(errors: Floats, at: int) -> bool:
    """Whether the errors around a place of a row are those that one wrong value there makes; True where none is known."""
    window = np.pad(errors, 3, constant_values=np.nan)[at : at + 7]
    known = np.isfinite(window)
    if not known.any():
        return True
    seen, made = window[known], _MADE[known]
    left = seen - made * np.sum(seen * made) / np.sum(made**2)
    return bool(np.sum(left**2) < np.sum(seen**2) / 9)


def _prediction_error(values: Floats) -> Floats:
    """What each value is off from the prediction along its row; NaN without three neighbours on each side."""
    padded = np.pad(values, ((0, 0), (3, 3)), constant_values=np.nan)
    return sum(w * padded[:, k : k + values.shape[1]] for k, w in enumerate(_MADE))
