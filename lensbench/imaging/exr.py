"""OpenEXR files of a view: its light, and what the optics know of each pixel, in parts that carry their units."""

import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import __version__
from ..errors import LensBenchError
from ..layers import SeenScene
from ..optics.conventions import VERSION, Status
from .pixels import PixelOptics, pixel_optics


class Part(NamedTuple):
    """A part of the file: its channels and, for each, the array of PixelOptics and its component; unit and meaning."""

    channels: dict[str, tuple[str, int | None]]
    unit: str
    meaning: str


def _xyz(name: str) -> dict[str, tuple[str, int | None]]:
    return {axis: (name, k) for k, axis in enumerate("XYZ")}


PARTS = {
    "depth": Part(
        {"Z": ("distance", None)},
        "mm",
        "from the lens's front surface (naked eye: from the entrance pupil) along the refracted ray to what it meets first",
    ),
    "hit": Part(_xyz("hit"), "mm", "the point that the chief ray meets first"),
    "apparent": Part(_xyz("apparent"), "unit vector", "direction in which the eye looks: the pixel's middle"),
    "refracted": Part(_xyz("refracted"), "unit vector", "direction of the chief ray beyond the lens"),
    "power": Part(
        {"sphere": ("sphere", None), "cylinder": ("cylinder", None), "axis": ("axis", None)},
        "sphere D, cylinder D (minus), axis degrees TABO",
        "as-worn power for an object at the depth",
    ),
    "ellipse": Part(
        {name: (name, None) for name in ("semi_major", "semi_minor", "orientation")},
        "semi_major mm, semi_minor mm, orientation degrees 0 to 180",
        "ellipse of confusion at the hit, across the refracted ray: x and y carried by the least rotation of +z onto it",
    ),
    "eye": Part(
        {name: (name, None) for name in ("accommodation", "residual_mean", "defocus")},
        "accommodation D, residual_mean D, defocus arcmin",
        "accommodation in use, mean defocus after it, rms diameter of the blur that the eye receives",
    ),
    "zone": Part(
        {"through": ("through", None), "status": ("status", None)},
        "1",
        "through: 1 the lens, 0 the naked eye; status of the chief ray: "
        + ", ".join(f"{s.value} {s.name}" for s in Status),
    ),
}
FRAME = (
    "right-handed, mm: +x to the wearer's left, +y up, +z straight ahead; origin on this eye's line of sight straight ahead, "
    "one vertex distance before the cornea"
)


def exr_bytes(light: NDArray[np.float32], seen: SeenScene) -> bytes:
    """The file of a view. light (h, w, 3): linear, Rec. 709 primaries, first row at the top.

    Raises LensBenchError when OpenEXR is not installed.
    """
    try:
        import OpenEXR
    except ModuleNotFoundError:
        raise LensBenchError('OpenEXR files need another package: pip install "lensbench[views]"') from None
    optics = pixel_optics(seen)
    common = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **_facts(seen)}
    view = {"name": "view", "units": "linear light, 1 is white", "meaning": "what the eye sees, blurred", **common}
    parts = [OpenEXR.Part(view, {"RGB": OpenEXR.Channel(np.ascontiguousarray(light, dtype=np.float32))})]
    for name, part in PARTS.items():
        header = {"name": name, "units": part.unit, "meaning": part.meaning, **common}
        channels = {channel: _channel(optics, *source) for channel, source in part.channels.items()}
        parts.append(OpenEXR.Part(header, channels))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "view.exr"
        OpenEXR.File(parts).write(str(path))
        return path.read_bytes()


def _channel(optics: PixelOptics, name: str, component: int | None) -> NDArray[Any]:
    values = getattr(optics, name)
    values = values if component is None else values[..., component]
    return np.ascontiguousarray(values, dtype=np.uint32 if values.dtype == np.uint32 else np.float32)


def _facts(seen: SeenScene) -> dict[str, Any]:
    """What every part's header says of the view."""
    layer = seen.layer
    return {
        "software": f"LensBench {__version__}",
        "conventions": VERSION,
        "frame": FRAME,
        "lens": "none" if seen.lens is None else seen.lens.name,
        "wearer": seen.wearer.name,
        "scene": seen.scene.name,
        "eye": layer.eye,
        "eyePosition": np.array(seen.eye, dtype=np.float32),
        "pictureRight": np.array(-seen.frame[0], dtype=np.float32),
        "pictureUp": np.array(seen.frame[1], dtype=np.float32),
        "pictureAhead": np.array(seen.frame[2], dtype=np.float32),
        "horizontalFieldDegrees": float(2 * np.degrees(layer.half_width)),
        "headTurnDegrees": float(np.degrees(layer.head_turn)),
        "headTiltDegrees": float(np.degrees(layer.head_tilt)),
        "pupilDiameterMm": float(seen.wearer.eye.pupil_diameter),
        "accommodationRule": str(layer.accommodation),
        "noValue": "NaN: no ray passes, or it meets nothing",
    }
