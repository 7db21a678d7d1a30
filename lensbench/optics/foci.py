"""Where light that leaves the eye through the lens comes to a focus: two focal lines a gaze, two sheets over all gazes."""

from typing import NamedTuple

import numpy as np

from .conventions import Floats, inverse_2x2
from .field import Accommodation, GazeField


class Foci(NamedTuple):
    """Focal lines of n pencils, the more convergent focus first.

    distance (n, 2): along the outgoing ray from the exit point, mm; negative where the focus lies behind the lens (virtual),
    infinite for parallel light. blur (n, 2, 2, 2): matrices M there, mm across the outgoing ray; each makes a line of the
    pupil's disc, and holds NaN where the focus is infinitely far.
    """

    distance: Floats
    blur: Floats


def foci(field: GazeField, accommodation: Accommodation = 0.0) -> Foci:
    """Foci of the pencils that the eye sends out, by default relaxed: there, and only there, it sees one meridian sharply.

    accommodation: in use, D (a number or (n,)), or the rule for far objects. At the front surface the light has the vergence
    V = (C + D S)(A + B S)^-1, symmetric; M(s) = (I + s V) M(0) is singular at s = -1 / eigenvalue of V.
    """
    s = field.vergence(np.inf, accommodation) / 1000
    t, radius = field.transfer, field.wearer.eye.pupil_diameter / 2
    at_lens, per_mm = (t[:, rows, :2] + t[:, rows, 2:] @ s for rows in (slice(0, 2), slice(2, 4)))
    vergence = per_mm @ inverse_2x2(at_lens)
    mean = (vergence[:, 0, 0] + vergence[:, 1, 1]) / 2
    half = np.hypot((vergence[:, 0, 0] - vergence[:, 1, 1]) / 2, (vergence[:, 0, 1] + vergence[:, 1, 0]) / 2)
    with np.errstate(divide="ignore"):
        distance = -1 / np.stack([mean - half, mean + half], axis=-1)
    known = np.where(np.isfinite(distance), distance, np.nan)[..., None, None]
    return Foci(distance, radius * (at_lens[:, None] + known * per_mm[:, None]))
