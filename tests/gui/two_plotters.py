"""Run by test_real_window.py on a screen of its own: two views in two PyVista plotters, edited and drawn in turn."""

import sys
from dataclasses import replace

import numpy as np
import pyvista as pv

import lensbench as lb
from lensbench.layers import Request, ViewLayer
from lensbench.scenes.builtin import load_scene
from lensbench.views.jitter import JitterPass
from lensbench.workbench import run

SIZE, PASSES = (200, 150), 4


def open_view():
    """A plotter and the view that it draws."""
    plotter = pv.Plotter(off_screen=True, window_size=SIZE)
    return plotter, JitterPass(plotter.render_window, plotter.renderer, passes=PASSES)


def drawn(plotter, view):
    """The light of all passes."""
    while not view.done:
        plotter.render_window.Render()
    return view.light()


def fresh(seen):
    """The light of a view that has shown nothing else."""
    plotter, view = open_view()
    view.show(seen)
    light = drawn(plotter, view)
    view.close()
    plotter.close()
    return light


def main(path: str) -> None:
    lens, wearer, scene = lb.load_lens(path), lb.Wearer(), load_scene("room")
    layer = ViewLayer("lens", elevation=-0.2, half_width=0.5, size=SIZE)
    seen = {
        distance: run(Request(lens, replace(wearer, wear=replace(wearer.wear, vertex_distance=distance)), layer, scene))
        for distance in (13.0, 18.0)
    }
    meant = {distance: fresh(picture) for distance, picture in seen.items()}
    assert np.abs(meant[13.0] - meant[18.0]).max() > 0.05
    pairs = [open_view() for _ in range(2)]
    for distance in (13.0, 18.0, 13.0):
        for _, view in pairs:
            view.show(seen[distance])
        for plotter, view in reversed(pairs):
            np.testing.assert_allclose(drawn(plotter, view), meant[distance], atol=1e-6)
    for plotter, view in pairs:
        view.close()
        plotter.close()


if __name__ == "__main__":
    main(sys.argv[1])
