"""Smoothing splines against the normal equations written out, and gaps against what they hid."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from lensbench.optics import smoothing, surfaces


def sag(x, y):
    return -(x**2 + 1.3 * y**2) / 240 + 2e-6 * x * y**2 - 3e-9 * y**5


def dense(fit, x, y, z, sigma):
    """The spline on the fit's knots whose squared residuals sum to those of the noise, by dense normal equations."""
    bases = [BSpline.design_matrix(at, t, 5).toarray() for at, t in ((y, fit.knots_y), (x, fit.knots_x))]
    rough, plain = [], []
    for at, t in ((y, fit.knots_y), (x, fit.knots_x)):
        fine = np.linspace(t[0], t[-1], 2001)
        third = BSpline(t, np.eye(t.size - 6), 5).derivative(3)(fine)
        rough.append(np.trapezoid(third[:, :, None] * third[:, None, :], fine, axis=0) / (t[-1] - t[0]) * at.size)
        plain.append(bases[len(plain)].T @ bases[len(plain)])
    design = np.kron(*bases)
    penalty = np.kron(rough[0], plain[1]) + np.kron(plain[0], rough[1])
    low, high = -14.0, 10.0
    for _ in range(40):
        weight = 10 ** ((low + high) / 2)
        c = np.linalg.solve(design.T @ design + weight * penalty, design.T @ z.ravel())
        if np.sum((design @ c - z.ravel()) ** 2) > z.size * sigma**2:
            high = (low + high) / 2
        else:
            low = (low + high) / 2
    return c.reshape(fit.coefficients.shape)


def test_the_fast_fit_is_the_penalised_least_squares_fit():
    x, y = np.linspace(-12, 12, 15), np.linspace(-10, 9, 13)
    sigma = 1e-3 / np.sqrt(12)
    z = np.round(sag(*np.meshgrid(x, y)), 3)
    fit = smoothing.fit_grid(x, y, z, sigma)
    assert np.sqrt(np.mean(fit.residual**2)) == pytest.approx(sigma, rel=1e-3)
    assert fit.coefficients == pytest.approx(dense(fit, x, y, z, sigma), abs=2e-5)
    assert z - smoothing.evaluate(fit, x, y) == pytest.approx(fit.residual, abs=1e-12)
    assert smoothing.derivatives(fit, x, y)[0] == pytest.approx(
        np.gradient(sag(*np.meshgrid(x, y)), x, axis=1), abs=2e-2
    )


@pytest.mark.parametrize("share", [0.02, 0.4])
def test_gaps_are_filled_from_around_them(share):
    """Few gaps are solved for exactly; with many the points are fitted as scattered ones."""
    rng = np.random.default_rng(2)
    g = np.linspace(-20, 20, 41)
    x, y = np.meshgrid(g, g)
    z = np.round(sag(x, y), 5)
    gaps = rng.random(z.shape) < share
    fit = smoothing.fit_grid(g, g, np.where(gaps, np.nan, z), 1e-5 / np.sqrt(12))
    assert np.array_equal(np.isnan(fit.residual), gaps)
    assert smoothing.evaluate(fit, g, g)[2:-2, 2:-2] == pytest.approx(sag(x, y)[2:-2, 2:-2], abs=3e-5)
    whole = surfaces.fitted(smoothing.fit_grid(g, g, z, 1e-5 / np.sqrt(12)))
    inner = np.meshgrid(g[8:-8], g[8:-8])
    gap = surfaces.fitted(fit).surface_power(*inner, 1.6) - whole.surface_power(*inner, 1.6)
    assert np.sqrt(np.mean(gap**2)) < 0.01


@pytest.mark.parametrize("scale", [1.0, 4.0])
def test_noise_is_estimated_and_its_power_foretold(scale):
    """Rms astigmatism of fits of pure noise, and the noise found in it."""
    rng = np.random.default_rng(4)
    g = np.linspace(-30, 30, 61)
    x, y = np.meshgrid(g, g)
    sigma = scale * 1e-5
    found, stated, noises = [], [], []
    for _ in range(5):
        fit = smoothing.fit_grid(g, g, sag(x, y) + rng.normal(0, sigma, x.shape), sigma)
        clean = surfaces.fitted(fit).derivatives(*np.meshgrid(g[12:-12], g[12:-12]))
        u, v = np.meshgrid(g[12:-12], g[12:-12])
        exact = (-2 / 240, 4e-6 * v, -2.6 / 240 + 4e-6 * u - 60e-9 * v**3)
        xx, xy, yy = clean.fxx - exact[0], clean.fxy - exact[1], clean.fyy - exact[2]
        found.append(np.mean((xx - yy) ** 2 + 4 * xy**2))
        stated.append(fit.astigmatism)
        noises.append(fit.noise)
    assert np.mean(noises) == pytest.approx(sigma, rel=0.1)
    assert np.sqrt(np.mean(found)) == pytest.approx(np.mean(stated), rel=0.5)
