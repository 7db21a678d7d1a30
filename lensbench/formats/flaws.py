"""What may be wrong with the values of a grid of sags: the step to which they are rounded, and single values that stand out."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, median_filter

from ..optics.conventions import Floats

STANDS_OUT = 10.0
_WEIGHTS = ((1, 0.75), (2, -0.3), (3, 0.05))
_OWN_STEPS = 3.0


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
    """Single values of a grid (NaN: missing) that stand out from both their row and their column.

    Each value is compared with the one that the polynomial of degree 5 through three neighbours on each side predicts
    (of the two predictions, row and column, the nearer one counts). It stands out when it is off by more than 3 rounding
    steps plus 10 times the robust standard deviation (1.4826 times the median) of that error among its 11 x 11 neighbours.
    Steps and edges that run through the surface stand out as rows of values and are left alone.
    """
    left = values.copy()
    for _ in range(8):
        error = _least_error(left)
        known = np.isfinite(error)
        if not known.any():
            break
        typical = 1.4826 * median_filter(np.where(known, error, np.median(error[known])), 11, mode="nearest")
        excess = np.where(known, error, 0.0) - _OWN_STEPS * step - STANDS_OUT * typical
        found = (excess > 0) & (excess == maximum_filter(excess, 7, mode="constant"))
        if not found.any():
            break
        left[found] = np.nan
    refused = np.isnan(left) & ~np.isnan(values)
    return refused & ~_crowded(refused)


def _crowded(refused: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which refused values have more than three others within 5 points: a feature of the surface, not a spike."""
    near = np.zeros(refused.shape)
    for row, column in np.argwhere(refused):
        near[max(0, row - 5) : row + 6, max(0, column - 5) : column + 6] += 1
    return near > 4


def _least_error(values: Floats) -> Floats:
    """The smaller of the errors of the predictions along the row and along the column; NaN where there is neither."""
    by_row, by_column = (_prediction_error(v) for v in (values, values.T))
    return np.fmin(by_row, by_column.T)


def _prediction_error(values: Floats) -> Floats:
    padded = np.pad(values, ((0, 0), (3, 3)), constant_values=np.nan)
    n = values.shape[1]
    predicted = sum(w * (padded[:, 3 - k : 3 - k + n] + padded[:, 3 + k : 3 + k + n]) for k, w in _WEIGHTS)
    return np.abs(values - predicted)
