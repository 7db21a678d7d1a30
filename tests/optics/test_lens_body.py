"""Thickness, weight, edge and outlines of a lens against closed forms."""

from dataclasses import replace

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lensbench.optics import surfaces
from lensbench.optics.eye import Wear
from lensbench.optics.gaze import worn_pose
from lensbench.optics.lens import (
    Points,
    box_outline,
    circle_outline,
    ellipse_outline,
    polygon_outline,
    surface_height,
)
from lensbench.optics.materials import MATERIALS


def cap(radius, half_width):
    """Height and volume of a spherical cap."""
    height = radius - np.sqrt(radius**2 - half_width**2)
    return height, np.pi * height**2 * (3 * radius - height) / 3


def test_thickness_of_two_spheres(lens_of):
    lens = lens_of(surfaces.sphere(90.0), surfaces.sphere(150.0), 5.0)
    assert lens.thickness([0.0, 12.0], [0.0, -16.0]) == pytest.approx([5.0, 5 - cap(90, 20)[0] + cap(150, 20)[0]])


@pytest.mark.parametrize("radius", [10.0, 32.5])
def test_weight_of_a_plane_disc(lens_of, radius):
    lens = lens_of(surfaces.plane(), surfaces.plane(), 2.0, outline=circle_outline(2 * radius))
    assert lens.weight() == pytest.approx(1.3e-3 * 2 * np.pi * radius**2, rel=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_weight_of_a_lens_of_two_caps(lens_of, sign):
    """Edge disc plus front cap less back cap; the lens is 60 mm wide."""
    lens = lens_of(surfaces.sphere(sign * 100.0), surfaces.sphere(sign * 140.0), 4.0, outline=circle_outline(60.0))
    (high, front), (low, back) = cap(100, 30), cap(140, 30)
    edge = 4.0 - sign * (high - low)
    assert lens.weight() == pytest.approx(1.3e-3 * (np.pi * 900 * edge + sign * (front - back)), rel=1e-10)


def test_weight_of_a_rectangular_plate(lens_of):
    lens = lens_of(surfaces.plane(), surfaces.plane(), 2.0, outline=box_outline(50.0, 30.0, (3.0, -4.0)))
    assert lens.weight() == pytest.approx(1.3e-3 * 2 * 50 * 30, rel=1e-4)


def test_plus_lens_is_thinnest_at_the_farthest_edge(lens_of):
    lens = lens_of(surfaces.sphere(100.0), surfaces.plane(), 6.0, outline=circle_outline(50.0, (3.0, 4.0)))
    thin = lens.minimum_edge_thickness()
    assert thin.thickness == pytest.approx(6 - cap(100, 30)[0], abs=1e-4)
    assert (thin.x, thin.y) == pytest.approx((18.0, 24.0), abs=0.2)


def test_minus_lens_is_thinnest_at_the_nearest_edge(lens_of):
    lens = lens_of(surfaces.plane(), surfaces.sphere(100.0), 1.5, outline=box_outline(60.0, 40.0, (0.0, -5.0)))
    thin = lens.minimum_edge_thickness()
    assert thin.thickness == pytest.approx(1.5 + cap(100, 15)[0], abs=1e-5)
    assert (thin.x, thin.y) == pytest.approx((0.0, 15.0), abs=0.1)


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-15, 15), st.floats(-15, 15))
def test_height_of_a_tilted_sphere(about_x, about_y, x, y):
    """A ball stays a ball: its centre is turned about the vertex."""
    ball = surfaces.sphere(80.0, tilt=(about_x, about_y), decentration=(1.0, -2.0))
    cx, cy, cz = naive.pose(about_x, about_y) @ [0.0, 0.0, -80.0] + [1.0, -2.0, 0.0]
    assert surface_height(ball, x, y) == pytest.approx(cz + np.sqrt(80**2 - (x - cx) ** 2 - (y - cy) ** 2), abs=1e-10)


@given(st.floats(-0.2, 0.3), st.floats(-0.2, 0.3), st.sampled_from("RL"))
def test_pose_puts_the_back_point_behind_the_fitting_point_on_the_line_of_sight(lens_of, panto, face_form, side):
    points = Points(fitting_point=(1.0, 4.0))
    lens = replace(lens_of(surfaces.sphere(90.0), surfaces.sphere(120.0), side=side), points=points)
    wear = Wear(13.0, panto, face_form, (0.5, -1.5))
    pose = worn_pose(lens, wear)
    back = [1.0, 4.0, -cap(120, np.hypot(1, 4))[0]]
    assert pose.to_wear(back) == pytest.approx([0.5, -1.5, 0.0], abs=1e-12)
    assert pose.to_lens(pose.to_wear([[3.0, 2.0, 1.0]])) == pytest.approx(np.array([[3.0, 2.0, 1.0]]), abs=1e-13)
    assert pose.rotation == pytest.approx(naive.pose(panto, face_form * (-1 if side == "R" else 1)), abs=1e-15)


@pytest.mark.parametrize("side", ["R", "L"])
def test_positive_angles_of_wear(lens_of, side):
    """Lower edge towards the cheek, temporal edge towards the face."""
    lens, temporal = lens_of(surfaces.plane(), surfaces.plane(), side=side), -20.0 if side == "R" else 20.0
    assert worn_pose(lens, Wear(pantoscopic_angle=0.1)).to_wear([0.0, -20.0, 0.0])[2] < -1
    assert worn_pose(lens, Wear(face_form_angle=0.1)).to_wear([temporal, 0.0, 0.0])[2] < -1


# -- outlines ----------------------------------------------------------------------------------------------------------

grid = np.meshgrid(np.linspace(-40, 40, 61), np.linspace(-40, 40, 53))


def test_ellipse_contains_what_it_should():
    x, y = grid
    inside = ellipse_outline(52.0, 34.0, (2.0, -3.0)).contains(x, y)
    q = ((x - 2) / 26) ** 2 + ((y + 3) / 17) ** 2
    clear = np.abs(q - 1) > 1e-3
    assert np.array_equal(inside[clear], (q < 1)[clear])


def test_box_contains_what_it_should():
    x, y = grid
    outline = box_outline(50.5, 30.5, (1.0, 2.0))
    assert np.array_equal(outline.contains(x, y), (np.abs(x - 1) < 25.25) & (np.abs(y - 2) < 15.25))
    assert outline.box == pytest.approx((-24.25, 26.25, -13.25, 17.25), abs=2e-3)


@pytest.mark.parametrize("order", [1, -1], ids=["counter-clockwise", "clockwise"])
def test_polygon_contains_what_it_should(order):
    corners = np.array([[20.3, -10.1], [18.2, 15.7], [0.4, 9.1], [-22.5, 14.2], [-15.1, -17.3]])
    x, y = grid
    inside = np.zeros(x.shape, dtype=bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        crosses = (ay > y) != (by > y)
        inside ^= crosses & (x < ax + (y - ay) * (bx - ax) / (by - ay))
    assert np.array_equal(polygon_outline(corners[::order]).contains(x, y), inside)


def test_points_along_the_edge_lie_on_it():
    x, y = circle_outline(44.0, (1.0, 5.0)).points(100)
    assert np.hypot(x - 1, y - 5) == pytest.approx(np.full(100, 22.0), abs=1e-3)
    assert (x[0], y[0]) == pytest.approx((23.0, 5.0))
    assert y[1] > y[0]


def test_nowhere_is_not_inside():
    assert not circle_outline(50.0).contains(np.nan, 0.0)


HORSESHOE = [[-20, -20], [20, -20], [20, 20], [15, 20], [15, -15], [-15, -15], [-15, 20], [-20, 20]]
PENTAGRAM = [[np.cos(4 * np.pi * k / 5), np.sin(4 * np.pi * k / 5)] for k in range(5)]


@pytest.mark.parametrize(
    ("corners", "centre"),
    [
        (HORSESHOE, None),
        (HORSESHOE, (0.0, 15.0)),
        (PENTAGRAM, None),
        ([[-1, -1], [1, -1], [1, 1], [-1, 1]], (5.0, 0.0)),
        ([[5, 0], [10, 2], [5, 2]], (0.0, 0.0)),
    ],
)
def test_polygons_that_hide_from_their_centre_are_refused(corners, centre):
    with pytest.raises(ValueError, match="not star-shaped"):
        polygon_outline(corners, centre)


def test_index_of_both_lines_follows_the_abbe_number():
    """Cauchy's n = A + B / w^2: n_e - n_d = 0.239 (n_d - 1) / V."""
    for material in MATERIALS.values():
        expected = 0.239 * (material.n_d - 1) / material.abbe
        assert material.index("e") - material.index("d") == pytest.approx(expected, abs=1.2e-3)
