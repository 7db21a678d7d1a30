"""Which point of a scene a ray meets first, by Embree."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..optics.conventions import Floats
from .scene import Scene


class Caster:
    """Meshes (points (n, 3) mm, triangles (m, 3)) ready for rays. Embree computes in single precision."""

    def __init__(self, meshes: Sequence[tuple[Floats, NDArray[np.int64]]]) -> None:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        self._scene = EmbreeScene()
        for points, triangles in meshes:
            TriangleMesh(self._scene, points.astype(np.float32), triangles.astype(np.int32))

    def distances(self, start: Floats, along: Floats) -> Floats:
        """Distance (n,), mm, along rays from start (n, 3) in unit directions (n, 3) to what they meet; inf for nothing."""
        hit = self._scene.run(start.astype(np.float32), along.astype(np.float32), output=1)
        return np.where(hit["primID"] >= 0, hit["tfar"].astype(float), np.inf)


def first_hit(scene: Scene, origin: ArrayLike, direction: ArrayLike) -> Floats:
    """Distance (n,) in mm along each ray to the scene's first surface: inf where it meets none, NaN for a NaN ray.

    origin (n, 3): mm, wear frame. direction (n, 3): wear frame, any length. Precision: about 1e-6 of the distance.
    """
    start, along = np.broadcast_arrays(np.asarray(origin, dtype=float), np.asarray(direction, dtype=float))
    distance = np.full(len(start), np.nan)
    known = np.isfinite(start).all(axis=1) & np.isfinite(along).all(axis=1)
    if known.any():
        length = np.linalg.norm(along[known], axis=1, keepdims=True)
        distance[known] = _caster(scene).distances(start[known], along[known] / length)
    return distance


@lru_cache(maxsize=4)
def _caster(scene: Scene) -> Caster:
    return Caster([(part.points, part.triangles) for part in scene.parts])
