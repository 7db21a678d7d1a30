"""What the eye meets where somebody points: one gaze through a lens, and all that is read along it."""

import numpy as np
from numpy.typing import ArrayLike

from .layers import Probe
from .optics.conventions import mean_power
from .optics.field import Accommodation, GazeField
from .optics.gaze import angles_from_direction, worn_pose


def read_probe(field: GazeField, distance: ArrayLike, rule: Accommodation) -> Probe:
    """The readings of the only ray of a field through a lens, for an object at a distance (mm, inf)."""
    lens = field.lens
    assert lens is not None
    away = np.broadcast_to(np.asarray(distance, dtype=float), (1,))
    used = field.accommodation(away, rule)
    ellipse = field.eoc(away, used) if np.isfinite(away[0]) else None
    power, prism = field.as_worn_power(away), field.prism()
    x, y, _ = worn_pose(lens, field.wearer.wear).to_lens(field.origin[0])
    azimuth, elevation = (float(np.degrees(angle[0])) for angle in angles_from_direction(field.directions))
    return Probe(
        (float(x), float(y)),
        field.directions[0],
        azimuth,
        elevation,
        field.origin[0],
        field.direction[0],
        float(away[0]),
        float(power.sphere[0]),
        float(power.cylinder[0]),
        float(power.axis[0]),
        float(mean_power(field.as_worn_matrix(away))[0]),
        float(prism.prism[0]),
        float(prism.base[0]),
        float(ellipse.semi_major[0]) if ellipse else float("nan"),
        float(ellipse.semi_minor[0]) if ellipse else float("nan"),
        float(used[0]),
        float(np.degrees(field.defocus(away, used)[0]) * 60),
        int(field.status[0]),
    )
