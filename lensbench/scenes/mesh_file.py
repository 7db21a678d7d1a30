"""Meshes from glTF, OBJ, PLY and STL files, put before the wearer: pieces of a scene. Needs trimesh.

Base colours, vertex colours and textures are kept. A textured surface is shown as its texture is; others are lit as they are
built into a scene. Surfaces more transparent than half (glass) are left out.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from ..errors import InputError, LensBenchError
from ..optics.conventions import Floats
from .build import Painted, Thing
from .drawing import LIGHT_OF_CODE, Pixels, encode
from .scene import Part
from .solids import Solid
from .tessellate import MOST_TRIANGLES, Mesh, tessellated

KINDS = (".glb", ".gltf", ".obj", ".ply", ".stl")
UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}
_MOST_TILES, _WIDEST_IMAGE = 64, 8192


@dataclass(frozen=True, slots=True)
class Placing:
    """Where the wearer stands in a file's coordinates: its unit, the place of the eye, and which way is ahead and up.

    The eye is the origin of the scene's frame: on the face's midline, one vertex distance before the corneas.
    """

    unit: str
    eye: tuple[float, float, float]
    ahead: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def frame(self) -> Floats:
        """Rows (3, 3): the wear frame's x (to the wearer's left), y and z in the file's axes. Raises InputError."""
        z, up = np.array(self.ahead, dtype=float), np.array(self.up, dtype=float)
        x = np.cross(up, z)
        if not np.linalg.norm(x) > 1e-6 * np.linalg.norm(up) * np.linalg.norm(z):
            raise InputError(
                f"scene: ahead {self.ahead} and up {self.up} must be two different directions: ahead is where the face "
                "points; where it points straight up or down, name another up"
            )
        return np.stack([v / np.linalg.norm(v) for v in (x, np.cross(z, x), z)])

    def points(self, points: ArrayLike) -> Floats:
        """Points (n, 3) of the file in the wear frame, mm."""
        if self.unit not in UNITS:
            raise InputError(f"scene: unit {self.unit!r} is none of {', '.join(UNITS)}")
        return UNITS[self.unit] * ((np.asarray(points, dtype=float) - self.eye) @ self.frame().T)


def read_meshes(path: Path, placing: Placing) -> list[Part | Thing | Painted]:
    """Everything that a mesh file shows, before the wearer. Raises InputError for what cannot be used."""
    found = _loaded(path)
    pieces: list[Part | Thing | Painted] = []
    total = 0
    for node in found.graph.nodes_geometry:
        turn, name = found.graph[node]
        mesh = found.geometry[name]
        if not hasattr(mesh, "faces") or not len(mesh.faces):
            continue
        total += len(mesh.faces)
        if total > MOST_TRIANGLES:
            raise InputError(f"{path}: has more than {MOST_TRIANGLES} triangles: simplify the mesh")
        mesh = mesh.copy().apply_transform(turn)
        if not np.isfinite(mesh.vertices).all():
            raise InputError(f"{path}: {name}: has vertices that are no numbers")
        pieces += _pieces(path, str(name), mesh, placing)
    if not pieces:
        raise InputError(f"{path}: shows nothing: it holds no opaque triangles")
    return pieces


def _loaded(path: Path) -> Any:
    try:
        import trimesh
    except ModuleNotFoundError:
        raise LensBenchError(f'{path}: meshes need another package: pip install "lensbench[scenes]"') from None
    if path.suffix.lower() not in KINDS:
        raise InputError(f"{path}: is no mesh that can be read; there are {', '.join(KINDS)}")
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        return trimesh.load_scene(str(path), allow_remote=False)
    except Exception as error:  # each of trimesh's readers fails in its own way
        raise InputError(f"{path}: not a mesh that can be read: {type(error).__name__}: {error}") from None


def _pieces(path: Path, name: str, mesh: Any, placing: Placing) -> list[Part | Thing | Painted]:
    """What one of the file's meshes becomes."""
    linear = path.suffix.lower() in (".glb", ".gltf")
    colour, opacity, image = _material(mesh, linear)
    if opacity < 0.5:
        return []
    label = f"{path.name}: {name}"
    if image is not None:
        bare = Mesh(placing.points(mesh.vertices), np.asarray(mesh.faces, dtype=np.int64), np.asarray(mesh.visual.uv))
        return [_textured(label, tessellated(bare, label), _tinted(image, colour))]
    painted = mesh.visual.kind == "vertex"
    if not painted and mesh.visual.kind != "face":
        mesh = mesh.smooth_shaded
    solid = Solid(
        placing.points(mesh.vertices),
        np.asarray(mesh.faces, dtype=np.int64),
        np.asarray(mesh.vertex_normals) @ placing.frame().T,
    )
    if painted:
        return [Painted(label, solid, _codes(mesh.visual.vertex_colors[:, :3] / 255, linear))]
    if mesh.visual.kind == "face":
        apart = _apart(solid, np.asarray(mesh.face_normals) @ placing.frame().T)
        codes = _codes(np.repeat(mesh.visual.face_colors[:, :3], 3, axis=0) / 255, linear)
        return [Painted(label, apart, codes)]
    return [Thing(path.name, solid, colour, closed=False)]


def _apart(solid: Solid, face_normals: Floats) -> Solid:
    """The solid with three points of its own for every triangle."""
    count = np.arange(solid.triangles.size).reshape(-1, 3)
    return Solid(solid.points[solid.triangles.ravel()], count, np.repeat(face_normals, 3, axis=0))


def _material(mesh: Any, linear: bool) -> tuple[tuple[int, int, int], float, Pixels | None]:
    """Base colour (sRGB), opacity and texture of a mesh. linear: the file's colours are linear light (glTF)."""
    material = getattr(mesh.visual, "material", None)
    if material is None:
        return (190, 190, 186), 1.0, None
    rgba = np.asarray(material.main_color, dtype=float) / 255
    clear = getattr(material, "alphaMode", None) == "BLEND" or not linear
    picture = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if picture is not None and getattr(mesh.visual, "uv", None) is None:
        picture = None
    if picture is not None and hasattr(material, "baseColorFactor"):
        factor = material.baseColorFactor
        rgba = np.ones(4) if factor is None else np.asarray(factor, dtype=float) / 255
    elif picture is not None:
        rgba = np.ones(4)
    red, green, blue = (int(c) for c in _codes(rgba[:3], linear))
    image = None if picture is None else np.asarray(picture.convert("RGB"))
    return (red, green, blue), float(rgba[3]) if clear else 1.0, image


def _codes(colours: ArrayLike, linear: bool) -> NDArray[np.uint8]:
    """sRGB codes of a file's colours (..., 3), 0 to 1."""
    values = np.asarray(colours, dtype=float)
    return encode(values) if linear else np.round(255 * values).astype(np.uint8)


def _tinted(image: Pixels, colour: tuple[int, int, int]) -> Pixels:
    """The image in the light of a base colour."""
    if colour == (255, 255, 255):
        return image
    table = encode(LIGHT_OF_CODE[:, None] * LIGHT_OF_CODE[list(colour)])
    return np.stack([table[image[..., c], c] for c in range(3)], axis=-1)


def _textured(name: str, mesh: Mesh, image: Pixels) -> Part:
    """A textured part. Where its uv leave the image, they mean its repetition, which is laid out here."""
    low = np.floor(mesh.values.min(axis=0) + 1e-6)
    tiles = np.maximum(np.ceil(mesh.values.max(axis=0) - 1e-6) - low, 1).astype(int)
    if tiles.max() > _MOST_TILES:
        raise InputError(f"{name}: its texture is repeated {tiles.max()} times; {_MOST_TILES} times are the most")
    width, height = (max(1, min(n, _WIDEST_IMAGE // t)) for n, t in zip(image.shape[1::-1], tiles, strict=True))
    if (width, height) != image.shape[1::-1]:
        image = np.asarray(Image.fromarray(image).resize((width, height), Image.Resampling.BOX))
    tiled = np.tile(image, (int(tiles[1]), int(tiles[0]), 1))
    return Part(name, mesh.points, mesh.triangles, (mesh.values - low) / tiles, tiled)
