"""The view against real rays pixel by pixel: edges, point spreads and the whole picture, through a strong progressive lens."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import real_view

import lensbench as lb
from lensbench.layers import Request, ViewLayer
from lensbench.optics.eye import Eye
from lensbench.optics.mirror import mirrored
from lensbench.scenes.builtin import load_scene
from lensbench.scenes.scene import Scene, rectangle
from lensbench.workbench import look, run

pytest.importorskip("vtkmodules")

from lensbench.views import jitter

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
WHITE = np.full((2, 2, 3), 255, dtype=np.uint8)


@pytest.fixture(scope="module")
def strong():
    """A progressive of -3.00 / -1.00 with an addition of 2.00, and an eye that it corrects, without accommodation."""
    lens = lb.load_lens(SAMPLES / "wide_near_R.toml")
    wearer = lb.load_wearer(SAMPLES / "presbyope_60.toml")
    eye = Eye(lens.ordered.power(), wearer.wear.vertex_distance, 0.0, 4.0)
    return lens, replace(wearer, eye=eye, wear=replace(wearer.wear, pupillary_distance=0.0))


def seen_squares(strong, places, half_width, layer):
    lens, wearer = strong
    parts = (
        rectangle(str(k), place, [-half_width[k], 0, 0], [0, half_width[k], 0], WHITE) for k, place in enumerate(places)
    )
    return run(Request(lens, wearer, layer, Scene("squares", tuple(parts), (0, 0, 0))))


def spread_out(layer, strong, depths):
    """Places (n, 3) at given depths that are seen evenly over the picture, and where: pixels (n, 2)."""
    lens, wearer = strong
    width, height = layer.size
    columns = len(depths) // 4
    x, y = np.meshgrid((np.arange(columns) + 0.5) / columns * width, (np.arange(4) + 0.5) / 4 * height)
    pixels = np.stack([x.ravel(), y.ravel()], axis=1) + 0.3
    field = lb.trace(lens, wearer, real_view.pixel_gazes(layer, pixels))
    assert (field.status == lb.Status.OK).all()
    along = (depths - field.origin[:, 2]) / field.direction[:, 2]
    return field.origin + along[:, None] * field.direction, pixels


def crop(place, half):
    """Pixel centres (k, k, 2) of the square around a place of a picture."""
    corner = np.floor(place) - half + 0.5
    x, y = np.meshgrid(*(c + np.arange(2 * half) for c in corner))
    return np.stack([x, y], axis=-1)


def light_in(picture, centres):
    x, y = np.moveaxis(centres.astype(int), -1, 0)
    return jitter.decode(picture)[y, x, 1].astype(float)


def test_edges_lie_within_half_a_pixel(strong):
    layer = ViewLayer("lens", 0.0, -0.12, float(np.radians(26)), (960, 720))
    depths = np.array([6000.0, 1500.0, 700.0, 400.0])[np.arange(20) % 4]
    places, pixels = spread_out(layer, strong, depths)
    half = 0.035 * depths
    picture = jitter.render_view(seen_squares(strong, places, half, layer), 128)
    along = np.array([crop(middle, 60)[59:61] for middle in pixels])
    down = np.array([np.swapaxes(crop(middle, 60)[:, 59:61], 0, 1) for middle in pixels])
    for strips in (along, down):
        shade = real_view.squares(np.repeat(places, 240, axis=0), np.repeat(half, 240))
        real = real_view.picture_light(*strong, layer, strips.reshape(-1, 2), shade, 64)[:, 1].reshape(20, 2, 120)
        drawn = light_in(picture, strips)
        assert real[..., [0, -1]].max() < 1e-3
        assert real[..., 60].min() > 0.99
        for side in (slice(0, 60), slice(60, 120)):
            moved = (drawn - real)[..., side].sum(axis=(1, 2)) / 2
            assert np.abs(moved).max() < 0.5


def covariance(places, weight):
    weight = weight / weight.sum()
    offset = places - weight @ places
    return np.einsum("n,nk,nl->kl", weight, offset, offset)


def test_point_spreads_are_those_of_real_rays(strong):
    """An eye 3 D away from the lens, with a pupil of 3 mm: what the first order leaves out grows with the pupil's square, and
    makes up to a fifth of the covariance of those spreads of a 4 mm pupil that are close to a focus."""
    lens, corrected = strong
    eye = replace(corrected.eye, refraction=corrected.eye.refraction + 3.0 * np.eye(2), pupil_diameter=3.0)
    strong = lens, replace(corrected, eye=eye)
    layer = ViewLayer("lens", 0.0, -0.12, float(np.radians(26)), (1280, 960))
    depths = np.array([270.0, 400.0, 6000.0, 1000.0, 600.0])[np.arange(20) // 4]
    places, pixels = spread_out(layer, strong, depths)
    seen = seen_squares(strong, places, 0.0015 * depths, layer)
    with jitter.Studio() as studio:
        blurred = studio.picture(seen, 400)
        point = studio.picture(replace(seen, layer=replace(layer, eye="pinhole")), 64)
    spread, weight = real_view.point_spread(*strong, layer, places, pixels, 200)
    errors = []
    for k, middle in enumerate(pixels):
        centres = crop(middle, 48)
        drawn, sharp = (covariance(centres.reshape(-1, 2), light_in(p, centres).ravel()) for p in (blurred, point))
        real = covariance(spread[k], weight[k])
        errors.append(np.linalg.norm(drawn - sharp - real) / np.linalg.norm(real))
    assert np.max(errors) < 0.05


def test_the_whole_picture_is_that_of_real_rays(strong):
    lens, wearer = strong
    scene = load_scene("room")
    layer = ViewLayer("lens", *look("near", lens, wearer, scene), float(np.radians(18)), (96, 72))
    seen = run(Request(lens, wearer, layer, scene))
    y, x = (a + 0.5 for a in np.mgrid[:72, :96])
    room = real_view.TexturedScene(seen.scene)
    pixels = np.stack([x, y], axis=-1).reshape(-1, 2)
    real = real_view.picture_light(lens, wearer, layer, pixels, room.shade, 64, room.meet)
    reference = jitter.encode(real.reshape(72, 96, 3))
    found = [real_view.psnr(jitter.render_view(seen, passes), reference) for passes in (4, 64)]
    assert found[0] < found[1]
    assert found[1] > 33
    flipped = run(Request(replace(mirrored(lens), side=lens.side), wearer, layer, scene))
    assert real_view.psnr(jitter.render_view(flipped, 64), reference) < 25
