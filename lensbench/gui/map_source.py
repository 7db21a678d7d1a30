"""Maps for viewports: those of one quantity that are seen side by side share one scale."""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from ..compare import difference
from ..layers import LensMap, MapLayer, Request
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..session import Pane, Workbench
from ..views.bands import Bands, map_bands, shared_limits
from .scene_source import answer_with_scene, scene_named

SAMPLES = 128

Worn = tuple[Lens, Wearer]


class BandedMap(NamedTuple):
    """A map of a lens as it is worn, with its bands; limits: of the scale where it is not the map's own."""

    lens: Lens
    wearer: Wearer
    lens_map: LensMap
    bands: Bands
    limits: tuple[float, float] | None


def map_question(bench: Workbench, pane: Pane) -> tuple[tuple[Any, ...], Callable[[], BandedMap]] | None:
    """What a pane's map depends on, and how it is found; None without a lens."""
    lens, less = bench.lens_of(pane), bench.lens_less(pane)
    if lens is None:
        return None
    worn = lens, bench.worn_by(lens)
    layer = MapLayer(pane.quantity, bench.distance, bench.accommodation, SAMPLES)
    scene = bench.scene if bench.distance == "scene" else ""
    look = pane.low, pane.high, pane.step
    if less is not None:
        reference = less, bench.worn_by(less)
        return (worn, reference, layer, scene, look), partial(_difference, worn, reference, layer, scene, pane)
    shown = _side_by_side(bench, pane) if pane.low is None else (lens,)
    others = tuple((other, bench.worn_by(other)) for other in shown)
    return (worn, others, layer, scene, look), partial(_banded, worn, others, layer, scene, pane)


def _side_by_side(bench: Workbench, pane: Pane) -> tuple[Lens, ...]:
    """The lenses whose maps of the same quantity are shown, in the order of the table."""
    alike = [p for p in bench.panes[: bench.split] if p.kind in ("map", "lens") and p.quantity == pane.quantity]
    shown = [bench.lens_of(p) for p in (*alike, pane) if p.minus is None and p.low is None]
    return tuple(entry.lens for entry in bench.lenses if any(entry.lens is lens for lens in shown))


def _banded(worn: Worn, others: tuple[Worn, ...], layer: MapLayer, scene: str, pane: Pane) -> BandedMap:
    lens_map = answer_with_scene(*worn, layer, scene)
    limits = None if pane.low is None or pane.high is None else (pane.low, pane.high)
    if len(others) > 1:
        limits = shared_limits([answer_with_scene(*other, layer, scene) for other in others])
    return BandedMap(*worn, lens_map, map_bands(others[0][0], lens_map, pane.step, limits), limits)


def _difference(worn: Worn, reference: Worn, layer: MapLayer, scene: str, pane: Pane) -> BandedMap:
    seen = scene_named(scene) if scene else None
    lens_map = difference(Request(*worn, layer, seen), Request(*reference, layer, seen))
    limits = None if pane.low is None or pane.high is None else (pane.low, pane.high)
    return BandedMap(*reference, lens_map, map_bands(reference[0], lens_map, pane.step, limits), limits)
