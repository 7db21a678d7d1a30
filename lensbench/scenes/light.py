"""Light baked into the built-in scenes: what of the sky, the lamps and the sun reaches a point of a surface.

Nothing is lit when a picture is drawn: each surface carries its light in its texture. Rays are cast with Embree.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..optics.conventions import Floats, listing_frame, unit
from .cast import Caster

_SPOTS = np.array([[x, y] for y in (-0.67, 0.0, 0.67) for x in (-0.67, 0.0, 0.67)])
_RAYS = 48


class Lamp(NamedTuple):
    """A shining rectangle: centre, half edges across and upward (3,) mm; it shines to the side of across x upward.

    strength: light on a surface 1 m before its middle.
    """

    centre: tuple[float, float, float]
    across: tuple[float, float, float]
    upward: tuple[float, float, float]
    strength: float


@dataclass(frozen=True, slots=True)
class Lights:
    """ambient: light from all around, of which what stands within `reach` mm takes its share. Light of 1 shows a texture
    as it is drawn. sun: direction towards it and strength."""

    ambient: float = 0.6
    reach: float = 600.0
    lamps: tuple[Lamp, ...] = ()
    sun: tuple[tuple[float, float, float], float] | None = None

    def on(self, points: Floats, normals: Floats, caster: Caster) -> NDArray[np.float32]:
        """Light (n,) on points (n, 3) mm with unit normals (n, 3)."""
        start = points + 1.5 * normals
        total = self.ambient * (0.8 + 0.2 * normals[:, 1]) * self._openness(start, normals, caster)
        for lamp in self.lamps:
            total += _lamp_light(lamp, start, normals, caster)
        if self.sun is not None:
            total += _sun_light(*self.sun, start, normals, caster)
        return total.astype(np.float32)

    def _openness(self, start: Floats, normals: Floats, caster: Caster) -> Floats:
        """How free (n,) a point is of what stands about it, 0 to 1, over rays of equal weight in the cosine law."""
        k = np.arange(_RAYS)
        radius, turn = np.sqrt((k + 0.5) / _RAYS), k * np.pi * (3 - np.sqrt(5))
        local = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - radius**2)], axis=-1)
        rays = local @ _frames(normals)
        return 0.3 + 0.7 * np.minimum(_cast(caster, start, rays) / self.reach, 1.0).mean(axis=1)


def _frames(normals: Floats) -> Floats:
    """Frames (n, 3, 3) whose third row is the normal."""
    back = normals[:, 2] < 0
    frames = listing_frame(np.where(back[:, None], -normals, normals))
    return np.where(back[:, None, None], -frames, frames)


def _cast(caster: Caster, start: Floats, rays: Floats) -> Floats:
    """Distances (n, k) along rays (n, k, 3) from n starts."""
    n, k = rays.shape[:2]
    return caster.distances(np.repeat(start, k, axis=0), rays.reshape(-1, 3)).reshape(n, k)


def _lamp_light(lamp: Lamp, start: Floats, normals: Floats, caster: Caster) -> Floats:
    centre, across, upward = (np.array(v) for v in lamp[:3])
    spots = centre + _SPOTS[:, :1] * across + _SPOTS[:, 1:] * upward
    line = spots - start[:, None]
    distance = np.linalg.norm(line, axis=2)
    rays = line / distance[..., None]
    cosine = np.einsum("nkj,nj->nk", rays, normals)
    leaving = -rays @ unit(np.cross(across, upward))
    given = np.maximum(cosine, 0) * np.maximum(leaving, 0) / (distance / 1000) ** 2
    lit = np.nonzero(given)
    given[lit] *= caster.distances(start[lit[0]], rays[lit]) > distance[lit] - 5.0
    return lamp.strength * given.mean(axis=1)


def _sun_light(
    towards: tuple[float, float, float], strength: float, start: Floats, normals: Floats, caster: Caster
) -> Floats:
    rays = unit(unit(towards) + 0.02 * np.column_stack([_SPOTS, 0 * _SPOTS[:, 0]]))
    light = np.maximum(normals @ unit(towards), 0)
    lit = np.flatnonzero(light)
    open_sky = np.isinf(_cast(caster, start[lit], np.broadcast_to(rays, (lit.size, *rays.shape))))
    light[lit] *= open_sky.mean(axis=1)
    return strength * light
