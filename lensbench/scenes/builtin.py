"""The built-in scenes by name. Each is built when it is first asked for, and kept."""

import difflib
from functools import cache
from importlib import import_module

from ..errors import InputError
from .scene import Scene

SCENES = ("room", "desk", "cockpit", "chart", "stairs")


@cache
def load_scene(name: str) -> Scene:
    """The built-in scene of that name. Raises InputError when there is none."""
    if name not in SCENES:
        near = difflib.get_close_matches(name, SCENES, 1)
        hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(SCENES)}"
        raise InputError(f"unknown scene {name!r}: {hint}")
    scene: Scene = getattr(import_module(f".{name}", __package__), name)()
    return scene
