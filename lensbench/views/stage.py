"""The off-screen stage: where a VTK picture is set up, taken once and struck."""

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from .offscreen import require_gl

FINENESS = 2  # pixels of the stage per pixel of the picture: cheaper than multisampling on a software renderer


def stage(size: tuple[int, int], background: str = "white") -> pv.Plotter:
    """An empty off-screen stage for a picture of size (width, height) pixels; give it to `snapshot`.

    It is FINENESS times finer than the picture, so widths of lines and points are to be multiplied by it.
    Raises LensBenchError where this machine cannot draw off-screen.
    """
    require_gl()
    plotter = pv.Plotter(off_screen=True, window_size=[FINENESS * n for n in size], lighting="light kit")
    plotter.render_window.SetMultiSamples(0)
    plotter.set_background(background)
    plotter.suppress_rendering = True  # else every mesh that is added draws the whole stage
    return plotter


def snapshot(plotter: pv.Plotter) -> NDArray[np.uint8]:
    """The stage's picture (h, w, 3), averaged from its finer pixels; the stage is closed and its memory freed."""
    try:
        plotter.suppress_rendering = False
        fine = plotter.screenshot(return_img=True)[..., :3]
    finally:
        plotter.close()
        plotter.deep_clean()
    height, width = fine.shape[0] // FINENESS, fine.shape[1] // FINENESS
    blocks = fine.reshape(height, FINENESS, width, FINENESS, 3)
    return np.round(blocks.mean(axis=(1, 3), dtype=np.float32)).astype(np.uint8)
