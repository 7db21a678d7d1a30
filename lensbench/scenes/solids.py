"""Solids of the built-in scenes: boxes, bodies of revolution, tubes and extruded outlines, in mm, with outward normals."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..optics.conventions import Floats, rotation_xy, unit


class Solid(NamedTuple):
    """points (n, 3) mm, triangles (m, 3), normals (n, 3); an edge between faces has its points twice."""

    points: Floats
    triangles: NDArray[np.int64]
    normals: Floats

    def placed(self, shift: ArrayLike, about_x: float = 0.0, about_y: float = 0.0) -> "Solid":
        """The solid turned about the origin (degrees, first about x, then about y) and shifted."""
        turn = rotation_xy(np.radians(about_x), np.radians(about_y))
        return Solid(self.points @ turn.T + np.asarray(shift, dtype=float), self.triangles, self.normals @ turn.T)


def join(solids: Sequence[Solid]) -> Solid:
    """Several solids as one."""
    first = np.cumsum([0, *(len(s.points) for s in solids)])
    triangles = np.concatenate([s.triangles + n for s, n in zip(solids, first, strict=False)])
    return Solid(np.concatenate([s.points for s in solids]), triangles, np.concatenate([s.normals for s in solids]))


def _sheet(points: Floats, normals: Floats) -> Solid:
    """A grid of points (rows, columns, 3), two triangles a cell."""
    rows, columns = points.shape[:2]
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    right, above, opposite = corner + 1, corner + columns, corner + columns + 1
    triangles = np.concatenate([np.stack([corner, right, opposite], 1), np.stack([corner, opposite, above], 1)])
    return Solid(points.reshape(-1, 3), triangles, np.broadcast_to(normals, points.shape).reshape(-1, 3))


def box(centre: ArrayLike, size: ArrayLike, without: str = "") -> Solid:
    """A box along the axes. size: whole edges, mm. without: a face that is left out, such as "+y"."""
    half, faces = np.asarray(size, dtype=float) / 2, []
    for axis in range(3):
        for side in (-1.0, 1.0):
            if without == f"{'-' if side < 0 else '+'}{'xyz'[axis]}":
                continue
            normal, a, b = np.zeros((3, 3))
            normal[axis], a[(axis + 1) % 3], b[(axis + 2) % 3] = side, 1.0, 1.0
            grid = np.array([[normal - a - b, normal + a - b], [normal - a + b, normal + a + b]])
            faces.append(_sheet(np.asarray(centre, dtype=float) + half * grid, normal))
    return join(faces)


def turned(profile: ArrayLike, sides: int = 32, smooth: bool = False) -> Solid:
    """A body of revolution about y. profile (k, 2): radius and height, mm, upwards on the outside; corners stay sharp
    unless smooth."""
    outline = np.asarray(profile, dtype=float)
    along = np.diff(outline, axis=0)
    across = unit(np.stack([along[:, 1], -along[:, 0]], axis=-1))
    if smooth:
        rims = unit(np.vstack([across[:1], across[1:] + across[:-1], across[-1:]]))
        return _revolved(outline, rims, sides)
    return join([_revolved(outline[k : k + 2], across[[k, k]], sides) for k in range(len(across))])


def _revolved(outline: Floats, normals: Floats, sides: int) -> Solid:
    turn = np.linspace(0, 2 * np.pi, sides + 1)

    def around(pairs: Floats) -> Floats:
        r, y = pairs[:, :1], pairs[:, 1:]
        return np.stack([r * np.cos(turn), np.broadcast_to(y, (len(pairs), sides + 1)), r * np.sin(turn)], axis=-1)

    return _sheet(around(outline), around(normals))


def cylinder(foot: ArrayLike, radius: float, height: float, sides: int = 24) -> Solid:
    """An upright cylinder on the middle of its foot."""
    return turned([(0, 0), (radius, 0), (radius, height), (0, height)], sides).placed(foot)


def tube(path: ArrayLike, radius: float, sides: int = 12, closed: bool = False) -> Solid:
    """A round bar along a path (k, 3), mm; closed: its end is its beginning (a ring's path makes a torus)."""
    line = np.asarray(path, dtype=float)
    line = np.vstack([line, line[:1]]) if closed else line
    step = np.diff(line, axis=0)
    along = unit(np.vstack([step[:1] + (step[-1:] if closed else 0), step[1:] + step[:-1], step[-1:]]))
    along[-1] = along[0] if closed else along[-1]
    odd = np.eye(3)[np.argmin(np.abs(along).max(axis=0))]
    first = unit(np.cross(along, odd))
    second = np.cross(along, first)
    turn = np.linspace(0, 2 * np.pi, sides + 1)[:, None]
    normals = np.cos(turn) * first[:, None] + np.sin(turn) * second[:, None]
    return _sheet(line[:, None] + radius * normals, normals)


def ring(centre: ArrayLike, radius: float, sides: int = 64) -> Floats:
    """A circle (sides, 3) about z, mm: the path of a ring."""
    turn = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    flat = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros_like(turn)], axis=-1)
    return np.asarray(centre, dtype=float) + flat


def athwart(outline: ArrayLike, left: float, right: float) -> Solid:
    """An outline (k, 2) in z and y, anticlockwise and star-shaped about its mean, from x = left to x = right."""
    solid = extruded(outline, right - left)
    return Solid(solid.points[:, [2, 1, 0]] + [left, 0.0, 0.0], solid.triangles, solid.normals[:, [2, 1, 0]])


def extruded(outline: ArrayLike, depth: float) -> Solid:
    """An outline (k, 2) in x and y, anticlockwise and star-shaped about its mean, from z = 0 to `depth`."""
    o = np.asarray(outline, dtype=float)
    k, ahead = len(o), np.array([0.0, 0.0, 1.0])
    faces = []
    for z, normal in ((0.0, -ahead), (depth, ahead)):
        points = np.column_stack([np.vstack([o, o.mean(axis=0)]), np.full(k + 1, z)])
        fan = np.stack([np.arange(k), (np.arange(k) + 1) % k, np.full(k, k)], axis=-1)
        faces.append(Solid(points, fan, np.broadcast_to(normal, points.shape)))
    for a, b in zip(o, np.roll(o, -1, axis=0), strict=True):
        side = np.array([[[*a, 0], [*b, 0]], [[*a, depth], [*b, depth]]])
        faces.append(_sheet(side, unit([b[1] - a[1], a[0] - b[0], 0.0])))
    return join(faces)
