"""Furniture of the built-in scenes, as pieces."""

import numpy as np

from ..optics.conventions import Floats
from .build import Panel, Thing
from .drawing import Colour, Pixels
from .solids import Solid, box, join, tube, turned

DARK, STEEL = (52, 54, 58), (176, 180, 184)


def facing(distance: float, elevation: float) -> tuple[Floats, Floats]:
    """The place (3,) at a distance (mm) and elevation (degrees) ahead, and "up" (3,) of a plane that faces the eye there."""
    e = np.radians(elevation)
    return distance * np.array([0, np.sin(e), np.cos(e)]), np.array([0, np.cos(e), -np.sin(e)])


def sheet_facing(name: str, distance: float, elevation: float, size: tuple[float, float], image: Pixels) -> Panel:
    """A sheet of size (w, h) mm that faces the eye."""
    centre, up = facing(distance, elevation)
    return Panel(name, centre, [-size[0] / 2, 0, 0], size[1] / 2 * up, image)


def lying(name: str, middle: tuple[float, float, float], size: tuple[float, float], image: Pixels) -> Panel:
    """A sheet of size (w, h) mm that lies flat and is read from the eye's side."""
    return Panel(name, middle, [-size[0] / 2, 0, 0], [0, 0, size[1] / 2], image)


def standing(name: str, middle: tuple[float, float, float], size: tuple[float, float], image: Pixels) -> Panel:
    """A sheet of size (w, h) mm that stands upright across the line of sight."""
    return Panel(name, middle, [-size[0] / 2, 0, 0], [0, size[1] / 2, 0], image)


def monitor(distance: float, elevation: float, size: tuple[float, float], image: Pixels, foot: float) -> list:
    """A monitor whose screen of size (w, h) mm faces the eye; its foot stands at the height `foot` mm."""
    centre, up = facing(distance, elevation)
    ahead = centre / distance
    case = box([0, 0, 12], [size[0] + 22, size[1] + 26, 22]).placed(centre + 1.5 * ahead - 4 * up, -elevation)
    back = centre + 40 * ahead
    neck = box([back[0], (back[1] + foot) / 2, back[2]], [64, back[1] - foot, 14])
    plate = box([0, foot + 5, back[2] - 15], [250, 10, 190])
    screen = Panel("screen", centre, [-size[0] / 2, 0, 0], size[1] / 2 * up, image, shines=True)
    return [screen, Thing("monitor", case, (38, 40, 44)), Thing("monitor", join([neck, plate]), STEEL)]


def document_holder(distance: float, elevation: float, size: tuple[float, float], foot: float) -> list[Thing]:
    """A slanted board behind a sheet that faces the eye, on a leg down to the height `foot` mm."""
    centre, up = facing(distance, elevation)
    ahead = centre / distance
    board = box([0, 0, 5], [size[0] + 12, size[1] + 10, 6]).placed(centre + 1 * ahead, -elevation)
    lip = box([0, 0, 0], [size[0] + 12, 9, 14]).placed(centre - (size[1] / 2 + 6) * up, -elevation)
    top = centre + 8 * ahead
    leg = tube([[0, top[1], top[2]], [0, top[1] - 60, top[2] + 55], [0, foot + 8, top[2] + 55]], 9)
    plate = turned([(82, 0), (80, 8), (0, 8)], 40).placed([0, foot, top[2] + 55])
    return [Thing("holder", join([board, lip]), (126, 92, 62)), Thing("holder", join([leg, plate]), DARK)]


def table(front: float, depth: float, width: float, top: float, floor: float, image: Pixels) -> list:
    """A table whose top (at the height `top`) begins at z = front; image: its surface, read from the eye's side."""
    middle = (0.0, top, front + depth / 2)
    under = box([0, top - 16.5, middle[2]], [width, 33, depth], without="+y")
    legs = [
        box([x, (floor + top - 33) / 2, z], [70, top - 33 - floor, 70])
        for x in (-width / 2 + 90, width / 2 - 90)
        for z in (front + 120, front + depth - 120)
    ]
    red, green, blue = (int(c) for c in 0.8 * image.reshape(-1, 3).mean(axis=0))
    return [
        lying("table", middle, (width, depth), image),
        Thing("table body", under, (red, green, blue)),
        Thing("table body", join(legs), DARK),
    ]


def chair(x: float, z: float, floor: float, turn: float, colour: Colour = (46, 66, 92)) -> list[Thing]:
    """A chair at (x, z); turn: degrees about the vertical, 0 faces away from the eye."""
    seat = join([box([0, 460, 0], [460, 60, 450]), box([0, 720, -215], [440, 380, 44])])
    posts = [tube([[s * 150, 480, -225], [s * 150, 640, -238]], 13, 8) for s in (-1, 1)]
    legs = [tube([[sx * 190, 440, sz * 180], [sx * 215, 0, sz * 210]], 14, 8) for sx in (-1, 1) for sz in (-1, 1)]

    def put(solid: Solid) -> Solid:
        return solid.placed([x, floor, z], about_y=turn)

    return [Thing("chairs", put(seat), colour), Thing("chairs", put(join([*posts, *legs])), STEEL)]


def mug(x: float, z: float, foot: float, colour: Colour) -> Thing:
    """A mug with its handle to the wearer's right."""
    wall = turned([(0, 0), (38, 0), (41, 4), (41, 92), (37, 95), (36, 90), (35, 12), (0, 10)], 32)
    turn = np.linspace(-1.4, 1.4, 12)
    handle = tube(np.stack([-38 - 26 * np.cos(turn), 48 + 30 * np.sin(turn), 0 * turn], axis=-1), 5, 8)
    return Thing("mug", join([wall, handle]).placed([x, foot, z]), colour)


def plant(x: float, z: float, floor: float) -> list[Thing]:
    """A pot with long leaves."""
    pot = turned([(0, 0), (130, 0), (170, 330), (150, 335), (140, 300), (0, 295)], 32)
    leaves = []
    for k in range(26):
        turn, lean = 2.4 * k, 0.25 + 0.75 * ((k * 0.618) % 1)
        t = np.linspace(0, 1, 7)
        out = 90 + 520 * lean * t**1.6
        path = np.stack([out * np.cos(turn), 300 + (900 - 380 * lean) * t - 160 * lean * t**3, out * np.sin(turn)], -1)
        leaves.append(_leaf(path, 34))
    return [
        Thing("plant", pot.placed([x, floor, z]), (188, 108, 78)),
        Thing("plant", join(leaves).placed([x, floor, z]), (74, 118, 62)),
    ]


def _leaf(path: Floats, width: float) -> Solid:
    """A pointed ribbon along a path (k, 3), of two faces."""
    t = np.linspace(0, 1, len(path))[:, None]
    side = np.cross(np.gradient(path, axis=0), [0.0, 1.0, 0.0])
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-9)
    half = width * np.sin(np.pi * np.clip(0.08 + 0.92 * t, 0, 1)) ** 0.7
    grid = np.stack([path - half * side, path, path + half * side], axis=1)
    normal = np.cross(side, np.gradient(path, axis=0))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    normals = np.stack([normal - 0.5 * side, normal, normal + 0.5 * side], axis=1)
    rows, columns = grid.shape[:2]
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    quads = np.stack([corner, corner + 1, corner + columns + 1, corner + columns], axis=1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    flat = normals.reshape(-1, 3)
    return Solid(grid.reshape(-1, 3), triangles, flat / np.linalg.norm(flat, axis=1, keepdims=True))
