"""A lens's body as CAD, mesh and design files hold it: two surfaces and their distance, without material and side."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from ..errors import InputError
from ..optics.conventions import Floats
from ..optics.lens import Lens, Outline, circle_outline, ellipse_outline, polygon_outline
from ..optics.materials import Material
from ..optics.surfaces import Surface

USUAL_DIAMETER = 60.0


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """front, back: None where the file holds one surface only; centre_thickness: mm; outline: None if the file has none.

    understood: how the file was read, a line each.
    """

    front: Surface | None
    back: Surface | None
    centre_thickness: float
    outline: Outline | None
    understood: tuple[str, ...]
    material: Material | None = None

    def lens(self, path: Path, material: Material | None = None, side: str = "R") -> Lens:
        """The lens of a material (which wins over the file's own) and a side. Raises InputError for what is missing."""
        from .lens_file import check_body

        if self.front is None or self.back is None:
            held = "front" if self.back is None else "back"
            raise InputError(
                f"{path}: holds one surface, taken for the {held}; a lens needs two: name it in a lens file"
            )
        chosen = material or self.material
        if chosen is None:
            raise InputError(f"{path}: says nothing of the material; name one (--material MR-8)")
        outline = self.outline or circle_outline(USUAL_DIAMETER)
        lens = Lens(self.front, self.back, self.centre_thickness, chosen, outline, side, name=path.stem)
        check_body(path, lens)
        return lens

    def surface(self, name: str, path: Path) -> Surface:
        """The surface called "front" or "back"; a file of one surface gives that. Raises InputError."""
        found = self.front if name == "front" else self.back
        found = found or self.front or self.back
        if found is None:
            raise InputError(f"{path}: holds no surface")
        return replace(found)


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
        return Body(found[0].surface, None, 0.0, _outline(found[0].edge), (f"one face: {found[0].word}", *words))
    back, front = sorted(found, key=lambda face: face.height)
    if not front.height > back.height:
        raise InputError(f"{path}: the two largest faces do not lie one before the other along z")
    edge = min((front, back), key=lambda face: float(np.prod(np.ptp(face.edge, axis=0)))).edge
    words = [f"front: {front.word}", f"back: {back.word}", *words]
    return Body(front.surface, back.surface, front.height - back.height, _outline(edge), tuple(words))


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
