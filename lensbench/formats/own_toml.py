"""LensBench's own TOML files: the key `format` says which kind one is."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..scenes.scene import Scene
from .lens_file import build_lens
from .lens_writer import write
from .toml_file import read_toml
from .wearer_file import build_wearer

__all__ = ["read", "sniff", "write"]

LENS_FORMAT, WEARER_FORMAT, SCENE_FORMAT = "lensbench-lens/1", "lensbench-wearer/1", "lensbench-scene/1"


def _scene(path: Path, data: dict[str, Any]) -> Scene:
    from .scene_file import scene_of_tables

    return scene_of_tables(path, data)


READERS: dict[str, Callable[[Path, dict[str, Any]], Lens | Wearer | Scene]] = {
    LENS_FORMAT: build_lens,
    WEARER_FORMAT: build_wearer,
    SCENE_FORMAT: _scene,
}


def sniff(head: bytes, text: str) -> float:
    """Certain where the key `format` names one of ours."""
    return 1.0 if re.search(r'^\s*format\s*=\s*["\']lensbench-', text, re.MULTILINE) else 0.0


def read(path: Path) -> tuple[Lens | Wearer | Scene]:
    """The lens, the wearer or the scene. Raises InputError."""
    data = read_toml(path)
    reader = READERS.get(str(data.get("format")))
    if reader is None:
        raise InputError(f"{path}: format: {data.get('format')!r} is not known; write one of {', '.join(READERS)}")
    return (reader(path, data),)
