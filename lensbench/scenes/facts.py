"""What there is to say in numbers about a scene."""

from typing import Any

import numpy as np

from .scene import Scene
from .tessellate import edge_angles


def scene_facts(scene: Scene) -> dict[str, Any]:
    """Name, looks (distance from the cornea mm; elevation, azimuth towards the wearer's left, degrees), triangles, widest
    edge (degrees) of what stands before the eye. Angles are those from the frame's origin, on the face's midline.
    """
    looks = {}
    for name, look in scene.looks.items():
        x, y, z = look.target
        looks[name] = {
            "distance": look.distance,
            "elevation": float(np.degrees(np.arctan2(y, np.hypot(x, z)))),
            "azimuth": float(np.degrees(np.arctan2(x, z))),
        }
    return {
        "name": scene.name,
        "about": scene.about,
        "looks": looks,
        "triangles": sum(len(part.triangles) for part in scene.drawn),
        "widest_edge": float(np.degrees(max((_widest(part) for part in scene.drawn), default=0.0))),
    }


def _widest(part: Any) -> float:
    ahead = (part.points[:, 2] > 0)[part.triangles].all(axis=1)
    return float(edge_angles(part.points, part.triangles[ahead]).max(initial=0.0))
