"""Designs side by side as their wearer sees through them, under one scale of defocus; and a contact sheet of scenes.

After Kakimoto, Tatsukawa & Nishita 2010, figure 15.
"""

from collections.abc import Sequence
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np
from PIL import Image, ImageDraw

from ..errors import InputError
from ..layers import DefocusLayer, DefocusView, Request, SeenScene, ViewLayer
from ..optics.eye import Eye, Wear, Wearer
from ..optics.lens import Lens
from ..scenes.scene import Look, Scene
from ..views.defocus import Scale, scale_bar, shared_scale, with_defocus
from ..views.jitter import Studio
from ..views.jitter.light import Pixels
from ..views.jitter.picture import letters
from ..workbench import look, run
from .facts import away_text

FIELD = float(np.radians(86.0))  # nearly the whole of a spectacle lens
INK, FAINT = (32, 36, 40), (96, 102, 108)
_MARGIN = 16


class Case(NamedTuple):
    """A lens by name, what its wearer sees through it, and the defocus over that."""

    name: str
    seen: SeenScene
    defocus: DefocusView


def gallery_cases(
    pairs: Sequence[tuple[Lens, Wearer]], scene: Scene, name: str | None, side: int, measure: str = "defocus"
) -> list[Case]:
    """Each lens on its wearer before the scene. name: look of the scene in the middle. side: pixels along a picture's edge.
    measure: of the defocus, as in DefocusLayer.
    """
    cases = []
    for lens, wearer in pairs:
        azimuth, up = look(name, lens, wearer, scene)
        layer = ViewLayer("lens", azimuth, up, FIELD / 2, (side, side))
        seen, defocus = (run(Request(lens, wearer, asked, scene)) for asked in (layer, DefocusLayer(layer, measure)))
        cases.append(Case(lens.name, seen, defocus))
    return cases


def gallery_pictures(cases: Sequence[Case], passes: int, way: str = "veil") -> tuple[Scale, dict[str, list[Pixels]]]:
    """The common scale, and for each row ("seen" and "defocus") a picture for each case."""
    scale = shared_scale([case.defocus for case in cases], way)
    with Studio() as studio:
        seen = [studio.picture(case.seen, passes) for case in cases]
    veiled = [with_defocus(picture, case.defocus, scale) for picture, case in zip(seen, cases, strict=True)]
    return scale, {"seen": seen, "defocus": veiled}


def gallery_sheet(cases: Sequence[Case], scale: Scale, rows: dict[str, list[Pixels]], about: str) -> Pixels:
    """All pictures on one sheet: a column a lens, its name above, the scale of the defocus below."""
    side = rows["seen"][0].shape[0]
    letter = max(12, side // 26)
    titles = {"seen": "as seen", "defocus": "under its defocus map"}
    left, gap, head, line = _MARGIN, _MARGIN // 2, 4 * letter, round(1.9 * letter)
    width = 2 * left + len(cases) * side + (len(cases) - 1) * gap
    height = head + len(rows) * (side + line + gap)
    sheet = Image.new("RGB", (width, height), "white")
    pen = ImageDraw.Draw(sheet)
    pen.text((left, 1.1 * letter), about, INK, _fitting(pen, "-Bold", about, 1.15 * letter, width - 2 * left), "lm")
    for k, case in enumerate(cases):
        x = left + k * (side + gap)
        pen.text((x, head - 0.9 * letter), case.name, INK, _fitting(pen, "-Bold", case.name, letter, side), "lm")
    for j, (row, pictures) in enumerate(rows.items()):
        y = head + j * (side + line + gap)
        for k, picture in enumerate(pictures):
            sheet.paste(Image.fromarray(picture), (left + k * (side + gap), y))
        pen.text((left, y + side + line / 2), titles[row], FAINT, letters("", letter), "lm")
    return np.vstack([np.asarray(sheet), scale_bar(scale, width, letter)])


def _fitting(pen: Any, weight: str, text: str, size: float, room: float) -> Any:
    """The font in which a text fits into a room, at most `size` pixels high."""
    wide = pen.textlength(text, letters(weight, round(size)))
    return letters(weight, max(6, int(size * min(1.0, room / max(wide, 1.0)))))


def small_png(picture: Pixels, widest: int = 1200, most: int = 400_000) -> bytes:
    """A picture as a small PNG of at most 256 colours, reduced until it takes fewer than `most` bytes."""
    image = Image.fromarray(picture)
    while True:
        scale = min(1.0, widest / image.width)
        small = image.resize((round(image.width * scale), round(image.height * scale)), Image.Resampling.LANCZOS)
        buffer = BytesIO()
        small.quantize(256, Image.Quantize.MEDIANCUT, kmeans=3).save(buffer, format="png", optimize=True)
        if buffer.tell() < most:
            return buffer.getvalue()
        widest = round(0.9 * small.width)


# ---- scenes ----


def contact_sheet(scenes: Sequence[Scene], passes: int = 16, size: tuple[int, int] = (400, 300)) -> Pixels:
    """A row for each scene, a picture for each of its looks, sharp and without a lens, named and with their distances."""
    columns = max(len(scene.looks) for scene in scenes)
    if columns == 0:
        raise InputError("these scenes have no looks")
    letter = 15
    cell = size[0] + _MARGIN // 2, size[1] + 2 * letter
    head = 2 * letter
    sheet = Image.new("RGB", (2 * _MARGIN + columns * cell[0], len(scenes) * (cell[1] + head + letter)), "white")
    pen = ImageDraw.Draw(sheet)
    with Studio() as studio:
        for j, scene in enumerate(scenes):
            y = j * (cell[1] + head + letter)
            text = f"{scene.name}: {scene.about}"
            pen.text(
                (_MARGIN, y + head / 2),
                text,
                INK,
                _fitting(pen, "-Bold", text, letter, sheet.width - 2 * _MARGIN),
                "lm",
            )
            for k, (name, what) in enumerate(scene.looks.items()):
                x = _MARGIN + k * cell[0]
                sheet.paste(Image.fromarray(_sharp(studio, scene, what, size, passes)), (x, y + head))
                caption = f"{name}, {away_text(what.distance)}"
                pen.text((x, y + head + size[1] + letter), caption, FAINT, letters("", letter), "lm")
    return np.asarray(sheet)


def _sharp(studio: Studio, scene: Scene, what: Look, size: tuple[int, int], passes: int) -> Pixels:
    wearer = Wearer(Eye(), Wear())
    x, y, z = np.array(what.target) - wearer.centre_of_rotation
    layer = ViewLayer("perfect", float(np.arctan2(x, z)), float(np.arctan2(y, np.hypot(x, z))), size=size)
    return studio.picture(run(Request(None, wearer, layer, scene)), passes)
