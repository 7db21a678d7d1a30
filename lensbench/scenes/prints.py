"""What can be read in the built-in scenes: a printed page and a screen, as drawings."""

import numpy as np

from .drawing import BLUE, GREY, INK, RED, WHITE, Pixels, Sheet

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
    star(s, 111, 118, 20)
    s.text(138, 112, "8.5 pt  Seven black birds sat on", 3.0, "Sans")
    s.text(138, 117, "7 pt  the long fence and watched the", 2.5, "Sans")
    s.text(138, 121.4, "6 pt  ships go by until the evening fell, and", 2.1, "Sans")
    s.text(138, 125.3, "5 pt  none of them thought of counting the letters here.", 1.75, "Sans")
    s.box(138, 129, 64, 9, (255, 235, 120))
    s.text(170, 135.6, "40 cm", 6, "Sans-Bold", RED, at="ms")
    return s.pixels()


def star(s: Sheet, x: float, y: float, radius: float) -> None:
    """A star of 36 spokes: it shows blur and astigmatism at a glance."""
    s.disc(x, y, radius, INK)
    for k in range(36):
        turn = np.radians([k * 10 - 2.5, k * 10 + 2.5])
        far = np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=-1) * s.scale
        s.pen.polygon([(x * s.scale, y * s.scale), *map(tuple, far)], s.paper)
    s.disc(x, y, radius / 7, INK)


# ---- a screen ----

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
    s.text(14, 18.6, "Monthly report", 11, "Sans-Bold", WHITE)
    for k, colour in enumerate(((120, 200, 130), (250, 200, 90), (235, 100, 90))):
        s.disc(368 + 15 * k, 14.5, 4, colour)
    s.text(16, 45, "Arm's length", 17, "Sans-Bold", BLUE)
    s.lines(16, 63, REPORT, 9.5, "Sans")
    for k, row in enumerate(TABLE):
        y = 134 + 11.5 * k
        s.box(14, y - 9, 150, 11.5, (222, 230, 241) if k % 2 == 0 else WHITE)
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
    s.box(x, y, w, h, WHITE, GREY, 0.6)
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
