"""Reading charts at 40 cm, 60 cm, 1 m and 6 m: rows of five letters from logMAR 1.0 to -0.2, in their true sizes.

A letter of logMAR L is 5 x 10^L minutes of arc high, its strokes a fifth of that; letters stand one letter's width apart,
rows the upper row's height. Distances count from the corneas. Source: Bailey & Lovie 1976; letters after Sloan 1959.
"""

from typing import Any

import numpy as np

from ..optics.conventions import Floats
from .build import Panel, Thing, build_scene
from .drawing import GREY, INK, RED, WHITE, Pixels, Sheet, cloth, wood
from .furniture import DARK, facing, lying, standing, table
from .light import Lamp, Lights
from .scene import CORNEA, Look, Scene
from .solids import box, join, tube

FLOOR, CEILING, TABLE, WALL, SIDE, NEAREST = -1200.0, 1500.0, -560.0, 6100.0, 2000.0, 600.0
CHARTS = {"6 m": (6000.0, 0.0), "1 m": (1000.0, -11.5), "60 cm": (600.0, -22.0), "40 cm": (400.0, -33.0)}
ROWS = (
    "NCKZO",
    "RHSDK",
    "DOVHR",
    "CZRHS",
    "ONHRC",
    "DKSNV",
    "ZSOKN",
    "CKDNR",
    "SRZKD",
    "HZOVC",
    "NVDOK",
    "VHCNO",
    "SVHCZ",
)
_ACUITY = [round(1.0 - 0.1 * k, 1) for k in range(len(ROWS))]

# ---- letters ----

_HALF = np.linspace(-np.pi / 2, np.pi / 2, 24)
_STROKES: dict[str, list[Any]] = {
    "H": [[(0, 0), (1, 0), (1, 5), (0, 5)], [(4, 0), (5, 0), (5, 5), (4, 5)], [(1, 2), (4, 2), (4, 3), (1, 3)]],
    "N": [[(0, 0), (1, 0), (1, 5), (0, 5)], [(4, 0), (5, 0), (5, 5), (4, 5)], [(0, 0), (1, 0), (5, 5), (4, 5)]],
    "V": [[(0, 0), (1.1, 0), (2.5, 3.75), (3.9, 0), (5, 0), (3.05, 5), (1.95, 5)]],
    "Z": [[(0, 0), (5, 0), (5, 1), (0, 1)], [(0, 4), (5, 4), (5, 5), (0, 5)], [(3.7, 1), (5, 1), (1.3, 4), (0, 4)]],
    "K": [
        [(0, 0), (1, 0), (1, 5), (0, 5)],
        [(3.6, 0), (5, 0), (1, 3.7), (1, 2.4)],
        [(1.75, 2.3), (2.5, 1.6), (5, 5), (3.7, 5)],
    ],
}


def draw_letter(s: Sheet, letter: str, x: float, y: float, height: float) -> None:
    """One of the ten Sloan letters in a square of side `height` whose upper left corner is (x, y), mm."""
    u = height / 5

    def shape(points: Any, ink: tuple[int, int, int] = INK) -> None:
        s.shape(np.array([x, y]) + u * np.asarray(points, dtype=float), ink)

    if letter in _STROKES:
        for stroke in _STROKES[letter]:
            shape(stroke)
    elif letter in "OC":
        s.disc(x + 2.5 * u, y + 2.5 * u, 2.5 * u, INK)
        s.disc(x + 2.5 * u, y + 2.5 * u, 1.5 * u, s.paper)
        if letter == "C":
            shape([(2.5, 2), (5.2, 2), (5.2, 3), (2.5, 3)], s.paper)
    elif letter == "D":
        shape([(0, 0), (2.5, 0), *_bow(2.5, 2.5, 2.5), (0, 5)])
        shape([(1, 1), (2.5, 1), *_bow(2.5, 2.5, 1.5), (1, 4)], s.paper)
    elif letter == "R":
        shape([(0, 0), (3.4, 0), *_bow(3.4, 1.5, 1.5), (0, 3)])
        shape([(1, 1), (3.4, 1), *_bow(3.4, 1.5, 0.5), (1, 2)], s.paper)
        shape([(0, 0), (1, 0), (1, 5), (0, 5)])
        shape([(2.1, 3), (3.3, 3), (5, 5), (3.75, 5)])
    else:
        _draw_s(shape, s.paper)


def _bow(x: float, y: float, radius: float) -> Floats:
    """Half a circle open to the left, from its top to its foot."""
    return np.stack([x + radius * np.cos(_HALF), y + radius * np.sin(_HALF)], axis=-1)


def _draw_s(shape: Any, paper: tuple[int, int, int]) -> None:
    """The S: two bows, each with one open quarter."""
    mirror = np.array([5.0, 5.0])
    for turned in (False, True):
        for points, ink in (
            ([(1.5, 0), *_bow(3.5, 1.5, 1.5)[:12], (3.5, 0), (1.5, 0)], None),
            (_ring(1.5, 1.5, 1.5), None),
            (_ring(3.5, 1.5, 1.5), None),
            ([(1.5, 0), (3.5, 0), (3.5, 3), (1.5, 3)], None),
        ):
            shape(mirror - np.asarray(points) if turned else points, *([ink] if ink else []))
    for turned in (False, True):
        for points in (_ring(1.5, 1.5, 0.5), _ring(3.5, 1.5, 0.5), [(1.5, 1), (3.5, 1), (3.5, 2), (1.5, 2)]):
            shape(mirror - np.asarray(points) if turned else points, paper)
        gap = [(3.5, 1.45), (5.1, 1.45), (5.1, 2.02), (3.5, 2.02)]
        shape(mirror - np.asarray(gap) if turned else gap, paper)


def _ring(x: float, y: float, radius: float) -> Floats:
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=-1)


def letter_height(acuity: float, distance: float) -> float:
    """Height (mm) of a letter of an acuity in logMAR at a distance (mm) from the cornea."""
    return 2 * distance * float(np.tan(np.radians(5 * 10**acuity / 60) / 2))


def chart_size(distance: float) -> tuple[float, float]:
    """Width and height (mm) of the sheet for a distance."""
    largest = letter_height(_ACUITY[0], distance)
    rows = sum(2 * letter_height(a, distance) for a in _ACUITY)
    return 13.4 * largest, rows + 1.2 * largest


def chart_sheet(label: str, distance: float) -> Pixels:
    """The chart (h, w, 3), finer than half a minute of arc; label: its distance as printed."""
    width, height = chart_size(distance)
    s = Sheet(width, height, 1320 / width, (250, 250, 248))
    top = 0.55 * letter_height(_ACUITY[0], distance)
    for acuity, letters in zip(_ACUITY, ROWS, strict=True):
        tall = letter_height(acuity, distance)
        left = width / 2 - 4.5 * tall
        for k, letter in enumerate(letters):
            draw_letter(s, letter, left + 2 * k * tall, top, tall)
        small = 0.30 * letter_height(1.0, distance)
        s.text(width * 0.985, top + tall / 2, f"{acuity:.1f}", small, "Sans", GREY, "rm")
        top += 2 * tall
    s.text(width * 0.02, height - 0.02 * width, label, 0.035 * width, "Sans-Bold", RED)
    s.text(width * 0.985, height - 0.02 * width, "logMAR", 0.022 * width, "Sans", GREY, "rs")
    return s.pixels()


# ---- the scene ----


def chart() -> Scene:
    """The reading charts."""
    pieces: list[Any] = [
        *_walls(),
        *table(260.0, 1250.0, 1500.0, TABLE, FLOOR, wood((1500, 1250), 125, (196, 158, 118))),
    ]
    looks = {}
    for label, (distance, elevation) in CHARTS.items():
        name = f"chart {label}"
        size = chart_size(distance)
        centre, up = facing(distance, elevation)
        half = [-size[0] / 2, 0, 0], size[1] / 2 * up
        sheet = Panel(name, centre + CORNEA, *half, chart_sheet(label, distance))
        pieces += [sheet._replace(shines=distance > 2000), *_board(distance, elevation, size)]
        looks[label] = Look.at(centre + CORNEA, name)
    for side in (-1, 1):
        pieces.append(standing("dial", (side * 1250, 0, 6000), (900, 900), _dial() if side > 0 else _grating()))
        pieces.append(Thing("boards", box([side * 1250, 0, 6018], [940, 940, 30]), (60, 62, 66)))
    lamps = [
        Lamp((x, CEILING - 30, z), (150, 0, 0), (0, 0, 600), 1.0)
        for z in (700.0, 2600.0, 4700.0)
        for x in (-900.0, 900.0)
    ]
    looks = {"far": looks["6 m"], "intermediate": looks["1 m"], "60 cm": looks["60 cm"], "near": looks["40 cm"]}
    about = "logMAR letters in their true sizes at 6 m, 1 m, 60 cm and 40 cm"
    return build_scene("chart", about, pieces, Lights(0.78, 900.0, tuple(lamps)), looks)


def _board(distance: float, elevation: float, size: tuple[float, float]) -> list[Thing]:
    """The board behind a chart; on the table, with a leg."""
    centre, _ = facing(distance, elevation)
    ahead, centre = centre / distance, centre + CORNEA
    thick = 5.0 if distance < 2000 else 30.0
    board = box([0, 0, thick / 2 + 1], [size[0] * 1.03, size[1] * 1.03, thick]).placed(centre, -elevation)
    things = [Thing("boards", board, (60, 62, 66))]
    if distance < 2000:
        top = centre + 8 * ahead
        leg = tube([top, [0, top[1] - 20, top[2] + 30], [0, TABLE, top[2] + 30]], 7)
        foot = box([0, TABLE + 5, top[2] + 30], [130, 10, 90])
        things.append(Thing("stands", join([leg, foot]), DARK))
    return things


def _walls() -> list[Panel]:
    height, middle = CEILING - FLOOR, (CEILING + FLOOR) / 2
    deep, far = (WALL - NEAREST) / 2, (WALL + NEAREST) / 2
    plaster = cloth((400, 200), (214, 222, 224), 0.01)
    floor = cloth((700, 900), (150, 140, 126), 0.04)
    return [
        Panel("wall", [0, middle, WALL], [-SIDE, 0, 0], [0, height / 2, 0], plaster),
        lying("floor", (0, FLOOR, far), (2 * SIDE, 2 * deep), floor),
        Panel("ceiling", [0, CEILING, far], [-SIDE, 0, 0], [0, 0, -deep], cloth((300, 300), (240, 240, 238), 0.008)),
        Panel("left wall", [SIDE, middle, far], [0, 0, deep], [0, height / 2, 0], plaster),
        Panel("right wall", [-SIDE, middle, far], [0, 0, -deep], [0, height / 2, 0], plaster),
    ]


def _dial() -> Pixels:
    """An astigmatic dial, 900 mm: a line every 15 degrees, numbered as on a clock."""
    s = Sheet(900, 900, 0.9, WHITE)
    for k in range(24):
        a = np.radians(15 * k)
        line = np.array([[150 * np.sin(a), -150 * np.cos(a)], [330 * np.sin(a), -330 * np.cos(a)]]) + 450
        s.line(line, 9)
        if k % 2 == 0:
            s.text(450 + 390 * np.sin(a), 450 - 390 * np.cos(a), str(k // 2 or 12), 52, "Sans-Bold", at="mm")
    return s.pixels()


def _grating() -> Pixels:
    """Gratings of 1, 2, 4 and 8 minutes of arc a bar at 6 m, across and upright."""
    s = Sheet(900, 900, 2.0, WHITE)
    for row in range(2):
        for k, bar in enumerate((1.75, 3.5, 7.0, 14.0)):
            x, y = 60 + 205 * k, 130 + 370 * row
            thick = bar - 1 / s.scale
            for at in np.arange(0.0, 160.0 if row == 0 else 250.0, 2 * bar):
                if row == 0:
                    s.box(x + at, y, thick, 250, INK)
                else:
                    s.box(x, y + at, 160, thick, INK)
            s.text(x + 80, y - 20, f"{2**k}'", 48, "Sans-Bold", at="ms")
    return s.pixels()
