"""A lens from a file that holds surfaces only: what is missing is assumed, and said in one line (Lens.note)."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..optics import surfaces
from ..optics.conventions import mean_power
from ..optics.lens import Lens, Order, Points, circle_outline
from ..optics.materials import MATERIALS, Material
from ..optics.surfaces import Surface
from .lens_file import check_body
from .orientation import named
from .surface_data import Fitted, Reading, SurfaceData, chosen

USUAL_MATERIAL = "MR-8"
USUAL_DIAMETER = 60.0
LEAST_CENTRE, LEAST_EDGE = 2.0, 1.0
LEAST_ADDITION = 0.5
DISTANCE_POINT, FITTING_POINT = (0.0, 8.0), (0.0, 4.0)


@dataclass(frozen=True, slots=True)
class Completion:
    """What is told of a lens beside its surface file; None, "": assumed, or found from the surface.

    reading: side, face, order of points, sign. thickness, radii (of the other surface; inf: a plane), diameter: mm. power:
    mean back vertex power at the distance reference point, D, for which the other surface is chosen if it has no radius.
    """

    reading: Reading = field(default_factory=Reading)
    material: Material | None = None
    thickness: float | None = None
    front_radius: float | None = None
    back_radius: float | None = None
    diameter: float | None = None
    power: float = 0.0


def completed_lenses(path: Path, held: Sequence[SurfaceData], told: Completion) -> tuple[Lens, ...]:
    """A lens of each side that the file's surfaces have (one if they have none). Raises InputError."""
    wanted = told.reading.side
    sides = sorted({s.side for s in held if s.side}, key="RL".index) or [wanted]
    if wanted and wanted not in sides:
        raise InputError(
            f"{path}: holds side {' and '.join(sides)}, not {wanted}; --mirror of convert makes one of the other"
        )
    return tuple(_lens(path, held, side, told) for side in ([wanted] if wanted else sides))


def _lens(path: Path, held: Sequence[SurfaceData], side: str, told: Completion) -> Lens:
    material = told.material or MATERIALS[USUAL_MATERIAL]
    said = [] if told.material else [f"material {material.name}"]
    face = told.reading.face or next((s.face for s in held if s.face), "F")
    reading = replace(told.reading, side=side, face=face, index=material.n_e)
    mine = [s for s in held if s.side in ("", side)]
    other = {"F": "B", "B": "F"}[face]
    pair = {face: chosen(path, mine, side, face)}
    second = next((s for s in mine if s.face == other), None)
    if second is not None and told.front_radius is None and told.back_radius is None:
        pair[other] = second
    fitted = _fitted(pair, reading)
    side = side or _side_found(fitted[face]) or "R"
    lens = _with_other(fitted, face, material, side, told, said)
    lens = replace(lens, name=path.name, note=_note(path, fitted, said))
    check_body(path, lens)
    return lens


def _fitted(pair: dict[str, SurfaceData], reading: Reading) -> dict[str, Fitted]:
    """The surfaces of a file by face; a shape that cannot tell its order is read in the order that the other one tells."""
    fitted: dict[str, Fitted] = {}
    failed: dict[str, InputError] = {}
    for face, surface in pair.items():
        try:
            fitted[face] = surface.fitted(replace(reading, face=face))
        except InputError as error:
            failed[face] = error
    told = [v for f in fitted.values() for label, _, v in f.facts if label == "Orientation" and isinstance(v, dict)]
    for face, failure in failed.items():
        if not told or str(told[0]["why"]).startswith("any order"):
            raise failure
        order = named(str(told[0]["orientation"]))
        again = replace(
            reading,
            face=face,
            first_point=order.first_point,
            rows=order.rows,
            z_towards=told[0]["z_towards"],
            flip_z=False,
        )
        fitted[face] = pair[face].fitted(again)
    return fitted


def _side_found(fitted: Fitted) -> str:
    """The side that the orientation's detection found from the near zone."""
    return next((str(v["side"]) for label, _, v in fitted.facts if label == "Orientation" and isinstance(v, dict)), "")


def _note(path: Path, fitted: dict[str, Fitted], said: list[str]) -> str:
    found = [text for f in fitted.values() for label, text, _ in f.facts if label == "Orientation"]
    return f"{path.name}: {'; '.join(found)}" * bool(found) + f"; assumed: {', '.join(said)}" * bool(said)


def _with_other(
    fitted: dict[str, Fitted], face: str, material: Material, side: str, told: Completion, said: list[str]
) -> Lens:
    """The lens with its other surface, thickness, outline and points; what is assumed is added to `said`."""
    index = material.n_e
    own = fitted[face].surface
    near, addition = _near(fitted, index)
    distance = DISTANCE_POINT if addition else (0.0, 0.0)
    diameter = told.diameter or _reach(fitted)
    thickness = told.thickness or LEAST_CENTRE
    for _ in range(3):
        pair = {f: fit.surface for f, fit in fitted.items()}
        if len(pair) == 1:
            pair["B" if face == "F" else "F"] = _other(own, face, index, thickness, distance, told)
        lens = Lens(pair["F"], pair["B"], thickness, material, circle_outline(diameter), side)
        if told.thickness:
            break
        thickness = max(LEAST_CENTRE, np.ceil(10 * (thickness + LEAST_EDGE - _thinnest(lens))) / 10)
    if len(fitted) == 1:
        name = "back" if face == "F" else "front"
        radius = told.back_radius if face == "F" else told.front_radius
        purpose = "" if radius else f" for {told.power:+.2f} D at x = {distance[0]:g}, y = {distance[1]:g} mm"
        if not radius:
            said.append(f"{name} {lens.back.describe() if face == 'F' else lens.front.describe()}{purpose}")
    if not told.thickness:
        said.append(f"centre thickness {lens.centre_thickness:.1f} mm")
    if not told.diameter:
        said.append(f"diameter {diameter:g} mm")
    points, order = Points(), Order(told.power)
    if near is not None:
        points = Points(FITTING_POINT, (0.0, 0.0), DISTANCE_POINT, near, near[0] * (1 if side == "R" else -1))
        order = Order(told.power, addition=addition)
        said.append(f"fitting point 0, {FITTING_POINT[1]:g} mm, addition {addition:g} D at {near[0]:g}, {near[1]:g} mm")
    return replace(lens, points=points, ordered=order)


def _thinnest(lens: Lens) -> float:
    x, y, _ = lens.disc_points(8, 36)
    edge_x, edge_y = lens.outline.points(72)
    found = lens.thickness(np.append(x.ravel(), edge_x), np.append(y.ravel(), edge_y))
    return float(np.nanmin(found)) if np.isfinite(found).any() else LEAST_EDGE


def _reach(fitted: dict[str, Fitted]) -> float:
    """Diameter about the origin that all surfaces reach, mm, at most the usual one."""
    return float(min(USUAL_DIAMETER, *(np.floor(20 * f.reach) / 10 for f in fitted.values())))


def _other(
    own: Surface, face: str, index: float, thickness: float, at: tuple[float, float], told: Completion
) -> Surface:
    """The sphere of the radius told, or the one that gives the power told at a point, by the thick-lens formula."""
    radius = told.back_radius if face == "F" else told.front_radius
    if radius is not None:
        return surfaces.sphere(radius)
    power = (1 if face == "F" else -1) * float(mean_power(own.surface_power(*at, index)))
    reduced = thickness / (1000 * index)
    if face == "F":
        needed = told.power - power / (1 - reduced * power)
        return surfaces.conic(-needed / (1000 * (index - 1)))
    needed = (told.power - power) / (1 + reduced * (told.power - power))
    return surfaces.conic(needed / (1000 * (index - 1)))


def _near(fitted: dict[str, Fitted], index: float) -> tuple[tuple[float, float] | None, float]:
    """Where the mean power of the known surfaces comes within 5 % of its greatest rise, and that rise, to 0.25 D; or 0."""
    x, y = np.meshgrid(np.arange(-6, 6.1, 0.5), np.arange(-6, -18.1, -0.5))
    rise = np.zeros(x.shape)
    for face, fit in fitted.items():
        sign = 1 if face == "F" else -1
        at = mean_power(fit.surface.surface_power(x, y, index))
        rise = rise + sign * (at - mean_power(fit.surface.surface_power(*DISTANCE_POINT, index)))
    rise = np.where(np.isfinite(rise), rise, -np.inf)
    addition = round(float(rise.max()) * 4) / 4 if np.isfinite(rise.max()) else 0.0
    if addition < LEAST_ADDITION:
        return None, 0.0
    row = int(np.argmax(rise.max(axis=1) >= 0.95 * rise.max()))
    column = int(np.argmax(rise[row]))
    return (float(x[row, column]), float(y[row, column])), addition
