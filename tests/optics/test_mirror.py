"""Left from right: a mirrored lens before a mirrored wearer does what the lens does, mirrored."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lensbench as lb
from lensbench.optics.lens import Order, Points, polygon_outline
from lensbench.optics.mirror import mirrored, mirrored_order, mirrored_outline, mirrored_surface, mirrored_wearer


def test_sag_is_mirrored(shape):
    surface, _ = shape
    x, y = np.meshgrid(np.linspace(-31, 33, 41), np.linspace(-29, 30, 37))
    there, here = surface.derivatives(-x, y), mirrored_surface(surface).derivatives(x, y)
    for mine, theirs, sign in zip(here, there, (1, -1, 1, 1, -1, 1), strict=True):
        assert mine == pytest.approx(sign * theirs, abs=1e-12)


def test_as_worn_power_prism_and_rays_are_mirrored(worn, gazes):
    lens, wearer, _ = worn
    right = lb.trace(lens, wearer, gazes)
    left = lb.trace(mirrored(lens), mirrored_wearer(wearer), gazes * [-1, 1, 1])
    assert left.origin * [-1, 1, 1] == pytest.approx(right.origin, abs=1e-9)
    flip = np.array([[1, -1], [-1, 1]])
    assert left.as_worn_matrix(400.0) * flip == pytest.approx(right.as_worn_matrix(400.0), abs=1e-8)
    assert left.prism_components() * [-1, 1] == pytest.approx(right.prism_components(), abs=1e-8)


def test_side_points_and_twice_is_the_same(worn):
    lens = replace(worn[0], points=Points((1.0, 4.0), (0.0, 0.0), None, (2.5, -12.0), 2.5), side="R")
    other = mirrored(lens)
    assert (other.side, mirrored(other).side) == ("L", "R")
    assert other.points.named()["near_reference_point"] == (-2.5, -12.0)
    assert other.points.near_inset == 2.5
    assert mirrored(other).points.named() == lens.points.named()
    assert other.thickness(-11.0, 7.0) == pytest.approx(lens.thickness(11.0, 7.0), abs=1e-12)


@given(st.integers(0, 180), st.integers(0, 359))
def test_ordered_axis_and_base(axis, base):
    order = Order(-1.0, -2.0, axis or 180, prism=2.0, prism_base=base)
    other = mirrored_order(order)
    assert 0 < other.axis <= 180
    assert 0 <= other.prism_base < 360
    assert other.power() == pytest.approx(order.power() * [[1, -1], [-1, 1]], abs=1e-12)
    assert other.prism_components() == pytest.approx(order.prism_components() * [-1, 1], abs=1e-12)


def test_outline():
    outline = polygon_outline([[20, 15], [-25, 12], [-22, -18], [28, -14]], (1.0, 0.5))
    other = mirrored_outline(outline)
    angle = np.linspace(0, 2 * np.pi, 97)
    assert other.radius(np.pi - angle) == pytest.approx(outline.radius(angle), abs=1e-9)
    assert other.box == pytest.approx((-outline.box[1], -outline.box[0], *outline.box[2:]))
