"""Designs side by side: zones against closed forms, differences on the same places, one page."""

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import lensbench as lb
from lensbench.cli import main
from lensbench.compare import MAPS, compare, difference
from lensbench.errors import InputError
from lensbench.layers import MapLayer, Profile, ProfileLayer, Request
from lensbench.optics.conventions import astigmatism, mean_power
from lensbench.optics.gaze import look_through
from lensbench.optics.lens import circle_outline
from lensbench.report.comparison import measure_rows, zones_csv
from lensbench.workbench import run
from lensbench.zones import ANY_POWER, CLEAR, _Looked, zones

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
FAR, NEAR = "wide_far_R.toml", "wide_near_R.toml"


@pytest.fixture(scope="module")
def wearer():
    return lb.load_wearer(SAMPLES / "presbyope_60.toml")


@pytest.fixture(scope="module")
def regular():
    return lb.load_lens(SAMPLES / "regular_R.toml")


def minkwitz(slope, inset=0.05):
    """Gained power -slope y and error 2 slope |x - inset y| of an umbilic x = inset y: Minkwitz's theorem."""
    x, y = np.arange(-30, 30.01, 0.25), np.arange(-25, 25.01, 0.25)
    gx, gy = np.meshgrid(x, y)
    meridian = Profile(inset * y, y, -slope * y, -slope * y, -slope * y, 0 * y)
    return _Looked(x, y, -slope * gy, 2 * slope * np.abs(gx - inset * gy), meridian)


@pytest.mark.parametrize("slope", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("y", [-12.3, 0.0, 7.7])
def test_width_of_a_corridor_is_that_of_minkwitz(slope, y):
    """CLEAR / slope, to 0.05 mm (samples every 0.25 mm)."""
    assert minkwitz(slope).width(y) == pytest.approx(CLEAR / slope, abs=0.05)


def test_windows_of_power_bound_width_and_area():
    looked = minkwitz(0.1)
    assert looked.width(-10.0, (0.9, 1.1)) == pytest.approx(5.0, abs=0.05)
    assert looked.width(-10.0, (1.1, 2.0)) == 0.0
    assert looked.area((0.5, 1.5)) == pytest.approx(5.0 * 10.0, rel=0.06)
    assert looked.area(ANY_POWER) == pytest.approx(5.0 * 50.0, rel=0.06)


def test_reach_of_the_addition_is_where_the_meridian_has_it(regular, wearer):
    found = zones(regular, wearer)
    far_profile, profile = (run(Request(regular, wearer, ProfileLayer(d, samples=2001))) for d in (np.inf, "model"))
    _, far_y = regular.points.distance_reference_point
    far = np.interp(far_y, far_profile.y, far_profile.mean_power)
    there = regular.points.fitting_point[1] - found.reach_of_addition
    assert np.interp(there, profile.y, profile.mean_power) - far == pytest.approx(0.85 * 2.0, abs=0.01)


def test_zones_keep_their_promises(wearer):
    """The wide-far design is wide above, the wide-near design below; the widest corridor is that of the soft occupational."""
    far, near, soft = (zones(lb.load_lens(SAMPLES / n), wearer) for n in (FAR, NEAR, "occupational_R.toml"))
    assert far.distance_width > 2 * near.distance_width
    assert near.near_width > 5 * far.near_width
    assert soft.corridor_width > max(far.corridor_width, near.corridor_width)


def test_the_near_zone_is_judged_where_the_wearer_reads(wearer):
    """Its width: gazes along the row of the near reference point, for a point 40 cm from the cornea on each; and it is another
    for far objects."""
    lens = lb.load_lens(SAMPLES / FAR)
    x0, y = lens.points.near_reference_point
    x = np.arange(x0 - 8, x0 + 8, 0.02)
    field = look_through(lens, wearer, x, np.full_like(x, y))
    cornea = np.array([0.0, 0.0, -wearer.wear.vertex_distance])
    distance = [brentq(lambda s, k=k: np.linalg.norm(field.origin[k] + s * field.direction[k] - cornea) - 400, 1, 900)
                for k in range(x.size)]  # fmt: skip
    power = field.as_worn_matrix(np.array(distance))
    far = look_through(lens, wearer, *np.transpose([lens.points.distance_reference_point])).as_worn_matrix()
    clear = astigmatism(power - wearer.prescription) <= CLEAR
    clear &= mean_power(power) - mean_power(far[0]) >= 7 / 8 * lens.ordered.addition
    assert zones(lens, wearer).near_width == pytest.approx(0.02 * clear.sum(), abs=0.15)
    far_reader = replace(wearer, wear=replace(wearer.wear, near_distance=1e7))
    assert zones(lens, far_reader).near_width < 0.5 * zones(lens, wearer).near_width


def test_the_page_says_for_which_objects_each_measure_is_taken(regular, wearer):
    design = compare([regular, regular], wearer, ())
    reader = replace(wearer, wear=replace(wearer.wear, near_distance=330.0))
    said = {row.label: row.value[0] for row in measure_rows(design, reader)}
    assert (said["distance_width"], said["near_width"], said["intermediate_width"]) == ("∞", "33 cm", "by gaze")


def test_a_lens_without_addition_has_a_distance_zone_only(wearer):
    found = zones(lb.load_lens(SAMPLES / "sphere_minus_4_R.toml"), wearer)
    assert found.near_width is found.corridor_width is found.reach_of_addition is None
    assert found.distance_area > 1000


def test_difference_is_taken_on_the_same_places(regular, wearer):
    other = replace(regular, outline=circle_outline(40.0), centre_thickness=regular.centre_thickness + 1.0)
    layer = MapLayer("mean_power", samples=31)
    found = difference(Request(other, wearer, layer), Request(regular, wearer, layer))
    reference = run(Request(regular, wearer, layer))
    thicker = run(Request(replace(other, outline=regular.outline), wearer, layer))
    assert np.array_equal(found.x, reference.x)
    np.testing.assert_allclose(found.values, thicker.values - reference.values, rtol=0, atol=1e-12)
    assert np.nanmax(np.abs(found.values)) > 0.005
    same = Request(regular, wearer, layer)
    assert np.nanmax(np.abs(difference(same, same).values)) == 0


def test_differences_are_those_of_the_maps_beside_them(regular, wearer):
    """Lenses ordered for +1.00 and for 0.00 D: each is worn by the eye for which it was ordered, in its maps and in the
    differences."""
    stronger = replace(regular, ordered=replace(regular.ordered, sphere=regular.ordered.sphere + 1.0))
    layers = [MapLayer(quantity, samples=21) for quantity in ("mean_error", "astigmatic_error", "defocus")]
    first, second = compare([regular, stronger], wearer, layers)
    for k, found in enumerate(second.differences):
        np.testing.assert_array_equal(found.values, second.maps[k].values - first.maps[k].values)
    assert np.nanmean(second.differences[0].values) == pytest.approx(-1.0, abs=0.01)


def test_comparison_needs_two_lenses_of_one_side(regular, wearer):
    with pytest.raises(InputError, match="at least two"):
        compare([regular], wearer)
    with pytest.raises(InputError, match="one side"):
        compare([regular, replace(regular, side="L")], wearer)


def test_command_writes_page_and_table(tmp_path, wearer, capsys):
    paths = [str(SAMPLES / FAR), str(SAMPLES / NEAR)]
    out = tmp_path / "side by side"
    assert main(["compare", *paths, "-w", str(SAMPLES / "presbyope_60.toml"), "-o", str(out)]) == 0
    page = (out / "index.html").read_text(encoding="utf-8")
    assert page.count("data:image/png") == 3 * len(MAPS) + 1 == len(list(out.glob("*.png")))
    numbers = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert [d["zones"]["near_width"] for d in numbers["designs"]] == [
        pytest.approx(zones(lb.load_lens(p), wearer).near_width) for p in paths
    ]
    table = tmp_path / "zones.csv"
    assert main(["compare", *paths, "-w", str(SAMPLES / "presbyope_60.toml"), "-o", str(table)]) == 0
    assert table.read_text(encoding="utf-8") == (out / "zones.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(io.StringIO(table.read_text(encoding="utf-8"))))
    assert [float(r["near_width"]) for r in rows] == [
        pytest.approx(d["zones"]["near_width"], rel=1e-5) for d in numbers["designs"]
    ]


def test_names_are_escaped(regular, wearer):
    hostile = replace(regular, name='=A<script>"$x')
    designs = compare([hostile, regular], wearer, (MapLayer("mean_error", samples=15),))
    assert zones_csv(designs).splitlines()[1].startswith('"=A<script>""$x",')
