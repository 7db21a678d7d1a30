"""A scene: textured triangle meshes, what there is to look at in it, and the sky behind.

A scene's frame is the wear frame of an eye on the face's midline; `moved` puts it before the right or the left eye.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..optics.conventions import ReadOnlyArrays
from .tessellate import Mesh, tessellated


@dataclass(frozen=True, slots=True, eq=False)
class Part(ReadOnlyArrays):
    """One object. points (n, 3): mm, wear frame. triangles (m, 3): int. uv (n, 2): (0, 0) is the image's lower left corner.

    image (h, w, 3): uint8 sRGB, first row at the top.
    """

    name: str
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    uv: NDArray[np.float64]
    image: NDArray[np.uint8]


CORNEA = np.array([0.0, 0.0, -13.0])  # mm, wear frame: where the corneas stand at the usual vertex distance


class Look(NamedTuple):
    """Something to look at: its place (x, y, z) in mm, wear frame, and the part that is met there."""

    target: tuple[float, float, float]
    part: str

    @classmethod
    def at(cls, place: ArrayLike, part: str = "") -> "Look":
        """A look at a place (3,)."""
        x, y, z = np.asarray(place, dtype=float)
        return cls((float(x), float(y), float(z)), part)

    @property
    def distance(self) -> float:
        """Distance from the cornea, mm."""
        return float(np.linalg.norm(np.array(self.target) - CORNEA))


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What stands before the wearer. background: sRGB 0 to 255 where nothing stands. looks: by name, the first is the usual.

    sky: drawn behind everything; it is far beyond all objects, and no ray meets it.
    """

    name: str
    parts: tuple[Part, ...]
    background: tuple[int, int, int] = (200, 208, 216)
    looks: Mapping[str, Look] = field(default_factory=dict)
    sky: Part | None = None
    about: str = ""

    @property
    def drawn(self) -> tuple[Part, ...]:
        """All that a picture shows: the parts and the sky."""
        return self.parts if self.sky is None else (*self.parts, self.sky)

    def moved(self, x: float) -> "Scene":
        """The scene moved by x mm towards the wearer's left; the sky stays."""
        step = np.array([x, 0.0, 0.0])
        looks = {name: Look((k.target[0] + x, *k.target[1:]), k.part) for name, k in self.looks.items()}
        return replace(self, parts=tuple(replace(p, points=p.points + step) for p in self.parts), looks=looks)


def rectangle(name: str, centre: ArrayLike, across: ArrayLike, upward: ArrayLike, image: NDArray[np.uint8]) -> Part:
    """A textured rectangle, tessellated. centre, and half edges across (to the image's right) and upward: (3,) mm."""
    c, a, b = (np.asarray(v, dtype=float) for v in (centre, across, upward))
    uv = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    corners = Mesh(np.stack([c - a - b, c + a - b, c + a + b, c - a + b]), np.array([[0, 1, 2], [0, 2, 3]]), uv)
    return Part(name, *tessellated(corners, name), image)
