"""A sweep of the head while the eye keeps its target: frames, an animation of them, and a contact sheet.

Kakimoto, Tatsukawa & Nishita 2010, figure 13.
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from ..errors import InputError
from ..output import write_file
from .jitter.light import Pixels
from .jitter.picture import letters

KINDS = (".mp4", ".gif", ".png", ".apng")
_INK, _PAPER = (255, 255, 255), (32, 36, 40)


def titled(picture: Pixels, title: str) -> Pixels:
    """The picture (h, w, 3) with a line of text in its lower left corner."""
    image = Image.fromarray(picture)
    letter = max(11, picture.shape[0] // 28)
    pen, font = ImageDraw.Draw(image), letters("", letter)
    high, wide = round(1.7 * letter), pen.textlength(title, font) + letter
    pen.rectangle((0, image.height - high, wide, image.height), _PAPER)
    pen.text((letter / 2, image.height - high / 2), title, _INK, font, "lm")
    return np.asarray(image)


def contact_sheet(frames: Sequence[Pixels], most: int = 12) -> Pixels:
    """At most so many of the frames (h, w, 3), evenly chosen, the first and the last among them, in rows of four."""
    chosen = [frames[k] for k in np.unique(np.linspace(0, len(frames) - 1, min(most, len(frames))).round().astype(int))]
    columns, gap = min(4, len(chosen)), 6
    height, width, _ = chosen[0].shape
    rows = -(-len(chosen) // columns)
    sheet = np.full((rows * (height + gap) + gap, columns * (width + gap) + gap, 3), 255, dtype=np.uint8)
    for k, frame in enumerate(chosen):
        y, x = gap + k // columns * (height + gap), gap + k % columns * (width + gap)
        sheet[y : y + height, x : x + width] = frame
    return sheet


def there_and_back(frames: Sequence[Pixels]) -> list[Pixels]:
    """The frames forwards and backwards, for an animation that repeats without a jump."""
    return [*frames, *frames[-2:0:-1]]


def write_animation(path: Path, frames: Sequence[Pixels], rate: float) -> None:
    """Write frames (h, w, 3) as .mp4 (H.264), .gif, or .png / .apng (animated PNG), `rate` of them a second.

    Raises InputError for another extension, and for an MP4 whose sides are odd: its encoder takes even ones only.
    """
    import imageio.v3 as iio

    kind = path.suffix.lower()
    if kind not in KINDS:
        raise InputError(f"{path}: cannot write {kind or 'a file without extension'}; name one of {', '.join(KINDS)}")
    if kind == ".mp4" and (frames[0].shape[0] % 2 or frames[0].shape[1] % 2):
        raise InputError(f"{path}: the sides of an MP4 must be even numbers of pixels")
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"animation{'.png' if kind == '.apng' else kind}"
        if kind == ".mp4":
            more = {"plugin": "FFMPEG", "fps": rate, "codec": "libx264", "quality": 8, "macro_block_size": 2}
        else:
            more = {"plugin": "pillow", "duration": 1000 / rate, "loop": 0}
        iio.imwrite(made, np.stack(frames), **more)
        write_file(path, made.read_bytes())
