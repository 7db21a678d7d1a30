"""Where a lens is usable: widths and areas of its zones, its unwanted astigmatism, and how soon the addition comes.

A place belongs to a zone where the astigmatic error (as worn, against the order; without one against the wearer's
prescription) is at most CLEAR and the share of the addition reached there lies in the zone's window, each for objects where
the wearer has them (OBJECTS). Source: Sheedy 2004; Sheedy, Hardy & Hayes 2006: their windows for an addition of 2 D (up to
0.25, 0.75 to 1.50, from 1.75 D) as shares of it; the distances of the objects are ours.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .layers import Profile, ProfileLayer, Request
from .optics.conventions import Floats, Status, astigmatism, mean_power
from .optics.eye import Wearer
from .optics.field import GazeField
from .optics.lens import Lens
from .optics.object_distance import from_cornea, model_distance
from .optics.ordered import refracted_as_ordered
from .workbench import run, sampled

Window = tuple[float, float]

CLEAR = 0.5  # D
WINDOWS = {
    "distance": (-1 / 8, 1 / 8),
    "intermediate": (3 / 8, 3 / 4),
    "near": (7 / 8, np.inf),
}  # shares of the addition
OBJECTS: dict[str, Callable[[GazeField], Any]] = {
    "distance": lambda field: np.inf,
    "intermediate": model_distance,
    "near": lambda field: from_cornea(field, field.wearer.wear.near_distance),
}  # distance along each outgoing ray, mm
SINGLE_VISION = (-0.25, 0.25)  # D, where there is no addition
REACHED = 0.85  # share of the addition that counts as reached
ANY_POWER = (-np.inf, np.inf)
SAMPLES = 241
_FINE, _ASIDE = 0.02, 6.0  # mm: steps across a row; how far from the meridian the clearest place of a row is sought


@dataclass(frozen=True, slots=True)
class Zones:
    """Measures of a lens as worn; None where the lens has no addition or no near reference point. Objects of the distance
    zone are at infinity, those of the near zone at the wearer's near distance, those of the intermediate zone, the corridor
    and the reach where the wearer's model has them for each gaze (optics.object_distance); most_astigmatism at infinity.

    Widths (mm) at the height of the fitting point (distance), half-way down to the near reference point (intermediate) and
    at the near reference point; areas (mm2) within the outline, seen along z. corridor_width: the narrowest clear width
    between these points, mm, at the height corridor_y. reach_of_addition: from the fitting point down to where REACHED of
    the addition is there, mm. most_astigmatism: greatest astigmatic error (D), at (x, y) mm.
    """

    distance_width: float
    distance_area: float
    most_astigmatism: float
    most_astigmatism_at: tuple[float, float]
    intermediate_width: float | None = None
    intermediate_area: float | None = None
    near_width: float | None = None
    near_area: float | None = None
    corridor_width: float | None = None
    corridor_y: float | None = None
    reach_of_addition: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class _Looked:
    """Maps over x (nx,), y (ny,) mm: power gained against the distance reference point, astigmatic error (ny, nx), D."""

    x: Floats
    y: Floats
    gained: Floats
    error: Floats
    profile: Profile

    def area(self, window: Window) -> float:
        """Area (mm2) of the clear places whose gained power lies in the window (D)."""
        clear = (self.error <= CLEAR) & (self.gained >= window[0]) & (self.gained <= window[1])
        return float(clear.sum() * np.diff(self.x).mean() * np.diff(self.y).mean())

    def width(self, y: float, window: Window = ANY_POWER) -> float:
        """Width (mm) at a height of the clear interval about the clearest place near the meridian; 0 where there is none."""
        x = np.arange(self.x[0], self.x[-1], _FINE)
        gained, error = (self._row(values, y, x) for values in (self.gained, self.error))
        middle = np.interp(y, self.profile.y, self.profile.x)
        start = int(np.argmin(np.where(np.abs(x - middle) <= _ASIDE, np.nan_to_num(error, nan=np.inf), np.inf)))
        clear = (error <= CLEAR) & (gained >= window[0]) & (gained <= window[1])
        if not clear[start]:
            return 0.0
        ends = np.flatnonzero(~clear)
        left, right = ends[ends < start].max(initial=-1), ends[ends > start].min(initial=x.size)
        return float((right - left - 1) * _FINE)

    def _row(self, values: Floats, y: float, x: Floats) -> Floats:
        """The values at a height, linear between the samples."""
        k = int(np.clip(np.searchsorted(self.y, y), 1, self.y.size - 1))
        share = (y - self.y[k - 1]) / (self.y[k] - self.y[k - 1])
        return np.interp(x, self.x, (1 - share) * values[k - 1] + share * values[k])


def zones(lens: Lens, wearer: Wearer) -> Zones:
    """Measure the zones of a lens as this wearer wears it. Raises InputError when no ray passes."""
    wearer = refracted_as_ordered(wearer, lens.ordered)
    fitting_y = lens.points.fitting_point[1]
    far_y = (lens.points.distance_reference_point or lens.points.fitting_point)[1]
    far_power = _power_at(run(Request(lens, wearer, ProfileLayer(samples=SAMPLES))), far_y)
    profile: Profile = run(Request(lens, wearer, ProfileLayer("model", SAMPLES)))
    far, between, near = (_looked(lens, wearer, zone, far_power, profile) for zone in OBJECTS)
    worst = np.unravel_index(np.nanargmax(far.error), far.error.shape)
    most = float(far.error[worst]), (float(far.x[worst[1]]), float(far.y[worst[0]]))
    addition, point = lens.ordered.addition if lens.ordered else 0.0, lens.points.near_reference_point
    if not addition or point is None:
        return Zones(far.width(fitting_y, SINGLE_VISION), far.area(SINGLE_VISION), *most)
    window = {zone: (addition * low, addition * high) for zone, (low, high) in WINDOWS.items()}
    narrowest, where = min((between.width(y), y) for y in np.linspace(point[1], fitting_y, 33))
    return Zones(
        far.width(fitting_y, window["distance"]),
        far.area(window["distance"]),
        *most,
        intermediate_width=between.width((fitting_y + point[1]) / 2, window["intermediate"]),
        intermediate_area=between.area(window["intermediate"]),
        near_width=near.width(point[1], window["near"]),
        near_area=near.area(window["near"]),
        corridor_width=narrowest,
        corridor_y=float(where),
        reach_of_addition=_reach(profile, fitting_y, far_power + REACHED * addition),
    )


def _looked(lens: Lens, wearer: Wearer, zone: str, far_power: float, profile: Profile) -> _Looked:
    x, y, inside, field = sampled(lens, wearer, SAMPLES)
    distance = OBJECTS[zone](field)
    maps = np.full((2, inside.size), np.nan)
    power = field.as_worn_matrix(distance)
    found = np.stack([mean_power(power) - far_power, astigmatism(power - wearer.prescription)])
    maps[:, inside] = np.where(field.status == Status.OK, found, np.nan)
    gained, error = maps.reshape(2, y.size, x.size)
    return _Looked(x, y, gained, error, profile)


def _power_at(profile: Profile, y: float) -> float:
    return float(np.interp(y, profile.y, profile.mean_power))


def _reach(profile: Profile, fitting_y: float, wanted: float) -> float | None:
    """How far below the fitting point (mm) the mean power along the meridian first reaches a power (D); None if never."""
    below = profile.y <= fitting_y
    down, power = fitting_y - profile.y[below][::-1], profile.mean_power[below][::-1]
    there = np.flatnonzero(power >= wanted)
    if not there.size:
        return None
    k = int(there[0])
    return float(np.interp(wanted, power[k - 1 : k + 1], down[k - 1 : k + 1])) if k else 0.0
