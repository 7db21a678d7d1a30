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
from .scene_source import answer_with_scene

SAMPLES = 128


class BandedMap(NamedTuple):
    """A map of a lens with its bands; limits: of the scale where it is not the map's own."""

    lens: Lens
    lens_map: LensMap
    bands: Bands
    limits: tuple[float, float] | None


def map_question(bench: Workbench, pane: Pane) -> tuple[tuple[Any, ...], Callable[[], BandedMap]] | None:
    """What a pane's map depends on, and how it is found; None without a lens."""
    lens, wearer = bench.lens_of(pane), bench.active_wearer
    if lens is None:
        return None
    layer = MapLayer(pane.quantity, bench.distance, bench.accommodation, SAMPLES)
    scene = bench.scene if bench.distance == "scene" else ""
    look = pane.low, pane.high, pane.step
    if pane.minus is not None and pane.minus < len(bench.lenses):
        reference = bench.lenses[pane.minus].lens
        return (lens, reference, wearer, layer, look), partial(_difference, lens, reference, wearer, layer, pane)
    others = _side_by_side(bench, pane) if pane.low is None else (lens,)
    return (lens, others, wearer, layer, scene, look), partial(_banded, lens, others, wearer, layer, scene, pane)


def _side_by_side(bench: Workbench, pane: Pane) -> tuple[Lens, ...]:
    """The lenses whose maps of the same quantity are shown, in the order of the table."""
    alike = [p for p in bench.panes[: bench.split] if p.kind in ("map", "lens") and p.quantity == pane.quantity]
    shown = [bench.lens_of(p) for p in (*alike, pane) if p.minus is None and p.low is None]
    return tuple(entry.lens for entry in bench.lenses if any(entry.lens is lens for lens in shown))


def _banded(lens: Lens, others: tuple[Lens, ...], wearer: Wearer, layer: MapLayer, scene: str, pane: Pane) -> BandedMap:
    lens_map = answer_with_scene(lens, wearer, layer, scene)
    limits = None if pane.low is None or pane.high is None else (pane.low, pane.high)
    if len(others) > 1:
        limits = shared_limits([answer_with_scene(other, wearer, layer, scene) for other in others])
    return BandedMap(lens, lens_map, map_bands(others[0], lens_map, pane.step, limits), limits)


def _difference(lens: Lens, reference: Lens, wearer: Wearer, layer: MapLayer, pane: Pane) -> BandedMap:
    lens_map = difference(Request(lens, wearer, layer), Request(reference, wearer, layer))
    limits = None if pane.low is None or pane.high is None else (pane.low, pane.high)
    return BandedMap(reference, lens_map, map_bands(reference, lens_map, pane.step, limits), limits)
