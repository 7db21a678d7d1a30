"""Whatever file somebody drops on the window."""

from dataclasses import replace
from pathlib import Path

from ..errors import InputError
from ..formats import read_file
from ..formats.scene_file import KINDS as MESHES
from ..optics.eye import Wearer
from ..scenes.scene import Scene
from ..session import Workbench


def opened(path: Path, bench: Workbench) -> Workbench:
    """The workbench with what the file holds: a wearer, a scene, or else a lens. Raises InputError."""
    try:
        items = read_file(path).items
    except InputError:
        if path.suffix.lower() in MESHES:
            raise InputError(
                f"{path}: neither a lens; as a scene it needs a scene file that says its unit and place"
            ) from None
        raise
    if isinstance(items[0], Wearer):
        return bench.with_wearer(items[0])
    if isinstance(items[0], Scene):
        return replace(bench, scene=str(path.absolute()))
    return bench.with_lens(path)
