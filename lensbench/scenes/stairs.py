"""A staircase seen from its top, the head bent down by 25 degrees: the steps are seen through the lens's lower part.

Walking down, a person looks two to six steps ahead: 2 to 4 m away, through the zone that a progressive lens gives to 40 cm.
"""

from dataclasses import replace

import numpy as np

from ..optics.conventions import Floats, rotation_xy
from .build import Panel, Thing, build_scene
from .drawing import RED, WHITE, Pixels, Sheet, cloth, tiles
from .furniture import plant
from .light import Lamp, Lights
from .scene import Look, Scene
from .solids import box, cylinder, join, tube

EYE, RISER, TREAD, STEPS, WIDTH, FIRST, BENT = 1600.0, 170.0, 285.0, 16, 1500.0, 330.0, 25.0
BOTTOM = -EYE - STEPS * RISER
FOOT = FIRST + (STEPS - 1) * TREAD
END, TOP, NEAREST = FOOT + 4200.0, 1150.0, 300.0


def stairs() -> Scene:
    """The staircase."""
    pieces = [*_flight(), *_hall(), *_rails(), *_signs(), *plant(1100.0, END - 500.0, BOTTOM)]
    lamps = (
        Lamp((0, TOP - 20, 1200.0), (300, 0, 0), (0, 0, 500), 1.8),
        Lamp((0, 350, FOOT + 1500), (300, 0, 0), (0, 0, 600), 6.5),
        Lamp((700, 200, 2600), (0, 0, 600), (0, 500, 0), 0.8),
    )
    looks = {
        "far": Look((-180.0, BOTTOM + 2380, END - 14), "sign"),
        "floor": Look((0.0, BOTTOM, FOOT + 500), "landing below"),
        "fifth step": Look(_on_step(5), "steps"),
        "third step": Look(_on_step(3), "steps"),
    }
    about = "a staircase going down, the head bent by 25 degrees: steps at 2 to 4 m through the lens's lower part"
    upright = build_scene("stairs", about, pieces, Lights(0.62, 900.0, lamps), looks, background=(40, 42, 46))
    return _bent(upright)


def _bent(scene: Scene) -> Scene:
    """The scene as the eye has it when the head is bent down."""
    turn = rotation_xy(np.radians(-BENT), 0.0)
    parts = tuple(replace(part, points=part.points @ turn.T) for part in scene.parts)
    looks = {name: Look.at(turn @ k.target, k.part) for name, k in scene.looks.items()}
    return replace(scene, parts=parts, looks=looks)


def _on_step(k: int) -> tuple[float, float, float]:
    """The middle of the k-th step down, a third behind its edge."""
    return 0.0, -EYE - k * RISER, FIRST + (k - 1) * TREAD + 0.65 * TREAD


def _tread() -> Pixels:
    """A tread of stone with its dark edge strip, 1500 x 285 mm, seen from above."""
    s = Sheet(WIDTH, TREAD, 0.5)
    s.put(0, 0, cloth(s.image.size, (186, 180, 170), 0.05))
    s.box(0, TREAD - 52, WIDTH, 40, (52, 50, 48))
    for k in range(4):
        s.box(0, TREAD - 48 + 9 * k, WIDTH, 4, (232, 190, 60) if k in (0, 3) else (70, 68, 64))
    return s.pixels()


def _flight() -> list:
    tread = _tread()[::-1].copy()
    half = WIDTH / 2
    pieces: list = [
        Panel("landing", [0, -EYE, FIRST - 400], [-half, 0, 0], [0, 0, 400], cloth((400, 220), (186, 180, 170), 0.05))
    ]
    edges = []
    for k in range(1, STEPS):
        y, z = -EYE - k * RISER, FIRST + (k - 0.5) * TREAD
        pieces.append(Panel("steps", [0, y, z], [-half, 0, 0], [0, 0, TREAD / 2], tread))
    for k in range(STEPS):
        y, z = -EYE - k * RISER, FIRST + k * TREAD
        edges.append(box([0, y - RISER / 2, z - 12], [WIDTH, RISER, 24], without="+y"))
    pieces.append(Thing("risers", join(edges), (150, 145, 138)))
    return pieces


def _hall() -> list[Panel]:
    half = WIDTH / 2
    plaster, lower = cloth((600, 400), (226, 214, 192), 0.015), cloth((600, 300), (206, 216, 214), 0.012)
    floor = tiles((900, 900), (90, 90), 3, ((176, 168, 156), (120, 114, 106)), 0.0)
    depth, deep, far = (END - FOOT) / 2, (END - NEAREST) / 2, (END + NEAREST) / 2
    walls = []
    for side, name in ((1, "left wall"), (-1, "right wall")):
        middle = (TOP + BOTTOM) / 2
        walls.append(
            Panel(name, [side * (half + 60), middle, far], [0, 0, side * deep], [0, (TOP - BOTTOM) / 2, 0], plaster)
        )
    return [
        *walls,
        Panel("landing below", [0, BOTTOM, FOOT + depth], [-half - 60, 0, 0], [0, 0, depth], floor),
        Panel("end wall", [0, (TOP + BOTTOM) / 2, END], [-half - 60, 0, 0], [0, (TOP - BOTTOM) / 2, 0], lower),
        Panel("ceiling", [0, TOP, far], [-half - 60, 0, 0], [0, 0, -deep], cloth((200, 400), (236, 234, 230), 0.01)),
    ]


def _rails() -> list[Thing]:
    slope, things = RISER / TREAD, []
    for side in (-1, 1):
        x = side * (WIDTH / 2 - 10)
        z = np.array([FIRST - 350, FIRST, FOOT + 60, FOOT + 400])
        floor = np.array([-EYE, -EYE, BOTTOM + slope * 60, BOTTOM])
        path: Floats = np.stack([np.full(4, x), floor + 930, z], axis=-1)
        things.append(Thing("handrails", tube(_finer(path), 21, 12), (128, 78, 44)))
        posts = [
            cylinder([x, -EYE - k * RISER, FIRST + (k - 0.5) * TREAD], 9, 905 + RISER / 2, 10)
            for k in range(1, STEPS, 2)
        ]
        things.append(Thing("posts", join(posts), (70, 74, 78)))
    return things


def _finer(path: Floats) -> Floats:
    """The path with points between, so that a tube along it bends within a short way."""
    at = np.array([0, 0.97, 1, 1.03, 1.97, 2, 2.03, 3])
    return np.stack([np.interp(at, np.arange(len(path)), c) for c in path.T], axis=-1)


def _signs() -> list:
    sign = Sheet(900, 420, 1.0, (20, 120, 66))
    sign.text(450, 190, "EXIT", 190, "Sans-Bold", WHITE, "ms")
    sign.text(450, 330, "ground floor  ·  mind the step", 46, "Sans", WHITE, "ms")
    door = Sheet(1000, 2100, 0.4, (196, 190, 180))
    door.box(60, 60, 880, 2040, (92, 116, 132), (60, 76, 88), 14)
    door.box(200, 220, 600, 820, (206, 226, 236), (60, 76, 88), 16)
    door.disc(850, 1130, 40, (214, 214, 210))
    level = Sheet(420, 420, 0.8, (246, 244, 238))
    level.disc(210, 210, 190, RED)
    level.text(210, 275, "0", 190, "Sans-Bold", WHITE, "ms")
    y = BOTTOM + 1050
    return [
        Panel("door", [-180, y, END - 12], [-500, 0, 0], [0, 1050, 0], door.pixels()),
        Panel("sign", [-180, y + 1330, END - 14], [-450, 0, 0], [0, 210, 0], sign.pixels(), True),
        Panel("level", [620, y + 560, END - 14], [-160, 0, 0], [0, 160, 0], level.pixels()),
    ]
