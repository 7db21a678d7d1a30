"""What a map can show: each quantity as a function of the gaze field, the object distance and the accommodation."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .optics.conventions import Floats, astigmatism, mean_power
from .optics.field import Accommodation, GazeField
from .optics.gaze import worn_pose


@dataclass(frozen=True, slots=True)
class Quantity:
    """label and unit for the reader; values (n,) from a gaze field, the object distance and the accommodation rule."""

    label: str
    unit: str
    values: Callable[[GazeField, Any, Accommodation], Floats]


QUANTITIES = {
    "mean_power": Quantity("As-worn mean power", "D", lambda f, s, a: mean_power(f.as_worn_matrix(s))),
    "astigmatism": Quantity("As-worn astigmatism", "D", lambda f, s, a: astigmatism(f.as_worn_matrix(s))),
    "sphere": Quantity("As-worn sphere", "D", lambda f, s, a: f.as_worn_power(s).sphere),
    "cylinder": Quantity("As-worn cylinder", "D", lambda f, s, a: f.as_worn_power(s).cylinder),
    "axis": Quantity("As-worn axis", "deg", lambda f, s, a: f.as_worn_power(s).axis),
    "mean_error": Quantity("Mean power error", "D", lambda f, s, a: mean_power(f.power_error(s))),
    "astigmatic_error": Quantity("Astigmatic error", "D", lambda f, s, a: astigmatism(f.power_error(s))),
    "residual_mean": Quantity("Residual mean defocus", "D", lambda f, s, a: mean_power(f.residual_defocus(s, a))),
    "accommodation": Quantity("Accommodation in use", "D", lambda f, s, a: f.accommodation(s, a)),
    "defocus": Quantity("Defocus 2|ε|", "arcmin", lambda f, s, a: np.degrees(f.defocus(s, a)) * 60),
    "prism": Quantity("Prism", "cm/m", lambda f, s, a: f.prism().prism),
    "prism_horizontal": Quantity(
        "Horizontal prism, + base to the wearer's left", "cm/m", lambda f, s, a: f.prism_components()[:, 0]
    ),
    "prism_vertical": Quantity("Vertical prism, + base up", "cm/m", lambda f, s, a: f.prism_components()[:, 1]),
    "magnification": Quantity("Magnification", "x", lambda f, s, a: _area_magnification(f.magnification(s))),
    "thickness": Quantity("Thickness", "mm", lambda f, s, a: _thickness(f)),
}


def _area_magnification(m: Floats) -> Floats:
    """Linear magnification of equal area: the root of the determinant."""
    return np.sqrt(np.abs(m[..., 0, 0] * m[..., 1, 1] - m[..., 0, 1] * m[..., 1, 0]))


def _thickness(field: GazeField) -> Floats:
    lens = field.lens
    assert lens is not None
    point = worn_pose(lens, field.wearer.wear).to_lens(field.origin)
    return lens.thickness(point[:, 0], point[:, 1])
