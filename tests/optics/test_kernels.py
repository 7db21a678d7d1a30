"""The vectorised kernels against the search that never fails, and the tables that make them quick."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lensbench.optics import gaze, kernels, surfaces
from lensbench.optics.conventions import Status
from lensbench.optics.eye import Wear
from lensbench.optics.gaze import ENDLESS, _kernel, _traced_rays, _worn, trace_rays
from lensbench.optics.lens import Outline, polygon_outline

WEAR = Wear(13.0, 0.15, 0.09, (1.5, -2.5))
BACK = surfaces.toric(0.008, 0.014, 130.0, decentration=(0.4, 0.3), tilt=(-0.015, 0.01))


def many_rays(n, half_angle=0.45):
    rng = np.random.default_rng(7)
    direction = np.stack([*rng.uniform(-np.tan(half_angle), np.tan(half_angle), (2, n)), np.ones(n)], axis=1)
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return np.array([0.0, 0.0, -26.5]) + 10.0 * direction, direction


def traced_surely(lens, start, direction):
    """The same rays, each by the search that never fails: as if no quick kernel had met it."""
    n = len(start)
    rays = np.ascontiguousarray(np.concatenate([start, direction], axis=1).T)
    out, status = np.full((28, n), np.nan), np.empty(n, dtype=np.int8)
    search = kernels.surface.compiled(kernels.trace.search, kernels.trace.SEARCH)
    search(_worn(lens, WEAR)[0], lens.index, ENDLESS, rays, 0, np.arange(n), out, status)
    return _traced_rays(out, status)


def assert_quick_is_sure(lens):
    """Of 500 rays: position to 1e-12 mm, transfer matrix to 5e-9 (mm, rad)."""
    start, direction = many_rays(500)
    quick, sure = trace_rays(lens, WEAR, start, direction), traced_surely(lens, start, direction)
    assert np.array_equal(quick.status, sure.status)
    np.testing.assert_allclose(quick.exit, sure.exit, rtol=0, atol=1e-12)
    np.testing.assert_allclose(quick.transfer, sure.transfer, rtol=0, atol=5e-9)


def test_quick_rays_are_the_sure_rays(shape, lens_of, monkeypatch):
    """Position to 1e-12 mm, direction to 1e-14, transfer matrix to 2e-9 (mm, rad; 1e-7 D), over two chunks and a rest."""
    lens = lens_of(shape[0], BACK)
    monkeypatch.setattr(gaze, "CHUNK", 8192)
    start, direction = many_rays(2 * gaze.CHUNK + 37)
    quick, sure = trace_rays(lens, WEAR, start, direction), traced_surely(lens, start, direction)
    assert np.array_equal(quick.status, sure.status)
    assert (quick.status == Status.OK).mean() > 0.9
    for ours, other, tolerance in zip(quick[:4], sure[:4], (1e-12, 1e-12, 1e-14, 2e-9), strict=True):
        np.testing.assert_allclose(ours, other, rtol=0, atol=tolerance)


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_splines_of_every_degree(lens_of, spline_arrays, degree):
    front = surfaces.bspline(*spline_arrays(degree)) if degree % 2 else bspline_of_even_degree(degree)
    lens = lens_of(front, BACK)
    assert_quick_is_sure(lens)


@pytest.mark.parametrize("degree", [3, 5])
@pytest.mark.parametrize("uneven", [0.0, 0.3])
def test_splines_of_100_by_100_control_points(lens_of, degree, uneven):
    """As many as a laboratory sends, on even and on uneven knots: sag to 1e-12 mm of scipy's, rays to 1e-12 mm."""
    inner = np.linspace(-48, 48, 101 - degree)
    inner[1:-1] += uneven * np.random.default_rng(3).uniform(-0.5, 0.5, inner.size - 2)
    knots = np.concatenate([np.full(degree, -48.0), inner, np.full(degree, 48.0)])
    at = np.array([knots[i + 1 : i + degree + 1].mean() for i in range(100)])
    x, y = np.meshgrid(at, at)
    coefficients = -(x**2 + y**2) / 190 + 5e-5 * (x**2 * y / 2 + y**3 / 6)
    front = surfaces.bspline(knots, knots, coefficients, degree)
    assert front.even == (uneven == 0)
    sag = naive.spline_sag(knots, knots, coefficients, degree)
    for point in ((0.3, 0.2), (-47.9, 31.0), (12.34, -20.5)):
        assert front.sag(*point) == pytest.approx(sag(*point), abs=1e-12)
    lens = lens_of(front, BACK)
    assert_quick_is_sure(lens)


def test_cells_become_even_where_that_is_exact():
    """Breakpoints of an interpolating spline, which leaves out those next to its ends; and such that never can be even."""
    knots = np.concatenate([[-9.0] * 6, np.arange(-6.0, 4.0), [6.0] * 6])
    coefficients = np.random.default_rng(2).normal(size=(16, 16))
    surface, sag = surfaces.bspline(knots, knots, coefficients, 5), naive.spline_sag(knots, knots, coefficients, 5)
    np.testing.assert_allclose(surface.breaks_x, np.arange(-9.0, 7.0), rtol=0, atol=1e-14)
    for x, y in ((-8.9, 5.9), (-7.0, -4.5), (0.0, 3.0)):
        assert surface.sag(x, y) == pytest.approx(sag(x, y), abs=1e-12)
    odd = np.concatenate([[0.0] * 3, [0.0, 1.0, 2.1, 4.0], [4.0] * 3])
    assert not surfaces.bspline(odd, odd, np.zeros((6, 6)), 3).even


def bspline_of_even_degree(degree):
    knots = np.concatenate([np.full(degree, -60.0), np.linspace(-60, 60, 31), np.full(degree, 60.0)])
    middle = np.array([knots[i + 1 : i + degree + 1].mean() for i in range(knots.size - degree - 1)])
    return surfaces.bspline(knots, knots, -(middle[:, None] ** 2 + middle**2) / 200, degree)


def test_ordinary_rays_need_no_second_search(shape):
    """Every ray that meets the surface well inside its rim is settled by the vectorised kernel."""
    start, direction = many_rays(1000, 0.4)
    rays = np.ascontiguousarray(np.concatenate([start, direction], axis=1).T)
    surface = (*shape[0].shape_arrays(), np.concatenate([np.eye(3).ravel(), np.zeros(3)]))
    refracted, bends = np.empty_like(rays), np.empty((9, 1000))
    _kernel(shape[0], second=False)(surface, 1.0, 1.6, rays, refracted, None, bends, None, 0, 1000)
    assert np.isfinite(refracted).all()
    assert np.isfinite(bends).all()


@given(st.lists(st.floats(0.02, 9.0), min_size=2, max_size=30), st.floats(-0.2, 1.2), st.integers(2, 5))
def test_splines_on_uneven_knots(widths, share, degree):
    """The bins find the cell that the definition finds, on and beyond the breakpoints too."""
    inner = np.cumsum([0.0, *widths])
    knots = np.concatenate([np.full(degree, inner[0]), inner, np.full(degree, inner[-1])])
    count = knots.size - degree - 1
    coefficients = np.random.default_rng(count).normal(size=(count, count))
    surface, sag = (
        surfaces.bspline(knots, knots, coefficients, degree),
        naive.spline_sag(knots, knots, coefficients, degree),
    )
    for x in (share * inner[-1], *inner):
        if inner[0] <= x <= inner[-1]:
            assert surface.sag(x, inner[1]) == pytest.approx(sag(x, inner[1]), abs=1e-9)
        else:
            assert np.isnan(surface.sag(x, inner[1]))


@given(
    st.lists(st.tuples(st.floats(0, 6.28), st.floats(5.0, 40.0)), min_size=2, max_size=40, unique_by=lambda p: p[0]),
    st.floats(-50, 50),
    st.floats(-50, 50),
)
def test_outline_is_linear_between_its_angles(corners, x, y):
    angles, radii = np.array(sorted(corners)).T
    outline = Outline((1.0, -2.0), angles, radii)
    edge = outline.radius(np.arctan2(y + 2, x - 1))
    distance = np.hypot(x - 1, y + 2)
    if abs(distance - edge) > 1e-6:
        assert outline.contains(x, y) == (distance < edge)


def test_points_on_the_corners_of_an_outline():
    outline = polygon_outline([[20, 10], [-20, 10], [-20, -10], [20, -10]])
    x, y = np.array([20.0, -20.0, 20.0]), np.array([10.0, 10.0, 0.0])
    assert outline.contains(0.999999 * x, 0.999999 * y).all()
    assert not outline.contains(1.000001 * x, 1.000001 * y).any()
