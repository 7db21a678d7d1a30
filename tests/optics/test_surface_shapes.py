"""Sags, derivatives, curvatures and fitted grids against slow twins and closed forms."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lensbench.optics import surfaces
from lensbench.optics.conventions import astigmatism, mean_power

POINTS = [(0.0, 0.0), (7.3, -4.1), (-18.2, 11.7), (0.4, 29.0), (-25.0, -16.0), (4.0, -8.0)]


@pytest.mark.parametrize("at", POINTS)
def test_derivatives_match_the_slow_twin(shape, at):
    surface, sag = shape
    mine, slow = surface.derivatives(*at), naive.sag_derivatives(sag, *at)
    assert mine.f == pytest.approx(slow[0], abs=1e-12)
    assert mine[1:3] == pytest.approx(slow[1:3], abs=1e-10)
    assert mine[3:] == pytest.approx(slow[3:], abs=2e-10)


def test_derivatives_are_each_others_differences(shape):
    surface, _ = shape
    x, y = np.array(POINTS).T + 0.123
    along_x = naive.first_derivative(lambda h: np.array(surface.derivatives(x + h, y)), 0.1)
    along_y = naive.first_derivative(lambda h: np.array(surface.derivatives(x, y + h)), 0.1)
    _, fx, fy, fxx, fxy, fyy = surface.derivatives(x, y)
    assert along_x[:3] == pytest.approx(np.array([fx, fxx, fxy]), abs=1e-10)
    assert along_y[:3] == pytest.approx(np.array([fy, fxy, fyy]), abs=1e-10)


def test_surface_power_has_the_curvatures_of_the_graph(shape):
    surface, sag = shape
    for at in POINTS:
        mean, gauss = naive.curvatures(naive.sag_derivatives(sag, *at))
        power = surface.surface_power(*at, index=1.6) / 600
        assert mean_power(power) == pytest.approx(-mean, abs=1e-9)
        assert np.linalg.det(power) == pytest.approx(gauss, abs=1e-10)


@given(st.floats(20, 500), st.sampled_from([-1, 1]), st.floats(1.4, 1.9))
def test_surface_power_of_a_sphere_is_the_same_everywhere(radius, sign, index):
    power = surfaces.sphere(sign * radius).surface_power([0.0, 9.0, -3.0], [0.0, -5.0, 14.0], index)
    assert power == pytest.approx(np.broadcast_to(sign * 1000 * (index - 1) / radius * np.eye(2), (3, 2, 2)), abs=1e-9)


@given(st.floats(-0.01, 0.02), st.floats(-0.01, 0.02), st.floats(0, 180), st.floats(-25, 25))
def test_surface_power_of_a_torus(along, across, axis, v):
    """Across the axis meridian the torus is a circle; along it the curvature is that of the arc."""
    turn = np.radians(axis)
    x, y = -v * np.sin(turn), v * np.cos(turn)
    power = surfaces.toric(along, across, axis).surface_power(x, y, 1.5)
    meridian, tilted = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    assert meridian @ power @ meridian == pytest.approx(500 * along, abs=1e-8)
    assert tilted @ power @ tilted == pytest.approx(500 * across, abs=1e-8)
    assert meridian @ power @ tilted == pytest.approx(0, abs=1e-8)


def test_a_torus_of_equal_curvatures_is_a_sphere():
    x, y = np.array(POINTS).T
    ball = np.array(surfaces.sphere(80.0).derivatives(x, y))
    assert np.array(surfaces.toric(1 / 80, 1 / 80, 33.0).derivatives(x, y)) == pytest.approx(ball, abs=1e-13)


def test_points_without_surface_are_nan():
    assert np.isnan(surfaces.sphere(20.0).sag(15.0, 15.0))
    assert np.isnan(surfaces.toric(1 / 20, 1 / 90, 0.0).sag(21.0, 0.0))
    flat = surfaces.bspline([0, 0, 0, 0, 5, 5, 5, 5], [0, 0, 0, 0, 5, 5, 5, 5], np.zeros((4, 4)), 3)
    assert flat.sag([0, 5, 5.001, -0.001], [5, 0, 1, 1]) == pytest.approx([0, 0, np.nan, np.nan], nan_ok=True)


def test_too_many_asphere_terms_are_refused():
    with pytest.raises(ValueError, match="at most 6"):
        surfaces.conic(0.01, 0.0, [0.0] * 7)


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_bspline_of_uneven_knots(degree):
    rng = np.random.default_rng(degree)
    tx = np.sort(np.r_[[-9.0] * (degree + 1), -5.0, -1.5, -1.0, 4.0, [8.0] * (degree + 1)])
    ty = np.sort(np.r_[[-7.0] * (degree + 1), -2.0, 3.0, [6.0] * (degree + 1)])
    c = rng.normal(size=(ty.size - degree - 1, tx.size - degree - 1))
    x, y = rng.uniform(-7, 6, (2, 50))
    slow = [naive.spline_sag(tx, ty, c, degree)(*at) for at in zip(x, y, strict=True)]
    assert surfaces.bspline(tx, ty, c, degree).sag(x, y) == pytest.approx(slow, abs=1e-11)


INDEX, BASE, GROWTH = 1.598, 4.0, 0.1


def progressive_sag(x, y):
    """A sphere of 4 D and a cubic whose addition grows by 0.1 D a millimetre downwards."""
    radius, k = 1000 * (INDEX - 1) / BASE, 1 / (1000 * (INDEX - 1))
    return np.sqrt(radius**2 - x**2 - y**2) - radius + GROWTH * k * (x**2 * y / 2 + y**3 / 6)


@pytest.mark.parametrize(("pitch", "decimals"), [(0.5, 4), (0.5, 5), (1.0, 3), (1.0, 4), (1.0, 5)])
def test_rounded_grids_are_fitted_better_than_their_power_noise(pitch, decimals):
    g = np.arange(-30, 30 + pitch / 2, pitch)
    step = 10.0**-decimals
    fit = surfaces.fitted_grid(g, g, np.round(progressive_sag(*np.meshgrid(g, g)), decimals), step)
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-25, 25, 41), np.linspace(-25, 25, 41)))
    x, y = x[np.hypot(x, y) < 25], y[np.hypot(x, y) < 25]
    truth = 2 * np.sqrt([max(m * m - k, 0) for m, k in map(true_curvatures, x, y)]) * 1000 * (INDEX - 1)
    error = astigmatism(fit.surface_power(x, y, INDEX)) - truth
    noise = surfaces.power_noise(step, pitch, INDEX)
    assert np.sqrt(np.mean(error**2)) < noise
    assert noise == pytest.approx(1.14 * (INDEX - 1) * step * 1000 / pitch**2)


def true_curvatures(x, y):
    return naive.curvatures(naive.sag_derivatives(progressive_sag, x, y))


def test_fitted_grid_keeps_rows_and_columns_apart():
    x, y = np.linspace(-20, 20, 21), np.linspace(-10, 10, 17)
    z = -(x[None, :] ** 2) / 200 + 0.01 * y[:, None] + x[None, :] * y[:, None] ** 2 / 5e4
    fit = surfaces.fitted_grid(x, y, z, 1e-7, decentration=(2.0, 0.0))
    assert fit.sag(13.0, -6.5) == pytest.approx(-(13.0**2) / 200 - 0.065 + 13 * 6.5**2 / 5e4, abs=1e-6)
    assert fit.decentration == (2.0, 0.0)
    assert np.isnan(fit.sag(0.0, 15.0))
