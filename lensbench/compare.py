"""Several designs in one position of wear: the same maps on the same places, differences to the first, measures of zones.

Each is worn by an eye with the refraction for which it was ordered, so that designs ordered for different powers compare.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .errors import InputError
from .layers import Layer, LensMap, MapLayer, PointReading, PointsLayer, Profile, ProfileLayer, Request
from .optics.eye import Wearer
from .optics.lens import Lens
from .optics.ordered import refracted_as_ordered
from .workbench import run
from .zones import Zones, zones

MAPS = (MapLayer("mean_error"), MapLayer("astigmatic_error"), MapLayer("defocus", 400.0))


@dataclass(frozen=True, slots=True, eq=False)
class Design:
    """What one lens shows: maps as asked for, differences to the first lens's maps on that lens's places, the rest."""

    lens: Lens
    maps: tuple[LensMap, ...]
    differences: tuple[LensMap, ...]
    profile: Profile
    readings: tuple[PointReading, ...]
    zones: Zones


def compare(lenses: Sequence[Lens], wearer: Wearer, layers: Sequence[MapLayer] = MAPS) -> tuple[Design, ...]:
    """Each lens as this wearer wears it; the first one is the reference and has no differences.

    Raises InputError for fewer than two lenses, lenses of both sides, and a lens that no ray passes.
    """
    if len(lenses) < 2:
        raise InputError("compare: at least two lenses are needed")
    if len({lens.side for lens in lenses}) > 1:
        sides = ", ".join(f"{lens.name} is {lens.side}" for lens in lenses)
        raise InputError(f"compare: the lenses must be of one side ({sides})")
    return tuple(_design(lens, lenses[0], wearer, layers) for lens in lenses)


def _design(lens: Lens, first: Lens, wearer: Wearer, layers: Sequence[MapLayer]) -> Design:
    asked, of_first = ([_fitted(each, wearer, layer) for layer in layers] for each in (lens, first))
    return Design(
        lens,
        tuple(run(request) for request in asked),
        tuple(map(difference, asked, of_first)) if lens is not first else (),
        run(_fitted(lens, wearer, ProfileLayer())),
        run(_fitted(lens, wearer, PointsLayer())),
        zones(lens, wearer),
    )


def _fitted(lens: Lens, wearer: Wearer, layer: Layer) -> Request:
    return Request(lens, refracted_as_ordered(wearer, lens.ordered), layer)


def difference(request: Request, reference: Request) -> LensMap:
    """The map asked for less that of the reference, at the reference's places; NaN where either has no value.

    Each lens is worn by the wearer of its own request. Both are traced there, nothing is interpolated: the lens is taken
    within the reference's outline. Raises InputError where either request would.
    """
    if request.lens is None or reference.lens is None:
        raise InputError("a difference of maps needs two lenses")
    ours = run(replace(request, lens=replace(request.lens, outline=reference.lens.outline)))
    theirs = run(reference)
    return replace(
        ours,
        quantity="difference",
        label=f"{ours.label}, difference",
        values=ours.values - theirs.values,
        status=np.maximum(ours.status, theirs.status),
    )
