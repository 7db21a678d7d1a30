"""Lens files: format "lensbench-lens/1". Lengths in mm, powers in D, angles in degrees; frames as in optics.conventions."""

import difflib
import re
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from ..errors import InputError
from ..optics import lens as optics_lens
from ..optics import surfaces
from ..optics.lens import Lens, Order, Outline, Points
from ..optics.materials import MATERIALS, Material, material_from_abbe, named_material
from ..optics.surfaces import Surface
from .orientation import Corner, Rows, Towards
from .registry import read_file
from .surface_data import Reading, chosen
from .toml_file import Pair, Table, validated

OneWay = tuple[float | None, float | None, float | None]


@dataclass(frozen=True, slots=True)
class Face:
    """Where a surface goes: "front" or "back" of a lens of side "R" or "L" and a refractive index, files beside folder."""

    name: str
    side: str
    index: float
    folder: Path


class SurfaceTable(Table):
    """Pose of any surface: decentration (mm) of its vertex and tilt (degrees about x, about y) of its axis in the lens."""

    decentration: Pair = (0.0, 0.0)
    tilt: Pair = (0.0, 0.0)

    def pose(self) -> dict[str, Any]:
        """The pose as the surface functions take it."""
        return {"decentration": self.decentration, "tilt": (np.radians(self.tilt[0]), np.radians(self.tilt[1]))}


class Plane(SurfaceTable):
    """A plane."""

    type: Literal["plane"]

    def build(self, face: Face) -> Surface:
        """The surface."""
        return surfaces.plane(**self.pose())


class OneCurvature(SurfaceTable):
    """radius (mm), curvature (1/mm) or power (D) at an index; radius > 0: centre of curvature on the eye's side."""

    radius: float | None = None
    curvature: float | None = None
    power: float | None = None
    index: float | None = Field(None, gt=1, lt=3)

    @model_validator(mode="after")
    def _one_way(self) -> "OneCurvature":
        _check_one_way(self.radius, self.curvature, self.power, self.index)
        return self

    def vertex_curvature(self, face: Face) -> float:
        """Curvature at the vertex, 1/mm."""
        return _curvature(face, self.index, self.radius, self.curvature, self.power)


class Sphere(OneCurvature):
    """A sphere."""

    type: Literal["sphere"]

    def build(self, face: Face) -> Surface:
        """The surface."""
        return surfaces.conic(self.vertex_curvature(face), **self.pose())


class Conic(OneCurvature):
    """A conic of revolution; asphere: even terms a4, a6, ... in mm^-3, mm^-5, ..., positive towards the eye."""

    type: Literal["conic"]
    conic_constant: float = 0.0
    asphere: list[float] = Field(default_factory=list, max_length=6)

    def build(self, face: Face) -> Surface:
        """The surface."""
        return surfaces.conic(self.vertex_curvature(face), self.conic_constant, self.asphere, **self.pose())


class TwoCurvatures(SurfaceTable):
    """Pairs along and across the meridian `axis` (degrees): radius, curvature or power at an index."""

    axis: float = Field(ge=0, le=180)
    radius: Pair | None = None
    curvature: Pair | None = None
    power: Pair | None = None
    index: float | None = Field(None, gt=1, lt=3)

    @model_validator(mode="after")
    def _one_way(self) -> "TwoCurvatures":
        for radius, curvature, power in self.pairs():
            _check_one_way(radius, curvature, power, self.index)
        return self

    def pairs(self) -> tuple[OneWay, OneWay]:
        """(radius, curvature, power) along and across the axis meridian."""
        radius, curvature, power = (pair or (None, None) for pair in (self.radius, self.curvature, self.power))
        return (radius[0], curvature[0], power[0]), (radius[1], curvature[1], power[1])

    def vertex_curvatures(self, face: Face) -> Pair:
        """Curvatures at the vertex along and across the axis meridian, 1/mm."""
        along, across = self.pairs()
        return _curvature(face, self.index, *along), _curvature(face, self.index, *across)


class Toric(TwoCurvatures):
    """A true torus: the arc along the axis meridian, turned about a line across it."""

    type: Literal["toric"]

    def build(self, face: Face) -> Surface:
        """The surface."""
        return surfaces.toric(*self.vertex_curvatures(face), self.axis, **self.pose())


class Biconic(TwoCurvatures):
    """A biconic: conic constants along and across the axis meridian."""

    type: Literal["biconic"]
    conic_constant: Pair = (0.0, 0.0)

    def build(self, face: Face) -> Surface:
        """The surface."""
        return surfaces.biconic(*self.vertex_curvatures(face), self.axis, *self.conic_constant, **self.pose())


class Grid(SurfaceTable):
    """A surface's file beside the lens file. first_point: corner of its first value, seen from the front of the wearer.

    rows: "horizontal" or "vertical"; z_towards: the side to which the file counts positive. What is left out is found from
    the surface's shape.
    """

    type: Literal["grid"]
    file: str
    first_point: Corner | None = None
    rows: Rows | None = None
    z_towards: Towards | None = None

    def build(self, face: Face) -> Surface:
        """The surface."""
        path = face.folder / self.file
        items = [item for item in read_file(path).items if hasattr(item, "fitted")]
        letter = face.name[0].upper()
        found = chosen(path, items, face.side, letter)
        order = self.first_point, self.rows, self.z_towards
        return found.fitted(Reading(face.side, letter, face.index, *order, pose=self.pose())).surface


class BSpline(SurfaceTable):
    """A tensor B-spline: full knot vectors (mm), coefficients[row of y][column of x] (mm, + towards the scene)."""

    type: Literal["bspline"]
    degree: int = Field(ge=2, le=5)
    knots_x: list[float]
    knots_y: list[float]
    coefficients: list[list[float]]

    @model_validator(mode="after")
    def _counts(self) -> "BSpline":
        ny, widths = len(self.coefficients), {len(row) for row in self.coefficients}
        for name, knots, count in (("knots_y", self.knots_y, {ny}), ("knots_x", self.knots_x, widths)):
            if count != {len(knots) - self.degree - 1} or len(knots) < 2 * self.degree + 2:
                raise ValueError(
                    f"{name}: {len(knots)} knots of degree {self.degree} do not fit {sorted(count)} coefficients"
                )
            if np.any(np.diff(knots) < 0) or knots[self.degree] >= knots[-1 - self.degree]:
                raise ValueError(f"{name}: knots must rise")
        return self

    def build(self, face: Face) -> Surface:
        """The surface."""
        return surfaces.bspline(self.knots_x, self.knots_y, self.coefficients, self.degree, **self.pose())


AnySurface = Annotated[
    Plane | Sphere | Conic | Toric | Biconic | Grid | BSpline, Field(discriminator="type")
]  # fmt: skip


def _check_one_way(
    radius: float | None = None, curvature: float | None = None, power: float | None = None, index: float | None = None
) -> None:
    if sum(v is not None for v in (radius, curvature, power)) != 1:
        raise ValueError("give exactly one of radius (mm), curvature (1/mm) and power (D, with its index)")
    if radius == 0:
        raise ValueError("radius: 0 is no radius; a plane has type = 'plane'")
    if index is not None and power is None:
        raise ValueError("index: belongs to power (D) only")


def _curvature(
    face: Face, stated_index: float | None, radius: float | None, curvature: float | None, power: float | None
) -> float:
    if radius is not None:
        return 1.0 / radius
    if curvature is not None:
        return curvature
    return (1.0 if face.name == "front" else -1.0) * (power or 0.0) / (1000 * ((stated_index or face.index) - 1))


class MaterialTable(Table):
    """A material by its own numbers (density in g/cm3), or by a name of the table of materials."""

    name: str
    n_d: float = Field(gt=1, lt=3)
    n_e: float = Field(gt=1, lt=3)
    abbe: float = Field(gt=10, lt=120)
    density: float = Field(gt=0.5, lt=10)

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, data: Any) -> Any:
        if not isinstance(data, str):
            return data
        if data not in MATERIALS:
            near = difflib.get_close_matches(data, MATERIALS, n=1, cutoff=0.75)
            hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(MATERIALS)}, or give its numbers"
            raise ValueError(f"{data!r} is not known; {hint}")
        return asdict(MATERIALS[data])


def material_named(text: str) -> Material:
    """The material of the table that a command names, or "n_d/V_d". Raises InputError."""
    numbers = re.fullmatch(r"([\d.]+)/([\d.]+)", text)
    found = named_material(text)
    if numbers and 1 < float(numbers[1]) < 3 and 10 < float(numbers[2]) < 120:
        return material_from_abbe(text, float(numbers[1]), float(numbers[2]))
    if found is None:
        raise InputError(
            f"material: {text!r} is not known; there are {', '.join(MATERIALS)}, or write n_d/V_d (Abbe number): 1.592/41"
        )
    return found


class OutlineTable(Table):
    """shape "circle" (diameter), "ellipse" or "box" (width, height) or "points" ([[x, y], ...]); centre; all mm."""

    shape: Literal["circle", "ellipse", "box", "points"]
    diameter: float | None = Field(None, gt=0, le=200)
    width: float | None = Field(None, gt=0, le=200)
    height: float | None = Field(None, gt=0, le=200)
    points: list[Pair] | None = Field(None, min_length=3)
    centre: Pair | None = None

    @model_validator(mode="after")
    def _complete(self) -> "OutlineTable":
        needed = {"circle": ("diameter",), "points": ("points",)}.get(self.shape, ("width", "height"))
        for key in ("diameter", "width", "height", "points"):
            if (getattr(self, key) is not None) != (key in needed):
                raise ValueError(f"shape = {self.shape!r} needs {' and '.join(needed)} and nothing else")
        self.build()
        return self

    def build(self) -> Outline:
        """The outline."""
        if self.shape == "points":
            return optics_lens.polygon_outline(np.array(self.points), self.centre)
        if self.shape == "circle":
            return optics_lens.circle_outline(self.diameter or 0.0, self.centre or (0.0, 0.0))
        make = optics_lens.ellipse_outline if self.shape == "ellipse" else optics_lens.box_outline
        return make(self.width or 0.0, self.height or 0.0, self.centre or (0.0, 0.0))


class PointsTable(Table):
    """Reference points on the front surface, [x, y] in mm; near_inset: mm towards the nose."""

    fitting_point: Pair = (0.0, 0.0)
    prism_reference_point: Pair = (0.0, 0.0)
    distance_reference_point: Pair | None = None
    near_reference_point: Pair | None = None
    near_inset: float | None = None


class OrderTable(Table):
    """Ordered power: sphere, cylinder, addition (D), axis (degrees), prism (cm/m), prism_base (degrees)."""

    sphere: float = Field(0.0, ge=-40, le=40)
    cylinder: float = Field(0.0, ge=-20, le=20)
    axis: float = Field(180.0, ge=0, le=180)
    addition: float = Field(0.0, ge=0, le=5)
    prism: float = Field(0.0, ge=0, le=20)
    prism_base: float = Field(0.0, ge=0, le=360)


class VerificationTable(Table):
    """Power to verify by focimeter where it is not the order; what is left out is as ordered."""

    sphere: float | None = Field(None, ge=-40, le=40)
    cylinder: float | None = Field(None, ge=-20, le=20)
    axis: float | None = Field(None, ge=0, le=180)
    addition: float | None = Field(None, ge=-5, le=5)
    prism: float | None = Field(None, ge=0, le=20)
    prism_base: float | None = Field(None, ge=0, le=360)

    def build(self, ordered: Order | None) -> Order:
        """The whole power."""
        return replace(ordered or Order(), **self.model_dump(exclude_none=True))


class LensTable(Table):
    """The whole file."""

    format: Literal["lensbench-lens/1"]
    name: str = ""
    side: Literal["R", "L"]
    material: MaterialTable
    wavelength: Literal["d", "e"] = "e"
    centre_thickness: float = Field(gt=0, le=50)
    outline: OutlineTable
    front: AnySurface
    back: AnySurface
    points: PointsTable = PointsTable()
    ordered: OrderTable | None = None
    verification: VerificationTable | None = None


def build_lens(path: Path, data: dict[str, Any]) -> Lens:
    """The lens of a lens file's tables, checked for thickness over its whole outline. Raises InputError."""
    table = validated(path, data, LensTable)
    material = Material(**table.material.model_dump())
    index = material.index(table.wavelength)
    ordered = None if table.ordered is None else Order(**table.ordered.model_dump())
    lens = Lens(
        front=table.front.build(Face("front", table.side, index, path.parent)),
        back=table.back.build(Face("back", table.side, index, path.parent)),
        centre_thickness=table.centre_thickness,
        material=material,
        outline=table.outline.build(),
        side=table.side,
        wavelength=table.wavelength,
        points=Points(**table.points.model_dump()),
        ordered=ordered,
        verification_power=None if table.verification is None else table.verification.build(ordered),
        name=table.name or path.stem,
    )
    _check_points(path, lens)
    _check_inset(path, lens)
    check_body(path, lens)
    return lens


def _check_points(path: Path, lens: Lens) -> None:
    for name, (x, y) in lens.points.named().items():
        if not lens.outline.contains(x, y):
            raise InputError(f"{path}: points.{name}: ({x:g}, {y:g}) mm lies outside the outline")


def _check_inset(path: Path, lens: Lens) -> None:
    near, inset = lens.points.near_reference_point, lens.points.near_inset
    if near is None or inset is None:
        return
    wanted = lens.points.prism_reference_point[0] + (inset if lens.side == "R" else -inset)
    if abs(near[0] - wanted) > 0.05:
        raise InputError(
            f"{path}: points.near_inset: {inset:g} mm towards the nose of a {lens.side} lens puts the near reference point "
            f"at x = {wanted:g}, but near_reference_point says {near[0]:g}"
        )


def check_body(path: Path, lens: Lens) -> None:
    """Raise InputError where a surface does not reach the outline, or the lens has no thickness."""
    inner_x, inner_y, _ = lens.disc_points(12, 72)
    edge_x, edge_y = lens.outline.points()
    x, y = np.append(inner_x.ravel(), edge_x), np.append(inner_y.ravel(), edge_y)
    for face, height in (("front", lens.front_height(x, y)), ("back", lens.back_height(x, y))):
        if np.isnan(height).any():
            k = int(np.argmax(np.isnan(height)))
            raise InputError(
                f"{path}: {face}: the surface does not reach the outline at x = {x[k]:.1f}, y = {y[k]:.1f} mm"
            )
    thickness = lens.thickness(x, y)
    k = int(np.argmin(thickness))
    if thickness[k] <= 0:
        least = lens.centre_thickness - thickness[k]
        raise InputError(
            f"{path}: centre_thickness: the lens is {thickness[k]:.2f} mm thick at x = {x[k]:.1f}, y = {y[k]:.1f} mm; "
            f"with these surfaces it must be more than {least:.2f} mm at the centre"
        )
