"""What the optics know of each pixel of a view: its chief ray, the point that this meets, power, blur and accommodation."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ..layers import SeenScene
from ..optics.conventions import Floats, ReadOnlyArrays, mean_power, sphere_cylinder_axis
from ..optics.field import GazeField, ellipse
from ..optics.gaze import trace
from ..optics.lens import Lens
from ..scenes.cast import first_hit
from ..seen import pixel_directions, right_half

_CHUNK = 65536  # pixels at a time: 100 MB


@dataclass(frozen=True, slots=True, eq=False)
class PixelOptics(ReadOnlyArrays):
    """Arrays (h, w) and (h, w, 3), first row at the top; NaN where no ray passes, or where it meets nothing.

    through (h, w): 1 where the lens is seen, 0 past its edge and without a lens. status (h, w): Status of the chief ray.
    distance: mm from the lens's front surface (naked eye: from the entrance pupil) along the ray. hit: mm. apparent: unit,
    the gaze. refracted: unit, the ray into the scene. hit and directions: the scene's frame, which is the wear frame of this
    eye with its head straight. sphere, cylinder D, axis degrees TABO: as worn at that distance. semi_major, semi_minor mm,
    orientation degrees 0 to 180: ellipse of confusion there, in the frame across the outgoing ray. accommodation in use,
    residual_mean defocus after it: D. defocus: rms blur diameter, arcmin.
    """

    through: NDArray[np.uint32]
    status: NDArray[np.uint32]
    distance: Floats
    hit: Floats
    apparent: Floats
    refracted: Floats
    sphere: Floats
    cylinder: Floats
    axis: Floats
    semi_major: Floats
    semi_minor: Floats
    orientation: Floats
    accommodation: Floats
    residual_mean: Floats
    defocus: Floats


def pixel_optics(seen: SeenScene) -> PixelOptics:
    """The optics in the middle of each pixel of a view."""
    width, height = seen.layer.size
    gaze = pixel_directions(seen.layer).reshape(-1, 3) @ seen.frame @ seen.head
    inside = np.full(len(gaze), seen.lens is not None)
    if seen.edge is not None:
        inside = seen.edge.within(gaze)
    if seen.layer.split:
        inside &= np.tile(right_half(width), height)
    arrays = {f.name: np.full((len(gaze), *_WIDE.get(f.name, ())), np.nan) for f in fields(PixelOptics)}
    arrays["through"], arrays["status"] = inside.astype(np.uint32), np.zeros(len(gaze), dtype=np.uint32)
    for lens, where in ((seen.lens, inside), (None, ~inside)):
        places = np.flatnonzero(where)
        for first in range(0, places.size, _CHUNK):
            some = places[first : first + _CHUNK]
            for name, values in _along(seen, lens, gaze[some]).items():
                arrays[name][some] = values
    return PixelOptics(**{name: a.reshape(height, width, *a.shape[1:]) for name, a in arrays.items()})


_WIDE = {"hit": (3,), "apparent": (3,), "refracted": (3,)}


def _along(seen: SeenScene, lens: Lens | None, gaze: Floats) -> dict[str, NDArray[np.generic]]:
    """The values for chief rays at gazes (n, 3) in the head's frame."""
    field = trace(lens, seen.wearer, gaze)
    start = (field.origin - seen.eye) @ seen.head.T + seen.eye
    ray = field.direction @ seen.head.T
    found = first_hit(seen.scene, start, ray)
    distance = np.where(np.isfinite(found), found, np.nan)
    return {
        "status": field.status.astype(np.uint32),
        "distance": distance,
        "hit": start + distance[:, None] * ray,
        "apparent": field.directions @ seen.head.T,
        "refracted": ray,
        **_at(field, distance, seen),
    }


def _at(field: GazeField, distance: Floats, seen: SeenScene) -> dict[str, Floats]:
    """Power, blur and accommodation for objects at distances (n,), NaN where there is none."""
    rule, spread = seen.layer.accommodation, 0.0 if seen.layer.sharp else 1.0
    power = sphere_cylinder_axis(field.as_worn_matrix(distance))
    used = field.accommodation(distance, rule)
    shape = ellipse(field.blur(distance, used))
    return {
        "sphere": power.sphere,
        "cylinder": power.cylinder,
        "axis": np.where(np.isfinite(power.sphere), power.axis, np.nan),
        "semi_major": spread * shape.semi_major,
        "semi_minor": spread * shape.semi_minor,
        "orientation": np.degrees(shape.orientation),
        "accommodation": used,
        "residual_mean": mean_power(field.residual_defocus(distance, used)),
        "defocus": spread * np.degrees(field.defocus(distance, used)) * 60,
    }
