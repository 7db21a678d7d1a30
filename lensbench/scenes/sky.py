"""What lies behind a scene: pictures of all directions (equirectangular), from an OpenEXR file or drawn, as a far sphere."""

from functools import cache
from pathlib import Path

import numpy as np
from PIL import Image

from ..errors import InputError
from ..optics.conventions import Floats
from .drawing import Pixels, encode
from .scene import Part
from .tessellate import WIDEST, Mesh, tessellated

RADIUS = 2e6  # mm: 0.0005 D, beyond everything that stands in a scene
ALL_AHEAD = (-85.0, 85.0)
_FINE = 0.95 * WIDEST  # new points move outwards onto the sphere


def sky_part(
    image: Pixels,
    azimuths: tuple[float, float] = ALL_AHEAD,
    elevations: tuple[float, float] = ALL_AHEAD,
) -> Part:
    """The part of the sky between two azimuths and elevations (degrees), on a sphere about the wear frame's origin.

    image (h, w, 3): equirectangular; its middle column is straight ahead, what is to the left of it lies to the wearer's
    left, both its edges are straight back; its top row is the zenith.
    """
    azimuth, elevation = (np.radians(np.linspace(*ends, 15)) for ends in (azimuths, elevations))
    azimuth, elevation = (a.ravel() for a in np.meshgrid(azimuth, elevation))
    corner = (np.arange(14)[:, None] * 15 + np.arange(14)).ravel()
    right, above, opposite = corner + 1, corner + 15, corner + 16
    triangles = np.concatenate([np.stack([corner, right, opposite], 1), np.stack([corner, opposite, above], 1)])
    angles = np.stack([azimuth, elevation], axis=-1)
    mesh = tessellated(Mesh(_on_sphere(angles), triangles, angles), "sky", _FINE)
    uv = np.stack([0.5 - mesh.values[:, 0] / (2 * np.pi), 0.5 + mesh.values[:, 1] / np.pi], axis=-1)
    return Part("sky", _on_sphere(mesh.values), mesh.triangles, uv, image)


def _on_sphere(angles: Floats) -> Floats:
    """Places (n, 3) of azimuths (towards the wearer's left) and elevations (n, 2), rad."""
    a, e = angles.T
    return RADIUS * np.stack([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)], axis=-1)


def read_environment(path: Path, exposure: float = 0.0) -> Pixels:
    """The picture (h, w, 3), sRGB, of an equirectangular OpenEXR file. exposure: stops; light above 1 is cut off.

    Raises InputError for what is no such picture.
    """
    import OpenEXR

    try:
        with OpenEXR.File(str(path)) as file:
            channels = file.channels()
            light = channels["RGB"].pixels if "RGB" in channels else channels["RGBA"].pixels[..., :3]
    except KeyError:
        raise InputError(f"{path}: holds no channels R, G and B") from None
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as OpenEXR: {error}") from None
    height, width = light.shape[:2]
    if width != 2 * height:
        raise InputError(f"{path}: is {width} x {height}; an equirectangular environment is twice as wide as high")
    return encode(np.nan_to_num(light.astype(np.float32)) * 2.0**exposure)


@cache
def summer_sky(size: int = 1024) -> Pixels:
    """A drawn sky (size / 2, size, 3): blue above, pale at the horizon, fair-weather clouds, fields below."""
    elevation = np.linspace(np.pi / 2, -np.pi / 2, size // 2)[:, None]
    azimuth = np.linspace(-np.pi, np.pi, size, endpoint=False)[None]
    height = np.clip(np.sin(elevation), 0, 1)[..., None]
    blue = np.array([0.16, 0.35, 0.78]) + (np.array([0.78, 0.87, 0.95]) - [0.16, 0.35, 0.78]) * np.exp(-5 * height)
    clouds = _clouds(azimuth, elevation)[..., None]
    above = blue + clouds * (np.array([0.97, 0.97, 0.98]) - blue)
    hills = 0.022 + 0.014 * np.sin(3 * azimuth) + 0.008 * np.sin(11 * azimuth + 1) + 0.004 * np.sin(29 * azimuth)
    land = np.array([0.20, 0.27, 0.19]) + np.clip(elevation / 0.06, 0, 1)[..., None] * [0.16, 0.18, 0.28]
    ground = np.broadcast_to(np.where(elevation[..., None] > 0, land, [0.21, 0.25, 0.13]), above.shape)
    return encode(np.where((elevation < hills)[..., None], ground, above))


def _clouds(azimuth: Floats, elevation: Floats) -> Floats:
    """How much of a cloud stands in each direction (h, w), 0 to 1."""
    chance = np.random.default_rng(21)
    shape = elevation.size, azimuth.size
    total = np.zeros(shape, dtype=np.float32)
    for octave in range(5):
        few = chance.normal(0, 1, (6 * 2**octave, 8 * 2**octave)).astype(np.float32)
        few[:, -1] = few[:, 0]
        layer = Image.fromarray(few, "F").resize((shape[1], shape[0]), Image.Resampling.BICUBIC)
        total += np.asarray(layer) / 1.8**octave
    fade = np.clip(elevation / 0.12, 0, 1)
    return np.clip((total - 0.35) / 1.3, 0, 0.9) * fade
