"""The kernel that fills voxels against the gaze field, one plane at a time, and against the definition."""

from dataclasses import replace

import naive
import numpy as np
import pytest

from lensbench.optics.eye import Eye
from lensbench.optics.gaze import GazeGrid, look_at, trace
from lensbench.optics.voxels import blur_on_planes, distance_to_plane, ndc_blur

PLANES = np.array([-5.0, 60.0, 250.0, 700.0, 3400.0, 10000.0])
EYES = {"presbyope": 0.0, "in between": 1.5, "young": 8.0}


def assert_same_blur(mine, field, distance, reference):
    """Within 1e-6 of the pupil's radius at the lens and 1e-8 rad as seen from there."""
    allowed = 1e-6 * field.wearer.eye.pupil_diameter / 2 + 1e-8 * distance
    passed = np.isfinite(reference[..., 0, 0])
    assert np.array_equal(np.isfinite(mine).all(axis=(0, 1)), passed)
    error = np.abs(np.moveaxis(mine, (0, 1), (-2, -1)) - reference).max(axis=(-2, -1))
    assert (error[passed] < allowed[passed]).all()


@pytest.mark.parametrize("amplitude", EYES.values(), ids=EYES)
@pytest.mark.parametrize("rule", ["retina", "object", "paper", 0.8, "array"])
def test_voxels_are_the_blur_of_the_field(worn, amplitude, rule):
    lens, wearer, _ = worn
    eye = replace(wearer.eye, accommodation=amplitude, pupil_diameter=5.0)
    field = trace(lens, replace(wearer, eye=eye), GazeGrid(9, 7, 0.6, 0.5))
    rule = np.linspace(0, 2, 63) if rule == "array" else rule
    blur = blur_on_planes(field, PLANES, rule)
    assert blur.shape == (2, 2, 63, 6)
    assert blur.dtype == np.float32
    for k, plane in enumerate(PLANES):
        distance = distance_to_plane(field, plane)
        assert_same_blur(blur[..., k], field, distance, field.blur(distance, rule))


def test_voxels_of_the_naked_eye_by_the_definition(worn):
    _, wearer, _ = worn
    field = trace(None, wearer, GazeGrid(3, 3))
    blur = blur_on_planes(field, PLANES[2:])
    for i in range(9):
        for k, plane in enumerate(PLANES[2:]):
            s = (plane - field.origin[i, 2]) / field.direction[i, 2]
            vergence = wearer.eye.pupil_refraction - field.accommodation(s)[i] * np.eye(2)
            expected = naive.blur(field.transfer[i], vergence, s, wearer.eye.pupil_diameter / 2)
            assert blur[:, :, i, k] == pytest.approx(expected, abs=2e-6 + 1e-8 * s)


@pytest.mark.parametrize("with_lens", [True, False])
def test_a_point_spreads_in_the_picture_as_its_ndc_matrix_says(worn, with_lens):
    """The turning eye looks at points displaced by M d, found by Newton's method on real chief rays."""
    lens, wearer, _ = worn
    lens, half, step = lens if with_lens else None, 0.5, 1e-4
    field = trace(lens, wearer, GazeGrid(5, 4, half, half)).take(slice(6, 9))
    blur = blur_on_planes(field, PLANES[2:])
    found = ndc_blur(field, PLANES[2:], blur, half)
    for k, plane in enumerate(PLANES[2:]):
        point = field.origin + distance_to_plane(field, plane)[:, None] * field.direction
        for axis in (0, 1):
            aside = np.einsum("ni,nij->nj", blur[:, axis, :, k].T, field.frame[:, :2])
            seen = [look_at(lens, wearer, point + sign * step * aside).directions for sign in (1, -1)]
            ndc = [d[:, :2] / d[:, 2:] / np.tan(half) for d in seen]
            np.testing.assert_allclose(found[:, axis, :, k].T, (ndc[0] - ndc[1]) / (2 * step), rtol=1e-4, atol=1e-6)


def test_planes_behind_the_lens_hold_nothing(worn):
    lens, wearer, _ = worn
    blur = blur_on_planes(trace(lens, wearer, GazeGrid(5, 5)), PLANES)
    assert np.isnan(blur[..., 0]).all()
    assert np.isfinite(blur[..., 2:]).all()


def test_voxels_fill_an_array_that_is_there(worn):
    lens, wearer, _ = worn
    field = trace(lens, replace(wearer, eye=Eye(accommodation=1.0)), GazeGrid(5, 5))
    there = np.zeros((2, 2, 25, 6), dtype=np.float32)
    assert blur_on_planes(field, PLANES, out=there) is there
    assert np.array_equal(there, blur_on_planes(field, PLANES), equal_nan=True)
