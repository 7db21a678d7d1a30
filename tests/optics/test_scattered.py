"""Surfaces fitted to points that lie anywhere, against the closed form that the points were taken from."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lensbench.optics.scattered import fitted_points


def sag(x, y):
    return -(x**2 / 200 + y**2 / 300 + x * y / 900 + x**3 / 9e5 - x**2 * y / 8e5)


def disc(count, radius=30.0, seed=1):
    """Points spread evenly over a disc (sunflower), slightly off their places."""
    k = np.arange(count)
    p = radius * np.sqrt((k + 0.5) / count) * np.exp(2.399963j * k)
    jitter = np.random.default_rng(seed).normal(0, 0.05, (2, count))
    return p.real + jitter[0], p.imag + jitter[1]


@settings(max_examples=8)
@given(st.integers(900, 3000), st.floats(2.5, 6.0), st.floats(-3, 3))
def test_a_smooth_sag_comes_back_with_its_curvatures(count, knot_pitch, height):
    x, y = disc(count)
    fit = fitted_points(x, y, sag(x, y) + height, knot_pitch)
    inside = np.hypot(x, y) < 29
    d = fit.surface.derivatives(x[inside], y[inside])
    assert d.f == pytest.approx(sag(x[inside], y[inside]), abs=1e-6)
    assert d.fxx == pytest.approx(-(1 / 100 + 6 * x[inside] / 9e5 - 2 * y[inside] / 8e5), abs=1e-6)  # 0.6 mD at n = 1.6
    assert fit.height == pytest.approx(height, abs=1e-6)


def test_where_there_are_no_points_the_surface_goes_on():
    x, y = disc(2500)
    fit = fitted_points(x, y, sag(x, y), 2.5)
    assert fit.surface.sag(28.0, 28.0) == pytest.approx(sag(28.0, 28.0), abs=0.01)


def test_noise_is_left_in_the_residuals():
    x, y = disc(4000)
    noise = np.random.default_rng(2).normal(0, 1e-3, x.size)
    fit = fitted_points(x, y, sag(x, y) + noise, 5.0)
    assert np.std(fit.residuals) == pytest.approx(1e-3, rel=0.1)
    assert fit.surface.sag(x, y) + fit.height + fit.residuals == pytest.approx(sag(x, y) + noise, abs=1e-12)
