"""Adaptive tessellation: triangles are split until the eye sees none of their edges wider than an angle.

A picture is refracted and blurred at its vertices, and drawn straight between them. Where the gaze turns by g(x) for a point
seen at the angle x, an edge of the angle e is drawn wrong by at most |g''| e^2 / 8 in its middle. An edge is split or not
by its two ends alone, so neighbours split alike: no cracks, not even between parts or along the seam of a texture.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..optics.conventions import Floats

WIDEST = float(np.radians(2.0))
MOST_TRIANGLES = 400_000
_BEHIND = -0.5  # cosine: an edge within 60 degrees of straight back is never seen, however the head turns


class Mesh(NamedTuple):
    """points (n, 3) mm, wear frame; triangles (m, 3); values (n, k): what varies linearly over them, such as uv."""

    points: Floats
    triangles: NDArray[np.int64]
    values: Floats


def tessellated(mesh: Mesh, name: str, widest: float = WIDEST, most: int = MOST_TRIANGLES) -> Mesh:
    """The mesh with no edge wider than `widest` (rad) seen from the origin of the wear frame; values keep their places.

    Raises InputError, which calls the mesh by its name, when that takes more than `most` triangles.
    """
    points, triangles, values = mesh
    while (wide := _too_wide(points, triangles, widest)).any():
        if triangles.shape[0] + 1.5 * wide.sum() > most:
            raise InputError(
                f"{name}: more than {most} triangles are needed for edges below {np.degrees(widest):g} degrees: "
                "simplify the mesh, or move the eye away from its surface"
            )
        ends, middle = _middles(triangles, wide, len(points))
        points, values = (np.concatenate([a, (a[ends[:, 0]] + a[ends[:, 1]]) / 2]) for a in (points, values))
        triangles = _split(triangles, middle, points)
    return Mesh(points, triangles, values)


def edge_angles(points: Floats, triangles: NDArray[np.int64]) -> Floats:
    """Angles (m, 3), rad, at which the origin sees the edges of triangles (m, 3): from corner 0 to 1, 1 to 2, 2 to 0."""
    seen = _directions(points)[triangles]
    return 2 * np.arcsin(np.clip(np.linalg.norm(seen - np.roll(seen, -1, axis=1), axis=2) / 2, 0, 1))


def _directions(points: Floats) -> Floats:
    length = np.linalg.norm(points, axis=1, keepdims=True)
    return points / np.where(length == 0, 1.0, length)


def _too_wide(points: Floats, triangles: NDArray[np.int64], widest: float) -> NDArray[np.bool_]:
    """Which edges (m, 3) are wider than `widest` and not wholly behind the head."""
    behind = (_directions(points)[:, 2] < _BEHIND)[triangles]
    return (edge_angles(points, triangles) > widest) & ~(behind & np.roll(behind, -1, axis=1))


def _middles(
    triangles: NDArray[np.int64], wide: NDArray[np.bool_], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Ends (k, 2) of the wide edges, each once, and the number (m, 3) of the new point in their middle, -1 for none."""
    pairs = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1)[wide], axis=1)
    code, which = np.unique(pairs[:, 0] * count + pairs[:, 1], return_inverse=True)
    middle = np.full(triangles.shape, -1)
    middle[wide] = count + which
    return np.stack([code // count, code % count], axis=-1), middle


def _split(triangles: NDArray[np.int64], middle: NDArray[np.int64], points: Floats) -> NDArray[np.int64]:
    """Triangles divided at the middles (m, 3) of their edges into two, three or four."""
    cut = middle >= 0
    number = cut.sum(axis=1)
    first = np.where(number == 2, (np.argmin(cut, axis=1) + 1) % 3, np.argmax(cut, axis=1))
    turn = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, turn, axis=1).T
    ab, bc, ca = np.take_along_axis(middle, turn, axis=1).T
    one, two, three = number == 1, number == 2, number == 3
    short = np.linalg.norm(points[a] - points[bc], axis=1) < np.linalg.norm(points[ab] - points[c], axis=1)
    near, far = two & short, two & ~short
    pieces = [
        (number == 0, a, b, c),
        (one, a, ab, c), (one, ab, b, c),
        (two, ab, b, bc), (near, a, ab, bc), (near, a, bc, c), (far, a, ab, c), (far, ab, bc, c),
        (three, a, ab, ca), (three, ab, b, bc), (three, ca, bc, c), (three, ab, bc, ca),
    ]  # fmt: skip
    return np.concatenate([np.stack(corners, axis=-1)[where] for where, *corners in pieces])
