"""Readings along one gaze: those of the field, wherever one points, with the head turned too."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lensbench as lb
from lensbench.errors import InputError
from lensbench.layers import MapLayer, ProbeLayer, Request, ViewLayer
from lensbench.optics.conventions import Status
from lensbench.optics.gaze import direction_from_angles
from lensbench.quantities import QUANTITIES
from lensbench.scenes.scene import Part, Scene
from lensbench.seen import pixel_directions
from lensbench.workbench import run

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
WALL = Part(
    "wall",
    np.array([[-3000.0, -3000, 1500], [3000, -3000, 1500], [3000, 3000, 1500], [-3000, 3000, 1500]]),
    np.array([[0, 1, 2], [0, 2, 3]]),
    np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]),
    np.full((2, 2, 3), 128, np.uint8),
)
SCENE = Scene("wall", (WALL,))


@pytest.fixture(scope="module")
def case():
    return lb.load_lens(SAMPLES / "regular_R.toml"), lb.load_wearer(SAMPLES / "presbyope_60.toml")


@pytest.mark.parametrize("distance", [np.inf, 400.0, "scene", "model"])
def test_readings_are_those_of_the_maps(case, distance):
    found = {}
    for quantity in ("mean_power", "prism", "defocus", "accommodation"):
        lens_map = run(Request(*case, MapLayer(quantity, distance, samples=31), SCENE))
        found[quantity] = lens_map.values[5, 17]
    probe = run(Request(*case, ProbeLayer((lens_map.x[17], lens_map.y[5]), distance=distance), SCENE))
    read = (probe.mean_power, probe.prism, probe.defocus, probe.accommodation)
    assert read == pytest.approx(tuple(found.values()), abs=1e-6)


def test_a_gaze_and_its_lens_point_are_one_probe(case):
    by_point = run(Request(*case, ProbeLayer((3.0, -12.0), distance=400.0)))
    by_gaze = run(Request(*case, ProbeLayer(direction=tuple(by_point.direction), distance=400.0)))
    assert by_gaze.point == pytest.approx((3.0, -12.0), abs=1e-8)
    assert by_gaze.semi_major == pytest.approx(by_point.semi_major, rel=1e-9)


def test_a_place_that_no_ray_passes_says_so(case):
    probe = run(Request(*case, ProbeLayer((60.0, 0.0))))
    assert probe.status != Status.OK
    assert np.isnan(probe.mean_power)


@pytest.mark.parametrize(("turn", "tilt"), [(0.0, 0.0), (0.3, 0.0), (-0.2, 0.25)])
def test_turned_head_meets_what_the_view_shows(case, turn, tilt):
    """A plano lens without power bends nothing: the hit of the pixel in the middle is where the view's centre line goes."""
    lens, wearer = case
    flat = replace(lens, front=lb.load_lens(SAMPLES / "sphere_minus_4_R.toml").back, points=type(lens.points)())
    flat = replace(flat, back=flat.front, centre_thickness=0.01)
    layer = ViewLayer("lens", 0.1, -0.15, size=(3, 3), head_turn=turn, head_tilt=tilt)
    seen = run(Request(flat, wearer, layer, SCENE))
    gaze = seen.head.T @ seen.frame.T @ pixel_directions(layer)[1, 1]
    gaze = gaze / np.linalg.norm(gaze)
    probe = run(
        Request(
            flat, wearer, ProbeLayer(direction=tuple(gaze), distance="scene", head_turn=turn, head_tilt=tilt), SCENE
        )
    )
    hit = seen.head @ (probe.exit + probe.distance * probe.outgoing - seen.eye) + seen.eye
    line = direction_from_angles(0.1, -0.15)
    expected = seen.eye + line * (1500.0 - seen.eye[2]) / line[2]
    assert hit == pytest.approx(expected, abs=0.5)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_quantity_of_a_map_is_read_at_a_point_as_the_map_has_it(case, quantity):
    lens_map = run(Request(*case, MapLayer(quantity, 400.0, samples=31)))
    for j, i in ((5, 17), (20, 12)):
        probe = run(Request(*case, ProbeLayer((lens_map.x[i], lens_map.y[j]), distance=400.0, quantity=quantity)))
        assert probe.value == pytest.approx(lens_map.values[j, i], rel=1e-6, abs=1e-6)


def test_a_quantity_that_is_not_known_is_said(case):
    with pytest.raises(InputError, match="taste"):
        run(Request(*case, ProbeLayer((0.0, 0.0), quantity="taste")))
