"""A car's driver's seat: instruments and wheel at 70 cm, a navigation screen, mirrors, and a road to the horizon."""

import numpy as np

from ..optics.conventions import Floats
from .build import Panel, Thing, build_scene
from .drawing import INK, RED, WHITE, Colour, Pixels, Sheet, cloth, darker, plain, soften
from .furniture import standing
from .light import Lights
from .scene import Look, Scene
from .sky import sky_part, summer_sky
from .solids import Solid, athwart, box, cylinder, join, ring, tube, turned

ROAD, LANE = -1250.0, 3500.0
CAR = -370.0  # x of the car's middle, which is the middle of its lane: the driver sits on the left
KERB, CENTRE = CAR - LANE / 2, CAR + LANE / 2
STRETCHES = (
    (2200, 8000, 120),
    (8000, 24000, 60),
    (24000, 70000, 30),
    (70000, 600000, 10),
)  # z, z, texels a metre across
REAR = [
    (-0.98, -0.8),
    (-0.84, -1),
    (0.84, -1),
    (0.98, -0.8),
    (0.98, 0.2),
    (0.82, 0.32),
    (0.63, 1),
    (-0.63, 1),
    (-0.82, 0.32),
    (-0.98, 0.2),
]
BLACK, TRIM, CREAM = (38, 40, 43), (58, 60, 64), (205, 200, 190)


def cockpit() -> Scene:
    """The driver's seat."""
    pieces = [*_dashboard(), *_wheel(), *_body(), *_road(), *_signs(), *_traffic(), *_trees()]
    looks = {
        "far": Look((CAR, ROAD + 800, 24000.0), "car ahead"),
        "sign": Look((KERB - 900, ROAD + 2600, 45000.0), "signs"),
        "instruments": Look((0.0, -222.0, 628.0), "instruments"),
        "navigation": Look((-390.0, -240.0, 625.0), "navigation"),
        "mirror": Look((-330.0, 205.0, 480.0), "mirror"),
    }
    lights = Lights(0.72, 900.0, (), ((0.35, 0.75, -0.45), 0.6))
    about = "a driver's seat: instruments at 68 cm, navigation at 79 cm, signs at 45 m, a car at 24 m, the road to the horizon"
    return build_scene(
        "cockpit", about, pieces, lights, looks, sky=sky_part(summer_sky(), (-75, 75), (-6, 55)), background=BLACK
    )


# ---- drawings ----


def instruments() -> Pixels:
    """Two gauges and a display, 300 x 112 mm."""
    s = Sheet(300, 112, 7, (16, 18, 22))
    _gauge(s, 62, 58, 48, [str(20 * k) for k in range(12)], "km/h", 0.375)
    _gauge(s, 238, 58, 48, [str(k) for k in range(8)], "x1000", 0.30)
    s.card(118, 20, 64, 76, 4, (28, 34, 44))
    s.text(150, 40, "82", 20, "Sans-Bold", WHITE, "ms")
    s.text(150, 49, "km/h", 6, "Sans", (170, 190, 210), "ms")
    s.text(150, 66, "21.5 °C", 8, "Sans", (210, 220, 230), "ms")
    s.text(150, 78, "128 406 km", 6.5, "Sans", (210, 220, 230), "ms")
    s.text(150, 89, "trip 36.2", 5.5, "Sans", (170, 190, 210), "ms")
    s.shape([(143, 12), (136, 7.5), (143, 3)], (70, 190, 90))
    s.disc(158, 7.5, 3, (240, 170, 60))
    return s.pixels()


def _gauge(s: Sheet, x: float, y: float, radius: float, numbers: list[str], unit: str, value: float) -> None:
    """A round gauge. value: place of its needle, 0 to 1."""
    s.disc(x, y, radius, (24, 27, 32), (120, 128, 136), 1.2)

    def at(share: float, r: float) -> tuple[float, float]:
        a = np.radians(-135 + 270 * share)
        return x + r * radius * float(np.sin(a)), y - r * radius * float(np.cos(a))

    steps = 2 * (len(numbers) - 1)
    for k in range(steps + 1):
        s.line([at(k / steps, 0.86 if k % 2 else 0.80), at(k / steps, 0.93)], 0.7 if k % 2 else 1.2, WHITE)
        if k % 2 == 0:
            s.text(*at(k / steps, 0.64), numbers[k // 2], 66 / (4 + len(numbers)), "Sans-Bold", WHITE, "mm")
    s.text(x, y + 0.55 * radius, unit, 5.5, "Sans", (170, 190, 210), "mm")
    s.line([at(value, -0.12), at(value, 0.82)], 1.8, (226, 60, 44))
    s.disc(x, y, 5, (60, 64, 70))


def navigation() -> Pixels:
    """A navigation screen, 250 x 150 mm."""
    s = Sheet(250, 150, 6, (224, 228, 218))
    for k in range(7):
        s.line([(-10, 20 + 30 * k), (260, -10 + 26 * k)], 3.4, WHITE)
        s.line([(20 + 44 * k, -5), (6 + 40 * k, 155)], 3.4, WHITE)
    s.shape([(150, 0), (250, 0), (250, 60), (185, 44)], (178, 208, 168))
    s.shape([(0, 104), (60, 118), (84, 150), (0, 150)], (168, 200, 226))
    s.line([(118, 155), (122, 92), (166, 72), (172, -5)], 6.5, (52, 116, 214))
    s.shape([(120, 96), (112, 116), (120, 111), (128, 116)], RED)
    s.card(6, 6, 104, 44, 4, (30, 96, 70))
    s.shape([(16, 30), (26, 14), (36, 30), (30, 30), (30, 42), (22, 42), (22, 30)], WHITE)
    s.text(44, 27, "350 m", 15, "Sans-Bold", WHITE)
    s.text(44, 42, "Snellius Road", 8.5, "Sans", WHITE)
    s.card(150, 122, 94, 22, 4, (246, 247, 248))
    s.text(156, 137, "10:42   12 min   8.4 km", 7, "Sans-Bold", INK)
    return s.pixels()


def _behind() -> Pixels:
    """What the mirror shows: the road behind, 236 x 62 mm."""
    s = Sheet(236, 62, 5)
    s.fade(0, 0, 236, 30, ((150, 186, 226), (214, 226, 236)))
    s.fade(0, 30, 236, 32, ((96, 118, 74), (120, 138, 86)))
    s.shape([(112, 30), (124, 30), (190, 62), (40, 62)], (112, 112, 114))
    for k in range(4):
        s.line([(118 - 3 * k - 0.5, 32 + 7 * k), (117 - 4 * k, 35 + 8 * k)], 0.6 + 0.5 * k, WHITE)
    s.shape([(128, 38), (146, 38), (150, 45), (150, 54), (124, 54), (124, 45)], (176, 40, 44))
    s.box(128.5, 40, 17, 5, (60, 76, 88))
    for x in (126, 144):
        s.box(x, 47, 4.5, 2.6, (250, 246, 214))
    return s.pixels()


def _asphalt(width: float, near: float, far: float, fine: float) -> Pixels:
    """A stretch of road, seen from above with the far end at the top: edge lines and a broken centre line, true to its z."""
    tall = int(np.clip((far - near) / 1000 * fine / 2, 64, 1400))
    size = round(width / 1000 * fine), tall
    road = cloth(size, (112, 113, 116), 0.035).astype(float)
    x = (np.arange(size[0])[None] + 0.5) / size[0] * width
    z = far - (np.arange(tall)[:, None] + 0.5) / tall * (far - near)
    left, middle, right = 350.0, LANE, width - 350.0
    marks = (np.abs(x - left) < 75) | (np.abs(x - right) < 75) | ((np.abs(x - middle) < 75) & (z % 9000 < 4000))
    tracks = np.exp(-(((x[..., None] - [1000, 2500, 4500, 6000]) / 260) ** 2)).sum(axis=-1)
    road *= 1 - 0.07 * tracks[..., None]
    road[np.broadcast_to(marks, road.shape[:2])] = (236, 236, 230)
    return np.clip(road, 0, 255).astype(np.uint8)


def _sign(kind: str, lines: list[str]) -> Pixels:
    """A road sign: "limit" (a disc), "towns" (a blue board) or "bend" (a red board with arrows)."""
    if kind == "limit":
        s = Sheet(900, 900, 0.5, (112, 136, 104))
        s.disc(450, 450, 448, (120, 122, 124))
        s.disc(450, 450, 440, RED)
        s.disc(450, 450, 340, WHITE)
        s.text(450, 450, lines[0], 400, "Sans-Bold", INK, "mm")
        return s.pixels()
    s = Sheet(3000, 1700, 0.4, (16, 72, 150))
    s.box(40, 40, 2920, 1620, None, WHITE, 36)
    for k, line in enumerate(lines):
        name, distance = line.rsplit(" ", 1)
        s.text(200, 560 + 480 * k, name, 360, "Sans-Bold", WHITE)
        s.text(2800, 560 + 480 * k, distance, 360, "Sans-Bold", WHITE, "rs")
    return s.pixels()


def _tail(colour: Colour, plate: str) -> Pixels:
    """A car's rear, 1760 x 1330 mm."""
    s = Sheet(1760, 1330, 0.7, (112, 113, 116))
    s.shape([(330, 0), (1430, 0), (1600, 470), (160, 470)], colour)
    s.shape([(390, 60), (1370, 60), (1500, 430), (260, 430)], (44, 56, 66))
    s.card(20, 440, 1720, 760, 120, colour)
    s.box(20, 1000, 1720, 130, darker(colour, 0.45))
    for x in (60, 1400):
        s.card(x, 560, 300, 150, 40, (196, 22, 26))
        s.card(x + 30, 650, 120, 50, 20, (250, 180, 90))
    s.box(620, 830, 520, 115, WHITE, INK, 8)
    s.text(880, 918, plate, 92, "Sans-Bold", INK, "ms")
    for x in (130, 1390):
        s.box(x, 1130, 240, 200, (26, 26, 28))
    return s.pixels()


# ---- the car ----


def _dashboard() -> list:
    top = [(640, -460), (1180, -460), (1180, -165), (900, -134), (700, -128), (640, -150)]
    body = athwart(top, CAR - 875.0, CAR + 875.0)
    turn = np.linspace(0, np.pi, 25)
    arch = np.stack([168 * np.cos(turn), -270 + 116 * np.sin(turn) ** 0.6, np.full(25, 606.0)], axis=-1)
    vents = [box([x, -215, 636], [120, 56, 12]) for x in (-205.0, -600.0, -1130.0)]
    slats = [box([x, -215 + 11 * k, 628], [108, 3, 6]) for x in (-205.0, -600.0, -1130.0) for k in range(-2, 3)]
    knobs = [turned([(24, 0), (22, 16), (0, 16)], 24).placed([x, -368, 632], -90) for x in (-460.0, -390.0, -320.0)]
    return [
        Thing("dashboard", body, BLACK),
        Thing("dashboard", tube(arch, 13), (32, 34, 37)),
        Thing("dashboard", join([*vents, *[box([-390, -240, 634], [276, 176, 14])]]), (24, 25, 27)),
        Thing("dashboard", join([*slats, *knobs]), (110, 114, 118)),
        Panel("footwell", [CAR, -800, 660], [-900, 0, 0], [0, 420, 0], plain(BLACK)),
        Thing("dashboard", box([-870, -330, 634], [420, 14, 10]), (150, 152, 154)),
        Panel("instruments", (0.0, -222.0, 628.0), [-150, 0, 0], [0, 54, 14], instruments(), True),
        Panel("navigation", (-390.0, -240.0, 625.0), [-125, 0, 0], [0, 75, 0], navigation(), True),
    ]


def _wheel() -> list[Thing]:
    tilt, centre = 24.0, [0.0, -285.0, 470.0]
    rim = tube(ring([0, 0, 0], 188), 15, 16, closed=True)
    spokes = [tube([[s * 40, -12, 10], [s * 110, -8, 4], [s * 186, 4, 0]], 13, 10) for s in (-1, 1)]
    spokes.append(tube([[0, -50, 10], [0, -120, 4], [0, -186, 0]], 13, 10))
    hub = turned([(0, 22), (40, 20), (58, 8), (62, -6), (0, -14)][::-1], 36).placed([0, 0, 8], -90)
    badge = turned([(20, 0), (19, 4), (0, 4)], 24).placed([0, 0, -16], -90)
    things = [(join([rim]), (30, 31, 33)), (join([*spokes, hub]), TRIM), (badge, (190, 192, 194))]
    stalks = [tube([[s * 60, -285, 560], [s * 185, -262, 560]], 8, 10) for s in (-1, 1)]
    return [
        *(Thing("wheel", solid.placed(centre, tilt), c) for solid, c in things),
        Thing("stalks", join(stalks), BLACK),
    ]


def _body() -> list:
    def strip(path: list[list[float]], radius: float) -> Solid:
        return tube(_smooth(np.array(path)), radius, 12)

    pillars = [
        strip([[470, -150, 1010], [505, 120, 760], [470, 330, 420]], 42),
        strip([[-1210, -150, 1010], [-1245, 120, 760], [-1210, 330, 420]], 42),
        strip([[470, 330, 420], [200, 372, 500], [CAR, 384, 530], [-940, 372, 500], [-1210, 330, 420]], 40),
    ]
    doors = [
        strip([[500, -160, 1000], [520, -190, 600], [520, -200, 300]], 46),
        strip([[-1240, -160, 1000], [-1260, -190, 600], [-1260, -200, 300]], 46),
    ]
    bonnet = [(1190, -600), (2180, -600), (2150, -228), (1900, -186), (1500, -172), (1190, -185)]
    shape = athwart(bonnet, CAR - 820.0, CAR + 820.0)
    mirror = box([-330, 205, 492], [252, 78, 22])
    stem = tube([[-330, 240, 500], [-345, 340, 560]], 9, 10)
    side = box([640, -120, 760], [190, 130, 60])
    wipers = [strip([[x, -208, 1195], [x - 260, -196, 1190], [x - 560, -170, 1150]], 6) for x in (250.0, -420.0)]
    return [
        Thing("pillars", join(pillars), CREAM),
        Thing("doors", join(doors), BLACK),
        Thing("bonnet", shape, (36, 84, 150)),
        Thing("mirrors", join([mirror, stem]), BLACK),
        Thing("mirrors", side, (36, 84, 150)),
        Thing("wipers", join(wipers), (30, 31, 33)),
        standing("mirror", (-330.0, 205.0, 480.0), (236, 62), _behind())._replace(shines=True),
        standing("side mirror", (640.0, -120.0, 728.0), (166, 106), _behind()[:, 300:900])._replace(shines=True),
    ]


def _smooth(path: Floats) -> Floats:
    """A path through the points without corners."""
    t, at = np.arange(len(path)), np.linspace(0, len(path) - 1, 6 * (len(path) - 1) + 1)
    if len(path) < 3:
        return path
    fit = [np.polyfit(t, path[:, k], min(3, len(path) - 1)) for k in range(3)]
    return np.stack([np.polyval(f, at) for f in fit], axis=-1)


# ---- the road ----


def _road() -> list[Panel]:
    width = 2 * LANE
    pieces = []
    for near, far, fine in STRETCHES:
        half = (far - near) / 2
        pieces.append(
            Panel(
                "road",
                [CENTRE, ROAD, near + half],
                [-width / 2, 0, 0],
                [0, 0, half],
                _asphalt(width, near, far, fine),
                True,
            )
        )
    grass = soften(cloth((700, 700), (112, 142, 78), 0.10), 1.2)
    for near, far in ((2200, 60000), (60000, 600000)):
        half = (far - near) / 2
        for edge, outwards in ((KERB - 0.0, -1), (CENTRE + LANE, 1)):
            reach = 40000.0 if far < 100000 else 300000.0
            middle = [edge + outwards * reach / 2, ROAD - 10, near + half]
            pieces.append(Panel("grass", middle, [-reach / 2, 0, 0], [0, 0, half], grass, True))
    return pieces


def _signs() -> list:
    x = KERB - 900
    rows = [
        ("limit", ["80"], 26000.0, 900.0),
        ("towns", ["Newton 5", "Young 12"], 45000.0, 3000.0),
        ("limit", ["50"], 90000.0, 900.0),
    ]
    pieces: list = []
    for kind, lines, z, width in rows:
        image = _sign(kind, lines)
        high = width * image.shape[0] / image.shape[1]
        middle = ROAD + 2600.0 if kind == "towns" else ROAD + 2200.0
        across = [-width / 2, 0, 0]
        if kind == "limit":
            pieces.append(
                Panel("signs", [x, middle, z], across, [0, high / 2, 0], image, False, ring([0, 0, 0], 0.98, 48)[:, :2])
            )
        else:
            pieces.append(Panel("signs", [x, middle, z], across, [0, high / 2, 0], image))
        posts = [
            cylinder([x + s * width / 3, ROAD, z + 30], 45, middle - ROAD, 10)
            for s in ((-1, 1) if width > 2000 else (0,))
        ]
        pieces.append(Thing("posts", join(posts), (150, 154, 156)))
    rail = [box([CENTRE + LANE + 900, ROAD + 650, z], [40, 300, 3900]) for z in np.arange(6000.0, 120000.0, 4000.0)]
    stands = [box([CENTRE + LANE + 960, ROAD + 300, z], [80, 600, 120]) for z in np.arange(6000.0, 70000.0, 4000.0)]
    return [*pieces, Thing("guard rail", join([*rail, *stands]), (176, 180, 182))]


def _traffic() -> list:
    side = [(0, 250), (4200, 250), (4250, 700), (3100, 800), (2500, 1400), (600, 1400), (60, 850)]
    body = athwart(side, -850.0, 850.0)
    ahead, colour = 24000.0, (188, 190, 194)
    other = Solid(body.points * [1, 1, -1], body.triangles, body.normals * [1, 1, -1])
    return [
        Panel("car ahead", [CAR, ROAD + 755, ahead], [-880, 0, 0], [0, 665, 0], _tail(colour, "LB·2010"), True, REAR),
        Thing("cars", body.placed([CAR, ROAD, ahead + 40]), colour),
        Thing("cars", other.placed([CENTRE + LANE / 2, ROAD, 68000]), (170, 44, 40)),
    ]


def _trees() -> list[Thing]:
    chance, crowns, trunks = np.random.default_rng(4), [], []
    for z in (30000, 41000, 56000, 74000, 96000, 130000, 180000, 250000):
        for side in (-1, 1):
            x = CENTRE + side * (LANE + 5500 + chance.uniform(0, 5000))
            tall, wide = chance.uniform(5500, 9500), chance.uniform(1900, 2900)
            profile = [
                (0.1, 0.27),
                (0.6, 0.28),
                (0.92, 0.36),
                (1.0, 0.5),
                (0.93, 0.66),
                (0.72, 0.82),
                (0.4, 0.95),
                (0, 1.0),
            ]
            crown = turned([(wide * r, tall * h) for r, h in profile], 20, smooth=True)
            crowns.append(crown.placed([x, ROAD, z]))
            trunks.append(cylinder([x, ROAD, z], 200, 0.35 * tall, 8))
    return [Thing("trees", join(crowns), (82, 124, 62)), Thing("trees", join(trunks), (100, 82, 64))]
