"""LensBench: what a spectacle lens does before an eye, and what its wearer sees.

    import lensbench as lb
    lens, wearer = lb.load_lens("lens.toml"), lb.load_wearer("wearer.toml")
    field = lb.trace(lens, wearer, lb.GazeGrid(64, 64))
    sphere, cylinder, axis = field.as_worn_power(distance=400.0)

Names are imported when they are first used, so that the command line starts at once.
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOME = {
    "load": "formats",
    "write": "formats",
    "load_lens": "formats",
    "load_pair": "formats",
    "load_wearer": "formats",
    "load_surface": "formats",
    "Reading": "formats.surface_data",
    "Writing": "formats.registry",
    "Lens": "optics.lens",
    "mirrored": "optics.mirror",
    "Wearer": "optics.eye",
    "Eye": "optics.eye",
    "Wear": "optics.eye",
    "GazeGrid": "optics.gaze",
    "GazeField": "optics.field",
    "trace": "optics.gaze",
    "look_at": "optics.gaze",
    "look_through": "optics.gaze",
    "Pair": "optics.binocular",
    "fixate": "optics.binocular",
    "mirrored_wearer": "optics.mirror",
    "swim": "optics.distortion",
    "seen_chart": "optics.distortion",
    "transverse_chromatic_aberration": "optics.chromatic",
    "gauss_pupil": "optics.pupil",
    "vogel_pupil": "optics.pupil",
    "back_vertex_power": "optics.lensmeter",
    "front_vertex_power": "optics.lensmeter",
    "surface_power": "optics.lensmeter",
    "verification": "optics.tolerances",
    "load_tolerances": "formats.tolerance_file",
    "verification_power": "optics.compensation",
    "power_as_worn": "optics.compensation",
    "model_distance": "optics.object_distance",
    "Status": "optics.conventions",
}

__all__ = ["__version__", *_HOME]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'lensbench' has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
