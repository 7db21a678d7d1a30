"""Focimeter readings against thick-lens closed forms, Prentice's rule, a slow twin and batoid; surface powers when posed."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lensbench.optics import surfaces
from lensbench.optics.conventions import astigmatism, mean_power, power_matrix
from lensbench.optics.eye import Wear
from lensbench.optics.lensmeter import back_vertex_power, front_vertex_power, surface_normal, surface_power

powers = st.floats(-12, 12)
POINTS = np.array([[9.0, -14.0], [-20.0, 3.0], [0.5, 16.0]])


def two_spheres(lens_of, front, back, thickness, index):
    return lens_of(
        surfaces.conic(front / (1000 * (index - 1))),
        surfaces.conic(-back / (1000 * (index - 1))),
        thickness,
        index=index,
    )


@given(powers, powers, st.floats(0.5, 12), st.floats(1.45, 1.8))
def test_vertex_powers_of_a_thick_lens(lens_of, front, back, thickness, index):
    """F1 / (1 - t/n F1) + F2 at the back, F1 + F2 / (1 - t/n F2) at the front."""
    lens, way = two_spheres(lens_of, front, back, thickness, index), thickness / (1000 * index)
    at_back, at_front = (read(lens, 0.0, 0.0) for read in (back_vertex_power, front_vertex_power))
    assert at_back.power[0] == pytest.approx((front / (1 - way * front) + back) * np.eye(2), abs=1e-9)
    assert at_front.power[0] == pytest.approx((front + back / (1 - way * back)) * np.eye(2), abs=1e-9)
    assert np.concatenate([at_back.prism, at_front.prism]) == pytest.approx(np.zeros((2, 2)), abs=1e-11)


def test_axis_of_a_torus_is_tabo(lens_of):
    back = surfaces.toric(2.0 / 600, 3.5 / 600, 20.0)
    reading = back_vertex_power(lens_of(surfaces.plane(), back, 2.0), 0.0, 0.0)
    assert reading.power[0] == pytest.approx(power_matrix(-2.0, -1.5, 20.0), abs=1e-9)


@pytest.mark.parametrize("power", [-6.0, 4.0])
@pytest.mark.parametrize("point", [(2.0, 0.0), (0.0, -3.0), (-1.0, 2.5)])
def test_prentice_rule(lens_of, power, point):
    """Thin lens of two like surfaces: prism = power times decentration, the base towards the centre of a plus lens."""
    lens = two_spheres(lens_of, power / 2, power / 2, 0.05, 1.6)
    expected = -power * np.array(point) / 10
    for read in (back_vertex_power, front_vertex_power):
        assert read(lens, *point).prism[0] == pytest.approx(expected, abs=2e-3 * np.linalg.norm(expected))


def test_plano_prism_reads_its_wedge(lens_of):
    """Plane back, front turned by a wedge: asin(n sin a) - a, thicker at the base."""
    lens = lens_of(surfaces.plane(tilt=(0.05, 0.0)), surfaces.plane(), 6.0, index=1.5)
    reading = back_vertex_power(lens, *POINTS.T)
    assert reading.prism == pytest.approx(
        np.tile([0.0, 100 * np.tan(np.arcsin(1.5 * np.sin(0.05)) - 0.05)], (3, 1)), abs=1e-9
    )
    assert reading.power == pytest.approx(np.zeros((3, 2, 2)), abs=1e-9)


def test_the_axis_passes_the_asked_point(worn):
    """A slow ray from the back surface along its normal leaves the front at that point, and deviates by the prism."""
    lens, _, sags = worn
    reading = back_vertex_power(lens, *POINTS.T)
    for k, (x, y) in enumerate(POINTS):
        normal, foot = surface_normal(lens.back, x, y), np.array([x, y])
        for _ in range(20):
            normal = surface_normal(lens.back, *foot)
            height = lens.front_height(x, y) - lens.back_height(*foot)
            foot = np.array([x, y]) - height * normal[:2] / normal[2]
        pivot = np.array([0.0, 0.0, lens.back_height(0.0, 0.0)])
        start = np.array([*foot, lens.back_height(*foot)]) - pivot - 3.0 * normal
        _, leaving, direction = naive.trace(sags, lens, Wear(), start, normal)
        assert (leaving + pivot)[:2] == pytest.approx([x, y], abs=1e-7)
        e1, e2 = naive.across(normal)
        seen = 100 * np.array([direction @ e1, direction @ e2]) / (direction @ normal)
        assert reading.prism[k] == pytest.approx(seen, abs=1e-6)


def test_front_and_back_reading_of_a_turned_lens_agree(lens_of):
    """The front vertex power is the back vertex power of the same lens turned about, as long as it has no prism."""
    front, back = surfaces.toric(0.010, 0.012, 30.0), surfaces.toric(0.004, 0.007, 100.0)
    turned = lens_of(surfaces.toric(-0.004, -0.007, 80.0), surfaces.toric(-0.010, -0.012, 150.0), 5.0)
    here = front_vertex_power(lens_of(front, back, 5.0), 0.0, 0.0).power[0]
    there = back_vertex_power(turned, 0.0, 0.0).power[0]
    assert there == pytest.approx(here * [[1, -1], [-1, 1]], abs=1e-9)


def test_off_axis_readings_against_real_rays_of_batoid(lens_of):
    """Rays that leave the back surface with the slopes of the read vertex power are parallel in front, to the first order."""
    pytest.importorskip("batoid")
    from test_against_batoid import BACK, FRONTS, THICKNESS, batoid_rays

    for kind in ("asphere", "bicubic spline"):
        front, twin = FRONTS[kind]
        lens = lens_of(front, BACK[0], THICKNESS)
        reading = back_vertex_power(lens, *POINTS.T)
        for k, (x, y) in enumerate(POINTS):
            foot = np.array([x, y])
            for _ in range(20):
                normal = surface_normal(lens.back, *foot)
                foot = [x, y] - (lens.front_height(x, y) - lens.back_height(*foot)) * normal[:2] / normal[2]
            across = np.array(naive.across(normal))
            h = 0.01
            offsets = np.array([[0, 0], [h, 0], [-h, 0], [0, h], [0, -h]])
            slopes = offsets @ reading.power[k] / 1000
            direction = normal + slopes @ across
            start = np.array([*foot, lens.back_height(*foot) - lens.back_height(0, 0)]) + offsets @ across - direction
            _, leaving, out = batoid_rays(
                lens, Wear(), (BACK[1], twin), start, direction / np.linalg.norm(direction, axis=1, keepdims=True)
            )
            assert (leaving[0] + [0, 0, lens.back_height(0, 0)])[:2] == pytest.approx([x, y], abs=1e-7)
            prism = 100 * (out[0] @ across.T) / (out[0] @ normal)
            assert reading.prism[k] == pytest.approx(prism, abs=1e-7)
            vergence = 1000 * (out[[1, 3]] - out[[2, 4]]) / (2 * h)
            assert np.abs(vergence).max() < 2e-4  # D; what is left is of third order in the offset


@pytest.mark.parametrize("shape", ["torus", "asphere", "spline"], indirect=True)
def test_surface_power_of_a_posed_surface(shape):
    """Curvatures do not depend on the pose: those of the height over the lens plane, by differences."""
    from dataclasses import replace

    from lensbench.optics.lens import surface_height

    posed = replace(shape[0], decentration=(1.0, -2.0), tilt=(0.06, -0.04))
    for x, y in POINTS:
        power = surface_power(posed, x, y, 1.6)
        mean, gauss = naive.curvatures(naive.sag_derivatives(lambda u, v: float(surface_height(posed, u, v)), x, y))
        assert mean_power(power) == pytest.approx(-600 * mean, abs=2e-4)
        assert astigmatism(power) == pytest.approx(1200 * np.sqrt(max(mean**2 - gauss, 0)), abs=2e-3)
