"""Scenes of the user's own: a mesh with the wearer's place in it, or a scene file, format "lensbench-scene/1"."""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from ..errors import InputError
from ..scenes.build import build_scene
from ..scenes.builtin import load_scene
from ..scenes.light import Lights
from ..scenes.mesh_file import KINDS, Placing, read_meshes
from ..scenes.scene import Look, Scene
from ..scenes.sky import read_environment, sky_part
from .toml_file import Table, read_toml, validated

Triple = Annotated[tuple[float, float, float], Field(strict=False)]
Code = Annotated[int, Field(ge=0, le=255)]


class EnvironmentTable(Table):
    """An equirectangular OpenEXR picture beside the scene file. exposure: stops; heading: degrees to the wearer's right."""

    file: str
    exposure: float = Field(0.0, ge=-20, le=20)
    heading: float = Field(0.0, ge=-360, le=360)


class SceneTable(Table):
    """The whole file. meshes: files beside it, in `unit`; eye, ahead, up, looks: in the meshes' coordinates.

    Without meshes there is only the environment.
    """

    format: Literal["lensbench-scene/1"]
    name: str = ""
    meshes: list[str] = Field(default_factory=list)
    unit: Literal["mm", "cm", "m", "in", "ft"]
    eye: Triple
    ahead: Triple
    up: Triple = (0.0, 1.0, 0.0)
    background: Annotated[tuple[Code, Code, Code], Field(strict=False)] = (200, 208, 216)
    environment: EnvironmentTable | None = None
    looks: dict[str, Triple] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _something_to_see(self) -> "SceneTable":
        if not self.meshes and self.environment is None:
            raise ValueError("give meshes, or an environment")
        return self


def find_scene(name: str, unit: str | None = None, **place: tuple[float, float, float] | None) -> Scene:
    """The scene that a name means: a built-in one, a scene file, or a mesh file with unit and place (eye, ahead, up).

    Raises InputError.
    """
    path = Path(name)
    if path.suffix.lower() not in (".toml", *KINDS):
        return load_scene(name)
    given = {key: value for key, value in place.items() if value is not None}
    if path.suffix.lower() == ".toml":
        if given or unit:
            raise InputError(f"{path}: a scene file says its unit and the wearer's place itself")
        return scene_of_tables(path, read_toml(path))
    if unit is None and path.suffix.lower() in (".glb", ".gltf"):
        unit = "m"
    if unit is None or not {"eye", "ahead"} <= given.keys():
        raise InputError(
            f"{path}: a mesh needs its unit and the wearer's place, in the mesh's coordinates: --scene-unit m "
            "--scene-eye X Y Z --scene-ahead X Y Z"
        )
    placing = Placing(unit, **given)
    return _scene(path.stem, read_meshes(path, placing), {}, path)


def scene_of_tables(path: Path, data: dict[str, Any]) -> Scene:
    """The scene of a scene file's tables. Raises InputError."""
    table = validated(path, data, SceneTable)
    placing = Placing(table.unit, table.eye, table.ahead, table.up)
    pieces: list[Any] = []
    for k, name in enumerate(table.meshes):
        pieces += read_meshes(_beside(path, f"meshes[{k}]", name), placing)
    looks = {name: Look.at(placing.points([target])[0]) for name, target in table.looks.items()}
    more: dict[str, Any] = {"background": table.background}
    if table.environment is not None:
        e = table.environment
        image = read_environment(_beside(path, "environment.file", e.file), e.exposure)
        more["sky"] = sky_part(np.roll(image, -round(e.heading / 360 * image.shape[1]), axis=1))
    return _scene(table.name or path.stem, pieces, looks, path, **more)


def _beside(path: Path, key: str, name: str) -> Path:
    """A file in the scene file's folder or below."""
    found = path.parent / name
    if Path(name).is_absolute() or not found.resolve().is_relative_to(path.parent.resolve()):
        raise InputError(f"{path}: {key}: {name!r} must lie in the scene file's folder")
    return found


def _scene(name: str, pieces: list[Any], looks: dict[str, Look], path: Path, **more: Any) -> Scene:
    """The scene of the pieces; without looks of its own it has "ahead"."""
    looks = looks or {"ahead": Look((0.0, 0.0, 1000.0), "")}
    lights = Lights(0.75, 500.0, (), ((0.4, 0.8, -0.6), 0.5))
    scene = build_scene(name, f"from {path.name}", pieces, lights, looks, **more)
    if scene.parts and not any((part.points[:, 2] > 0).any() for part in scene.parts):
        raise InputError(f"{path}: nothing of it stands before the eye: look again at eye, ahead and unit")
    behind = [key for key, k in looks.items() if not k.target[2] > 0]
    if behind:
        raise InputError(f"{path}: looks.{behind[0]}: lies behind the eye")
    return scene
