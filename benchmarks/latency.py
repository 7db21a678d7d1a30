"""How long a designer waits for a map after an edit: the way that the window and the command line go, workbench.run."""

from collections.abc import Callable
from dataclasses import replace
from itertools import cycle
from typing import Any

import lensbench as lb
from lensbench.layers import MapLayer, Request
from lensbench.optics.conventions import power_matrix
from lensbench.optics.eye import Wearer
from lensbench.optics.lens import Lens
from lensbench.workbench import run

from .figures import Figure
from .timing import ROOT, rounds

FILE = ROOT / "sample_lenses" / "regular_R.toml"
Edit = Callable[[Lens, Wearer, float, int], tuple[Lens, Wearer, float]]


def map_latency() -> list[Figure]:
    """A 128 x 128 map of the astigmatic error and of the defocus on the regular sample lens, after an edit; ms."""
    edits: dict[str, tuple[Edit, float]] = {
        "refraction": (lambda lens, w, s, k: (lens, _eye(w, refraction=power_matrix(-0.1 * k)), s), 5),
        "age": (lambda lens, w, s, k: (lens, _eye(w, accommodation=0.1 * k), s), 5),
        "pupil": (lambda lens, w, s, k: (lens, _eye(w, pupil_diameter=3 + 0.1 * k), s), 5),
        "object distance": (lambda lens, w, s, k: (lens, w, s + k), 5),
        "pose": (lambda lens, w, s, k: (lens, _wear(w, pantoscopic_angle=0.1 + 0.001 * k), s), 20),
        "thickness": (lambda lens, w, s, k: (replace(lens, centre_thickness=2.5 + 0.01 * k), w, s), 20),
        "material": (lambda lens, w, s, k: (_other_index(lens, 1.55 + 0.001 * k), w, s), 20),
        "surface, with its fit": (lambda lens, w, s, k: (lb.load_lens(FILE), w, s), 150),
    }
    lens = lb.load_lens(FILE)
    wearer = lb.load_wearer(ROOT / "sample_lenses" / "presbyope_60.toml")
    figures = []
    for quantity in ("astigmatic_error", "defocus"):
        actions = [_edited(edit, lens, wearer, quantity) for edit, _ in edits.values()]
        for (name, (_, most)), seconds in zip(edits.items(), rounds(*actions), strict=True):
            figures.append(
                Figure(f"128 x 128 map of {quantity} after another {name}", seconds * 1e3, "ms", at_most=most)
            )
    return figures


def _edited(edit: Edit, lens: Lens, wearer: Wearer, quantity: str) -> Callable[[], Any]:
    """Ask for a map after one more edit, no two of which are equal within a long while."""
    steps = cycle(range(1, 60))

    def ask() -> Any:
        changed, who, distance = edit(lens, wearer, 400.0, next(steps))
        return run(Request(changed, who, MapLayer(quantity, distance, samples=128)))

    return ask


def _eye(wearer: Wearer, **change: Any) -> Wearer:
    return replace(wearer, eye=replace(wearer.eye, **change))


def _wear(wearer: Wearer, **change: Any) -> Wearer:
    return replace(wearer, wear=replace(wearer.wear, **change))


def _other_index(lens: Lens, index: float) -> Lens:
    return replace(lens, material=replace(lens.material, n_d=index, n_e=index))
