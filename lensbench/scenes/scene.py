"""A scene: textured triangle meshes, and the rectangle of which scenes are built.

A scene's frame is the wear frame of an eye on the face's midline; `moved` puts it before the right or the left eye.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..optics.conventions import Floats, ReadOnlyArrays, unit

FINEST = float(np.radians(1.05))


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


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What stands before the wearer. background: sRGB 0 to 255 where nothing stands."""

    name: str
    parts: tuple[Part, ...]
    background: tuple[int, int, int] = (200, 208, 216)

    def moved(self, x: float) -> "Scene":
        """The scene moved by x mm towards the wearer's left."""
        step = np.array([x, 0.0, 0.0])
        return replace(self, parts=tuple(replace(p, points=p.points + step) for p in self.parts))


def rectangle(name: str, centre: ArrayLike, across: ArrayLike, upward: ArrayLike, image: NDArray[np.uint8]) -> Part:
    """A textured rectangle, divided so that no side of a cell is wider than 1.05 degrees seen from the lens.

    centre, and half edges across (to the image's right) and upward: (3,) mm, wear frame. Its diagonals stay below 2 degrees.
    """
    c, a, b = (np.asarray(v, dtype=float) for v in (centre, across, upward))
    s, t = _nodes(c, a, b), _nodes(c, b, a)
    u, v = (g.ravel() for g in np.meshgrid(s, t))
    points = c + u[:, None] * a + v[:, None] * b
    corner = (np.arange(t.size - 1)[:, None] * s.size + np.arange(s.size - 1)).ravel()
    right, above, opposite = corner + 1, corner + s.size, corner + s.size + 1
    triangles = np.concatenate([np.stack([corner, right, opposite], 1), np.stack([corner, opposite, above], 1)])
    return Part(name, points, triangles, np.stack([u + 1, v + 1], axis=-1) / 2, image)


def _nodes(centre: Floats, along: Floats, other: Floats) -> Floats:
    """Parameters in [-1, 1] along one edge, whose steps are at most FINEST wide anywhere across the rectangle."""
    fine = np.linspace(-1, 1, 401)
    seen = unit(centre + fine[:, None, None] * along + np.linspace(-1, 1, 41)[:, None] * other)
    step = np.linalg.norm(np.diff(seen, axis=0), axis=2).max(axis=1)
    turned = np.concatenate([[0.0], np.cumsum(step)])
    count = int(np.ceil(turned[-1] / FINEST))
    return np.interp(np.linspace(0, turned[-1], count + 1), turned, fine)
