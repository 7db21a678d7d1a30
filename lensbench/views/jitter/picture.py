"""Pictures of a view, drawn off screen."""

from collections.abc import Sequence
from textwrap import wrap

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow

from ...layers import SeenScene
from ..offscreen import require_gl
from .light import Light, Pixels
from .view_pass import JitterPass

_INK = (32, 36, 40)


class Studio:
    """An off-screen window for pictures of views, one after the other: what they share stays on the graphics card.

    Raises LensBenchError where this machine cannot draw. Use it in a with statement, or close it.
    """

    def __init__(self, **fallback: bool) -> None:
        require_gl()
        self.window, renderer = vtkRenderWindow(), vtkRenderer()
        self.window.SetOffScreenRendering(True)
        self.window.AddRenderer(renderer)
        self.view = JitterPass(self.window, renderer, **fallback)
        self.pixels = vtkUnsignedCharArray()

    def __enter__(self) -> "Studio":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def picture(self, seen: SeenScene, passes: int = 48, seed: int = 0, exposure: float = 1.0) -> Pixels:
        """The picture (h, w, 3), sRGB, first row at the top; see render_view."""
        self.view.exposure = exposure
        self._draw(seen, passes, seed)
        width, height = seen.layer.size
        self.window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, self.pixels)
        return vtk_to_numpy(self.pixels).reshape(height, width, 4)[::-1, :, :3].copy()

    def light(self, seen: SeenScene, passes: int = 48, seed: int = 0) -> Light:
        """The picture's mean light (h, w, 3), linear, float32, first row at the top."""
        self._draw(seen, passes, seed)
        return self.view.light()

    def _draw(self, seen: SeenScene, passes: int, seed: int) -> None:
        self.window.SetSize(*seen.layer.size)
        self.view.sample(passes, seed)
        self.view.show(seen)
        while not self.view.done:
            self.view.displayed = self.view.count >= passes - 1
            self.window.Render()

    def close(self) -> None:
        """Free what is held on the graphics card."""
        self.view.close()
        self.window.Finalize()


def render_view(seen: SeenScene, passes: int = 48, seed: int = 0, exposure: float = 1.0, **fallback: bool) -> Pixels:
    """The picture (h, w, 3), sRGB, first row at the top, as the turning eye sees it; the wearer's right is on the right.

    passes: points of the pupil that are averaged, in an order drawn from the seed: the same seed gives the same picture.
    exposure: factor on the light.
    Raises LensBenchError where this machine cannot draw. Several views of one scene: faster from one Studio.
    """
    with Studio(**fallback) as studio:
        return studio.picture(seen, passes, seed, exposure)


def side_by_side(pictures: Sequence[tuple[str, Pixels]], caption: str) -> Pixels:
    """Pictures of one height in a row (h, w, 3), each under its title, with a caption below all."""
    height = pictures[0][1].shape[0]
    letter, gap = max(11, height // 24), max(4, height // 60)
    width = sum(picture.shape[1] + gap for _, picture in pictures) + gap
    top, bottom = 2 * letter, 2 * letter
    strip = Image.new("RGB", (width, top + height + bottom), "white")
    pen, x = ImageDraw.Draw(strip), gap
    for title, picture in pictures:
        room = picture.shape[1]
        fitting = letter * min(1.0, room / max(1.0, pen.textlength(title, letters("-Bold", letter))))
        strip.paste(Image.fromarray(picture), (x, top))
        pen.text((x + room / 2, top / 2), title, _INK, letters("-Bold", int(fitting)), "mm")
        x += room + gap
    pen.text((gap, top + height + bottom / 2), caption, _INK, letters("", letter), "lm")
    return np.asarray(strip)


def captioned(picture: Pixels, texts: Sequence[str]) -> Pixels:
    """A picture (h, w, 3) with texts below, each on lines of its own that fit the width; an even number of pixels higher."""
    height, width, _ = picture.shape
    letter = max(10, height // 55)
    step = 2 * round(0.8 * letter)
    lines = [line for text in texts for line in wrap(text, max(8, int(width / (0.6 * letter))))]
    strip = Image.new("RGB", (width, step * len(lines) + 2 * (step // 4)), "white")
    pen = ImageDraw.Draw(strip)
    for k, line in enumerate(lines):
        pen.text((letter // 2, step * (k + 0.75)), line, _INK, letters("", letter), "lm")
    return np.vstack([picture, np.asarray(strip)])


def letters(weight: str, size: int) -> ImageFont.FreeTypeFont:
    """A sans-serif font of a size in pixels. weight: "" or "-Bold"."""
    from matplotlib import get_data_path

    return ImageFont.truetype(f"{get_data_path()}/fonts/ttf/DejaVuSans{weight}.ttf", size)
