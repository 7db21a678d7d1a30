"""First order against real rays: how far the maps of a lens can be trusted."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .layers import RealRays, RealRaysCheck, RealRaysLayer, Spot
from .optics.conventions import Floats
from .optics.field import Accommodation, GazeField
from .optics.gaze import look_through, worn_pose
from .optics.object_distance import from_cornea
from .optics.pupil import vogel_pupil

SPOT_POINTS = 400
ARCMIN = 60 * np.degrees(1)  # in a radian


def compare(field: GazeField, layer: RealRaysLayer, distance_of: Callable[[float | str, GazeField], Any]) -> RealRays:
    """Both blurs at each distance over a field of gazes. distance_of: the layer's distances along the field's rays, mm."""
    rule = layer.accommodation
    distances = [np.broadcast_to(distance_of(d, field), field.status.shape).astype(float) for d in layer.distances]
    checks = tuple(_check(field, name, s, rule) for name, s in zip(layer.distances, distances, strict=True))
    return RealRays(checks, (*_reference_spots(field, rule), *_deviating_spots(field, checks[0], distances[0], rule)))


def _check(field: GazeField, name: float | str, distance: Floats, rule: Accommodation) -> RealRaysCheck:
    wave = field.bundle(distance, rule).wavefront()
    first, real = (ARCMIN * angle for angle in (field.defocus(distance, rule), wave.defocus()))
    return RealRaysCheck(name, first, real, wave.higher_order_rms())


def _reference_spots(field: GazeField, rule: Accommodation) -> list[Spot]:
    """Spots at the distance reference point for far objects and at the near reference point for near ones."""
    lens, wearer = field.lens, field.wearer
    assert lens is not None
    points = lens.points.named()
    there = {n: points[n] for n in ("distance_reference_point", "near_reference_point") if n in points}
    if not there:
        return []
    rays = look_through(lens, wearer, *np.transpose(list(there.values())))
    near = from_cornea(rays, wearer.wear.near_distance)
    distance = np.where([n.startswith("near") for n in there], near, np.inf)
    return _spots(rays, [n.replace("_", " ") for n in there], distance, rule)


def _deviating_spots(field: GazeField, check: RealRaysCheck, distance: Floats, rule: Accommodation) -> list[Spot]:
    """Spots of the gazes whose deviation is the 90th percentile and the greatest of a check."""
    deviation = np.abs(check.deviation)
    known = np.flatnonzero(np.isfinite(deviation))
    if not known.size:
        return []
    order = known[np.argsort(deviation[known])]
    picked = order[[int(0.9 * (order.size - 1)), -1]]
    rays = field.take(picked)
    lens = field.lens
    assert lens is not None
    x, y, _ = worn_pose(lens, field.wearer.wear).to_lens(rays.origin).T
    names = [
        f"{word} deviation, x {x[k]:.0f}, y {y[k]:.0f} mm" for k, word in enumerate(("90th percentile of", "greatest"))
    ]
    return _spots(rays, [names[0].replace("of deviation", "of the deviation"), names[1]], distance[picked], rule)


def _spots(field: GazeField, names: Sequence[str], distance: Floats, rule: Accommodation) -> list[Spot]:
    landing = ARCMIN * field.bundle(distance, rule, vogel_pupil(SPOT_POINTS)).landing
    first = ARCMIN * field.angular_blur(distance, rule)
    return [Spot(name, float(distance[k]), landing[k], first[k]) for k, name in enumerate(names)]
