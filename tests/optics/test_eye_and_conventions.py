"""The wearer's tables and prescription, and the conventions for powers and frames."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lensbench.optics.conventions import (
    astigmatism,
    carry_vergence,
    inverse_2x2,
    listing_frame,
    mean_power,
    power_matrix,
    power_vector,
    rotation_xy,
    sphere_cylinder_axis,
    unit,
)
from lensbench.optics.eye import Eye, Wear, Wearer, hofstetter_amplitude, watson_yellott_pupil
from lensbench.optics.gaze import angles_from_direction, direction_from_angles

powers = st.floats(-20, 20)
cylinders = st.floats(-8, -0.01)
axes = st.floats(0.001, 180)


def test_hofstetter_mean_amplitude():
    assert hofstetter_amplitude([45, 50, 55, 60, 70]) == pytest.approx([5.0, 3.5, 2.0, 0.5, 0.0])


@pytest.mark.parametrize("side", ["R", "L"])
def test_the_pantoscopic_angle_is_the_axis_against_the_horizontal_plane(side):
    """8 degrees with 15 of face form: 8 against the horizontal plane, tan 8 / cos 15 seen from the side, 15 from above."""
    wear = Wear(pantoscopic_angle=np.radians(8.0), face_form_angle=np.radians(15.0))
    x, y, z = wear.rotation(side) @ [0.0, 0.0, 1.0]
    assert np.degrees(np.arcsin(-y)) == pytest.approx(8.0, abs=1e-12)
    assert np.degrees(np.arctan2(-y, z)) == pytest.approx(8.2784, abs=1e-4)
    assert wear.pantoscopic_angle_in_vertical_plane == pytest.approx(np.arctan2(-y, z), abs=1e-15)
    assert np.degrees(np.arctan2(abs(x), z)) == pytest.approx(15.0, abs=1e-12)


@pytest.mark.parametrize(
    ("luminance", "diameters"),
    [(10, [6.14, 5.42, 4.87, 4.33]), (100, [4.80, 4.33, 3.97, 3.61]), (1000, [3.53, 3.29, 3.11, 2.93])],
)
def test_watson_yellott_pupil(luminance, diameters):
    """Field of 60 deg2, both eyes, at 25, 45, 60 and 75 years."""
    mine = [watson_yellott_pupil(luminance, age, 60.0) for age in (25, 45, 60, 75)]
    assert mine == pytest.approx(diameters, abs=0.006)


def test_one_eye_sees_a_tenth_of_the_flux():
    assert watson_yellott_pupil(100, 40, 600.0, eyes=1) == pytest.approx(watson_yellott_pupil(100, 40, 60.0))
    assert watson_yellott_pupil(100, 95) == watson_yellott_pupil(100, 83)


@given(st.floats(-15, 10), st.floats(0, 20), st.floats(0, 20))
def test_prescription_keeps_the_far_point(sphere, refracted_at, worn_at):
    """The far point stays where it is: 1000 / F counts from the plane of the prescription, positive towards the eye."""
    eye = Eye(sphere * np.eye(2), refraction_vertex_distance=refracted_at)
    expected = 0.0 if sphere == 0 else 1 / (1 / sphere + (worn_at - refracted_at) / 1000)
    assert Wearer(eye, Wear(worn_at)).prescription == pytest.approx(expected * np.eye(2), abs=1e-11)
    at_pupil = 0.0 if sphere == 0 else 1 / (1 / sphere - (refracted_at + 3.05) / 1000)
    assert eye.pupil_refraction == pytest.approx(at_pupil * np.eye(2), abs=1e-11)


def test_ten_dioptres_of_myopia_at_the_cornea():
    assert Eye(-10 * np.eye(2)).refraction_at(0.0)[0, 0] == pytest.approx(-10 / 1.12)


@given(powers, cylinders, axes, st.floats(-30, 15))
def test_meridians_are_carried_one_by_one(sphere, cylinder, axis, distance):
    carried = carry_vergence(power_matrix(sphere, cylinder, axis), distance)
    u = np.array([np.cos(np.radians(axis)), np.sin(np.radians(axis))])
    across = np.array([-u[1], u[0]])
    assert u @ carried @ u == pytest.approx(sphere / (1 - distance * sphere / 1000), abs=1e-9)
    power = sphere + cylinder
    assert across @ carried @ across == pytest.approx(power / (1 - distance * power / 1000), abs=1e-9)


@given(powers, cylinders, axes)
def test_sphere_cylinder_axis_round_trip(sphere, cylinder, axis):
    back = sphere_cylinder_axis(power_matrix(sphere, cylinder, axis))
    assert (back.sphere, back.cylinder) == pytest.approx((sphere, cylinder), abs=1e-12)
    assert np.sin(np.radians(back.axis - axis)) == pytest.approx(0, abs=1e-9)
    assert 0 < back.axis <= 180


@given(powers, cylinders, axes)
def test_power_along_and_across_the_axis(sphere, cylinder, axis):
    f, turn = power_matrix(sphere, cylinder, axis), np.radians(axis)
    u, v = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    assert (u @ f @ u, v @ f @ v, u @ f @ v) == pytest.approx((sphere, sphere + cylinder, 0), abs=1e-12)
    assert (mean_power(f), astigmatism(f)) == pytest.approx((sphere + cylinder / 2, -cylinder), abs=1e-12)
    assert power_matrix(sphere + cylinder, -cylinder, axis + 90) == pytest.approx(f, abs=1e-12)


def test_power_vector_and_printed_axis():
    assert power_vector([[3.0, 0.5], [0.5, 1.0]]) == pytest.approx((2.0, 1.0, 0.5))
    assert sphere_cylinder_axis(np.eye(2)).axis == 180
    assert sphere_cylinder_axis(power_matrix([1.0, 2.0], -1.0, [180.0, 90.0])).axis == pytest.approx([180, 90])


directions = st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.05, 1)).map(lambda d: d / np.linalg.norm(d))


@given(directions)
def test_listing_frame(direction):
    frame = listing_frame(direction)
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-14)
    assert np.linalg.det(frame) == pytest.approx(1)
    assert frame[2] == pytest.approx(direction, abs=1e-15)
    assert frame[:2] == pytest.approx(np.array(naive.across(direction)), abs=1e-13)


@given(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))
def test_fick_angles(azimuth, elevation):
    direction = direction_from_angles(azimuth, elevation)
    assert direction == pytest.approx(naive.pose(-elevation, azimuth) @ [0, 0, 1], abs=1e-15)
    assert angles_from_direction(5 * direction) == pytest.approx((azimuth, elevation), abs=1e-12)


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_rotation(about_x, about_y):
    assert rotation_xy(about_x, about_y) == pytest.approx(naive.pose(about_x, about_y), abs=1e-15)


def test_small_helpers():
    matrices = np.random.default_rng(0).normal(size=(50, 2, 2))
    assert inverse_2x2(matrices) @ matrices == pytest.approx(np.broadcast_to(np.eye(2), (50, 2, 2)), abs=1e-10)
    assert not np.isfinite(inverse_2x2(np.ones((2, 2)))).any()
    assert unit([[3.0, 0.0, 4.0]]) == pytest.approx(np.array([[0.6, 0.0, 0.8]]))
