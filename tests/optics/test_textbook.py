"""Oblique gaze against the textbooks: Coddington, Tscherning's ellipse, Martin's tilt formula."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from lensbench.optics import surfaces
from lensbench.optics.conventions import astigmatism
from lensbench.optics.eye import Wear, Wearer
from lensbench.optics.gaze import direction_from_angles, trace

INDEX = 1.6


def spheres(front_power, back_power, index=INDEX):
    return 1000 * (index - 1) / front_power, -1000 * (index - 1) / back_power


@given(st.floats(2, 10), st.floats(-14, -1), st.floats(6, 9), st.floats(0, 0.5), st.floats(250, 1e5))
def test_coddington_through_two_spheres(lens_of, front, back, thickness, angle, distance):
    front_radius, back_radius = spheres(front, back)
    lens = lens_of(surfaces.sphere(front_radius), surfaces.sphere(back_radius), thickness)
    wearer = Wearer()
    field = trace(lens, wearer, [direction_from_angles(0.0, -angle)])
    for s in (np.inf, distance):
        tangential, sagittal = naive.coddington(
            (back_radius, front_radius), thickness, INDEX, wearer.vertex_sphere_radius, angle, s
        )
        expected = np.diag([sagittal, tangential]) + 1000 / s * np.eye(2)
        assert field.as_worn_matrix(s)[0] == pytest.approx(expected, abs=1e-9)


def test_coddington_powers_are_the_same_in_every_meridian(lens_of):
    lens, around = lens_of(surfaces.sphere(120.0), surfaces.sphere(60.0)), np.arange(12) * np.pi / 6
    gazes = np.stack([np.sin(0.5) * np.cos(around), np.sin(0.5) * np.sin(around), np.full(12, np.cos(0.5))], axis=-1)
    tangential, sagittal = naive.coddington((60.0, 120.0), 3.0, INDEX, Wearer().vertex_sphere_radius, 0.5)
    power = trace(lens, Wearer(), gazes).as_worn_power()
    assert tangential < sagittal
    assert power.sphere == pytest.approx(np.full(12, sagittal), abs=1e-10)
    assert power.cylinder == pytest.approx(np.full(12, tangential - sagittal), abs=1e-10)
    assert power.axis % 180 == pytest.approx(np.degrees(around + np.pi / 2) % 180, abs=1e-9)


# Tscherning for distance vision, thin lens, third order (Jalie, point-focal forms), Z = 1000 / vertex_sphere_radius:
# (n + 2) F1^2 - ((n + 2) F + 2 (n^2 - 1) Z) F1 + n (F + (n - 1) Z)^2 = 0.
def tscherning(power, lever, n=INDEX):
    z = 1000 / lever
    return np.sort(np.roots([n + 2, -(n + 2) * power - 2 * (n * n - 1) * z, n * (power + (n - 1) * z) ** 2]))


def signed_astigmatism(lens_of, wearer, power, front_power):
    """Tangential less sagittal as-worn power at 1 degree, D, of a lens 10 um thick."""
    front, back = spheres(front_power, power - front_power)
    lens = lens_of(surfaces.sphere(front), surfaces.sphere(back), 0.01)
    matrix = trace(lens, wearer, [direction_from_angles(np.radians(1.0), 0.0)]).as_worn_matrix()[0]
    return matrix[0, 0] - matrix[1, 1]


@pytest.mark.parametrize("power", [-15.0, -8.0, -3.0, 0.5, 4.0])
@pytest.mark.parametrize("branch", [0, 1], ids=["Ostwalt", "Wollaston"])
def test_tscherning_ellipse(lens_of, power, branch):
    """The bends without oblique astigmatism; at 1 degree they lie within 0.3 % of the third-order ellipse."""
    wearer = Wearer()
    expected = tscherning(power, wearer.vertex_sphere_radius)[branch]
    root = brentq(lambda f: signed_astigmatism(lens_of, wearer, power, f), expected - 0.7, expected + 0.7, xtol=1e-6)
    assert root == pytest.approx(expected, rel=3e-3)
    front, back = spheres(root, power - root)
    t, s = naive.coddington((back, front), 0.01, INDEX, wearer.vertex_sphere_radius, np.radians(1.0))
    assert t == pytest.approx(s, abs=1e-8)


def test_there_is_no_point_focal_bend_beyond_the_ellipse(lens_of):
    wearer = Wearer()
    assert np.iscomplex(tscherning(12.0, wearer.vertex_sphere_radius)).all()
    errors = [signed_astigmatism(lens_of, wearer, 12.0, f) for f in np.linspace(12.5, 35, 40)]
    assert np.min(errors) > 1e-5


@pytest.mark.parametrize("power", [-10.0, -4.0, 3.0, 8.0])
@pytest.mark.parametrize("degrees", [3.0, 8.0, 15.0])
@pytest.mark.parametrize("turn", ["pantoscopic", "face form"])
def test_martin_tilt_formula(lens_of, power, degrees, turn):
    """S (1 + sin^2 t / 2n) and C = S tan^2 t about the axis of the tilt; the fourth order is left out: 0.9 t^4 S."""
    t = np.radians(degrees)
    front, back = spheres(power / 2, power / 2)
    wear = Wear(pantoscopic_angle=t) if turn == "pantoscopic" else Wear(face_form_angle=t)
    lens = lens_of(surfaces.sphere(front), surfaces.sphere(back), 1e-3)
    matrix = trace(lens, Wearer(wear=wear), [[0.0, 0.0, 1.0]]).as_worn_matrix()[0]
    sphere = power * (1 + np.sin(t) ** 2 / (2 * INDEX))
    cylinder = power * np.tan(t) ** 2
    along_axis, across = (0, 1) if turn == "pantoscopic" else (1, 0)
    tolerance = 0.9 * t**4 * abs(power) + 1e-4
    assert matrix[along_axis, along_axis] == pytest.approx(sphere, abs=tolerance)
    assert matrix[across, across] == pytest.approx(sphere + cylinder, abs=tolerance)
    assert matrix[0, 1] == pytest.approx(0, abs=1e-12)


@given(st.floats(-12, 8), st.floats(0.02, 0.5))
def test_thin_tilted_lens_exactly(lens_of, power, angle):
    """The sagittal power of a thin tilted lens is F (n cos i' - cos i) / (n - 1), the tangential that over cos^2 i."""
    front, back = (1000 * 0.6 / (power / 2), -1000 * 0.6 / (power / 2)) if abs(power) > 0.01 else (np.inf, np.inf)
    lens = lens_of(surfaces.sphere(front), surfaces.sphere(back), 1e-7)
    matrix = trace(lens, Wearer(wear=Wear(pantoscopic_angle=angle)), [[0.0, 0.0, 1.0]]).as_worn_matrix()[0]
    inner = np.arcsin(np.sin(angle) / INDEX)
    sagittal = (power if abs(power) > 0.01 else 0) * (INDEX * np.cos(inner) - np.cos(angle)) / 0.6
    assert matrix == pytest.approx(np.diag([sagittal, sagittal / np.cos(angle) ** 2]), abs=1e-6)
    assert astigmatism(matrix) == pytest.approx(abs(sagittal) * np.tan(angle) ** 2, abs=1e-6)
