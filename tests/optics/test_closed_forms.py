"""Straight-ahead gaze against closed forms of ophthalmic optics; powers to 1e-9 D."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lensbench.optics import surfaces
from lensbench.optics.conventions import power_matrix
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.field import ellipse_diagonal
from lensbench.optics.gaze import direction_from_angles, trace

AHEAD = [[0.0, 0.0, 1.0]]
powers = st.floats(-15, 15)
thicknesses = st.floats(0.5, 12)
indices = st.floats(1.45, 1.8)
axes = st.floats(0, 180)


def curvature(power, index):
    return power / (1000 * (index - 1))


def vertex_power(front, back, thickness, index):
    """Back vertex power (2, 2), D, of surface powers (2, 2) in D: F1 (I - t/n F1)^-1 + F2."""
    return front @ np.linalg.inv(np.eye(2) - thickness / (1000 * index) * front) + back


def principal(along, across, axis):
    """Power matrix with `along` D in the meridian `axis` (degrees) and `across` D at right angles to it."""
    u = np.array([np.cos(np.radians(axis)), np.sin(np.radians(axis))])
    return across * np.eye(2) + (along - across) * np.outer(u, u)


@given(powers, powers, thicknesses, indices)
def test_back_vertex_power_of_a_thick_lens(lens_of, front, back, thickness, index):
    lens = lens_of(
        surfaces.conic(curvature(front, index)), surfaces.conic(-curvature(back, index)), thickness, index=index
    )
    expected = vertex_power(front * np.eye(2), back * np.eye(2), thickness, index)
    assert trace(lens, Wearer(), AHEAD).as_worn_matrix()[0] == pytest.approx(expected, abs=1e-9)


@given(st.floats(-8, 12), st.floats(-8, 12), axes, st.floats(-12, 8), st.floats(-12, 8), axes, thicknesses)
def test_back_vertex_power_of_two_crossed_tori(
    lens_of, f_along, f_across, f_axis, b_along, b_across, b_axis, thickness
):
    n = 1.6
    front = surfaces.toric(curvature(f_along, n), curvature(f_across, n), f_axis)
    back = surfaces.toric(-curvature(b_along, n), -curvature(b_across, n), b_axis)
    expected = vertex_power(principal(f_along, f_across, f_axis), principal(b_along, b_across, b_axis), thickness, n)
    field = trace(lens_of(front, back, thickness), Wearer(), AHEAD)
    assert field.as_worn_matrix()[0] == pytest.approx(expected, abs=1e-9)


@given(st.floats(-8, 8), st.floats(-6, -0.01), st.floats(0.1, 180), st.booleans())
def test_cylinder_and_axis_of_a_toric_lens(lens_of, sphere, cylinder, axis, in_front):
    n = 1.6
    torus = (curvature(sphere, n), curvature(sphere + cylinder, n))
    front, back = surfaces.toric(*torus, axis), surfaces.plane()
    if not in_front:
        front, back = surfaces.plane(), surfaces.toric(-torus[0], -torus[1], axis)
    as_worn = trace(lens_of(front, back, 1e-9, index=n), Wearer(), AHEAD).as_worn_power()
    assert as_worn.sphere[0] == pytest.approx(sphere, abs=1e-8)
    assert as_worn.cylinder[0] == pytest.approx(cylinder, abs=1e-8)
    assert as_worn.axis[0] == pytest.approx(axis, abs=1e-5)


@given(thicknesses, indices, st.floats(50, 1e5))
def test_plate_shortens_the_way_to_thickness_over_index(lens_of, thickness, index, distance):
    wearer = Wearer(Eye(), Wear(14.0))
    field = trace(lens_of(surfaces.plane(), surfaces.plane(), thickness, index=index), wearer, AHEAD)
    from_pupil = 14.0 + wearer.eye.entrance_pupil + thickness / index + distance
    assert field.required_vergence(distance)[0] == pytest.approx(-1000 / from_pupil * np.eye(2), abs=1e-9)
    assert field.as_worn_matrix()[0] == pytest.approx(np.zeros((2, 2)), abs=1e-9)


@given(st.floats(0.01, 0.6), thicknesses, st.floats(100, 1e4))
def test_plate_seen_obliquely(lens_of, angle, thickness, distance):
    """Within the plate the sagittal way counts 1/n, the tangential way cos^2 i / (n cos^2 i')."""
    n, wearer = 1.6, Wearer()
    field = trace(lens_of(surfaces.plane(), surfaces.plane(), thickness), wearer, [direction_from_angles(angle, 0)])
    inner = np.arcsin(np.sin(angle) / n)
    way = thickness / np.cos(inner) / n
    outer = wearer.vertex_sphere_radius / np.cos(angle) - wearer.eye.pupil_from_rotation + distance
    tangential = outer + way * (np.cos(angle) / np.cos(inner)) ** 2
    expected = -1000 * np.diag([1 / tangential, 1 / (outer + way)])
    assert field.required_vergence(distance)[0] == pytest.approx(expected, abs=1e-9)
    assert field.direction[0] == pytest.approx(field.directions[0], abs=1e-14)


# -- naked eye: angular blur = pupil radius times the vergence error ---------------------------------------------------


def naked_blur(refraction, amplitude, distance, **accommodation):
    eye = Eye(refraction * np.eye(2), refraction_vertex_distance=-3.05, accommodation=amplitude)
    field = trace(None, Wearer(eye), [direction_from_angles(0.3, -0.2)])
    blur = field.angular_blur(distance, **accommodation)[0]
    assert blur == pytest.approx(blur[0, 0] * np.eye(2), abs=1e-15)
    assert field.defocus(distance, **accommodation)[0] == pytest.approx(2 * abs(blur[0, 0]), abs=1e-15)
    return abs(blur[0, 0])


def test_two_measures_of_a_myopes_blur():
    """-1 D, pupil 3.94 mm, far objects: a disc of r_p |R| = 1.97 mrad; its diameter, and the paper's 2 sqrt(e1^2 + e2^2)."""
    eye = Eye(-np.eye(2), refraction_vertex_distance=-3.05, accommodation=0.0, pupil_diameter=3.94)
    field = trace(None, Wearer(eye), AHEAD)
    assert field.defocus(np.inf)[0] == pytest.approx(3.94e-3, rel=1e-12)
    assert ellipse_diagonal(field.angular_blur(np.inf))[0] == pytest.approx(2 * np.hypot(1.97e-3, 1.97e-3), rel=1e-12)


@given(st.floats(100, 1e6))
def test_relaxed_emmetrope(distance):
    assert naked_blur(0.0, 0.0, distance) == pytest.approx(2.0 / distance, abs=1e-15)
    assert naked_blur(0.0, 0.0, np.inf) == 0


@given(st.floats(-12, -0.1), st.floats(100, 1e6))
def test_relaxed_myope(refraction, distance):
    assert naked_blur(refraction, 0.0, distance) == pytest.approx(
        2.0 * abs(refraction / 1000 + 1 / distance), abs=1e-15
    )
    assert naked_blur(refraction, 0.0, -1000 / refraction) == pytest.approx(0, abs=1e-15)


@given(st.floats(-3, 3), st.floats(0, 4), st.floats(100, 1e5), st.sampled_from(["retina", "object", "paper"]))
def test_presbyope(refraction, amplitude, distance, rule):
    wanted = refraction + 1000 / distance
    left = wanted - min(max(wanted, 0), amplitude)
    assert naked_blur(refraction, amplitude, distance, accommodation=rule) == pytest.approx(
        2.0 * abs(left) / 1000, abs=1e-15
    )


# -- prism -------------------------------------------------------------------------------------------------------------

BASES = {"up": (1, 0), "down": (-1, 0), "towards +x": (0, -1), "towards -x": (0, 1)}
BASE_ANGLES = {"up": 90.0, "down": 270.0, "towards +x": 0.0, "towards -x": 180.0}


@pytest.mark.parametrize("base", BASES)
@given(degrees=st.floats(0.1, 20), index=st.floats(1.45, 1.8))
def test_plane_wedge(lens_of, base, degrees, index):
    """Flat back, front turned so that the lens is thicker at its base: deviation asin(n sin a) - a."""
    tilt = tuple(np.radians(degrees) * np.array(BASES[base]))
    lens = lens_of(surfaces.plane(tilt=tilt), surfaces.plane(), 6.0, index=index)
    seen = trace(lens, Wearer(), AHEAD).prism()
    wedge = np.radians(degrees)
    assert seen.prism[0] == pytest.approx(100 * np.tan(np.arcsin(index * np.sin(wedge)) - wedge), abs=1e-11)
    assert seen.base[0] % 360 == pytest.approx(BASE_ANGLES[base], abs=1e-9)
    toward = np.array([np.cos(np.radians(BASE_ANGLES[base])), np.sin(np.radians(BASE_ANGLES[base]))])
    assert lens.thickness(*(2 * toward)) > lens.thickness(*(-2 * toward))


@pytest.mark.parametrize(("side", "nasal_base"), [("R", 0.0), ("L", 180.0)])
def test_base_in_is_nasal(lens_of, side, nasal_base):
    nose_at = {"R": 1, "L": -1}[side]
    lens = lens_of(surfaces.plane(tilt=(0.0, -0.1 * nose_at)), surfaces.plane(), side=side)
    assert lens.thickness(nose_at * 5.0, 0.0) > lens.thickness(-nose_at * 5.0, 0.0)
    assert trace(lens, Wearer(), AHEAD).prism().base[0] == pytest.approx(nasal_base, abs=1e-9)


@pytest.mark.parametrize("power", [-8.0, -3.0, 2.0, 6.0])
@pytest.mark.parametrize("decentration", [(0.2, 0.0), (0.0, -0.3), (-0.1, 0.25)])
def test_prentice_rule(lens_of, power, decentration):
    """cm times D, the base towards the optical centre of a plus lens; third order: within 0.1 % below 0.4 mm."""
    lens = lens_of(surfaces.conic(curvature(power / 2, 1.6)), surfaces.conic(-curvature(power / 2, 1.6)), 1e-3)
    field = trace(lens, Wearer(wear=Wear(decentration=decentration)), AHEAD)
    expected = power * np.array(decentration) / 10
    assert field.prism_components()[0] == pytest.approx(expected, abs=1e-3 * np.linalg.norm(expected))


# -- magnification -----------------------------------------------------------------------------------------------------


@given(st.floats(1, 10), st.floats(-12, 5), thicknesses)
def test_spectacle_magnification_of_the_turning_eye(lens_of, front, back, thickness):
    """Shape factor times power factor: 1 / (1 - t/n F1) / (1 - z F'v), z from the vertex to the centre of rotation."""
    n, wearer = 1.6, Wearer()
    field = trace(
        lens_of(surfaces.conic(curvature(front, n)), surfaces.conic(-curvature(back, n)), thickness), wearer, AHEAD
    )
    shape = 1 / (1 - thickness * front / (1000 * n))
    power = 1 / (1 - wearer.vertex_sphere_radius / 1000 * (front * shape + back))
    assume(abs(power) < 10)
    assert field.magnification()[0] == pytest.approx(shape * power * np.eye(2), rel=1e-10)


@pytest.mark.parametrize("distance", [150.0, 4000.0, np.inf])
def test_naked_eye_magnifies_nothing(gazes, distance):
    field = trace(None, Wearer(), gazes)
    assert field.magnification(distance) == pytest.approx(np.broadcast_to(np.eye(2), (41, 2, 2)), abs=1e-14)
    assert field.as_worn_matrix(distance) == pytest.approx(np.zeros((41, 2, 2)), abs=1e-12)
    assert field.prism().prism == pytest.approx(np.zeros(41), abs=1e-13)


def test_an_ideal_lens_leaves_no_power_error_on_axis(lens_of):
    """A thin toric lens made to the prescription carried from 12 mm to the vertex sphere at 15 mm."""
    refraction, n = power_matrix(-6.0, -2.0, 30.0), 1.6
    far_points = 1000 / np.array([-6.0, -8.0]) + 15 - 12
    along, across = 1000 / far_points
    lens = lens_of(surfaces.toric(curvature(along, n), curvature(across, n), 30.0), surfaces.plane(), 1e-9)
    wearer = Wearer(Eye(refraction), Wear(15.0))
    assert trace(lens, wearer, AHEAD).power_error()[0] == pytest.approx(np.zeros((2, 2)), abs=1e-9)
