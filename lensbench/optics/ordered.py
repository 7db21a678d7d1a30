"""The wearer whom an order suggests, for when nothing else is known of the eye or another eye would mislead."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from .eye import Eye, Wear, Wearer
from .lens import Order

AVERAGE_WEAR = Wear(13.0, float(np.radians(8.0)), float(np.radians(5.0)))
PUPIL = 4.0


def wearer_as_ordered(order: Order, wear: Wear = AVERAGE_WEAR, name: str = "") -> Wearer:
    """Refraction as ordered at the vertex distance of the position of wear; 4 mm pupil.

    Accommodation 2 (2.5 D - addition): a near distance of 40 cm with half of the amplitude kept in reserve.
    """
    accommodation = max(0.0, 2 * (2.5 - order.addition))
    return Wearer(Eye(order.power(), wear.vertex_distance, accommodation, PUPIL), wear, name)


@lru_cache(maxsize=64)
def wearer_for(wearer: Wearer, order: Order) -> Wearer:
    """The wearer with the refraction and the accommodation that an order suggests, all else as it is; one object each."""
    suggested = wearer_as_ordered(order).eye
    eye = replace(wearer.eye, refraction=suggested.refraction, accommodation=suggested.accommodation)
    return replace(wearer, eye=eye)


def refracted_as_ordered(wearer: Wearer, order: Order | None) -> Wearer:
    """The wearer with the refraction for which a lens was ordered, in the same position of wear; as he is without an order."""
    if order is None:
        return wearer
    eye = replace(wearer.eye, refraction=order.power(), refraction_vertex_distance=wearer.wear.vertex_distance)
    return replace(wearer, eye=eye)
