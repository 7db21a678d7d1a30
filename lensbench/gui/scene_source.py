"""Requests that may need the scene on the table, which is loaded once, in the lane: textures take their time."""

from functools import lru_cache
from typing import Any

from ..formats.scene_file import find_scene
from ..layers import Layer, Request
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..scenes.scene import Scene
from ..workbench import run


@lru_cache(maxsize=4)
def scene_named(name: str) -> Scene:
    """A built-in scene or a scene file. Raises InputError."""
    return find_scene(name)


def answer_with_scene(lens: Lens | None, wearer: Wearer, layer: Layer, scene: str) -> Any:
    """Answer a request; scene "": it needs none. Raises InputError."""
    return run(Request(lens, wearer, layer, scene_named(scene) if scene else None))
