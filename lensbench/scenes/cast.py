"""Which point of a scene a ray meets first, by Embree."""

import numpy as np
from numpy.typing import ArrayLike

from ..optics.conventions import Floats
from .scene import Scene


def first_hit(scene: Scene, origin: ArrayLike, direction: ArrayLike) -> Floats:
    """Distance (n,) in mm along each ray to the scene's first surface: inf where it meets none, NaN for a NaN ray.

    origin (n, 3): mm, wear frame. direction (n, 3): wear frame, any length. Embree computes in single precision: about
    1e-6 of the distance.
    """
    start, along = np.broadcast_arrays(np.asarray(origin, dtype=float), np.asarray(direction, dtype=float))
    distance = np.full(len(start), np.nan)
    known = np.isfinite(start).all(axis=1) & np.isfinite(along).all(axis=1)
    if known.any():
        length = np.linalg.norm(along[known], axis=1, keepdims=True)
        distance[known] = _cast(scene, start[known], along[known] / length)
    return distance


def _cast(scene: Scene, start: Floats, along: Floats) -> Floats:
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    embree = EmbreeScene()
    for part in scene.parts:
        TriangleMesh(embree, part.points.astype(np.float32), part.triangles.astype(np.int32))
    hit = embree.run(start.astype(np.float32), along.astype(np.float32), output=1)
    return np.where(hit["primID"] >= 0, hit["tfar"].astype(float), np.inf)
