"""The pass in a renderer that is not its own: progressive, begun anew by every change, without leaks."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_jitter import CENTRED, EMMETROPE, MINUS_SIX, moments, on_picture, patches, resident_mb, see

from lensbench.imaging.pixels import pixel_optics
from lensbench.layers import Request, ViewLayer
from lensbench.optics.conventions import power_matrix
from lensbench.optics.eye import Eye, Wearer
from lensbench.optics.gaze import look_at
from lensbench.optics.lens_edge import LensEdge
from lensbench.scenes.builtin import load_scene
from lensbench.seen import defocus_view, pixel_directions
from lensbench.session import Workbench
from lensbench.workbench import run

pytest.importorskip("pyvista")

import pyvista as pv

from lensbench.views import jitter
from lensbench.views.jitter import accumulate, shaders
from lensbench.views.offscreen import require_gl

SAMPLES = Path(__file__).parents[1] / "sample_lenses"
SMALL = (160, 120)
MYOPE = Wearer(Eye(refraction=power_matrix(-2.0, -1.0, 30.0), accommodation=0.0), CENTRED)
PLACES = [(-600.0, 300.0, 6000.0), (400.0, -200.0, 3000.0), (0.0, 60.0, 700.0)]


@pytest.fixture
def plotter():
    require_gl()
    plotter = pv.Plotter(off_screen=True, window_size=SMALL)
    yield plotter
    plotter.close()


def drawn(window) -> np.ndarray:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

    pixels, (width, height) = vtkUnsignedCharArray(), window.GetSize()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, pixels)
    return vtk_to_numpy(pixels).reshape(height, width, 4)[::-1, :, :3].copy()


def finish(view) -> np.ndarray:
    while not view.done:
        view.window.Render()
    return drawn(view.window)


def view_of(seen, size=SMALL):
    return replace(seen, layer=replace(seen.layer, size=size))


def test_in_pyvistas_renderer_it_is_the_off_screen_picture(plotter):
    seen = see(patches(PLACES, 150), MINUS_SIX, MYOPE, size=SMALL)
    view = jitter.JitterPass(plotter.render_window, plotter.renderer, passes=12)
    view.show(seen)
    shown = finish(view)
    assert np.array_equal(shown, jitter.render_view(seen, 12))
    view.window.Render()
    assert np.array_equal(drawn(view.window), shown)
    assert view.done
    view.close()
    assert not list(plotter.renderer.GetActors())


def test_a_plotters_own_verbs_leave_the_view_as_it_is(plotter):
    """PyVista places a camera anew that nobody has set: when it first draws, and when a mesh is added."""
    seen = see(patches(PLACES, 150), MINUS_SIX, MYOPE, size=SMALL)
    fresh = jitter.render_view(seen, 4)
    assert fresh.max() == 255
    view = jitter.JitterPass(plotter.render_window, plotter.renderer, passes=4)
    plotter.add_mesh(pv.Sphere(radius=10.0, center=(0.0, 0.0, -5000.0)))
    view.show(seen)
    plotter.show(auto_close=False)
    for again in (lambda: None, lambda: plotter.add_mesh(pv.Sphere(radius=10.0, center=(0.0, 900.0, -9000.0)))):
        again()
        finish(view)
        assert np.array_equal(plotter.screenshot(), fresh)
        assert view.done
    view.close()


def test_every_change_begins_anew(plotter):
    seen = see(patches(PLACES, 150), MINUS_SIX, MYOPE, size=SMALL)
    view = jitter.JitterPass(plotter.render_window, plotter.renderer, passes=6)
    view.show(seen)
    finish(view)
    plotter.camera.Azimuth(3.0)
    assert not view.done
    plotter.render_window.Render()
    assert view.count == 1
    finish(view)
    plotter.window_size = (120, 90)
    assert not view.done
    other = see(patches(PLACES, 90), MINUS_SIX, EMMETROPE, size=(120, 90), head_turn=0.2)
    for changed in (view_of(seen, (120, 90)), replace(seen, wearer=EMMETROPE, layer=other.layer), other):
        view.show(changed)
        assert np.array_equal(finish(view), jitter.render_view(changed, 6))
    view.close()


@pytest.mark.parametrize("fallback", [{}, {"by_vertices": True}, {"in_memory": True}])
def test_passes_in_two_windows_do_not_meddle(plotter, fallback):
    """Whichever window was drawn last, whose OpenGL context is then the current one."""
    other = pv.Plotter(off_screen=True, window_size=SMALL)
    near = replace(MYOPE, wear=replace(CENTRED, vertex_distance=20.0))
    scenes = [see(patches(PLACES, 150), MINUS_SIX, wearer, size=SMALL) for wearer in (MYOPE, near)]
    fresh = [jitter.render_view(seen, 4, **fallback) for seen in scenes]
    lights = [jitter.decode(picture) for picture in fresh]
    assert np.abs(fresh[0].astype(int) - fresh[1]).max() > 100
    views = [jitter.JitterPass(p.render_window, p.renderer, 4, **fallback) for p in (plotter, other)]
    for order in ((0, 1), (1, 0)):
        for view, k in zip(views, order, strict=True):
            view.show(scenes[k])
        for view, k in zip(views, order, strict=True):
            assert np.array_equal(finish(view), fresh[k])
        for view, k in zip(views, order, strict=True):
            assert np.allclose(view.light(), lights[k], atol=0.005)
    views[1].close()
    other.close()
    views[0].show(scenes[0])
    assert np.array_equal(finish(views[0]), fresh[0])
    views[0].close()


@pytest.mark.parametrize(("lens", "vertex_distance", "half_width"), [
    ("sphere_minus_4_R", 8.0, 30.0), ("sphere_minus_4_R", 13.0, 55.0), ("toric_R", 13.0, 30.0), ("regular_R", 8.0, 55.0),
])  # fmt: skip
def test_no_vertex_of_a_room_is_drawn_astray(lens, vertex_distance, half_width):
    """Beside chief rays found vertex by vertex: past the edge of a strong lens Newton's method must not run away."""
    bench = Workbench().with_lens(SAMPLES / f"{lens}.toml")
    wearer = replace(bench.active_wearer, wear=replace(bench.active_wearer.wear, vertex_distance=vertex_distance))
    layer = ViewLayer("pinhole", elevation=-0.2, half_width=np.radians(half_width), size=(320, 240))
    seen = run(Request(bench.active_lens, wearer, layer, load_scene("room")))
    usual, other = (jitter.render_view(seen, 2, by_vertices=exact).astype(int) for exact in (False, True))
    apart = np.abs(usual - other).max(axis=2)
    assert np.mean(apart > 16) < 1e-3


EDGES = [{}, {"head_turn": 0.5}, {"split": True}, {"azimuth": 0.7, "elevation": -0.5, "split": True}]


def see_edge(**layer):
    bench = Workbench().with_lens(SAMPLES / "regular_R.toml")
    layer = ViewLayer("lens", half_width=np.radians(50), size=(320, 240), **layer)
    return run(Request(bench.active_lens, bench.active_wearer, layer, load_scene("room")))


@pytest.mark.parametrize("layer", EDGES)
@pytest.mark.parametrize("fallback", [{}, {"by_vertices": True}])
def test_triangles_left_out_of_a_zone_are_not_missed(layer, fallback, monkeypatch):
    """Beside a picture of which every triangle is drawn in both zones, and every fragment tested for its zone."""
    seen = see_edge(**layer)
    usual = jitter.render_view(seen, 3, **fallback)
    nowhere = -seen.edge.frame[2]
    monkeypatch.setattr(LensEdge, "bounds", lambda _, sides: (np.zeros((sides, 3)), np.tile(nowhere, (sides, 1))))
    assert np.array_equal(usual, jitter.render_view(seen, 3, **fallback))


def test_away_from_the_edge_only_one_zone_is_drawn(monkeypatch):
    """There nothing is left to a test of fragments: without it the picture is the same."""
    seen = see_edge()
    usual = jitter.render_view(seen, 3)
    monkeypatch.setattr(shaders, "ZONE_COLOUR", "")
    untested = jitter.render_view(seen, 3)
    directions = pixel_directions(seen.layer) @ seen.frame @ seen.head
    inside, outside = seen.edge.within(directions, 0.8), ~seen.edge.within(directions, 1.3)
    assert inside.sum() > 10_000
    assert outside.sum() > 1_000
    assert np.array_equal(usual[inside], untested[inside])
    assert np.array_equal(usual[outside], untested[outside])
    assert not np.array_equal(usual, untested)


def test_nothing_is_added_while_paused(plotter):
    view = jitter.JitterPass(plotter.render_window, plotter.renderer, passes=4)
    view.show(see(patches(PLACES, 150), MINUS_SIX, MYOPE, size=SMALL))
    shown = finish(view)
    view.paused = True
    view.window.Render()
    assert not np.array_equal(drawn(view.window), shown)
    view.paused = False
    view.window.Render()
    assert np.array_equal(drawn(view.window), shown)
    view.close()


def test_other_actors_are_seen_through_the_lens_too(plotter):
    place = np.array([[-180.0, 120.0, 800.0]])
    wearer = Wearer(Eye(refraction=power_matrix(-6.0), accommodation=4.0), CENTRED)
    plotter.window_size = (640, 480)
    seen = see(patches([(0.0, 0.0, 5000.0)], 1.0), MINUS_SIX, wearer)
    view = jitter.JitterPass(plotter.render_window, plotter.renderer, passes=8)
    view.show(seen)
    view.add(plotter.add_mesh(pv.Sphere(radius=8.0, center=place[0]), color="white", lighting=False, render=False))
    expected = on_picture(seen, look_at(MINUS_SIX, wearer, place).directions)[0]
    assert np.abs(expected - on_picture(seen, place - wearer.centre_of_rotation)).max() > 10
    assert np.allclose(moments(finish(view), expected, 20)[1], expected, atol=0.15)
    view.close()


@pytest.mark.parametrize("fallback", ["by_vertices", "in_memory"])
def test_a_fallback_gives_the_same_picture(fallback):
    seen = see(patches(PLACES, 150), MINUS_SIX, MYOPE, half_width=np.radians(50), size=(320, 240))
    usual, other = (jitter.render_view(seen, 8, **more).astype(int) for more in ({}, {fallback: True}))
    apart = np.abs(usual - other).max(axis=2)
    assert np.mean(apart > 2) < 2e-3
    assert usual.max() == 255


def test_a_driver_that_cannot_add_floats_sums_in_memory(monkeypatch):
    seen = see(patches(PLACES, 150), MINUS_SIX, MYOPE, size=SMALL)
    usual = jitter.render_view(seen, 4)
    monkeypatch.setattr(accumulate.shaders, "ADD", "this is no GLSL")
    assert np.abs(jitter.render_view(seen, 4).astype(int) - usual).max() <= 1


@pytest.mark.parametrize("width", [160, 161])
def test_split_shows_the_naked_eye_on_the_left(width):
    """Columns left of the picture's middle; half of the passes draw the one that the middle halves as through the lens."""
    seen = see(patches(PLACES, 150), MINUS_SIX, MYOPE, size=(width, 120), split=True)
    split = jitter.render_view(seen, 6)
    through = jitter.render_view(replace(seen, layer=replace(seen.layer, split=False)), 6)
    naked = jitter.render_view(see(patches(PLACES, 150), None, MYOPE, size=(width, 120)), 6)
    assert np.array_equal(split[:, (width + 1) // 2 :], through[:, (width + 1) // 2 :])
    assert np.array_equal(split[:, : width // 2], naked[:, : width // 2])


@pytest.mark.parametrize("width", [40, 41])
def test_defocus_map_and_optics_of_pixels_split_at_the_same_column(width):
    """The column that the middle of the picture halves is as through the lens."""
    seen = see(patches([(0.0, 0.0, 3000.0)], 4000.0), MINUS_SIX, MYOPE, size=(width, 24), split=True)
    through = np.broadcast_to(np.arange(width) + 0.5 >= width / 2, (24, width))
    assert np.array_equal(np.isfinite(defocus_view(seen).defocus), through)
    assert np.array_equal(pixel_optics(seen).through == 1, through)


def test_exposure_is_a_factor_on_the_light():
    seen = see(patches([(0, 0, 3000.0)], 2500, colour=(100, 90, 80)), size=(64, 48))
    dim, bright = (jitter.decode(jitter.render_view(seen, 2, exposure=e))[24, 32] for e in (1.0, 2.0))
    assert bright == pytest.approx(2 * dim, rel=0.02)


def test_three_hundred_passes_leak_less_than_five_megabytes():
    seen = see(patches(PLACES, 150), MINUS_SIX, MYOPE, half_width=np.radians(50), size=(320, 240))
    with jitter.Studio() as studio:
        studio.picture(seen, 40)
        studio.light(seen, 2)
        before = resident_mb()
        studio.picture(seen, 300)
        studio.light(seen, 2)
        assert resident_mb() - before < 5
