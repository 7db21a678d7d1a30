"""A desk at a window: a letter at 43 cm, a phone at 41 cm, a keyboard at 66 cm, a monitor at 73 cm, houses at 30 m."""

import numpy as np

from .build import Panel, Thing, build_scene
from .drawing import BLUE, GREY, INK, RED, WHITE, Colour, Pixels, Sheet, cloth, darker, wood
from .furniture import DARK, STEEL, facing, lying, monitor, mug, plant, standing, table
from .light import Lamp, Lights
from .prints import PARAGRAPH, star
from .scene import Look, Scene
from .sky import sky_part, summer_sky
from .solids import Solid, box, cylinder, extruded, join, tube, turned

FLOOR, CEILING, DESK, WALL, SIDE, NEAREST = -1200.0, 1400.0, -460.0, 2600.0, 2300.0, 500.0
PANE = (-900.0, 900.0, -330.0, 900.0)  # left edge, right edge, sill and lintel of the window
STREET = -7000.0
KEYS = ("1234567890-=", "QWERTYUIOP[]", "ASDFGHJKL;'#", "ZXCVBNM,./")


def desk() -> Scene:
    """The desk."""
    sheet, phone = (-125.0, -232.0, 322.0), (150.0, -225.0, 298.0)
    pieces = [
        *monitor(720.0, -13.5, (530, 300), dashboard(), DESK),
        *table(230.0, 800.0, 1800.0, DESK, FLOOR, wood((1800, 800), 133, (206, 170, 128))),
        *_tilted("sheet", sheet, (180, 232), letter_page()),
        *_phone(phone),
        *_keyboard(),
        *_around(),
        *_room(),
        *_street(),
    ]
    looks = {
        "far": Look((250.0, 120.0, 30000.0), "houses"),
        "intermediate": Look.at(facing(720.0, -13.5)[0], "screen"),
        "near": Look(sheet, "sheet"),
        "phone": Look(phone, "phone screen"),
        "keyboard": Look((0.0, DESK + 19, 480.0), "keys"),
    }
    lights = Lights(
        0.62,
        600.0,
        (
            Lamp((0, CEILING - 20, 900.0), (400, 0, 0), (0, 0, 400), 1.1),
            Lamp((0, 300, WALL - 20), (-900, 0, 0), (0, 600, 0), 1.3),
        ),
        ((0.4, 0.8, -0.5), 0.45),
    )
    about = "a desk at a window: letter at 43 cm, phone at 41 cm, keyboard, monitor at 73 cm, houses at 30 m"
    return build_scene("desk", about, pieces, lights, looks, sky=sky_part(summer_sky(), (-45, 45), (-10, 50)))


# ---- drawings ----


def dashboard() -> Pixels:
    """A monitor's picture, 530 x 300 mm: a design program with a map, its legend and a mail."""
    s = Sheet(530, 300, 4, (236, 239, 243))
    s.box(0, 0, 530, 17, (42, 48, 58))
    s.text(10, 12.5, "Lens designer  —  progressive 2.00 D, right", 8, "Sans", WHITE)
    s.box(0, 17, 62, 283, (58, 66, 78))
    for k, name in enumerate(("Order", "Surface", "Maps", "Ellipses", "Views", "Report")):
        if k == 2:
            s.box(0, 26 + 22 * k, 62, 20, BLUE)
        s.text(8, 39.5 + 22 * k, name, 8, "Sans", WHITE)
    _contour_map(s, 78, 32, 200)
    s.text(292, 46, "Mean power", 13, "Sans-Bold", INK)
    rows = [
        ("distance", "+0.02 D"),
        ("near", "+1.98 D"),
        ("corridor", "13.5 mm"),
        ("inset", "2.5 mm"),
        ("astigmatism", "1.96 D"),
    ]
    for k, (name, value) in enumerate(rows):
        y = 66 + 15 * k
        s.box(290, y - 10, 226, 14, WHITE if k % 2 else (222, 230, 241))
        s.text(296, y, name, 9, "Sans")
        s.text(510, y, value, 9, "Sans-Bold", at="rs")
    s.card(290, 146, 226, 138, 5, WHITE)
    s.text(300, 162, "To: laboratory", 9, "Sans-Bold", BLUE)
    lines = [
        "Please surface this pair by",
        "Thursday. The frame is deep,",
        "so keep the corridor at",
        "thirteen millimetres and do",
        "check the edge. Thank you!",
    ]
    s.lines(300, 180, lines, 10.5, "Sans")
    for k, size in enumerate((6, 4.5, 3.4, 2.6)):
        s.text(300, 250 + 9 * k, "The smallest line shows how fine the zone is.", size, "Sans")
    for k, colour in enumerate(_MAP):
        s.box(82 + 24 * k, 250, 24, 10, colour)
        s.text(82 + 24 * k, 272, f"{0.25 * k:.2f}", 6.5, "Sans")
    s.text(82, 288, "D", 8, "Sans", GREY)
    return s.pixels()


_MAP: tuple[Colour, ...] = (
    (250, 244, 214), (240, 224, 160), (224, 204, 120), (196, 190, 104),
    (150, 176, 110), (100, 156, 122), (64, 130, 132), (46, 98, 128),
)  # fmt: skip


def _contour_map(s: Sheet, x: float, y: float, size: float) -> None:
    """A power map of a progressive as a coloured disc."""
    n = round(size * s.scale)
    v, u = np.mgrid[1 : -1 : n * 1j, -1 : 1 : n * 1j]
    power = 2.0 / (1 + np.exp(7 * (v + 0.25))) / (1 + 1.4 * u**2 * (0.4 + np.abs(v)))
    colours = np.array(_MAP, dtype=np.uint8)[np.clip((power / 0.25).astype(int), 0, len(_MAP) - 1)]
    colours[np.hypot(u, v) > 0.97] = s.paper
    s.put(x, y, colours)
    for dx, dy in ((0, -0.1), (0, 0.1)):
        s.line([(x + size / 2 - 5, y + size * (0.45 + dy)), (x + size / 2 + 5 + dx, y + size * (0.45 + dy))], 1)


def letter_page() -> Pixels:
    """A printed letter, 180 x 232 mm."""
    s = Sheet(180, 232, 7)
    s.text(12, 20, "J. H. Lambert & Daughters", 6.6, "Serif-Bold")
    s.text(168, 20, "Opticians", 6.6, "Serif-Italic", BLUE, "rs")
    s.line([(12, 25), (168, 25)], 0.5)
    s.lines(12, 40, ["Dear colleague,", "", *PARAGRAPH[:4]], 5.6)
    s.lines(
        12,
        86,
        [
            "Please read this letter with the lower part of your",
            "lenses, and tell us which of its lines you can still",
            "read without moving your head or the sheet.",
        ],
        3.9,
    )
    for k, size in enumerate((4.4, 3.6, 2.9, 2.3, 1.8)):
        s.text(12, 112 + 8.2 * k, f"{size * 2.83:.0f} pt  sphinx of black quartz, judge my vow", size, "Sans")
    star(s, 146, 132, 20)
    for k in range(5):
        s.box(12, 164 + 8 * k, 156, 8, (233, 238, 245) if k % 2 else WHITE)
        row = ("right", "+0.50", "-0.75", f"{15 * k + 90}", "2.00")
        for x, cell in zip((30, 62, 94, 126, 158), row, strict=True):
            s.text(x, 169.8 + 8 * k, cell, 4.4, "Sans", at="ms")
    s.text(12, 222, "Yours sincerely,  Johann", 6, "Serif-Italic", BLUE)
    return s.pixels()


def phone_screen() -> Pixels:
    """A phone's screen, 68 x 144 mm: messages."""
    s = Sheet(68, 144, 13, (246, 247, 249))
    s.box(0, 0, 68, 13, (34, 118, 92))
    s.text(5, 9, "Anna", 5, "Sans-Bold", WHITE)
    s.text(64, 9, "10:09", 4, "Sans", WHITE, "rs")
    talk = [
        ("Are the new lenses", "ready yet?", 0),
        ("Yes! Come by at", "half past four.", 1),
        ("And the reading", "zone is wider?", 0),
        ("Try it with this", "text message.", 1),
        ("Very sharp, thanks", "a lot. See you!", 0),
    ]
    for k, (first, second, mine) in enumerate(talk):
        x, y = 4 + 10 * mine, 18 + 22 * k
        s.card(x, y, 50, 18, 3, (214, 240, 222) if mine else WHITE)
        s.text(x + 3, y + 7, first, 4.2, "Sans")
        s.text(x + 3, y + 13.5, second, 4.2, "Sans")
    s.card(3, 129, 62, 11, 5, WHITE)
    s.text(8, 136, "Message", 4, "Sans", GREY)
    return s.pixels()


def keys() -> Pixels:
    """The keys of a keyboard, 340 x 120 mm."""
    s = Sheet(340, 120, 4, (46, 49, 54))
    for row, letters in enumerate(KEYS):
        for k, key in enumerate(letters):
            _key(s, 10 + 7 * row + 24.6 * k, 6 + 22.6 * row, 22, key)
    for x, w in ((10, 40), (52, 26), (80, 150), (232, 26), (260, 70)):
        _key(s, x, 96.5, w, "")
    return s.pixels()


def _key(s: Sheet, x: float, y: float, w: float, letter: str) -> None:
    s.card(x, y, w, 20, 3, (34, 36, 40))
    s.card(x + 0.6, y + 0.4, w - 1.2, 18, 3, (78, 82, 90))
    s.card(x + 2, y + 1.2, w - 4, 15, 2.5, (92, 97, 106))
    s.text(x + w / 2, y + 12.5, letter, 9, "Sans-Bold", (240, 242, 244), at="ms")


def houses() -> Pixels:
    """A street front, 48 x 14 m: four houses with shops."""
    s = Sheet(48000, 14000, 0.03, (150, 150, 150))
    fronts = ((196, 110, 84), (226, 200, 150), (170, 184, 190), (212, 156, 120))
    for k, colour in enumerate(fronts):
        x, top = 12000.0 * k, (900, 0, 1500, 500)[k]
        s.box(x, top, 11950, 14000 - top, colour)
        s.box(x, top, 11950, 350, darker(colour, 0.8))
        for floor in range(3):
            for j in range(4):
                wx, wy = x + 900 + 2800 * j, top + 1300 + 3000 * floor
                s.box(wx - 120, wy - 120, 1640, 2040, (244, 242, 236))
                s.box(wx, wy, 1400, 1800, (92, 116, 134))
                s.box(wx + 650, wy, 90, 1800, (244, 242, 236))
        s.box(x + 400, 10600, 11100, 3400, (54, 62, 70))
        s.box(x + 700, 11700, 10500, 2300, (168, 190, 200))
        s.box(x + 400, 10500, 11100, 1050, (36, 88, 96) if k % 2 else (120, 40, 44))
        s.text(x + 5950, 11330, ("BAKERY", "OPTICIAN", "BOOKS", "FLOWERS")[k], 900, "Sans-Bold", WHITE, "ms")
    return s.pixels()


# ---- pieces ----


def _tilted(name: str, at: tuple[float, float, float], size: tuple[float, float], image: Pixels) -> list:
    """A sheet that faces the eye on a slanted board on the desk."""
    x, y, z = at
    ahead = np.array([0.0, y, z]) / np.hypot(y, z)
    up = np.array([0.0, ahead[2], -ahead[1]])
    elevation = float(np.degrees(np.arcsin(ahead[1])))
    board = box([0, 0, 4], [size[0] + 14, size[1] + 14, 6]).placed([x, y, z], -elevation)
    prop = tube([[x, y, z + 12], [x, DESK + 6, z + 110]], 6)
    foot = box([x, DESK + 5, z + 70], [120, 10, 130])
    return [
        Panel(name, np.array(at), [-size[0] / 2, 0, 0], size[1] / 2 * up, image),
        Thing("boards", board, (118, 84, 56)),
        Thing("stands", join([prop, foot]), DARK),
    ]


def _phone(at: tuple[float, float, float]) -> list:
    panel, *stand = _tilted("phone screen", at, (68, 144), phone_screen())
    return [panel._replace(shines=True), *(thing._replace(colour=(30, 31, 34)) for thing in stand)]


def _keyboard() -> list:
    body = box([0, DESK + 8, 480], [356, 16, 136], without="+y")
    mouse = turned([(32, 0), (32, 4), (26, 16), (14, 24), (0, 26)], 28, smooth=True)
    mouse = Solid(mouse.points * [1.0, 1.0, 1.7], mouse.triangles, mouse.normals)
    return [
        lying("keys", (0, DESK + 17, 480.0), (356, 136), keys()),
        Thing("keyboard", body, (40, 43, 48)),
        lying("mat", (-330, DESK + 2, 470.0), (230, 200), cloth((230, 200), (48, 62, 82), 0.08)),
        Thing("mouse", mouse.placed([-330, DESK + 4, 470]), (210, 212, 214)),
    ]


def _around() -> list:
    books = []
    for k, (w, h, d) in enumerate(((150, 34, 220), (142, 26, 210), (158, 40, 226), (135, 22, 200))):
        foot = DESK + (0, 34, 60, 100)[k]
        colour = ((150, 46, 44), (44, 84, 120), (206, 168, 90), (70, 104, 80))[k]
        books.append(Thing("books", box([560, foot + h / 2, 640], [d, h, w]), colour))
    arm = tube(np.array([[-640, DESK + 12, 760], [-560, 10, 800], [-430, 90, 640]]), 8)
    shade = turned([(84, 0), (86, 0), (34, 80), (24, 90), (0, 92)], 36).placed([-430, 20, 640], 18)
    base = turned([(90, 0), (86, 14), (0, 14)], 40).placed([-640, DESK, 760])
    pens = [
        Thing(
            "pens",
            tube(np.array([[400.0 + 9 * k, DESK + 20, 720], [392 + 14 * k, DESK + 165 - 6 * k, 726 + 4 * k]]), 3.6, 8),
            c,
        )
        for k, c in enumerate((RED, BLUE, (70, 130, 80), (226, 180, 60)))
    ]
    cup = turned([(0, 0), (36, 0), (38, 100), (34, 100), (33, 8)], 28).placed([415, DESK, 720])
    return [
        *books,
        Thing("desk lamp", join([arm, base]), STEEL),
        Thing("desk lamp", shade, (58, 110, 104)),
        *pens,
        Thing("cup", cup, (226, 222, 214)),
        mug(430.0, 520.0, DESK, (232, 228, 220)),
    ]


def _room() -> list:
    left, right, sill, lintel = PANE
    paint = cloth((300, 200), (228, 226, 216), 0.012)
    deep, far, middle = (WALL - NEAREST) / 2, (WALL + NEAREST) / 2, (CEILING + FLOOR) / 2
    wall = [
        _wall((-SIDE, left), (FLOOR, CEILING), paint),
        _wall((right, SIDE), (FLOOR, CEILING), paint),
        _wall((left, right), (FLOOR, sill), paint),
        _wall((left, right), (lintel, CEILING), paint),
    ]
    bars = [
        box([x, (sill + lintel) / 2, WALL + 20], [60, lintel - sill, 60]) for x in (left + 30, -320, 320, right - 30)
    ]
    bars += [box([0, y, WALL + 20], [right - left, 60, 58]) for y in (sill + 30, lintel - 30)]
    ledge = box([0, sill - 15, WALL - 90], [right - left + 160, 30, 190])
    return [
        *wall,
        lying("floor", (0, FLOOR, far), (2 * SIDE, 2 * deep), wood((900, 420), 30, (150, 108, 74))),
        Panel("ceiling", [0, CEILING, far], [-SIDE, 0, 0], [0, 0, -deep], cloth((200, 200), (242, 241, 238), 0.008)),
        Panel("left wall", [SIDE, middle, far], [0, 0, deep], [0, (CEILING - FLOOR) / 2, 0], paint),
        Panel("right wall", [-SIDE, middle, far], [0, 0, -deep], [0, (CEILING - FLOOR) / 2, 0], paint),
        standing("calendar", (-1400.0, 220.0, WALL - 6), (520, 680), _calendar()),
        Thing("window frame", join([*bars, ledge]), (244, 243, 238)),
        *plant(1300.0, WALL - 350, FLOOR + 500),
        Thing("chest", box([1350, FLOOR + 250, WALL - 300], [900, 500, 480]), (168, 122, 84)),
    ]


def _wall(x: tuple[float, float], y: tuple[float, float], paint: Pixels) -> Panel:
    half = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    return standing("wall", (sum(x) / 2, sum(y) / 2, WALL), (2 * half[0], 2 * half[1]), paint)


def _calendar() -> Pixels:
    s = Sheet(520, 680, 1.4, WHITE)
    s.box(0, 0, 520, 120, RED)
    s.text(260, 84, "NOVEMBER", 66, "Sans-Bold", WHITE, "ms")
    for day in range(30):
        x, y = 60 + 66 * (day % 7), 200 + 92 * (day // 7)
        s.text(x, y, str(day + 1), 46, "Sans-Bold" if day % 7 < 5 else "Sans", INK if day % 7 < 6 else RED, "ms")
    return s.pixels()


def _street() -> list:
    trees = []
    for x in (-7600.0, -2600.0, 3900.0, 8600.0):
        crown = turned([(0, -1700), (1300, -900), (1700, 100), (1100, 1300), (0, 1800)], 20, smooth=True)
        trees.append(Thing("trees", crown.placed([x, STREET + 4300, 22000]), (86, 130, 66)))
        trees.append(Thing("trees", cylinder([x, STREET, 22000], 170, 3000, 10), (104, 84, 66)))
    car = [(-2000, 250), (2000, 250), (2050, 800), (1250, 900), (800, 1400), (-900, 1400), (-1500, 900), (-2050, 800)]
    return [
        standing("houses", (2000.0, STREET + 7000, 30000.0), (48000, 14000), houses()),
        lying("street", (0.0, STREET, 22000.0), (60000, 17000), cloth((600, 200), (116, 116, 118), 0.05)),
        *trees,
        Thing("cars", extruded(car, 1500).placed([1500, STREET, 18000]), (52, 92, 160)),
        Thing("cars", extruded(car, 1500).placed([-5200, STREET, 18400]), (196, 60, 54)),
    ]
