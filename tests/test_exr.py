"""OpenEXR files of a view: what they hold is what the optics say, in the pixel in which the picture shows it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lensbench.cli import main
from lensbench.imaging.exr import PARTS, exr_bytes
from lensbench.imaging.pixels import pixel_optics
from lensbench.layers import Request, ViewLayer
from lensbench.optics.conventions import Status, power_matrix
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.gaze import look_at
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.optics.surfaces import sphere
from lensbench.scenes.scene import Scene, rectangle
from lensbench.workbench import run

OpenEXR = pytest.importorskip("OpenEXR")

CENTRED = Wear(pupillary_distance=0.0)
EYE = Wearer(Eye(accommodation=1.0, pupil_diameter=5.0), CENTRED, "test eye")
MINUS_FOUR = Lens(
    sphere(523.0 / 3.0), sphere(523.0 / 7.0), 1.8, MATERIALS["crown"], circle_outline(56), side="R", wavelength="d"
)
GREY, WHITE = np.full((2, 2, 3), 90, np.uint8), np.full((2, 2, 3), 255, np.uint8)
WALL = rectangle("wall", [0, 0, 2000], [-3000, 0, 0], [0, 3000, 0], GREY)


def see(scene, lens=None, wearer=EYE, **layer):
    layer = {"eye": "naked" if lens is None else "lens", "size": (160, 120), **layer}
    return run(Request(lens, wearer, ViewLayer(**layer), scene))


def read(data: bytes, folder: Path) -> dict:
    path = folder / "x.exr"
    path.write_bytes(data)
    with OpenEXR.File(str(path)) as file:
        return {
            part.name(): (dict(part.header), {k: c.pixels.copy() for k, c in part.channels.items()})
            for part in file.parts
        }


def test_the_naked_eyes_numbers_are_the_closed_forms():
    found = pixel_optics(see(Scene("wall", (WALL,))))
    gaze = found.apparent
    pupil = EYE.centre_of_rotation + EYE.eye.pupil_from_rotation * gaze
    distance = (2000 - pupil[..., 2]) / gaze[..., 2]
    assert np.allclose(found.distance, distance, rtol=2e-6)
    assert np.allclose(found.hit, pupil + distance[..., None] * gaze, atol=0.01)
    assert np.allclose(found.refracted, gaze)
    needed = 1000 / distance
    assert np.allclose(found.accommodation, np.minimum(needed, 1.0), atol=1e-5)
    assert np.allclose(found.residual_mean, needed - np.minimum(needed, 1.0), atol=1e-5)
    assert np.allclose(found.semi_major, 0, atol=1e-3)
    assert not found.through.any()


def test_an_eye_that_cannot_accommodate_sees_the_blur_of_its_pupil():
    wearer = replace(EYE, eye=replace(EYE.eye, accommodation=0.0))
    found = pixel_optics(see(Scene("wall", (WALL,)), wearer=wearer))
    assert np.allclose(found.semi_major, 2.5, atol=1e-6)  # a relaxed emmetrope: a beam as wide as the pupil
    assert np.allclose(found.defocus, np.degrees(5.0 / found.distance) * 60, rtol=1e-6)


def test_a_lens_in_the_middle_and_the_naked_eye_around_it():
    seen = see(Scene("wall", (WALL,)), replace(MINUS_FOUR, outline=circle_outline(20)))
    found = pixel_optics(seen)
    assert found.through[60, 80] == 1
    assert found.through[60, 2] == 0
    power = found.sphere + found.cylinder / 2
    assert power[60, 80] == pytest.approx(-4.0, abs=0.1)
    assert np.allclose(power[found.through == 0], 0, atol=1e-9)
    assert (found.status[found.through == 0] == Status.OK).all()


def test_each_pixel_holds_the_ray_that_the_optics_aim_at_its_hit():
    tilted = {"azimuth": 0.1, "elevation": -0.2, "head_turn": 0.12, "head_tilt": -0.08}
    seen = see(Scene("wall", (WALL,)), MINUS_FOUR, **tilted)
    found = pixel_optics(seen)
    rows, columns = np.nonzero(found.through)
    some = slice(None, None, 997)
    hit = found.hit[rows[some], columns[some]]
    field = look_at(MINUS_FOUR, EYE, (hit - seen.eye) @ seen.head + seen.eye)
    assert np.allclose(field.directions @ seen.head.T, found.apparent[rows[some], columns[some]], atol=2e-6)
    local = found.apparent[rows[some], columns[some]] @ seen.frame.T
    focal = 80 / np.tan(seen.layer.half_width)
    assert np.allclose(80 - focal * local[:, 0] / local[:, 2], columns[some] + 0.5, atol=1e-6)
    assert np.allclose(60 - focal * local[:, 1] / local[:, 2], rows[some] + 0.5, atol=1e-6)


def test_nothing_met_is_nan_and_a_pinhole_has_no_blur():
    seen = see(Scene("half", (rectangle("low", [0, -1500, 2000], [-3000, 0, 0], [0, 1500, 0], GREY),)), MINUS_FOUR)
    found = pixel_optics(seen)
    for name in ("distance", "hit", "sphere", "axis", "semi_major", "accommodation", "defocus"):
        assert np.isnan(getattr(found, name)[:55]).all(), name
        assert np.isfinite(getattr(found, name)[66:]).all(), name
    assert np.isfinite(found.refracted).all()
    sharp = pixel_optics(see(Scene("wall", (WALL,)), MINUS_FOUR, eye="pinhole"))
    assert sharp.semi_major.max() == 0
    assert sharp.defocus.max() == 0
    assert sharp.sphere[60, 80] == pytest.approx(-4.0, abs=0.1)


def test_the_split_view_is_naked_on_its_left():
    found = pixel_optics(see(Scene("wall", (WALL,)), MINUS_FOUR, split=True))
    assert not found.through[:, :80].any()
    assert found.through[40:80, 80:].all()


def test_the_file_holds_the_arrays_and_says_their_units(tmp_path):
    seen = see(Scene("wall", (WALL,)), MINUS_FOUR)
    light = np.random.default_rng(1).random((120, 160, 3)).astype(np.float32) * 3
    parts = read(exr_bytes(light, seen), tmp_path)
    assert list(parts) == ["view", *PARTS]
    assert np.array_equal(parts["view"][1]["RGB"], light)
    found = pixel_optics(seen)
    for name, part in PARTS.items():
        header, channels = parts[name]
        assert header["units"] == part.unit
        for channel, (array, component) in part.channels.items():
            expected = getattr(found, array)
            expected = expected if component is None else expected[..., component]
            assert np.array_equal(channels[channel], expected.astype(channels[channel].dtype), equal_nan=True), channel
    header = parts["depth"][0]
    assert header["frame"].startswith("right-handed, mm: +x to the wearer's left")
    assert header["wearer"] == "test eye"
    assert header["horizontalFieldDegrees"] == pytest.approx(50.0)
    assert np.allclose(header["pictureAhead"], [0, 0, 1])


def test_light_and_hits_share_their_pixels(tmp_path):
    """A white mark in the scene is bright in the picture just where the hits lie on it."""
    pytest.importorskip("vtkmodules")
    from lensbench.views.jitter import Studio

    centre = np.array([350.0, 220.0, 1990.0])
    mark = rectangle("mark", centre, [-60, 0, 0], [0, 60, 0], WHITE)
    seen = see(Scene("mark", (WALL, mark)), MINUS_FOUR, size=(320, 240), eye="pinhole")
    with Studio() as studio:
        light = studio.light(seen, 16)
    parts = read(exr_bytes(light, seen), tmp_path)
    bright = parts["view"][1]["RGB"][..., 1] > 0.55
    x, y, z = (parts["hit"][1][axis] for axis in "XYZ")
    on_mark = (np.abs(x - centre[0]) < 60) & (np.abs(y - centre[1]) < 60) & (np.abs(z - centre[2]) < 1)
    assert on_mark.sum() > 100
    assert np.count_nonzero(on_mark != bright) <= 4
    assert np.nonzero(on_mark)[0].mean() < 120  # up
    assert np.nonzero(on_mark)[1].mean() < 160  # on the wearer's left


def test_the_command_writes_it_whole_or_not_at_all(tmp_path, capsys):
    pytest.importorskip("vtkmodules")
    out = tmp_path / "view.exr"
    size = ["--size", "64", "48", "--passes", "2"]
    assert main(["view", "sample_lenses/regular_R.toml", "--look", "near", *size, "-o", str(out)]) == 0
    parts = read(out.read_bytes(), tmp_path)
    assert parts["view"][1]["RGB"].shape == (48, 64, 3)
    assert 0.05 < parts["view"][1]["RGB"].mean() < 0.95
    assert np.nanmin(parts["depth"][1]["Z"]) == pytest.approx(390, abs=30)
    assert parts["depth"][0]["scene"] == "room"
    assert main(["view", "sample_lenses/regular_R.toml", *size, "-o", str(tmp_path / "view.tif")]) == 2
    assert ".exr" in capsys.readouterr().err


def test_myopes_are_blurred_by_their_refraction_at_infinity():
    """Far wall, refraction -1 D, 5 mm pupil: rms blur diameter = 5 mm x 1 D less the wall's vergence."""
    wall = rectangle("wall", [0, 0, 1e5], [-3e4, 0, 0], [0, 3e4, 0], GREY)
    wearer = Wearer(Eye(power_matrix(-1.0), pupil_diameter=5.0), CENTRED)
    found = pixel_optics(see(Scene("wall", (wall,)), wearer=wearer, half_width=0.1))
    at_pupil = -1.0 / (1 + 0.0151)  # at the entrance pupil, 12 + 3.05 mm behind the plane of refraction
    expected = np.degrees(5e-3 * abs(at_pupil + 1000 / found.distance[60, 80])) * 60
    assert found.defocus[60, 80] == pytest.approx(expected, rel=1e-3)
