"""From pieces (textured panels and plain things) to a scene: lit, textured and tessellated."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from ..errors import InputError
from ..optics.conventions import Floats, unit
from .cast import Caster
from .drawing import LIGHT_OF_CODE, Colour, Pixels, encode
from .light import Lights
from .scene import Look, Part, Scene, rectangle
from .solids import Solid
from .tessellate import MOST_TRIANGLES, Mesh, tessellated

BRIGHTEST, _LEVELS, _NODES = 1.5, 256, 48
EYE_MOVES = 60.0  # mm, from the middle of the face


class Panel(NamedTuple):
    """A textured rectangle. centre, half edges across (to the image's right) and upward: (3,) mm, wear frame.

    shines: it shows its texture as it is, whatever light falls on it. outline (k, 2): cut out of the rectangle, which
    reaches from -1 to 1; anticlockwise, star-shaped about its mean.
    """

    name: str
    centre: ArrayLike
    across: ArrayLike
    upward: ArrayLike
    image: Pixels
    shines: bool = False
    outline: ArrayLike | None = None


class Thing(NamedTuple):
    """A solid of one colour; things of one name become one part. closed: it has no inside that could be seen."""

    name: str
    solid: Solid
    colour: Colour
    closed: bool = True


class Painted(NamedTuple):
    """A solid with a colour (n, 3), sRGB codes, at every point."""

    name: str
    solid: Solid
    colours: Pixels


Piece = Panel | Thing | Painted | Part


def build_scene(
    name: str, about: str, pieces: Iterable[Piece], lights: Lights, looks: Mapping[str, Look], **more: object
) -> Scene:
    """The scene of some pieces; parts are shown as they are. more: background and sky of the Scene.

    Raises InputError when it takes too many triangles.
    """
    bare: list[tuple[Panel, Part]] = []
    things: dict[str, list[Thing]] = defaultdict(list)
    painted: list[Painted] = []
    parts: list[Part] = []
    for piece in pieces:
        if isinstance(piece, Panel):
            bare.append((piece, _bare(piece)))
        elif isinstance(piece, Thing):
            things[piece.name].append(piece)
        elif isinstance(piece, Painted):
            painted.append(piece)
        else:
            parts.append(piece)
    solids = [thing.solid for group in things.values() for thing in group] + [p.solid for p in painted]
    standing = [part for _, part in bare] + parts
    caster = Caster([(s.points, s.triangles) for s in standing] + [(s.points, s.triangles) for s in solids])
    with ThreadPoolExecutor() as pool:  # Embree and numpy compute beside Python
        parts += pool.map(lambda pair: _lit_panel(pair[0], pair[1], lights, caster), bare)
        parts += pool.map(lambda group: _lit_things(group, lights, caster), things.values())
        parts += pool.map(lambda piece: _lit_paint(piece, lights, caster), painted)
    if sum(len(part.triangles) for part in parts) > MOST_TRIANGLES:
        raise InputError(f"{name}: more than {MOST_TRIANGLES} triangles are needed to draw it: simplify its meshes")
    return Scene(name, tuple(parts), looks=dict(looks), about=about, **more)  # type: ignore[arg-type]


# ---- panels: the light is drawn into the texture ----


def _bare(panel: Panel) -> Part:
    """The panel without light."""
    if panel.outline is None:
        return rectangle(*panel[:5])
    c, a, b = (np.asarray(v, dtype=float) for v in panel[1:4])
    edge = np.asarray(panel.outline, dtype=float)
    place = np.vstack([edge, edge.mean(axis=0)])
    k = np.arange(len(edge))
    fan = np.stack([k, (k + 1) % len(edge), np.full(len(edge), len(edge))], axis=-1)
    mesh = Mesh(c + place[:, :1] * a + place[:, 1:] * b, fan, (place + 1) / 2)
    return Part(panel.name, *tessellated(mesh, panel.name), panel.image)


def _lit_panel(panel: Panel, part: Part, lights: Lights, caster: Caster) -> Part:
    if panel.shines:
        return part
    c, a, b = (np.asarray(v, dtype=float) for v in panel[1:4])
    ratio = float(np.linalg.norm(a) / np.linalg.norm(b))
    columns, rows = (int(np.clip(_NODES * r, 6, 80)) for r in (min(ratio, 1.6), min(1 / ratio, 1.6)))
    u, v = (np.arange(n) * 2 / n + 1 / n - 1 for n in (columns, rows))
    points = c + u[None, :, None] * a - v[:, None, None] * b
    normals = np.broadcast_to(unit(np.cross(a, b)), points.shape)
    light = lights.on(points.reshape(-1, 3), normals.reshape(-1, 3), caster).reshape(rows, columns)
    image = _at_least(panel.image, 2 * columns, 2 * rows)
    return Part(part.name, part.points, part.triangles, part.uv, _shaded(image, light))


def _at_least(image: Pixels, width: int, height: int) -> Pixels:
    """The image, enlarged where it is too coarse to carry the light."""
    if image.shape[1] >= width and image.shape[0] >= height:
        return image
    size = max(image.shape[1], width), max(image.shape[0], height)
    return np.asarray(Image.fromarray(image).resize(size, Image.Resampling.BILINEAR))


def _shaded(image: Pixels, light: NDArray[np.float32]) -> Pixels:
    """The image (h, w, 3) under a light (rows, columns) that is stretched over it."""
    height, width = image.shape[:2]
    level = Image.fromarray(np.clip(light / BRIGHTEST, 0, 1) * (_LEVELS - 1), "F")
    fine = np.asarray(level.resize((width, height), Image.Resampling.BICUBIC))
    fine = np.clip(np.round(fine), 0, _LEVELS - 1).astype(np.intp)
    return _shades()[fine[..., None], image]


def _shades() -> Pixels:
    """sRGB codes (levels, 256) of every code under every level of light."""
    return encode(np.linspace(0, BRIGHTEST, _LEVELS)[:, None] * LIGHT_OF_CODE)


# ---- things: the light is a place in a ramp of their colour ----


def _lit_things(things: list[Thing], lights: Lights, caster: Caster) -> Part:
    """One part of things: its texture has a row for each colour, from no light to the brightest."""
    colours = list(dict.fromkeys(thing.colour for thing in things))
    ramp = _shades()[:, np.array(colours)].swapaxes(0, 1)
    parts = []
    for thing in things:
        row = (len(colours) - colours.index(thing.colour) - 0.5) / len(colours)
        parts.append(_lit_thing(thing, row, ramp, lights, caster))
    first = np.cumsum([0, *(len(part.points) for part in parts)])
    triangles = np.concatenate([part.triangles + n for part, n in zip(parts, first, strict=False)])
    points, uv = (np.concatenate([getattr(part, name) for part in parts]) for name in ("points", "uv"))
    return Part(things[0].name, points, triangles, uv, ramp)


def _lit_thing(thing: Thing, row: float, ramp: Pixels, lights: Lights, caster: Caster) -> Part:
    """Tessellated first, so that the light is known at every point."""
    solid = _before_the_eye(thing.solid) if thing.closed else _outwards(thing.solid, caster)
    points, triangles, normals = tessellated(Mesh(*solid), thing.name)
    light = lights.on(points, _directed(normals), caster)
    place = (np.clip(light / BRIGHTEST, 0, 1) * (_LEVELS - 1) + 0.5) / _LEVELS
    return Part(thing.name, points, triangles, np.column_stack([place, np.full(len(place), row)]), ramp)


def _outwards(solid: Solid, caster: Caster) -> Solid:
    """A solid whose normals may point inwards, turned so that most of what the eye sees of it is its outside."""
    corner = solid.points[solid.triangles]
    centre = corner.mean(axis=1)
    distance = np.linalg.norm(centre, axis=1)
    seen = caster.distances(np.zeros_like(centre), centre / np.maximum(distance, 1e-9)[:, None]) > 0.999 * distance
    size = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    away = np.einsum("mj,mj->m", solid.normals[solid.triangles].mean(axis=1), centre) / np.maximum(distance, 1e-9) ** 3
    return solid._replace(normals=-solid.normals) if np.sum((size * away)[seen]) > 0 else solid


def _before_the_eye(solid: Solid) -> Solid:
    """A closed solid without the faces that turn their backs on every eye near the origin."""
    corner = solid.points[solid.triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    outward = solid.normals[solid.triangles].sum(axis=1)
    normal *= np.sign(np.einsum("mj,mj->m", normal, outward))[:, None]
    height = -np.einsum("mj,mj->m", corner[:, 0], normal)
    seen = height > -EYE_MOVES * np.linalg.norm(normal, axis=1)
    return solid._replace(triangles=solid.triangles[seen])


# ---- painted solids: four texels a triangle, between which the colour runs straight ----


def _lit_paint(piece: Painted, lights: Lights, caster: Caster) -> Part:
    solid, count = _outwards(piece.solid, caster), len(piece.solid.points)
    values = np.column_stack([solid.normals, piece.colours.astype(float)]).reshape(count, 6)
    points, triangles, values = tessellated(Mesh(solid.points, solid.triangles, values), piece.name)
    light = lights.on(points, _directed(values[:, :3]), caster)
    codes = encode(light[:, None] * LIGHT_OF_CODE[np.round(values[:, 3:]).astype(np.intp)])
    columns = int(np.ceil(np.sqrt(len(triangles))))
    rows = -(-len(triangles) // columns)
    a, b, c = codes[triangles].astype(int).swapaxes(0, 1)
    cells = np.zeros((rows * columns, 2, 2, 3), dtype=np.uint8)
    cells[: len(triangles)] = np.stack([a, b, c, np.clip(b + c - a, 0, 255)], axis=1).reshape(-1, 2, 2, 3)
    image = cells.reshape(rows, columns, 2, 2, 3).swapaxes(1, 2).reshape(2 * rows, 2 * columns, 3)
    row, column = np.divmod(np.arange(len(triangles)), columns)
    texel = np.stack([column, row], axis=-1)[:, None] * 2 + [[0.5, 0.5], [1.5, 0.5], [0.5, 1.5]]
    uv = texel.reshape(-1, 2) / [2 * columns, 2 * rows]
    uv[:, 1] = 1 - uv[:, 1]
    return Part(piece.name, points[triangles.ravel()], np.arange(triangles.size).reshape(-1, 3), uv, image)


def _directed(normals: Floats) -> Floats:
    """Unit normals; where one vanishes, straight up."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(length > 1e-9, normals / np.maximum(length, 1e-9), [0.0, 1.0, 0.0])
