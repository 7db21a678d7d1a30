"""The built-in scene: a wearer at a desk, with a page at 40 cm, a screen at 76 cm and a lecture room's wall at 6 m.

Wear frame, mm: +x to the wearer's left, so to the left of a picture; +y up; +z ahead. Textures are drawn when asked for.
"""

import difflib
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont

from ..errors import InputError, LensBenchError
from .scene import Part, Scene, rectangle

Pixels = NDArray[np.uint8]
Colour = tuple[int, int, int]

FLOOR, CEILING, DESK, WALL = -1200.0, 1600.0, -460.0, 6000.0
INK, PAPER, BLUE, RED, GREY = (26, 28, 32), (250, 247, 238), (24, 74, 138), (178, 44, 40), (150, 154, 160)

# ---- drawing ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Sheet:
    """A drawing surface measured in mm from its upper left corner. scale: texels per mm."""

    width: float
    height: float
    scale: float
    paper: Colour = PAPER
    image: Any = field(init=False)
    pen: Any = field(init=False)

    def __post_init__(self) -> None:
        size = round(self.width * self.scale), round(self.height * self.scale)
        object.__setattr__(self, "image", Image.new("RGB", size, self.paper))
        object.__setattr__(self, "pen", ImageDraw.Draw(self.image))

    def text(self, x: float, y: float, text: str, size: float, face: str = "Sans", ink: Colour = INK, at: str = "ls"):
        """Text at (x, y) mm, em size in mm; at: Pillow's anchor (ls: left end of the base line)."""
        self.pen.text((x * self.scale, y * self.scale), text, ink, _font(face, round(size * self.scale)), at)

    def lines(self, x: float, y: float, lines: list[str], size: float, face: str = "Serif", ink: Colour = INK):
        """Lines of text, the first one's base line at (x, y) mm."""
        for k, line in enumerate(lines):
            self.text(x, y + 1.32 * size * k, line, size, face, ink)

    def box(self, x: float, y: float, w: float, h: float, fill: Colour | None, edge: Colour | None = None, pen=0.0):
        """A rectangle; pen: width of its edge, mm."""
        corners = [v * self.scale for v in (x, y, x + w, y + h)]
        self.pen.rectangle(corners, fill, edge, max(1, round(pen * self.scale)))

    def line(self, points: ArrayLike, pen: float, ink: Colour = INK):
        """A line through points (k, 2) mm; pen: width, mm."""
        path = [(float(x), float(y)) for x, y in np.asarray(points, dtype=float) * self.scale]
        self.pen.line(path, ink, max(1, round(pen * self.scale)), "curve")

    def disc(self, x: float, y: float, radius: float, fill: Colour):
        """A filled circle."""
        self.pen.circle((x * self.scale, y * self.scale), radius * self.scale, fill)

    def pixels(self) -> Pixels:
        """The drawing (h, w, 3), first row at the top."""
        return np.asarray(self.image)


@cache
def _font(face: str, size: int) -> ImageFont.FreeTypeFont:
    found = find_spec("matplotlib")
    if found is None or found.origin is None:
        raise LensBenchError('the built-in scenes take their letters from matplotlib: pip install "lensbench[scenes]"')
    folder = Path(found.origin).parent / "mpl-data" / "fonts" / "ttf"
    return ImageFont.truetype(folder / f"DejaVu{face}.ttf", size)


def _tiles(size: tuple[int, int], tile: tuple[int, int], joint: int, colours: tuple[Colour, Colour], bond: float):
    """Pixels (h, w, 3) of tiles that vary by chance in lightness. colours: of tile and joint; bond: shift between rows."""
    chance = np.random.default_rng(7)
    y, x = np.arange(size[1])[:, None], np.arange(size[0])[None, :]
    row = y // tile[1]
    shifted = x + (row * bond * tile[0]).astype(int)
    column = shifted // tile[0]
    shade = chance.normal(1.0, 0.035, (int(row.max()) + 1, int(column.max()) + 1)).astype(np.float32)[row, column]
    inside = (y % tile[1] >= joint) & (shifted % tile[0] >= joint)
    grain = chance.integers(-3, 4, (size[1], size[0]), dtype=np.int16)
    channels = [np.where(inside, shade * face, edge) + grain for face, edge in zip(*colours, strict=True)]
    return np.clip(np.stack(channels, axis=-1), 0, 255).astype(np.uint8)


def _wood(size: tuple[int, int], plank: int, colour: Colour) -> Pixels:
    """Planks (h, w, 3) with a grain that runs along the rows; plank: height of a plank, pixels."""
    chance = np.random.default_rng(11)
    boards = _tiles(size, (size[0] // 2, plank), 1, (colour, (88, 58, 36)), 0.37)
    y, x = np.arange(size[1], dtype=np.float32)[:, None], np.arange(size[0], dtype=np.float32)[None, :]
    phase = chance.uniform(0, 40, size[1] // plank + 1).astype(np.float32)[(y // plank).astype(int)]
    rings = np.sin(y * 0.55 + phase + 2.2 * np.sin(x * 0.006 + phase)) + 0.5 * np.sin(y * 1.7 + 3 * np.sin(x * 0.011))
    return np.clip(boards * (1 + 0.045 * rings[..., None]), 0, 255).astype(np.uint8)


# ---- the page at 40 cm ------------------------------------------------------------------------------------------------

PARAGRAPH = [
    "The eye turns to every place it",
    "wants to see. Behind a spectacle",
    "lens each of its directions has a",
    "power of its own, and so the far",
    "wall, the screen and this page",
    "are met by different zones.",
]
NEWS = [
    "MARKETS  The price of optical",
    "glass rose by 2.75 per cent on",
    "Tuesday; crown 1.523 was firm",
    "and high-index 1.74 fell after",
    "a week of brisk trade. Frames",
    "in acetate kept their value.",
    "WEATHER  Clear in the morning,",
    "haze of 0.25 D towards noon,",
    "visibility 6 m, wind from the",
    "nasal side 3 to 5 knots.",
    "CHESS  White to move and mate",
    "in three: Kf6, Qg7, Rh8, Bc4.",
    "CROSSWORD  7 across: it bends",
    "but does not break (5, 3, 2).",
]
LADDER = [
    (9.0, "E H N"), (6.5, "D F N P"), (4.6, "P T X Z U"),
    (3.3, "U Z D T F"), (2.4, "D F N P T H"), (1.7, "P H U N T D Z"),
]  # fmt: skip


def page() -> Pixels:
    """A printed page, 210 x 145 mm."""
    s = Sheet(210, 145, 9)
    s.text(105, 19, "The Reading Distance", 14, "Serif-Bold", at="ms")
    s.line([(8, 24), (202, 24)], 0.6)
    s.text(8, 29.4, "No. 400 mm", 3.4, "Serif")
    s.text(202, 29.4, "For wearers of all ages", 3.4, "Serif-Italic", at="rs")
    s.line([(8, 31.5), (202, 31.5)], 0.3)
    s.lines(8, 41, PARAGRAPH, 6.1)
    s.lines(139, 38.4, NEWS, 3.55)
    s.line([(134, 34), (134, 99)], 0.3)
    for k, (size, letters) in enumerate(LADDER):
        s.text(45, 103 + 1.05 * sum(row[0] for row in LADDER[:k]) + 2.2 * k, letters, size, "Sans-Bold", at="ms")
    s.line([(86, 92), (86, 140)], 0.3)
    _rings(s, 111, 118, 20)
    s.text(138, 112, "8.5 pt  Seven black birds sat on", 3.0, "Sans")
    s.text(138, 117, "7 pt  the long fence and watched the", 2.5, "Sans")
    s.text(138, 121.4, "6 pt  ships go by until the evening fell, and", 2.1, "Sans")
    s.text(138, 125.3, "5 pt  none of them thought of counting the letters here.", 1.75, "Sans")
    s.box(138, 129, 64, 9, (255, 235, 120))
    s.text(170, 135.6, "40 cm", 6, "Sans-Bold", RED, at="ms")
    return s.pixels()


def _rings(s: Sheet, x: float, y: float, radius: float) -> None:
    """A star of 36 spokes: it shows blur and astigmatism at a glance."""
    s.disc(x, y, radius, INK)
    for k in range(36):
        turn = np.radians([k * 10 - 2.5, k * 10 + 2.5])
        far = np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=-1) * s.scale
        s.pen.polygon([(x * s.scale, y * s.scale), *map(tuple, far)], s.paper)
    s.disc(x, y, radius / 7, INK)


# ---- the screen at 76 cm ----------------------------------------------------------------------------------------------

REPORT = [
    "Read this line with the zone", "for the middle distance. Its", "letters are as high as those",
    "of a web page at arm's", "length and a little more.",
]  # fmt: skip
TABLE = [
    ("month", "pairs", "+/-"), ("May", "1204", "+31"), ("June", "1377", "+173"),
    ("July", "1290", "-87"), ("August", "968", "-322"),
]  # fmt: skip


def screen() -> Pixels:
    """A monitor with its frame, laid out on 420 x 196: text, a graph, a table and fine lines."""
    s = Sheet(420, 196, 5, (30, 32, 36))
    s.box(6, 6, 408, 180, (244, 246, 249))
    s.box(6, 6, 408, 17, BLUE)
    s.text(14, 18.6, "Monthly report", 11, "Sans-Bold", (255, 255, 255))
    for k, colour in enumerate(((120, 200, 130), (250, 200, 90), (235, 100, 90))):
        s.disc(368 + 15 * k, 14.5, 4, colour)
    s.text(16, 45, "Arm's length", 17, "Sans-Bold", BLUE)
    s.lines(16, 63, REPORT, 9.5, "Sans")
    for k, row in enumerate(TABLE):
        y = 134 + 11.5 * k
        s.box(14, y - 9, 150, 11.5, (222, 230, 241) if k % 2 == 0 else (255, 255, 255))
        for x, cell in zip((62, 112, 158), row, strict=True):
            s.text(x, y, cell, 9, "Sans-Bold" if k == 0 else "Sans", at="rs")
    _graph(s, 196, 36, 208, 112)
    for k in range(7):
        pitch = (0.6, 0.8, 1.0, 1.4, 2.0, 2.8, 4.0)[k]
        x0 = 196 + 30 * k
        for j in range(int(26 / (2 * pitch))):
            s.box(x0 + 2 * pitch * j, 160, pitch - 1 / s.scale, 20, INK)
    return s.pixels()


def _graph(s: Sheet, x: float, y: float, w: float, h: float) -> None:
    """A graph: a grid of fine lines and two curves."""
    s.box(x, y, w, h, (255, 255, 255), GREY, 0.6)
    for k in range(1, 13):
        s.line([(x + w * k / 13, y), (x + w * k / 13, y + h)], 0.4, (205, 210, 218))
    for k in range(1, 7):
        s.line([(x, y + h * k / 7), (x + w, y + h * k / 7)], 0.4, (205, 210, 218))
    t = np.linspace(0, 1, 120)
    rise, wave = 1 / (1 + np.exp(-9 * (t - 0.5))), np.exp(-(((t - 0.55) / 0.2) ** 2))
    for height, ink in ((0.88 - 0.74 * rise, BLUE), (0.9 - 0.42 * wave, RED)):
        s.line(np.stack([x + w * t, y + h * height], axis=-1), 1.8, ink)
    s.text(x + 8, y + 17, "progressive", 9, "Sans-Bold", BLUE)
    s.text(x + 8, y + 30, "single vision", 9, "Sans-Bold", RED)


def keyboard() -> Pixels:
    """A keyboard, 340 x 120 mm."""
    s = Sheet(340, 120, 4, (52, 55, 60))
    for row, keys in enumerate(("1234567890-=", "QWERTYUIOP[]", "ASDFGHJKL;'#", "ZXCVBNM,./")):
        for k, key in enumerate(keys):
            x, y = 16 + 6 * row + 24 * k, 8 + 22 * row
            s.box(x, y, 21, 19, (86, 90, 97))
            s.text(x + 10.5, y + 13.5, key, 10, "Sans-Bold", (236, 238, 240), at="ms")
    s.box(86, 97, 150, 17, (86, 90, 97))
    return s.pixels()


# ---- the room at 6 m --------------------------------------------------------------------------------------------------

CHART = [
    (230, "E  F  P"), (165, "T  O  Z  L"), (118, "P  E  D  F  C"),
    (84, "F  E  L  O  P  Z  D"), (60, "D  E  F  P  O  T  E  C"), (44, "L  E  F  O  D  P  C  T"),
]  # fmt: skip
WELCOME = ["Six metres away", "is far enough for", "the eye to rest."]


def sign() -> Pixels:
    """The lecture room's slide, 2900 x 1160 mm: a headline, running text and rows of letters."""
    s = Sheet(2900, 1160, 0.62, (252, 252, 250))
    s.box(0, 0, 2900, 235, BLUE)
    s.text(90, 180, "FAR VISION", 165, "Sans-Bold", (255, 255, 255))
    s.text(2810, 180, "6 m", 165, "Sans-Bold", (255, 214, 90), at="rs")
    s.lines(90, 410, WELCOME, 128, "Sans")
    for k, turn in enumerate((0, 30, 60, 90, 120, 150)):
        a = np.radians(turn)
        for off in (-36, 0, 36):
            x, y = 190 + 215 * k - off * np.sin(a), 930 + off * np.cos(a)
            s.line([(x - 80 * np.cos(a), y - 80 * np.sin(a)), (x + 80 * np.cos(a), y + 80 * np.sin(a))], 14, INK)
    s.line([(1440, 300), (1440, 1090)], 8, GREY)
    y = 262.0
    for size, letters in CHART:
        y += 0.76 * size + 44
        s.text(2150, y, letters, size, "Sans-Bold", at="ms")
    s.box(0, 0, 2900, 1160, None, (60, 62, 66), 22)
    return s.pixels()


def clock() -> Pixels:
    """A square clock, 460 mm."""
    s = Sheet(460, 460, 1, (48, 52, 58))
    s.box(18, 18, 424, 424, (253, 253, 251))
    for hour in range(1, 13):
        a = np.radians(30 * hour)
        s.text(230 + 160 * np.sin(a), 230 - 160 * np.cos(a), str(hour), 62, "Sans-Bold", at="mm")
    for angle, length, pen in ((305, 100, 18), (60, 150, 12)):
        a = np.radians(angle)
        s.line([(230, 230), (230 + length * np.sin(a), 230 - length * np.cos(a))], pen)
    s.disc(230, 230, 14, RED)
    return s.pixels()


def door() -> Pixels:
    """A panelled door with its frame, 1020 x 2150 mm."""
    s = Sheet(1020, 2150, 0.35, (238, 234, 226))
    s.box(60, 60, 900, 2090, (132, 86, 54), (96, 60, 38), 12)
    for x in (150, 550):
        for y, h in ((160, 620), (880, 420), (1400, 620)):
            s.box(x, y, 320, h, (146, 98, 62), (98, 62, 40), 14)
    s.disc(890, 1180, 34, (222, 190, 110))
    return s.pixels()


def window() -> Pixels:
    """A window with four panes on a landscape, 1150 x 1350 mm."""
    s = Sheet(1150, 1350, 0.5)
    for k in range(100):
        s.box(0, 13.5 * k, 1150, 14.5, (118 + k, 172 + k * 6 // 10, 232 + k // 6))
    x = np.linspace(0, 1150, 80)
    for base, height, colour in ((880, 90, (126, 164, 150)), (1000, 60, (104, 150, 92)), (1130, 40, (74, 122, 66))):
        hill = base - height * np.sin(x / 150 + base) - 0.4 * height * np.sin(x / 61)
        land = np.vstack([np.stack([x, hill], axis=-1), [[1150, 1350], [0, 1350]]]) * s.scale
        s.pen.polygon([tuple(corner) for corner in land], colour)
    s.disc(830, 250, 70, (255, 246, 200))
    s.box(0, 0, 1150, 1350, None, (246, 244, 238), 70)
    for left, top, w, h in ((545, 0, 60, 1350), (0, 620, 1150, 50)):
        s.box(left, top, w, h, (246, 244, 238))
    return s.pixels()


def lamp() -> Pixels:
    """A ceiling lamp."""
    s = Sheet(300, 1200, 0.2, (255, 252, 240))
    s.box(0, 0, 300, 1200, None, (190, 192, 194), 24)
    return s.pixels()


def _plain(colour: Colour) -> Pixels:
    return np.full((4, 4, 3), colour, dtype=np.uint8)


# ---- the scene --------------------------------------------------------------------------------------------------------


def _facing(name: str, elevation: float, distance: float, size: tuple[float, float], image: Pixels) -> Part:
    """A rectangle of size (w, h) mm at a distance from the lens, facing it. elevation: degrees."""
    e = np.radians(elevation)
    ahead, up = np.array([0, np.sin(e), np.cos(e)]), np.array([0, np.cos(e), -np.sin(e)])
    return rectangle(name, distance * ahead, [-size[0] / 2, 0, 0], size[1] / 2 * up, image)


def _on_wall(name: str, x: float, y: float, size: tuple[float, float], image: Pixels) -> Part:
    return rectangle(name, [x, y, WALL - 30], [-size[0] / 2, 0, 0], [0, size[1] / 2, 0], image)


def _lying(name: str, middle: tuple[float, float, float], size: tuple[float, float], image: Pixels) -> Part:
    return rectangle(name, middle, [-size[0] / 2, 0, 0], [0, 0, size[1] / 2], image)


def _desk_parts() -> list[Part]:
    stand = _plain((70, 73, 78))
    return [
        _facing("page", -29.0, 392.0, (210, 145), page()),
        _facing("screen", -10.4, 760.0, (390, 182), screen()),
        rectangle("neck", [0, -340, 790], [-35, 0, 0], [0, 120, 0], stand),
        _lying("foot", (0, DESK + 6, 745), (240, 130), stand),
        _lying("keyboard", (0, DESK + 12, 470), (340, 120), keyboard()),
        _lying("desk", (0, DESK, 590), (1700, 780), _wood((1700, 780), 130, (186, 134, 88))),
    ]


def _room_parts() -> list[Part]:
    height, middle = CEILING - FLOOR, (CEILING + FLOOR) / 2
    brick = ((226, 208, 188), (246, 240, 230))
    front = _tiles((2720, 1120), (96, 32), 5, brick, 0.5)
    side = _tiles((1400, 700), (60, 20), 2, brick, 0.5)
    floor = _tiles((1400, 1400), (100, 100), 4, ((150, 128, 108), (92, 78, 66)), 0.0)
    parts = [
        rectangle("wall", [0, middle, WALL], [-3400, 0, 0], [0, height / 2, 0], front),
        _lying("floor", (0, FLOOR, 3500), (6800, 5000), floor),
        rectangle("ceiling", [0, CEILING, 3500], [-3400, 0, 0], [0, 0, -2500], _ceiling()),
        _on_wall("sign", 0, 220, (2900, 1160), sign()),
        _on_wall("clock", 0, 1110, (460, 460), clock()),
        _on_wall("door", 2420, FLOOR + 1075, (1020, 2150), door()),
        _on_wall("window", -2420, 250, (1150, 1350), window()),
    ]
    for name, x in (("left wall", 3400.0), ("right wall", -3400.0)):
        parts.append(rectangle(name, [x, middle, 3600], [0, 0, np.sign(x) * 2400], [0, height / 2, 0], side))
    for x in (-1500.0, 0.0, 1500.0):
        parts.append(_lying("lamp", (x, CEILING - 25, 4600), (300, 1200), lamp()))
    return parts


def _ceiling() -> Pixels:
    return _tiles((680, 520), (60, 60), 2, ((236, 236, 232), (206, 208, 208)), 0.0)


def room() -> Scene:
    """A wearer at a desk: page (40 cm, 29 degrees down), screen (76 cm, 10 degrees down), slide straight ahead at 6 m."""
    return Scene("room", (*_desk_parts(), *_room_parts()))


SCENES: dict[str, Callable[[], Scene]] = {"room": room}


def load_scene(name: str) -> Scene:
    """The built-in scene of that name. Raises InputError when there is none."""
    if name not in SCENES:
        near = difflib.get_close_matches(name, SCENES, 1)
        hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(SCENES)}"
        raise InputError(f"unknown scene {name!r}: {hint}")
    return SCENES[name]()
