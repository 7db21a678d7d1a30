"""A design against its measured map: both differences side by side, and in words how large they are."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..layers import Deviation, LensMap
from ..optics.conventions import Floats
from ..optics.lens import Lens
from .maps import figure_array, map_figure

MOST_BANDS = 8


def deviation_figure(lens: Lens, found: Deviation, tolerance: float) -> NDArray[np.uint8]:
    """Mean and astigmatic difference over the lens, picture (h, w, 3), in steps of the tolerance (D) if these are few.

    The bands next to 0 are then what lies within the tolerance.
    """
    pictures = [
        figure_array(f) for f in (_figure(lens, found, name, tolerance) for name in ("mean", "astigmatic")) if f
    ]
    return np.hstack(pictures)


def _figure(lens: Lens, found: Deviation, name: str, tolerance: float) -> Figure | None:
    values: Floats = getattr(found, name)
    if not np.isfinite(values).any():
        return None
    quantity = {"mean": "mean_error", "astigmatic": "astigmatic_error"}[name]
    label = {"mean": "Mean power, measured less designed", "astigmatic": "Astigmatic difference to the design"}[name]
    layer = LensMap(quantity, label, "D", found.x, found.y, values, found.status)
    step = tolerance if np.nanmax(np.abs(values)) < MOST_BANDS * tolerance else None
    return map_figure(lens, layer, step, subtitle=f"{found.layer.measured.source}: {within_text(values, tolerance)}")


def within_text(values: Floats, tolerance: float) -> str:
    """rms, greatest amount and the part within the tolerance (D) of differences, in words."""
    known = values[np.isfinite(values)]
    part = float(np.mean(np.abs(known) <= tolerance))
    return f"rms {np.sqrt(np.mean(known**2)):.3f} D, at most {np.abs(known).max():.2f} D, {part:.0%} within {tolerance:g} D"
