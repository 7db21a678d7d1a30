"""What can be edited by a number: its name, unit and bounds, and how it is read from and written to the workbench."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..optics.conventions import power_matrix, sphere_cylinder_axis
from ..optics.eye import hofstetter_amplitude
from ..optics.lens import Order
from ..session import Workbench

Read = Callable[[Workbench], float]
Write = Callable[[Workbench, float], Workbench]


@dataclass(frozen=True, slots=True)
class Field:
    """A number on the table, from low to high in steps, in `unit`; slider: whether it is dragged as well as typed."""

    name: str
    unit: str
    low: float
    high: float
    step: float
    read: Read
    write: Write
    slider: bool = True

    @property
    def decimals(self) -> int:
        """Digits behind the point that the step needs."""
        return next(d for d in range(6) if abs(round(self.step, d) - self.step) < 1e-9)


# ---- the wearer ----


def _with_wearer(bench: Workbench, as_ordered: bool = True, **changes: Any) -> Workbench:
    """With the active wearer changed; as_ordered: whether he is still the one for whom each lens was ordered, if he was."""
    if not as_ordered and bench.as_ordered == bench.wearer:
        changes["name"] = f"{bench.active_wearer.name}, edited"
    return bench.with_active_wearer(replace(bench.active_wearer, **changes), as_ordered)


def _of_eye(name: str, as_ordered: bool = True) -> tuple[Read, Write]:
    def write(bench: Workbench, value: float) -> Workbench:
        return _with_wearer(bench, as_ordered, eye=replace(bench.active_wearer.eye, **{name: value}))

    return lambda bench: getattr(bench.active_wearer.eye, name), write


def _of_wear(name: str, scale: float = 1.0) -> tuple[Read, Write]:
    """scale: unit of the field in that of the wear (degrees in rad)."""

    def write(bench: Workbench, value: float) -> Workbench:
        return _with_wearer(bench, wear=replace(bench.active_wearer.wear, **{name: float(value * scale)}))

    return lambda bench: getattr(bench.active_wearer.wear, name) / scale, write


def _of_decentration(k: int) -> tuple[Read, Write]:
    def write(bench: Workbench, value: float) -> Workbench:
        pair = list(bench.active_wearer.wear.decentration)
        pair[k] = value
        return _with_wearer(bench, wear=replace(bench.active_wearer.wear, decentration=tuple(pair)))

    return lambda bench: bench.active_wearer.wear.decentration[k], write


def _of_refraction(k: int) -> tuple[Read, Write]:
    """Sphere, cylinder or axis (k = 0, 1, 2) of the refraction where it was measured."""

    def write(bench: Workbench, value: float) -> Workbench:
        power = [float(v) for v in sphere_cylinder_axis(bench.active_wearer.eye.refraction)]
        power[k] = value
        return _with_wearer(bench, False, eye=replace(bench.active_wearer.eye, refraction=power_matrix(*power)))

    return lambda bench: float(sphere_cylinder_axis(bench.active_wearer.eye.refraction)[k]), write


def _write_age(bench: Workbench, age: float) -> Workbench:
    eye = replace(bench.active_wearer.eye, accommodation=float(hofstetter_amplitude(age)))
    return _with_wearer(bench, False, age=age, eye=eye)


DEGREE = float(np.radians(1.0))
REFRACTION = (
    Field("Sphere", "D", -25, 25, 0.25, *_of_refraction(0)),
    Field("Cylinder", "D", -10, 0, 0.25, *_of_refraction(1)),
    Field("Axis", "°", 0, 180, 1, *_of_refraction(2)),
)
EYE = (
    Field("Age", "years", 5, 90, 1, lambda bench: bench.active_wearer.age or 0.0, _write_age),
    Field("Accommodation", "D", 0, 15, 0.25, *_of_eye("accommodation", as_ordered=False)),
    Field("Pupil", "mm", 1.5, 9, 0.1, *_of_eye("pupil_diameter")),
    Field("Centre of rotation", "mm", 10, 17, 0.1, *_of_eye("centre_of_rotation"), slider=False),
)
WEAR = (
    Field("Vertex distance", "mm", 5, 25, 0.5, *_of_wear("vertex_distance")),
    Field("Pantoscopic angle", "°", -10, 25, 0.5, *_of_wear("pantoscopic_angle", DEGREE)),
    Field("Face-form angle", "°", -10, 30, 0.5, *_of_wear("face_form_angle", DEGREE)),
    Field("Decentration x", "mm", -10, 10, 0.5, *_of_decentration(0)),
    Field("Decentration y", "mm", -10, 10, 0.5, *_of_decentration(1)),
    Field("Pupillary distance (one eye)", "mm", 20, 45, 0.5, *_of_wear("pupillary_distance"), slider=False),
    Field("Near distance", "mm", 200, 1000, 10, *_of_wear("near_distance"), slider=False),
)

# ---- the lens ----


def _of_order(name: str) -> tuple[Read, Write]:
    def read(bench: Workbench) -> float:
        lens = bench.active_lens
        return getattr(lens.ordered or Order(), name) if lens else 0.0

    def write(bench: Workbench, value: float) -> Workbench:
        lens = bench.active_lens
        ordered = replace((lens.ordered if lens else None) or Order(), **{name: value})
        return _with_lens(bench, ordered=ordered)

    return read, write


def _with_lens(bench: Workbench, **edits: Any) -> Workbench:
    if not bench.lenses:
        return bench
    entry = bench.lenses[bench.lens].edited(**edits)
    return replace(bench, lenses=(*bench.lenses[: bench.lens], entry, *bench.lenses[bench.lens + 1 :]))


def with_material(bench: Workbench, name: str) -> Workbench:
    """With another material for the active lens. Raises InputError for one that is not known."""
    return _with_lens(bench, material=name)


LENS = (
    Field(
        "Centre thickness", "mm", 0.5, 12, 0.1,
        lambda bench: bench.active_lens.centre_thickness if bench.active_lens else 0.0,
        lambda bench, value: _with_lens(bench, centre_thickness=value),
    ),
)  # fmt: skip
ORDER = (
    Field("Sphere", "D", -25, 25, 0.25, *_of_order("sphere"), slider=False),
    Field("Cylinder", "D", -10, 10, 0.25, *_of_order("cylinder"), slider=False),
    Field("Axis", "°", 0, 180, 1, *_of_order("axis"), slider=False),
    Field("Addition", "D", 0, 4, 0.25, *_of_order("addition"), slider=False),
    Field("Prism", "cm/m", 0, 10, 0.25, *_of_order("prism"), slider=False),
    Field("Prism base", "°", 0, 360, 5, *_of_order("prism_base"), slider=False),
)

# ---- what is looked at ----


def _read_proximity(bench: Workbench) -> float:
    return 0.0 if isinstance(bench.distance, str) else 1000.0 / bench.distance


def _write_proximity(bench: Workbench, proximity: float) -> Workbench:
    return replace(bench, distance=1000.0 / proximity if proximity > 1e-9 else np.inf)


def _of_depth(k: int) -> tuple[Read, Write]:
    def write(bench: Workbench, value: float) -> Workbench:
        return replace(bench, depths=(*bench.depths[:k], value, *bench.depths[k + 1 :]))

    return lambda bench: bench.depths[k] if k < len(bench.depths) else 0.0, write


def _of_bench(name: str) -> tuple[Read, Write]:
    return lambda bench: getattr(bench, name), lambda bench, value: replace(bench, **{name: value})


LOOK = (
    Field("Object proximity", "D", 0, 5, 0.05, _read_proximity, _write_proximity),
    Field("Ellipses, from the eye, 1", "mm", 150, 4000, 10, *_of_depth(0)),
    Field("Ellipses, from the eye, 2", "mm", 150, 4000, 10, *_of_depth(1)),
    Field("Ellipses, from the eye, 3", "mm", 150, 4000, 10, *_of_depth(2)),
    Field("Head turned to the left", "°", -40, 40, 1, *_of_bench("head_turn")),
    Field("Head tilted up", "°", -40, 40, 1, *_of_bench("head_tilt")),
)

GROUPS: dict[str, tuple[Field, ...]] = {
    "Looking at": LOOK,
    "Position of wear": WEAR,
    "Eye": EYE,
    "Refraction": REFRACTION,
    "Lens": LENS,
    "Order": ORDER,
}
