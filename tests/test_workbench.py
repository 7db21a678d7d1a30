"""Requests and results: one question, the same arrays whoever asks."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lensbench as lb
from lensbench.cli import main
from lensbench.errors import InputError
from lensbench.layers import (
    DefocusLayer,
    EllipseLayer,
    MapLayer,
    PointsLayer,
    ProfileLayer,
    RealRaysLayer,
    Request,
    ViewLayer,
    VoxelLayer,
)
from lensbench.optics import surfaces
from lensbench.optics.conventions import Status, mean_power
from lensbench.optics.field import ellipse
from lensbench.optics.gaze import look_through
from lensbench.optics.lens import Lens, Order, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.optics.object_distance import model_distance, proximity
from lensbench.quantities import QUANTITIES, Quantity
from lensbench.scenes.scene import Look, Part, Scene
from lensbench.seen import middle_distance, seen_parts
from lensbench.workbench import assumed_wearer, look, run

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
WALL = Part(
    "wall",
    np.array([[-1000.0, -1000, 1500], [1000, -1000, 1500], [1000, 1000, 1500], [-1000, 1000, 1500]]),
    np.array([[0, 1, 2], [0, 2, 3]]),
    np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]),
    np.full((2, 2, 3), 128, np.uint8),
)


@pytest.fixture(scope="module")
def progressive():
    return lb.load_lens(SAMPLES / "regular_R.toml")


@pytest.fixture(scope="module")
def wearer():
    return lb.load_wearer(SAMPLES / "presbyope_60.toml")


def test_map_holds_the_field_at_its_own_points(progressive, wearer):
    lens_map = run(Request(progressive, wearer, MapLayer("mean_power", 400.0, samples=31)))
    j, i = 6, 17
    field = look_through(progressive, wearer, [lens_map.x[i]], [lens_map.y[j]])
    assert lens_map.values[j, i] == pytest.approx(mean_power(field.as_worn_matrix(400.0))[0], abs=1e-12)
    assert np.array_equal(np.isnan(lens_map.values), lens_map.status != Status.OK)
    assert np.diff(lens_map.x) == pytest.approx(lens_map.y[1] - lens_map.y[0])


def test_first_order_is_compared_with_real_rays(progressive, wearer):
    found = run(Request(progressive, wearer, RealRaysLayer((np.inf, 400.0, "model"), samples=13)))
    assert [check.distance for check in found.checks] == [np.inf, 400.0, "model"]
    for check in found.checks:
        assert 0 < np.nanpercentile(np.abs(check.deviation), 90) < 1.0
        assert np.nanmax(check.real_rays) > 10
    field = look_through(progressive, wearer, [0.0], [8.0])
    spot = found.spots[0]
    assert (spot.name, spot.distance) == ("distance reference point", np.inf)
    assert spot.first_order == pytest.approx(np.degrees(field.angular_blur(np.inf)[0]) * 60)
    assert 4 * np.cov(spot.points.T) == pytest.approx(spot.first_order @ spot.first_order.T, abs=0.02)
    greatest = found.spots[-1]
    assert greatest.name.startswith("greatest deviation, x ")
    assert greatest.points.shape == (400, 2)


def test_the_model_sees_far_above_and_near_below(progressive, wearer):
    seen = run(Request(progressive, wearer, MapLayer("defocus", "model", samples=21)))
    j, i = 3, 10
    field = look_through(progressive, wearer, [seen.x[i]], [seen.y[j]])
    distance = model_distance(field)
    assert seen.values[j, i] == pytest.approx(np.degrees(field.defocus(distance)[0]) * 60, rel=1e-12)
    point = field.origin[0] + distance[0] * field.direction[0]
    lowering = -np.arcsin(field.directions[0, 1])
    away = np.linalg.norm(point - [0, 0, -wearer.wear.vertex_distance])
    assert 1000 / away == pytest.approx(proximity(wearer.wear, lowering), rel=1e-9)
    profile = run(Request(progressive, wearer, ProfileLayer("model")))
    infinite = run(Request(progressive, wearer, ProfileLayer()))
    assert profile.mean_power[-1] == infinite.mean_power[-1]
    assert profile.mean_power[0] != infinite.mean_power[0]


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_quantity_has_finite_values_and_a_unit(progressive, wearer, quantity):
    lens_map = run(Request(progressive, wearer, MapLayer(quantity, samples=21)))
    assert np.array_equal(np.isfinite(lens_map.values), lens_map.status == Status.OK)
    assert np.isfinite(lens_map.values).sum() > 300
    assert lens_map.label
    assert lens_map.unit


def test_addition_shows_in_the_map(progressive, wearer):
    lens_map = run(Request(progressive, wearer, MapLayer("mean_power", samples=61)))
    at = {
        y: lens_map.values[np.argmin(abs(lens_map.y - y)), np.argmin(abs(lens_map.x - x))]
        for x, y in ((0, 8), (2.5, -13))
    }
    assert at[-13] - at[8] == pytest.approx(2.2, abs=0.3)


def test_defocus_of_a_scene_is_that_of_its_distance(progressive, wearer):
    pytest.importorskip("embreex")
    seen = run(Request(progressive, wearer, MapLayer("defocus", "scene", samples=21), Scene("wall", (WALL,))))
    field = look_through(progressive, wearer, [seen.x[12]], [seen.y[9]])
    distance = (1500 - field.origin[0, 2]) / field.direction[0, 2]
    assert seen.values[9, 12] == pytest.approx(np.degrees(field.defocus(distance)[0]) * 60, rel=1e-5)


def test_reference_points_of_a_sphere_show_its_order(wearer):
    lens = lb.load_lens(SAMPLES / "sphere_minus_4_R.toml")
    straight = lb.Wearer(wearer.eye, lb.Wear(13.0))
    reading = {r.name: r for r in run(Request(lens, straight, PointsLayer()))}["distance_reference_point"]
    assert (reading.sphere, reading.cylinder, reading.prism) == pytest.approx((-4.0, 0.0, 0.0), abs=1e-4)
    assert reading.mean_error == pytest.approx(0.0, abs=1e-4)


def test_profile_runs_from_the_lower_to_the_upper_edge(progressive, wearer):
    profile = run(Request(progressive, wearer, ProfileLayer()))
    assert profile.y[0] < -28
    assert profile.y[-1] > 28
    assert profile.x[0] == pytest.approx(2.5)
    assert profile.x[-1] == pytest.approx(0.0)
    assert np.all(profile.least_power <= profile.greatest_power)


def test_ellipse_sheets_lie_on_their_planes(progressive, wearer):
    for sheet in run(Request(progressive, wearer, EllipseLayer(n=8))):
        ok = sheet.status == Status.OK
        assert sheet.centre[ok, 2] == pytest.approx(sheet.depth - wearer.wear.vertex_distance, rel=1e-12)
        area = np.pi * sheet.semi_major * sheet.semi_minor
        cross = np.linalg.norm(np.cross(sheet.spokes[..., 0], sheet.spokes[..., 1]), axis=1)
        assert area[ok] == pytest.approx(np.pi * cross[ok], rel=1e-9, abs=1e-12)


def test_voxels_are_columns_of_the_gaze_field(progressive, wearer):
    voxels = run(Request(progressive, wearer, VoxelLayer(5, 4, 6, 300.0, 5000.0)))
    assert voxels.blur.shape == (2, 2, 4, 5, 6)
    assert voxels.depth[[0, -1]] == pytest.approx([300.0, 5000.0])
    near, far, camera = (d + wearer.eye.centre_of_rotation for d in (300.0, 5000.0, voxels.depth))
    ndc = (1 / near - 1 / camera) / (1 / near - 1 / far)
    assert np.diff(ndc) == pytest.approx(0.2)
    gaze = np.array([[voxels.u[3], voxels.v[1], 1.0]])
    field = lb.trace(progressive, wearer, gaze)
    distance = (voxels.depth[2] - wearer.wear.vertex_distance - field.origin[0, 2]) / field.direction[0, 2]
    assert voxels.blur[:, :, 1, 3, 2] == pytest.approx(field.blur(distance)[0], abs=1e-5)


def test_one_origin_serves_every_depth(progressive, wearer):
    """An ellipse and a voxel of the same gaze and depth are one."""
    sheet = run(Request(progressive, wearer, EllipseLayer((400.0,), 5)))[0]
    voxels = run(Request(progressive, wearer, VoxelLayer(5, 5, 2, 400.0, 900.0)))
    assert ellipse(voxels.blur[:, :, 2, 2, 0].astype(float)).semi_major == pytest.approx(sheet.semi_major[12], rel=1e-5)


@pytest.mark.parametrize("missing", [Status.NO_VALUE, Status.BUNDLE_CUT])
def test_a_map_says_why_a_ray_that_passes_has_no_value(progressive, wearer, monkeypatch, missing):
    half = Quantity("half", "D", lambda f, s, a: np.where(f.directions[:, 0] > 0, np.nan, 1.0), missing=missing)
    monkeypatch.setitem(QUANTITIES, "half", half)
    found = run(Request(progressive, wearer, MapLayer("half", samples=21)))
    assert set(found.status[np.isnan(found.values)]) == {Status.OUTSIDE_OUTLINE, missing}


def test_only_what_takes_the_whole_pupil_can_be_cut():
    by_real_rays = {
        "defocus_by_real_rays",
        "defocus_left_out",
        "higher_order_rms",
        "coma",
        "trefoil",
        "spherical_aberration",
    }
    assert {name for name, q in QUANTITIES.items() if q.missing == Status.BUNDLE_CUT} == by_real_rays


def test_view_meets_every_vertex_and_spreads_it_by_the_field(progressive, wearer):
    seen = run(Request(progressive, wearer, ViewLayer(), Scene("wall", (WALL,))))
    part = seen_parts(seen, seen.lens)[0]
    corner = WALL.points[:1] + np.array([wearer.wear.pupillary_distance, 0, 0])
    field = lb.look_at(progressive, wearer, corner, within_outline=False)
    assert part.gaze[0] == pytest.approx(field.directions[0], abs=1e-10)
    blur = field.apparent_blur(field.distances_to(corner))[0]
    assert np.linalg.svd(part.spread[0])[1] == pytest.approx(np.linalg.svd(blur)[1], rel=1e-8)


def test_naked_view_is_straight(wearer):
    naked = run(Request(None, wearer, ViewLayer("naked"), Scene("wall", (WALL,))))
    straight = WALL.points - wearer.centre_of_rotation
    gaze = seen_parts(naked, None)[0].gaze
    assert gaze == pytest.approx(straight / np.linalg.norm(straight, axis=1, keepdims=True))
    assert naked.around is naked.edge is None


def test_a_turned_head_sees_the_target_through_another_part_of_the_lens(progressive, wearer):
    ahead, turned = (
        run(Request(progressive, wearer, ViewLayer(head_turn=turn, head_tilt=0.1), Scene("wall", (WALL,))))
        for turn in (0.0, np.radians(12.0))
    )
    assert turned.frame == pytest.approx(ahead.frame)
    gaze = seen_parts(turned, None)[0].gaze @ turned.head.T
    assert gaze == pytest.approx(seen_parts(ahead, None)[0].gaze @ ahead.head.T)
    azimuth = np.arctan2(*(turned.frame[2] @ turned.head)[[0, 2]])
    assert np.degrees(azimuth) == pytest.approx(-12.0, abs=0.1)
    gaze = seen_parts(turned, turned.lens)[0].gaze
    points = seen_parts(turned, turned.lens)[0].part.points - turned.eye
    field = lb.trace(progressive, wearer, gaze, within_outline=False)
    outgoing = (field.origin - turned.eye) @ turned.head.T
    along = np.einsum("nj,nj->n", points - outgoing, field.direction @ turned.head.T)[:, None]
    assert outgoing + along * (field.direction @ turned.head.T) == pytest.approx(points, abs=1e-6)


def test_the_edge_is_where_the_outline_stands(progressive, wearer):
    edge = run(Request(progressive, wearer, ViewLayer(), Scene("wall", (WALL,)))).edge
    assert edge.within(edge.directions(0.999)).all()
    assert not edge.within(edge.directions(1.001)).any()
    inner, outer = (lb.trace(progressive, wearer, edge.directions(factor)).status for factor in (0.97, 1.03))
    assert (inner == lb.Status.OK).all()
    assert (outer == lb.Status.OUTSIDE_OUTLINE).all()


def test_defocus_in_the_view_is_that_of_what_each_pixel_meets(progressive, wearer):
    view = ViewLayer(size=(24, 18), half_width=np.radians(60), head_turn=0.1)
    found = run(Request(progressive, wearer, DefocusLayer(view), Scene("wall", (WALL,))))
    seen = run(Request(progressive, wearer, view, Scene("wall", (WALL,))))
    gaze = np.array([(11.5 - 14) * np.tan(np.radians(60)) / 12, (8.5 - 10) * np.tan(np.radians(60)) / 12, 1.0])
    field = lb.trace(progressive, wearer, [gaze @ seen.frame @ seen.head])
    turned = seen.head @ field.direction[0]
    start = seen.head @ (field.origin[0] - seen.eye) + seen.eye
    distance = (WALL.points[0, 2] - start[2]) / turned[2]
    assert found.defocus[10, 14] == pytest.approx(field.defocus(distance)[0], rel=1e-4)
    assert np.isnan(found.defocus[:, 0]).all()
    papers = run(Request(progressive, wearer, DefocusLayer(view, "ellipse_diagonal"), Scene("wall", (WALL,))))
    axes = field.eoc(distance)
    assert papers.defocus[10, 14] == pytest.approx(2 * np.hypot(*axes[:2])[0] / distance, rel=1e-4)
    with pytest.raises(InputError, match="defocus, ellipse_diagonal"):
        run(Request(progressive, wearer, DefocusLayer(view, "diameter"), Scene("wall", (WALL,))))


def test_a_map_of_the_papers_diagonal_is_that_of_the_ellipses(progressive, wearer):
    seen = run(Request(progressive, wearer, MapLayer("ellipse_diagonal", 400.0, samples=21)))
    field = lb.look_through(progressive, wearer, [seen.x[12]], [seen.y[9]])
    axes = field.eoc(400.0)
    expected = np.degrees(2 * np.hypot(axes.semi_major, axes.semi_minor)[0] / 400.0) * 60
    assert seen.values[9, 12] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("elevation", [0.0, 0.2])
def test_the_middle_of_a_view_is_as_far_as_what_it_shows(wearer, elevation):
    seen = run(Request(None, wearer, ViewLayer("naked", elevation=elevation), Scene("wall", (WALL,))))
    to_wall = 1500.0 - wearer.centre_of_rotation[2]
    expected = np.hypot(1500.0 - wearer.corneal_apex, to_wall * np.tan(elevation))
    assert middle_distance(seen) == pytest.approx(expected, abs=0.01)
    aside = run(Request(None, wearer, ViewLayer("naked", azimuth=1.2), Scene("wall", (WALL,))))
    assert np.isnan(middle_distance(aside))


def test_the_nose_is_on_the_other_side_of_a_left_lens(progressive, wearer):
    left = replace(progressive, side="L")
    page = Scene("page", (), looks={"near": Look((0.0, -180.0, 390.0), "page")})
    midline = {lens.side: look("near", lens, wearer, page)[0] for lens in (progressive, left)}
    assert midline["R"] == pytest.approx(np.arctan2(32.0, 390.0 - wearer.centre_of_rotation[2]))
    assert midline["L"] == -midline["R"]
    straight_on = run(Request(left, wearer, ViewLayer("naked"), Scene("wall", (WALL,)))).scene.parts[0]
    assert straight_on.points[:, 0] == pytest.approx(WALL.points[:, 0] - 32.0)


def test_the_command_line_asks_the_same_question(progressive, capsys):
    assert main(["map", str(SAMPLES / "regular_R.toml"), "-q", "astigmatism", "-d", "40cm", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    asked = run(Request(progressive, assumed_wearer(progressive), MapLayer("astigmatism", 400.0)))
    values = np.array(printed["values"], dtype=float)
    assert values == pytest.approx(asked.values, rel=1e-6, abs=1e-12, nan_ok=True)


def test_assumed_wearer_follows_the_order():
    lens = lb.load_lens(SAMPLES / "wide_near_R.toml")
    eye = assumed_wearer(lens).eye
    assert eye.refraction == pytest.approx(lens.ordered.power())
    assert eye.accommodation == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("layer", "lens", "word"),
    [
        (MapLayer("beauty"), True, "mean_power"),
        (MapLayer("mean_power"), False, "lens"),
        (MapLayer("defocus", "scene"), True, "scene"),
        (ViewLayer(), True, "scene"),
        (VoxelLayer(4, 4, 4, 500.0, 400.0), True, "near"),
    ],
)
def test_a_request_that_lacks_something(progressive, wearer, layer, lens, word):
    with pytest.raises(InputError, match=word):
        run(Request(progressive if lens else None, wearer, layer))


def test_a_lens_that_no_ray_passes(wearer):
    prism_of_50_degrees = surfaces.plane(tilt=(np.radians(50.0), 0.0))
    steep = Lens(prism_of_50_degrees, surfaces.plane(), 14.0, MATERIALS["CR-39"], circle_outline(6))
    for layer in (
        MapLayer("mean_power", samples=11),
        ProfileLayer(),
        EllipseLayer(n=8),
        VoxelLayer(8, 8, 2),
        ViewLayer(),
    ):
        with pytest.raises(InputError, match="no line of sight"):
            run(Request(steep, wearer, layer, Scene("wall", (WALL,))))


def test_the_near_object_is_at_the_near_distance_from_the_cornea(progressive, wearer):
    reading = {r.name: r for r in run(Request(progressive, wearer, PointsLayer()))}["near_reference_point"]
    field = look_through(progressive, wearer, [reading.x], [reading.y])
    point = field.origin[0] + reading.distance * field.direction[0]
    assert np.linalg.norm(point - [0, 0, -wearer.wear.vertex_distance]) == pytest.approx(400.0, abs=1e-9)
    assert reading.elevation < -20


def test_ordered_prism_is_compared_at_the_prism_reference_point():
    """A plane wedge of a: 100 tan((n - 1) a) to first order, base at the thicker edge, here down."""
    wedge = surfaces.plane(tilt=(np.radians(1.0), 0.0))
    lens = Lens(
        surfaces.plane(), wedge, 4.0, MATERIALS["CR-39"], circle_outline(40), ordered=Order(prism=1.0, prism_base=270)
    )
    reading = next(
        r for r in run(Request(lens, lb.Wearer(wear=lb.Wear(13.0)), PointsLayer())) if r.name == "prism_reference_point"
    )
    assert lens.thickness(0.0, -10.0) > lens.thickness(0.0, 10.0)
    assert (reading.prism, reading.prism_base) == (pytest.approx(0.873, abs=0.002), pytest.approx(270.0))
    assert (reading.lensmeter_prism, reading.lensmeter_prism_base) == pytest.approx((0.873, 270.0), abs=0.002)
    assert reading.prism_error == pytest.approx(1.0 - reading.lensmeter_prism)


def test_prism_maps_are_the_components_of_the_prism(progressive, wearer):
    prism, right, up = (
        run(Request(progressive, wearer, MapLayer(q, samples=15))).values
        for q in ("prism", "prism_horizontal", "prism_vertical")
    )
    assert np.hypot(right, up) == pytest.approx(prism, nan_ok=True)
    minus = lb.load_lens(SAMPLES / "sphere_minus_4_R.toml")
    straight = lb.Wearer(wear=lb.Wear(13.0))
    right, up = (
        run(Request(minus, straight, MapLayer(q, samples=15))).values for q in ("prism_horizontal", "prism_vertical")
    )
    assert right[7, 12] > 1.0
    assert right[7, 2] < -1.0
    assert up[12, 7] > 1.0


def test_profile_spans_the_principal_powers(progressive, wearer):
    profile = run(Request(progressive, wearer, ProfileLayer(400.0)))
    field = look_through(progressive, wearer, profile.x[40:41], profile.y[40:41])
    sphere, cylinder, _ = (v[0] for v in field.as_worn_power(400.0))
    assert (profile.greatest_power[40], profile.least_power[40]) == pytest.approx((sphere, sphere + cylinder))


def test_the_same_rays_serve_every_eye(progressive, wearer):
    myope = replace(wearer, eye=replace(wearer.eye, refraction=-1.0 * np.eye(2), pupil_diameter=3.0))
    layer = MapLayer("defocus", 2000.0, samples=15)
    shared = run(Request(progressive, wearer, layer)), run(Request(progressive, myope, layer))
    assert np.shares_memory(shared[0].x, shared[1].x)
    field = look_through(progressive, myope, [shared[1].x[9]], [shared[1].y[5]])
    assert shared[1].values[5, 9] == pytest.approx(np.degrees(field.defocus(2000.0)[0]) * 60)


def test_results_cannot_be_written_to(progressive, wearer):
    lens_map = run(Request(progressive, wearer, MapLayer("mean_power", samples=15)))
    for array in (lens_map.x, lens_map.values):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_layers_stand_where_the_paper_has_them():
    assert (EllipseLayer().depths, EllipseLayer().n) == ((270.0, 780.0, 3400.0), 32)


def test_a_look_that_the_scene_does_not_have_is_refused(progressive, wearer):
    page = Scene("page", (), looks={"near": Look((0.0, -180.0, 390.0), "page")})
    with pytest.raises(InputError, match="the scene 'page' has no 'far'; it has near"):
        look("far", progressive, wearer, page)
