"""The picture shows each point where the chief ray says, spread as the blur matrix says, the right way round."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from lensbench.errors import LensBenchError
from lensbench.layers import Request, SeenScene, ViewLayer
from lensbench.optics.conventions import power_matrix
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.gaze import look_at
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.optics.surfaces import sphere
from lensbench.scenes.builtin import load_scene
from lensbench.scenes.scene import Scene, rectangle
from lensbench.seen import seen_parts
from lensbench.workbench import run

pytest.importorskip("vtkmodules")

from lensbench.views import jitter, offscreen
from lensbench.views.jitter import shaders, view_pass

FAR = 6000.0
CENTRED = Wear(pupillary_distance=0.0)
EMMETROPE = Wearer(Eye(), CENTRED)
MINUS_SIX = Lens(
    sphere(523.0 / 2.0), sphere(523.0 / 8.0), 1.8, MATERIALS["crown"], circle_outline(56), side="R", wavelength="d"
)


def patches(places, half_width, colour=(255, 255, 255), background=(0, 0, 0)) -> Scene:
    """Small squares facing +z at places (n, 3) mm."""
    image = np.full((2, 2, 3), colour, dtype=np.uint8)
    squares = (rectangle(f"{k}", p, [-half_width, 0, 0], [0, half_width, 0], image) for k, p in enumerate(places))
    return Scene("patches", tuple(squares), background)


def see(scene, lens=None, wearer=EMMETROPE, **layer) -> SeenScene:
    return run(Request(lens, wearer, ViewLayer("naked" if lens is None else "lens", **layer), scene))


def sharp(seen: SeenScene) -> SeenScene:
    return replace(seen, layer=replace(seen.layer, eye="perfect" if seen.lens is None else "pinhole"))


def on_picture(seen: SeenScene, directions) -> np.ndarray:
    """Pixel coordinates (n, 2), x to the right and y down from the picture's upper left corner, of directions."""
    local = np.atleast_2d(directions) @ seen.frame.T
    width, height = seen.layer.size
    focal = width / 2 / np.tan(seen.layer.half_width)
    return [width / 2, height / 2] - focal * local[:, :2] / local[:, 2:]


def moments(picture, around, radius):
    """Light, centroid (2,) and covariance (2, 2), pixels, of what lies within `radius` of a place."""
    light = jitter.decode(picture)[..., 1].astype(float)
    y, x = (a + 0.5 for a in np.mgrid[: light.shape[0], : light.shape[1]])
    light[np.hypot(x - around[0], y - around[1]) > radius] = 0
    total = light.sum()
    centre = np.array([(light * x).sum(), (light * y).sum()]) / total
    dx, dy = x - centre[0], y - centre[1]
    second = [[(light * a * b).sum() / total for a in (dx, dy)] for b in (dx, dy)]
    return total, centre, np.array(second)


@pytest.mark.parametrize(("azimuth", "elevation"), [(0.0, 0.0), (12.0, -20.0)])
def test_the_naked_eye_sees_the_plain_perspective(azimuth, elevation):
    a, e = np.radians([azimuth, elevation])
    aim = FAR * np.array([np.tan(a), np.tan(e) / np.cos(a), 1.0])
    places = aim + np.array([[x, y, 0] for x in (-1800, 0, 900) for y in (-1100, 0, 1300)])
    seen = see(patches(places, 40), azimuth=a, elevation=e)
    picture = jitter.render_view(seen)
    expected = on_picture(seen, places - EMMETROPE.centre_of_rotation)
    for place in expected:
        assert np.allclose(moments(picture, place, 15)[1], place, atol=0.1)


def test_through_a_lens_a_patch_appears_where_its_chief_ray_comes_from():
    places = np.array([[x, y, 800.0] for x in (-250, 60, 300) for y in (-200, 150)])
    wearer = Wearer(Eye(refraction=power_matrix(-6.0), accommodation=4.0), CENTRED)
    seen = see(patches(places, 4), MINUS_SIX, wearer)
    assert seen.around is not None
    picture = jitter.render_view(seen)
    expected = on_picture(seen, look_at(MINUS_SIX, wearer, places).directions)
    assert np.abs(expected - on_picture(seen, places - wearer.centre_of_rotation)).max() > 10
    for place in expected:
        assert np.allclose(moments(picture, place, 15)[1], place, atol=0.1)


@pytest.mark.parametrize("place", [(0.0, 0.0), (-1100.0, 700.0)])
def test_the_point_spread_has_the_blur_matrix_covariance(place):
    wearer = Wearer(Eye(refraction=power_matrix(-3.0, -4.0, 30.0), pupil_diameter=5.0), CENTRED)
    seen = see(patches([(*place, FAR)], 20), wearer=wearer)
    part = seen_parts(seen, seen.lens)[0]
    middle = len(part.gaze) // 2
    step = 1e-5
    moved = on_picture(seen, part.gaze[middle] + step * part.spread[middle].T)
    kernel = ((moved - on_picture(seen, part.gaze[middle])) / step).T
    at = on_picture(seen, part.gaze[middle])[0]
    blurred = moments(jitter.render_view(seen, 400), at, 60)[2]
    point = moments(jitter.render_view(sharp(seen), 48), at, 60)[2]
    expected = kernel @ kernel.T / 4
    assert np.sqrt(expected.max()) > 4
    assert np.linalg.norm(blurred - point - expected) < 0.04 * np.linalg.norm(expected)


def test_blur_keeps_the_light():
    seen = see(
        patches([(0, 0, FAR), (900, -500, FAR)], 200), wearer=Wearer(Eye(refraction=power_matrix(-1.5)), CENTRED)
    )
    blurred, point = (jitter.decode(jitter.render_view(s)).mean() for s in (seen, sharp(seen)))
    assert blurred == pytest.approx(point, rel=0.01)


def test_a_uniform_texture_keeps_its_colour():
    seen = see(patches([(0, 0, FAR)], 2000, colour=(12, 130, 201)), half_width=np.radians(10))
    assert np.abs(jitter.render_view(seen, 5).astype(int) - [12, 130, 201]).max() <= 1


def test_the_wearers_right_is_right_and_up_is_up():
    wearer = EMMETROPE
    for lens in (None, MINUS_SIX):
        picture = jitter.render_view(see(patches([(-900, 700, FAR)], 60), lens, wearer), 8)
        bright = jitter.decode(picture)[..., 1]
        row, column = np.unravel_index(np.argmax(bright), bright.shape)
        assert column > 330
        assert row < 230


def test_what_is_nearer_hides_what_is_farther():
    red, blue = np.full((2, 2, 3), (200, 0, 0), np.uint8), np.full((2, 2, 3), (0, 0, 200), np.uint8)
    near = rectangle("near", [0, 0, 400], [-30, 0, 0], [0, 30, 0], red)
    far = rectangle("far", [0, 0, FAR], [-3000, 0, 0], [0, 3000, 0], blue)
    for parts in ((near, far), (far, near)):
        assert tuple(jitter.render_view(see(Scene("two", parts)), 4)[240, 320]) == (200, 0, 0)


def test_past_the_lens_edge_the_naked_eye_sees():
    lens = replace(MINUS_SIX, outline=circle_outline(20))
    place = np.array([[0.0, -2900.0, FAR]])
    seen = see(patches(place, 60), lens, half_width=np.radians(35))
    expected = on_picture(seen, place - EMMETROPE.centre_of_rotation)[0]
    assert np.allclose(moments(jitter.render_view(seen), expected, 12)[1], expected, atol=0.1)


def test_lost_vertices_take_their_triangles_with_them(monkeypatch):
    def half_lost(*given):
        part = seen_parts(*given)[0]
        gaze = part.gaze.copy()
        gaze[gaze[:, 0] > 1e-6] = np.nan
        return (replace(part, gaze=gaze),)

    monkeypatch.setattr(view_pass, "parts_by_zone", lambda seen: (half_lost(seen, seen.lens), ()))
    picture = jitter.render_view(see(patches([(0, 0, FAR)], 1500)), 4, by_vertices=True)
    assert picture[240, 260].max() == 0
    assert picture[240, 380].min() == 255


def test_the_same_seed_gives_the_same_picture():
    seen = see(patches([(0, 0, FAR)], 300), wearer=Wearer(Eye(refraction=power_matrix(-2.0)), CENTRED), size=(160, 120))
    first, again, other = (jitter.render_view(seen, 6, seed) for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert np.abs(first.astype(int) - other).max() > 0


def test_codes_survive_light_and_back():
    codes = np.arange(256, dtype=np.uint8)
    assert np.array_equal(jitter.encode(jitter.decode(codes)), codes)


def test_side_by_side_keeps_the_pictures():
    left, right = np.full((120, 160, 3), 10, np.uint8), np.full((120, 100, 3), 200, np.uint8)
    strip = jitter.side_by_side([("left", left), ("right", right)], "caption")
    assert strip.shape[0] > 120
    assert strip.shape[1] > 260
    assert (strip == 200).all(axis=2).sum() >= right.shape[0] * right.shape[1]


def test_a_refused_shader_is_said(monkeypatch):
    for kind in ("atlas", "vertices"):
        monkeypatch.setitem(shaders.KINDS, kind, (shaders.KINDS[kind][0], "  this is no GLSL;\n", shaders.ZONE))
    with pytest.raises(LensBenchError, match="refused the shader"):
        jitter.render_view(see(patches([(0, 0, FAR)], 100), size=(64, 48)), 1)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks for Linux libraries")
def test_missing_graphics_are_said_in_one_sentence(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    monkeypatch.setattr(offscreen, "_egl_starts", lambda: False)
    with pytest.raises(LensBenchError, match="finds no driver: apt-get install libgl1-mesa-dri"):
        offscreen.require_gl()
    monkeypatch.setattr(offscreen, "_loads", lambda name: not name.startswith("libEGL"))
    with pytest.raises(LensBenchError, match=r"libEGL\.so\.1 cannot be loaded: apt-get install libegl1"):
        offscreen.require_gl()
    monkeypatch.setattr(offscreen, "find_spec", lambda name: None)
    with pytest.raises(LensBenchError, match=r"lensbench\[views\]"):
        offscreen.require_gl()


def test_the_graphics_report_names_the_renderer():
    report = offscreen.gl_report()
    assert set(report) == {"vtk version", "opengl window", "opengl version", "opengl renderer"}
    assert "unknown" not in report.values()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_memory_does_not_grow():
    seen = see(load_scene("room"), MINUS_SIX, size=(160, 120))
    for _ in range(3):
        jitter.render_view(seen, 2)
    before = resident_mb()
    for _ in range(20):
        jitter.render_view(seen, 2)
    assert resident_mb() - before < 30


def resident_mb() -> float:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096 / 1e6
