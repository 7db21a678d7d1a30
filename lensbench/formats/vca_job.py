"""Job files of the VCA/OMA standard (.lms, .lds, .oma, ...): the order, the frame, and the lens if its surface lies beside.

Boxing: the traced shape is polar about the boxing centre, seen from in front of the wearer. The fitting point lies (HBOX +
DBL) / 2 - IPD towards the nose of that centre and SEGHT or OCHT above the lowest point of the box, unless FCSG or FCOC say
where it lies. Points of the layout (BCSG, ERDR, ERNR) count from the origin of the surface; IN is towards the nose.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..optics import surfaces
from ..optics.eye import Wear, Wearer
from ..optics.lens import Lens, Order, Outline, Points, circle_outline, polygon_outline
from ..optics.materials import MATERIALS, Material
from ..optics.ordered import AVERAGE_WEAR, wearer_as_ordered
from ..optics.surfaces import Surface
from . import sdf
from .body import USUAL_DIAMETER
from .lens_file import check_body
from .registry import read_file
from .surface_data import Reading
from .vca_powers import POWER_RANGES, Powers, powers_of
from .vca_records import SIDES, Records

FACES = {"F": "front", "B": "back"}
RADIUS_FROM = 25.0  # FRNT and BACK beyond this are radii in mm, up to it dioptres at TIND
TOOLING_INDEX = 1.530
LENS_KINDS = {  # LMATTYPE
    "1": ("CR-39",), "2": ("polycarbonate",), "3": ("crown",), "5": ("MR-8", "MR-7", "MR-10", "MR-174"), "6": ("Trivex",)
}  # fmt: skip
NASAL = {"R": 1.0, "L": -1.0}
NAMES = {"R": "right", "L": "left"}
RANGES = {
    **POWER_RANGES,
    "IPD": (10, 50), "NWD": (1, 2000), "OCHT": (0, 80), "SEGHT": (0, 80), "HBOX": (5, 120), "VBOX": (5, 120),
    "DBL": (1, 60), "FCSGIN": (-40, 40), "FCSGUP": (-40, 40), "FCOCIN": (-40, 40), "FCOCUP": (-40, 40),
    "PANTO": (-45, 45), "ZTILT": (-45, 45), "BVD": (1, 40), "LIND": (1.3, 2.2), "TIND": (1.3, 2.2),
    "CTHICK": (0.1, 50), "FRNT": (-1e5, 1e5), "BACK": (-1e5, 1e5), "DIA": (5, 150), "CRIB": (5, 150),
    "CORRLEN": (3, 40), "INSET": (-10, 10), "BCSGIN": (-30, 30), "BCSGUP": (-40, 40), "ERDRIN": (-30, 30),
    "ERDRUP": (-40, 40), "ERNRIN": (-30, 30), "ERNRUP": (-40, 40),
}  # fmt: skip
UNDERSTOOD = {*RANGES, "DO", "JOB", "LDPATH", "LMATTYPE", "LNAM"}


@dataclass(slots=True)
class Job:
    """A job file as understood: facts (label, text, value); by side the lens, the wearer, and what a lens is made of.

    unplaced: sides whose surface file does not tell how it lies, and the sentence that says so.
    """

    path: Path
    said: list[tuple[str, str, object]] = field(default_factory=list)
    lenses: dict[str, Lens] = field(default_factory=dict)
    wearers: dict[str, Wearer] = field(default_factory=dict)
    parts: "dict[str, tuple[Eyeside, Powers, list[Any]]]" = field(default_factory=dict)
    unplaced: dict[str, str] = field(default_factory=dict)

    def facts(self) -> list[tuple[str, str, object]]:
        """Label, text and value of all that was understood."""
        return [("File", f"a VCA/OMA job: {self.path.name}", "job"), *self.said]

    @property
    def sides(self) -> tuple[str, ...]:
        """The sides that have a surface."""
        return tuple(self.parts)

    def lens(self, material: Material | None = None, side: str = "", told: Reading | None = None) -> Lens:
        """The lens of a side ("": the first there is), of another material if one is given. Raises InputError.

        told: how the points of the surface file lie, where that is to be said or is not to be found from them.
        """
        side = side or next(iter(self.parts), "")
        if side not in self.parts:
            which = f"{NAMES[side]} lens" if side else "lens"
            raise InputError(
                f"{self.path}: holds no {which}: its surface file (LDPATH, or an .sdf of the job's name) does not lie beside "
                "it, or has no such side"
            )
        if told is not None and (told.first_point or told.rows or told.z_towards or told.flip_z):
            found = _lens(*self.parts[side], told)
        elif side in self.unplaced:
            raise InputError(self.unplaced[side])
        else:
            found = self.lenses[side]
        return found if material is None else replace(found, material=material)

    def wearer(self, side: str = "") -> Wearer:
        """The wearer as ordered of a side ("": the first). Raises InputError."""
        found = self.wearers.get(side) if side else next(iter(self.wearers.values()), None)
        if found is None:
            raise InputError(f"{self.path}: orders nothing for the {NAMES.get(side, side)} side")
        return found


class Unplaced(InputError):
    """A surface of which it cannot be told how it lies."""


class Eyeside:
    """One side of a job: numbers by label, each said once in the job's facts."""

    def __init__(self, records: Records, side: str, job: Job):
        self.records, self.side, self.job = records, side, job

    def __getitem__(self, label: str) -> float | None:
        return self.records.number(label, self.side, *RANGES[label])

    def first(self, *labels: str) -> float | None:
        """The value of the first of these labels that has one."""
        return next((value for value in (self[label] for label in labels) if value is not None), None)

    def say(self, label: str, text: str, value: object = None) -> None:
        """A fact of this side."""
        self.job.said.append((f"{label} ({NAMES[self.side]})", text, value if value is not None else text))


def sniff(head: bytes, text: str) -> float:
    """A job has an order or a frame among its records; with a surface in it the index and thickness tell it from an SDF."""
    labels = {line.partition("=")[0].strip().upper() for line in text.splitlines() if "=" in line}
    telling = labels & {
        "JOB",
        "DO",
        "REQ",
        "SPH",
        "CYL",
        "LIND",
        "IPD",
        "TRCFMT",
        "LDPATH",
        "FRNT",
        "OCHT",
        "HBOX",
        "DBL",
    }
    if "SURFMT" in labels:
        return 1.0 if {"LIND", "CTHICK"} <= labels else 0.0
    return 0.9 if len(telling) >= 2 else 0.0


def read(path: Path) -> tuple[Job | Lens | Wearer, ...]:
    """The job, its lenses (where their surface file lies beside it) and its wearers. Raises InputError."""
    records = Records(path)
    job = Job(path)
    for side in _sides(records):
        eye = Eyeside(records, side, job)
        powers = powers_of(eye)
        job.wearers[side] = _wearer(eye, powers.order)
        held = _held(eye, _surface_file(records, side))
        if not held:
            continue
        job.parts[side] = eye, powers, held
        try:
            job.lenses[side] = _lens(eye, powers, held, Reading())
        except Unplaced as error:
            job.unplaced[side] = str(error)
            eye.say("Lens", f"none: {error}")
    unused = sorted(set(records.by_label) - UNDERSTOOD)
    job.said.append(("Labels not used", ", ".join(unused) or "none", unused))
    return (job, *job.lenses.values(), *job.wearers.values())


def _sides(records: Records) -> tuple[str, ...]:
    do = records.text("DO").upper()
    if do in SIDES:
        return (do,)
    if do not in ("", "B"):
        raise InputError(f"{records.path}, line {records.by_label['DO'].line}: DO: {do[:20]!r} is none of R, L and B")
    there = [side for side in SIDES if any(records.text(label, side) for label in ("SPH", "FRNT", "LIND", "IPD"))]
    traced = [side for side in SIDES if records.shape("TRCFMT", side)]
    return tuple(there or traced or SIDES)


def _wearer(eye: Eyeside, order: Order) -> Wearer:
    """The wearer as ordered: refraction as ordered at the vertex distance BVD; what is not given as in an average wear."""
    vertex, panto, wrap, near = eye["BVD"], eye["PANTO"], eye["ZTILT"], eye["NWD"]
    pd = eye["IPD"]
    usual = AVERAGE_WEAR
    wear = Wear(
        usual.vertex_distance if vertex is None else vertex,
        usual.pantoscopic_angle if panto is None else float(np.radians(panto)),
        usual.face_form_angle if wrap is None else float(np.radians(wrap)),
        pupillary_distance=usual.pupillary_distance if pd is None else pd,
        near_distance=usual.near_distance if near is None else near * (10 if near < 100 else 1),
    )
    given = [f"{label} {eye[label]:g}" for label in ("BVD", "PANTO", "ZTILT", "IPD", "NWD") if eye[label] is not None]
    eye.say("Position of wear", (", ".join(given) or "nothing given") + "; the rest as in an average position of wear")
    return wearer_as_ordered(order, wear, f"{eye.job.path.name} {NAMES[eye.side]}, as ordered")


# ---- the lens ----


def _lens(eye: Eyeside, powers: Powers, held: list[Any], told: Reading) -> Lens:
    path = eye.records.path
    material, wavelength = _material(eye)
    index = material.index(wavelength)
    front, back = _faces(eye, held, replace(told, index=index))
    thickness = eye["CTHICK"]
    if thickness is None:
        raise InputError(f"{path}: CTHICK ({NAMES[eye.side]}): the centre thickness is missing; a lens needs it")
    points = _points(eye, powers.order)
    outline = _outline(eye, points, powers.order)
    name = f"{eye.records.text('JOB') or path.stem} {NAMES[eye.side]}"
    lens = Lens(
        front, back, thickness, material, outline, eye.side, wavelength, points, powers.order, name,
        verification_power=powers.verification_power,
    )  # fmt: skip
    check_body(path, lens)
    _compare_edge(eye, lens)
    return lens


def _surface_file(records: Records, side: str) -> Path | None:
    """The file with this side's surface: the job itself, the one that LDPATH names, or an SDF of the job's name; beside it."""
    if records.has_surface:
        return records.path
    named = records.text("LDPATH", side).replace("\\", "/").rpartition("/")[2]
    wanted = [named.lower()] if named else [f"{records.path.stem}.sdf".lower()]
    return next((p for p in sorted(records.path.parent.iterdir()) if p.name.lower() in wanted), None)


def _held(eye: Eyeside, surface_file: Path | None) -> list[Any]:
    """The surfaces of this side in its surface file."""
    if surface_file is None:
        named = eye.records.text("LDPATH", eye.side)
        eye.say("Lens", f"none: {named or 'an .sdf of the same name'} does not lie beside the job")
        return []
    items = sdf.read(surface_file) if surface_file == eye.records.path else read_file(surface_file).items
    held = [item for item in items if hasattr(item, "fitted") and item.side in ("", eye.side)]
    if not held:
        eye.say("Lens", f"none: {surface_file.name} holds no surface of this side")
    return held


def _faces(eye: Eyeside, held: list[Any], told: Reading) -> tuple[Surface, Surface]:
    """Front and back: from the surface file, and a sphere of FRNT or BACK for the face that the file does not hold."""
    faces: dict[str, Surface] = {}
    for item in held:
        face = item.face or "B"
        try:
            faces.setdefault(face, item.fitted(replace(told, side=eye.side, face=face)).surface)
        except InputError as error:
            raise Unplaced(f"{eye.records.path}: {NAMES[eye.side]} lens: {error}") from None
        eye.say(f"{FACES[face].capitalize()} surface", faces[face].describe())
    for face, label in (("F", "FRNT"), ("B", "BACK")):
        if face not in faces:
            faces[face] = _sphere(eye, face, label)
    return faces["F"], faces["B"]


def _sphere(eye: Eyeside, face: str, label: str) -> Surface:
    """The sphere of FRNT or BACK. Either sign of BACK is a back concave to the eye: programs write both."""
    value = eye[label]
    where = f"{eye.records.path}: {label} ({NAMES[eye.side]})"
    if not value:
        raise InputError(f"{where}: the {FACES[face]} is neither in the surface file nor given as a curve")
    tooling = eye["TIND"] or TOOLING_INDEX
    in_mm = abs(value) > RADIUS_FROM
    radius = value if in_mm else 1000 * (tooling - 1) / value
    if face == "B":
        radius = abs(radius)
    how = "taken as mm, for it is beyond 25" if in_mm else f"taken as D at the tooling index {tooling:g}"
    eye.say(
        f"{FACES[face].capitalize()} surface", f"{label} = {value:g}, {how}: sphere of radius {radius:.6g} mm", radius
    )
    return surfaces.sphere(radius)


def _material(eye: Eyeside) -> tuple[Material, str]:
    """The material of index LIND: that of the table whose n_e or n_d it is, else the nearest of its kind with this n_d."""
    index, kind = eye["LIND"], LENS_KINDS.get(eye.records.text("LMATTYPE", eye.side), MATERIALS)
    if index is None:
        raise InputError(
            f"{eye.records.path}: LIND ({NAMES[eye.side]}): the index of the lens is missing; a lens needs it"
        )
    known = [MATERIALS[name] for name in kind]
    for wavelength in ("e", "d"):
        for material in (*known, *MATERIALS.values()):
            if abs(material.index(wavelength) - index) < 5e-4:
                eye.say("Material", f"LIND = {index:g}: {material.name}, n_{wavelength}", index)
                return material, wavelength
    nearest = min(known, key=lambda m: abs(m.n_d - index))
    eye.say("Material", f"LIND = {index:g}, taken as n_d; Abbe number V_d and density as {nearest.name}", index)
    shift = nearest.n_e - nearest.n_d
    return Material(f"LIND {index:g}", index, index + shift, nearest.abbe, nearest.density), "d"


def _points(eye: Eyeside, order: Order) -> Points:
    """The layout: fitting point BCSG, distance point ERDR, near point ERNR or CORRLEN below the fitting point and INSET in."""
    nasal = NASAL[eye.side]
    x, y = eye["BCSGIN"], eye["BCSGUP"]
    fitting = nasal * (x or 0.0), y or 0.0
    if y is None and order.addition:
        eye.say("Fitting point", "BCSGUP is not given: taken at the origin of the surface", [0.0, 0.0])
    distance = _point(nasal, eye["ERDRIN"], eye["ERDRUP"])
    near = _point(nasal, eye["ERNRIN"], eye["ERNRUP"])
    corridor = eye["CORRLEN"]
    if near is None and corridor is not None:
        near = fitting[0] + nasal * (eye["INSET"] or 0.0), fitting[1] - corridor
        eye.say("Near point", f"CORRLEN = {corridor:g} mm below the fitting point", list(near))
    return Points(fitting, (0.0, 0.0), distance, near)


def _point(nasal: float, inwards: float | None, up: float | None) -> tuple[float, float] | None:
    return None if up is None else (nasal * (inwards or 0.0), up)


# ---- the frame ----


def _outline(eye: Eyeside, points: Points, order: Order) -> Outline:
    traced = _traced(eye)
    if traced is None:
        label = next((label for label in ("CRIB", "DIA") if eye[label]), None)
        diameter = eye[label] or USUAL_DIAMETER if label else USUAL_DIAMETER
        eye.say("Outline", f"no frame; circle of {label or 'a usual'} {diameter:g} mm", diameter)
        return circle_outline(diameter)
    angles, radii = traced
    centre = _boxing_centre(eye, points, order, radii * np.cos(angles), radii * np.sin(angles))
    corners = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=-1) + centre
    try:
        return polygon_outline(corners, centre)
    except ValueError as error:
        raise InputError(f"{eye.records.path}: TRCFMT ({NAMES[eye.side]}): {error}") from None


def _traced(eye: Eyeside) -> tuple[Any, Any] | None:
    """Angles (rad) and radii (mm) of the frame about its boxing centre; the other side's, mirrored, where it has none."""
    path, shape, mirror = eye.records.path, eye.records.shape("TRCFMT", eye.side), False
    if shape is None:
        shape, mirror = eye.records.shape("TRCFMT", "L" if eye.side == "R" else "R"), True
    if shape is None:
        return None
    radii = shape.column(path, "R")
    if not (radii.min() >= 1 and radii.max() <= 100):
        reach = f"radii of {radii.min():g} to {radii.max():g} mm"
        raise InputError(
            f"{path}, line {shape.record.line}: TRCFMT: {reach} are no frame's (they are written in 0.01 mm)"
        )
    angles = shape.angles(path)
    whose = "both sides" if shape.side == "B" else f"the {NAMES[shape.side]} side"
    eye.say("Frame", f"{shape.count} radii of {whose}{', mirrored' if mirror else ''}", shape.count)
    return (np.pi - angles, radii) if mirror else (angles, radii)


def _boxing_centre(eye: Eyeside, points: Points, order: Order, x: Any, y: Any) -> tuple[float, float]:
    """Where the boxing centre lies in the lens: the fitting point less its place in the box."""
    seg = bool(order.addition)
    inwards = eye.first(*(("FCSGIN", "FCOCIN") if seg else ("FCOCIN", "FCSGIN")))
    up = eye.first(*(("FCSGUP", "FCOCUP") if seg else ("FCOCUP", "FCSGUP")))
    how = "FCSG, FCOC"
    if inwards is None and None not in (eye["IPD"], eye["DBL"]):
        inwards = ((eye["HBOX"] or float(np.ptp(x))) + (eye["DBL"] or 0.0)) / 2 - (eye["IPD"] or 0.0)
        how = "HBOX, DBL, IPD"
    height = eye.first(*(("SEGHT", "OCHT") if seg else ("OCHT", "SEGHT")))
    if up is None and height is not None:
        up = height - (eye["VBOX"] or float(np.ptp(y))) / 2
        how += ", SEGHT, OCHT, VBOX"
    missing = [way for way, value in (("across", inwards), ("up", up)) if value is None]
    without = f"; nothing says how far {' and '.join(missing)}: 0" if missing else ""
    text = f"{inwards or 0.0:.2f} mm in, {up or 0.0:.2f} mm up of the boxing centre (by {how}){without}"
    eye.say("Fitting point in the box", text, [inwards, up])
    fx, fy = points.fitting_point
    return fx - NASAL[eye.side] * (inwards or 0.0), fy - (up or 0.0)


def _compare_edge(eye: Eyeside, lens: Lens) -> None:
    """Say how the edge thickness that the laboratory's program wrote along the frame (STHKFMT) agrees with the lens."""
    path, shape = eye.records.path, eye.records.shape("STHKFMT", eye.side)
    if shape is None:
        return
    theirs, radii, angles = shape.column(path, "T"), shape.column(path, "R"), shape.angles(path)
    cx, cy = lens.outline.centre
    gap = lens.thickness(cx + radii * np.cos(angles), cy + radii * np.sin(angles)) - theirs
    text = f"STHKFMT: the lens is {np.nanmean(gap):+.3f} mm thicker on average, {np.nanmax(np.abs(gap)):.3f} mm off at most"
    eye.say("Edge thickness", text, float(np.nanmax(np.abs(gap))))
