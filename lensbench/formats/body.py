"""A lens's body as CAD, mesh and design files hold it: two surfaces and their distance, without material and side."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from ..errors import InputError
from ..optics.conventions import Floats
from ..optics.lens import Lens, Outline, circle_outline, ellipse_outline, polygon_outline
from ..optics.materials import Material
from ..optics.surfaces import Surface
from .lens_file import check_body
from .surface_data import Fitted, Reading

USUAL_DIAMETER = 60.0


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """path: of the file. front, back: None where the file holds one surface only. centre_thickness: mm.

    understood: how the file was read, a line each. outline, material: None if the file has none.
    """

    path: Path
    front: Surface | None
    back: Surface | None
    centre_thickness: float
    understood: tuple[str, ...]
    outline: Outline | None = None
    material: Material | None = None

    def facts(self) -> list[tuple[str, str, object]]:
        """Label, text and value of what was understood."""
        lines = [(f"Understood {k}", line, line) for k, line in enumerate(self.understood, start=1)]
        missing = () if self.material else (("Material", "none in the file: name one with --material", None),)
        return [("File", "the body of a lens", "body"), *lines, *missing]

    def lens(self, material: Material | None = None, side: str = "") -> Lens:
        """The lens of a material (which wins over the file's own) and a side ("": right). Raises InputError."""
        if self.front is None or self.back is None:
            raise InputError(f"{self.path}: holds one surface; a lens has two: name it in a lens file")
        chosen = material or self.material
        if chosen is None:
            raise InputError(f"{self.path}: says nothing of the material; name one: --material MR-8")
        outline = self.outline or circle_outline(USUAL_DIAMETER)
        name, note = self.path.stem, "; ".join(self.understood)
        lens = Lens(
            self.front, self.back, self.centre_thickness, chosen, outline, side or "R", name=name, note=note
        )  # fmt: skip
        check_body(self.path, lens)
        return lens

    def surfaces(self) -> "tuple[BodySurface, ...]":
        """The one or two surfaces, each for itself; the only surface of a file may be either face."""
        if self.front is None or self.back is None:
            only = self.front or self.back
            return () if only is None else (BodySurface(self.path.name, only),)
        return BodySurface(self.path.name, self.front, face="F"), BodySurface(self.path.name, self.back, face="B")


@dataclass(frozen=True, slots=True, eq=False)
class BodySurface:
    """A surface of a file that says itself how it lies (see SurfaceData)."""

    source: str
    surface: Surface
    side: str = ""
    face: str = ""

    def fitted(self, reading: Reading) -> Fitted:
        """The surface, posed as the reading says. Raises InputError for an orientation, which only point files need."""
        if reading.flip_z or reading.first_point or reading.rows or reading.z_towards:
            raise InputError(f"{self.source}: says itself how its surfaces lie; it takes no orientation")
        own = self.surface
        x, y = reading.pose.get("decentration", (0.0, 0.0))
        tilt = reading.pose.get("tilt", (0.0, 0.0))
        if any(tilt) and any(own.tilt):
            raise InputError(f"{self.source}: the surface is tilted in the file itself; it takes no other tilt")
        placed = replace(
            own, decentration=(own.decentration[0] + x, own.decentration[1] + y), tilt=tilt if any(tilt) else own.tilt
        )
        return Fitted(placed, (("Surface", placed.describe(), placed.describe()),))


def the_lens(things: tuple[Any, ...], kind: str) -> Lens:
    """The first lens among things to be written. Raises InputError where there is none."""
    for thing in things:
        if isinstance(thing, Lens):
            return thing
    raise InputError(f"{kind} is written of a whole lens, and there is none")


# ---- from the faces of a solid or a mesh ----


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A face's surface, the z of that surface's vertex (mm), area (mm2), edge (k, 2) in mm and how it was understood."""

    surface: Surface
    height: float
    area: float
    edge: Floats
    word: str

    def identity(self) -> tuple[object, ...]:
        """Equal for pieces of one exact surface; a refitted or spline face is equal to itself only."""
        shape = id(self) if self.surface.cells.size > 16 else tuple(np.round(self.surface.p, 9))
        place = (round(v, 6) for v in (self.height, *self.surface.decentration))
        return (self.surface.kind, shape, *place)

    @property
    def bulge(self) -> float:
        """Mean curvature in the middle, 1/mm, positive when the face bulges towards +z."""
        middle = (self.edge.max(axis=0) + self.edge.min(axis=0)) / 2 - self.surface.decentration
        _, _, _, fxx, _, fyy = self.surface.derivatives(*middle)
        return float(-(fxx + fyy) / 2)


class Place(NamedTuple):
    """How a file's coordinates become the lens's: turned by 180 degrees about y, then moved by -x, -y (mm)."""

    turned: bool = False
    x: float = 0.0
    y: float = 0.0


def body_of(path: Path, faces_at: Callable[[Place], list[Face]]) -> Body:
    """The body whose one or two faces a file holds, faces_at a place. Raises InputError.

    The scene lies on the side to which the faces bulge, as both faces of a meniscus do; a file that bulges towards -z is
    turned. The face nearer to the scene is the front; a single face counts as a front.
    """
    found = faces_at(Place())
    turned = sum(face.bulge for face in found) < -1e-6
    words = ["axis along z, the scene on the side of +z, to which the faces bulge"]
    if turned:
        found = faces_at(Place(turned))
        words = ["axis along z; turned by 180 degrees about y, for the faces bulge towards -z"]
    if not all(_outline(face.edge).contains(0.0, 0.0) for face in found):
        edge = np.concatenate([face.edge for face in found])
        x, y = (edge.max(axis=0) + edge.min(axis=0)) / 2
        words.append(f"moved by {-x:.4g}, {-y:.4g} mm: the file's axis does not pass through the lens")
        found = faces_at(Place(turned, float(x), float(y)))
    if len(found) == 1:
        return Body(path, found[0].surface, None, 0.0, (f"one face: {found[0].word}", *words))
    back, front = sorted(found, key=lambda face: face.height)
    if not front.height > back.height:
        raise InputError(f"{path}: the two largest faces do not lie one before the other along z")
    edge = min((front, back), key=lambda face: float(np.prod(np.ptp(face.edge, axis=0)))).edge
    words = [f"front: {front.word}", f"back: {back.word}", *words]
    return Body(path, front.surface, back.surface, front.height - back.height, tuple(words), _outline(edge))


def _outline(edge: Floats) -> Outline:
    """The edge of a face about the middle of its box; the box's ellipse where rays from the middle cut it twice."""
    low, high = edge.min(axis=0), edge.max(axis=0)
    centre = float(low[0] + high[0]) / 2, float(low[1] + high[1]) / 2
    try:
        return polygon_outline(edge, centre)
    except ValueError:
        return ellipse_outline(float(high[0] - low[0]), float(high[1] - low[1]), centre)


def joined(pieces: list[Face]) -> Face:
    """Pieces of one surface, as CAD cuts a ball or a ring along its seam; their edge is the convex hull of all edges."""
    if len(pieces) == 1:
        return pieces[0]
    points = np.concatenate([piece.edge for piece in pieces])
    return replace(pieces[0], area=sum(piece.area for piece in pieces), edge=points[ConvexHull(points).vertices])
