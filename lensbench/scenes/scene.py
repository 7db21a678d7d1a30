"""A scene: textured triangle meshes in the wear frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Part:
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
