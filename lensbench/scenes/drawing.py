"""Drawing tools of the built-in scenes: sheets measured in mm, letters, tiles, wood and cloth. All colours are sRGB codes."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from ..errors import LensBenchError
from ..optics.conventions import Floats

Pixels = NDArray[np.uint8]
Colour = tuple[int, int, int]

INK, PAPER, WHITE = (26, 28, 32), (250, 247, 238), (255, 255, 255)
BLUE, RED, GREY = (24, 74, 138), (178, 44, 40), (150, 154, 160)

_CODES = np.arange(256) / 255.0
LIGHT_OF_CODE = np.where(_CODES <= 0.04045, _CODES / 12.92, ((_CODES + 0.055) / 1.055) ** 2.4)


def darker(colour: Colour, share: float) -> Colour:
    """A colour whose codes are a share of this one's."""
    red, green, blue = colour
    return int(share * red), int(share * green), int(share * blue)


def encode(light: NDArray[np.floating[Any]]) -> Pixels:
    """sRGB codes of linear light, 0 to 1. Source: IEC 61966-2-1."""
    clipped = np.clip(light, 0.0, 1.0)
    code = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    return np.round(255 * code).astype(np.uint8)


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

    def text(
        self, x: float, y: float, text: str, size: float, face: str = "Sans", ink: Colour = INK, at: str = "ls"
    ) -> None:
        """Text at (x, y) mm, em size in mm; at: Pillow's anchor (ls: left end of the base line)."""
        self.pen.text((x * self.scale, y * self.scale), text, ink, _font(face, round(size * self.scale)), at)

    def lines(self, x: float, y: float, lines: list[str], size: float, face: str = "Serif", ink: Colour = INK) -> None:
        """Lines of text, the first one's base line at (x, y) mm."""
        for k, line in enumerate(lines):
            self.text(x, y + 1.32 * size * k, line, size, face, ink)

    def box(
        self, x: float, y: float, w: float, h: float, fill: Colour | None, edge: Colour | None = None, pen: float = 0.0
    ) -> None:
        """A rectangle; pen: width of its edge, mm."""
        corners = [v * self.scale for v in (x, y, x + w, y + h)]
        self.pen.rectangle(corners, fill, edge, max(1, round(pen * self.scale)))

    def line(self, points: ArrayLike, pen: float, ink: Colour = INK) -> None:
        """A line through points (k, 2) mm; pen: width, mm."""
        path = [(float(x), float(y)) for x, y in np.asarray(points, dtype=float) * self.scale]
        self.pen.line(path, ink, max(1, round(pen * self.scale)), "curve")

    def disc(
        self, x: float, y: float, radius: float, fill: Colour, edge: Colour | None = None, pen: float = 0.0
    ) -> None:
        """A filled circle; pen: width of its edge, mm."""
        width = max(1, round(pen * self.scale))
        self.pen.circle((x * self.scale, y * self.scale), radius * self.scale, fill, edge, width)

    def shape(self, points: ArrayLike, fill: Colour) -> None:
        """A filled polygon (k, 2)."""
        self.pen.polygon([(float(x), float(y)) for x, y in np.asarray(points, dtype=float) * self.scale], fill)

    def card(self, x: float, y: float, w: float, h: float, radius: float, fill: Colour) -> None:
        """A filled rectangle with round corners."""
        self.pen.rounded_rectangle([v * self.scale for v in (x, y, x + w, y + h)], radius * self.scale, fill)

    def fade(self, x: float, y: float, w: float, h: float, colours: Sequence[Colour]) -> None:
        """A rectangle whose colour runs from the top through the colours to the bottom."""
        left, top, right, low = (round(v * self.scale) for v in (x, y, x + w, y + h))
        at = np.linspace(0, len(colours) - 1, max(low - top, 1))
        rows = np.stack([np.interp(at, np.arange(len(colours)), c) for c in zip(*colours, strict=True)], axis=-1)
        strip = Image.fromarray(np.round(rows).astype(np.uint8)[:, None])
        self.image.paste(strip.resize((max(right - left, 1), strip.height)), (left, top))

    def put(self, x: float, y: float, image: Pixels) -> None:
        """A picture (h, w, 3) of the sheet's own fineness, its upper left corner at (x, y) mm."""
        self.image.paste(Image.fromarray(image), (round(x * self.scale), round(y * self.scale)))

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


def tiles(
    size: tuple[int, int], tile: tuple[int, int], joint: int, colours: tuple[Colour, Colour], bond: float
) -> Pixels:
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


def wood(size: tuple[int, int], plank: int, colour: Colour) -> Pixels:
    """Planks (h, w, 3) with a grain that runs along the rows; plank: height of a plank, pixels."""
    chance = np.random.default_rng(11)
    boards = tiles(size, (size[0] // 2, plank), 1, (colour, (88, 58, 36)), 0.37)
    y, x = np.arange(size[1], dtype=np.float32)[:, None], np.arange(size[0], dtype=np.float32)[None, :]
    phase = chance.uniform(0, 40, size[1] // plank + 1).astype(np.float32)[(y // plank).astype(int)]
    rings = np.sin(y * 0.55 + phase + 2.2 * np.sin(x * 0.006 + phase)) + 0.5 * np.sin(y * 1.7 + 3 * np.sin(x * 0.011))
    return np.clip(boards * (1 + 0.045 * rings[..., None]), 0, 255).astype(np.uint8)


def plain(colour: Colour) -> Pixels:
    """A sheet of one colour."""
    return np.full((4, 4, 3), colour, dtype=np.uint8)


def cloth(size: tuple[int, int], colour: Colour, roughness: float = 0.06) -> Pixels:
    """A speckled surface (h, w, 3): carpet, plaster, asphalt. roughness: standard deviation of its lightness."""
    chance = np.random.default_rng(5)
    noise = chance.normal(0, 1, (size[1], size[0], 1)) + 0.5 * _clouds(size, 24, chance)[..., None]
    return np.clip(np.array(colour) * (1 + roughness * noise), 0, 255).astype(np.uint8)


def _clouds(size: tuple[int, int], cell: int, chance: np.random.Generator) -> Floats:
    """Smooth noise (h, w) of mean 0, varying over about `cell` pixels."""
    few = chance.normal(0, 1, (size[1] // cell + 2, size[0] // cell + 2)).astype(np.float32)
    return np.asarray(Image.fromarray(few, "F").resize(size, Image.Resampling.BICUBIC))


def soften(image: Pixels, pixels: float) -> Pixels:
    """The image with its edges blurred over some pixels."""
    return np.asarray(Image.fromarray(image).filter(ImageFilter.GaussianBlur(pixels)))
