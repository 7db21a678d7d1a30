"""Wearer files: format "lensbench-wearer/1". Lengths in mm, powers in D, angles in degrees, age in years."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from ..optics.conventions import power_matrix, sphere_cylinder_axis
from ..optics.eye import Eye, Wear, Wearer, hofstetter_amplitude, watson_yellott_pupil
from .toml_file import Pair, Table, validated


class RefractionTable(Table):
    """Far prescription: sphere, cylinder (D), axis (degrees TABO), measured vertex_distance mm before the cornea."""

    sphere: float = Field(0.0, ge=-40, le=40)
    cylinder: float = Field(0.0, ge=-20, le=20)
    axis: float = Field(180.0, ge=0, le=180)
    vertex_distance: float = Field(12.0, ge=0, le=30)


class EyeTable(Table):
    """accommodation: amplitude, D. pupil_diameter: entrance pupil, mm; or luminance, cd/m2, over field_area, deg2.

    centre_of_rotation, entrance_pupil: mm behind the corneal apex.
    """

    accommodation: float | None = Field(None, ge=0, le=20)
    pupil_diameter: float | None = Field(None, gt=0, le=10)
    luminance: float | None = Field(None, gt=0, le=1e6)
    field_area: float = Field(3600.0, gt=0, le=30000)
    centre_of_rotation: float = Field(13.5, gt=5, le=25)
    entrance_pupil: float = Field(3.05, ge=0, lt=5)

    @model_validator(mode="after")
    def _one_pupil(self) -> "EyeTable":
        if (self.pupil_diameter is None) == (self.luminance is None):
            raise ValueError("give either pupil_diameter (mm) or luminance (cd/m2)")
        return self


ObjectDistance = Annotated[tuple[float, Annotated[float, Field(allow_inf_nan=True)]], Field(strict=False)]


class WearTable(Table):
    """vertex_distance, decentration, pupillary_distance (monocular), near_distance (from the cornea): mm; angles: degrees.

    object_distances: pairs of the gaze's lowering (degrees) and the object's distance from the cornea (mm).
    """

    vertex_distance: float = Field(13.0, gt=0, le=40)
    pantoscopic_angle: float = Field(0.0, ge=-45, le=45)
    face_form_angle: float = Field(0.0, ge=-45, le=45)
    decentration: Pair = (0.0, 0.0)
    pupillary_distance: float = Field(32.0, gt=0, le=60)
    near_distance: float = Field(400.0, ge=100, le=2000)
    object_distances: tuple[ObjectDistance, ...] = Field((), strict=False)

    @field_validator("object_distances")
    @classmethod
    def _two_points_or_more(cls, points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        lowering = [angle for angle, _ in points]
        if len(points) == 1 or any(b <= a for a, b in pairwise(lowering)):
            raise ValueError(
                "give two or more pairs [lowering_deg, distance_mm], the lowering rising from pair to pair"
            )
        if any(abs(angle) > 60 or not distance >= 100 for angle, distance in points):
            raise ValueError("a lowering must be -60 to 60 degrees, a distance 100 mm or more (inf: far away)")
        return points


class WearerTable(Table):
    """The whole file."""

    format: Literal["lensbench-wearer/1"]
    name: str = ""
    age: float | None = Field(None, ge=0, le=120)
    refraction: RefractionTable = RefractionTable()
    eye: EyeTable
    wear: WearTable = WearTable()

    @model_validator(mode="after")
    def _age_or_amplitude(self) -> "WearerTable":
        if self.age is None and self.eye.accommodation is None:
            raise ValueError("give age (years) or eye.accommodation (D)")
        if self.age is None and self.eye.luminance is not None:
            raise ValueError("eye.luminance needs age (years): the pupil depends on both")
        return self


def build_wearer(path: Path, data: dict[str, Any]) -> Wearer:
    """The wearer of a wearer file's tables. Raises InputError."""
    t = validated(path, data, WearerTable)
    r, w = t.refraction, t.wear
    eye = Eye(
        power_matrix(r.sphere, r.cylinder, r.axis), r.vertex_distance, _amplitude(t), _pupil(t),
        t.eye.centre_of_rotation, t.eye.entrance_pupil,
    )  # fmt: skip
    angles = float(np.radians(w.pantoscopic_angle)), float(np.radians(w.face_form_angle))
    seen_at = tuple((float(np.radians(angle)), distance) for angle, distance in w.object_distances)
    wear = Wear(w.vertex_distance, *angles, w.decentration, w.pupillary_distance, w.near_distance, seen_at)
    return Wearer(eye, wear, t.name or path.stem, t.age)


def _amplitude(t: WearerTable) -> float:
    if t.eye.accommodation is not None:
        return t.eye.accommodation
    assert t.age is not None
    return float(hofstetter_amplitude(t.age))


def _pupil(t: WearerTable) -> float:
    if t.eye.pupil_diameter is not None:
        return t.eye.pupil_diameter
    assert t.age is not None
    assert t.eye.luminance is not None
    return float(watson_yellott_pupil(t.eye.luminance, t.age, t.eye.field_area))


def wearer_table(wearer: Wearer) -> dict[str, Any]:
    """A wearer as the tables of a wearer file, amplitude and pupil as numbers: build_wearer gives the same wearer again."""
    eye, wear = wearer.eye, wearer.wear
    sphere, cylinder, axis = (float(v) for v in sphere_cylinder_axis(eye.refraction))
    table = {
        "format": "lensbench-wearer/1",
        "name": wearer.name,
        "refraction": {
            "sphere": sphere, "cylinder": cylinder, "axis": axis, "vertex_distance": eye.refraction_vertex_distance,
        },
        "eye": {
            "accommodation": eye.accommodation, "pupil_diameter": eye.pupil_diameter,
            "centre_of_rotation": eye.centre_of_rotation, "entrance_pupil": eye.entrance_pupil,
        },
        "wear": {
            "vertex_distance": wear.vertex_distance,
            "pantoscopic_angle": float(np.degrees(wear.pantoscopic_angle)),
            "face_form_angle": float(np.degrees(wear.face_form_angle)),
            "decentration": list(wear.decentration),
            "pupillary_distance": wear.pupillary_distance,
            "near_distance": wear.near_distance,
            "object_distances": [[float(np.degrees(angle)), distance] for angle, distance in wear.object_distances],
        },
    }  # fmt: skip
    return table if wearer.age is None else table | {"age": wearer.age}
