"""A meeting room: a page at 40 cm, a monitor at 77 cm on a long table, a slide on the wall at 6 m."""

import numpy as np

from .build import Panel, Piece, Thing, build_scene
from .drawing import BLUE, GREY, INK, RED, WHITE, Pixels, Sheet, cloth, tiles, wood
from .furniture import chair, document_holder, facing, lying, monitor, mug, plant, sheet_facing, standing, table
from .light import Lamp, Lights
from .prints import page, screen
from .scene import Look, Scene
from .solids import box, cylinder, join, turned

FLOOR, CEILING, TABLE, WALL, SIDE, NEAREST = -1200.0, 1500.0, -460.0, 6000.0, 2700.0, 600.0

# ---- drawings ----

CHART = [
    (230, "E  F  P"), (165, "T  O  Z  L"), (118, "P  E  D  F  C"),
    (84, "F  E  L  O  P  Z  D"), (60, "D  E  F  P  O  T  E  C"), (44, "L  E  F  O  D  P  C  T"),
]  # fmt: skip
WELCOME = ["Six metres away", "is far enough for", "the eye to rest."]


def slide() -> Pixels:
    """The lecture room's slide, 2900 x 1160 mm: a headline, running text and rows of letters."""
    s = Sheet(2900, 1160, 0.62, (252, 252, 250))
    s.box(0, 0, 2900, 235, BLUE)
    s.text(90, 180, "FAR VISION", 165, "Sans-Bold", WHITE)
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


def poster() -> Pixels:
    """A framed poster of the seven colours, 800 x 1130 mm."""
    s = Sheet(800, 1130, 0.8, (250, 249, 245))
    colours = (
        (148, 60, 140),
        (64, 74, 160),
        (58, 130, 190),
        (84, 158, 96),
        (236, 202, 76),
        (230, 140, 62),
        (204, 66, 56),
    )
    for k, colour in enumerate(colours):
        s.disc(400, 470, 330 - 40 * k, colour)
    s.disc(400, 470, 50, (250, 249, 245))
    s.text(400, 930, "OPTICS", 120, "Sans-Bold", at="ms")
    s.text(400, 1010, "Principles of colour", 52, "Serif-Italic", at="ms")
    s.box(0, 0, 800, 1130, None, (40, 42, 46), 26)
    return s.pixels()


_LAMPS = [(x, z) for z in (900.0, 2600.0, 4600.0) for x in (-1300.0, 1300.0)]  # the first two: over the wearer, unseen

# ---- the scene ----


def room() -> Scene:
    """The meeting room."""
    pieces = [
        sheet_facing("page", 392.0, -29.0, (210, 145), page()),
        *document_holder(392.0, -29.0, (210, 145), TABLE),
        *monitor(760.0, -10.4, (390, 182), screen(), TABLE),
        *table(300.0, 3700.0, 1400.0, TABLE, FLOOR, wood((980, 2590), 105, (176, 128, 88))),
        *_chairs(),
        *_on_the_table(),
        *_walls(),
        *_on_the_walls(),
    ]
    lamps = [Lamp((x, CEILING - 40, z), (150, 0, 0), (0, 0, 600), 1.3) for x, z in _LAMPS]
    daylight = Lamp((SIDE - 20, 250, 3400.0), (0, 0, 1500), (0, 700, 0), 1.6)
    looks = {
        "far": Look((0.0, 0.0, WALL - 40), "slide"),
        "intermediate": Look.at(facing(760.0, -10.4)[0], "screen"),
        "near": Look.at(facing(392.0, -29.0)[0], "page"),
    }
    about = "a meeting room: page at 40 cm, monitor at 77 cm, slide at 6 m"
    return build_scene("room", about, pieces, Lights(0.64, 900.0, (*lamps, daylight)), looks)


def _chairs() -> list[Thing]:
    chairs = []
    for z in (1450.0, 2350.0, 3250.0):
        for side in (-1, 1):
            chairs += chair(side * 1000.0, z, FLOOR, -side * 90.0)
    return [*chairs, *chair(0.0, 4420.0, FLOOR, 180.0)]


def _on_the_table() -> list:
    paper = Sheet(210, 297, 2)
    paper.lines(20, 40, ["Agenda", "1  Minutes", "2  Lenses", "3  Any other"], 14)
    pieces: list[Piece] = [mug(-300.0, 640.0, TABLE, (196, 72, 52)), mug(430.0, 1500.0, TABLE, (236, 234, 228))]
    for x, z in ((420.0, 1900.0), (-420.0, 1600.0), (-420.0, 2600.0)):
        pieces.append(lying("papers", (x, TABLE + 1.5, z), (210, 297), paper.pixels()))
    bottle = turned([(0, 0), (36, 0), (36, 150), (16, 200), (16, 228), (0, 228)], 24)
    pieces.append(Thing("bottle", bottle.placed([60, TABLE, 2000]), (86, 132, 116)))
    pieces.append(Thing("bottle", bottle.placed([-60, TABLE, 2090]), (86, 132, 116)))
    return pieces


def _walls() -> list[Panel]:
    height, middle, deep, far = CEILING - FLOOR, (CEILING + FLOOR) / 2, (WALL - NEAREST) / 2, (WALL + NEAREST) / 2
    floor = cloth((900, 1000), (112, 116, 124), 0.07)
    ceiling = tiles((900, 1000), (100, 100), 2, ((240, 240, 237), (200, 202, 203)), 0.0)
    plaster = cloth((400, 200), (234, 230, 221), 0.012)
    brick = tiles((1350, 675), (60, 20), 2, ((206, 172, 146), (228, 220, 208)), 0.5)
    return [
        Panel("wall", [0, middle, WALL], [-SIDE, 0, 0], [0, height / 2, 0], brick),
        Panel("floor", [0, FLOOR, far], [-SIDE, 0, 0], [0, 0, deep], floor),
        Panel("ceiling", [0, CEILING, far], [-SIDE, 0, 0], [0, 0, -deep], ceiling),
        Panel("left wall", [SIDE, middle, far], [0, 0, deep], [0, height / 2, 0], plaster),
        Panel("right wall", [-SIDE, middle, far], [0, 0, -deep], [0, height / 2, 0], plaster),
    ]


def _on_the_walls() -> list:
    front = WALL - 40
    pieces = [
        standing("slide", (0, 180, front), (2900, 1160), slide())._replace(shines=True),
        Thing("frames", box([0, 180, front + 16], [2960, 1220, 30]), (44, 46, 50)),
        Thing("frames", box([0, 815, front + 5], [3060, 70, 70]), (214, 214, 210)),
        standing("clock", (0, 1130, front), (420, 420), clock()),
        standing("door", (2080, FLOOR + 1075, front), (1020, 2150), door()),
        standing("poster", (-2080, 150, front), (800, 1130), poster()),
        *plant(-2200.0, 5400.0, FLOOR),
        Thing("frames", box([0, FLOOR + 50, WALL - 10], [2 * SIDE, 100, 20]), (120, 92, 70)),
    ]
    for z in (1900.0, 3400.0, 4900.0):
        pieces.append(Panel("window", [SIDE - 15, 250, z], [0, 0, 575], [0, 675, 0], window(), True))
        pieces.append(Thing("sills", box([SIDE - 60, -450, z], [140, 40, 1250]), (238, 236, 230)))
    for x, z in _LAMPS[2:]:
        pieces.append(Panel("lamp", [x, CEILING - 32, z], [-150, 0, 0], [0, 0, -600], lamp(), True))
    projector = join([box([0, CEILING - 330, 3000], [330, 120, 280]), cylinder([0, CEILING - 270, 3000], 22, 270)])
    return [*pieces, Thing("projector", projector, (226, 226, 222))]
