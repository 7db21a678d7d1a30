"""Foci against closed forms of a naked eye, against the ellipse of confusion and against real rays."""

import numpy as np
import pytest

import lensbench as lb
from lensbench.optics import surfaces
from lensbench.optics.bundle import trace_pupil
from lensbench.optics.conventions import power_matrix
from lensbench.optics.field import ellipse
from lensbench.optics.foci import foci
from lensbench.optics.pupil import gauss_pupil

AHEAD = [[0.0, 0.0, 1.0]]


def test_a_naked_astigmatic_eye_has_its_focal_lines_at_its_far_points():
    """-2 D along 30 degrees, -3 D along 120: the meridian at 120 meets first, in a line along 30."""
    eye = lb.Eye(power_matrix(-2.0, -1.0, 30.0), refraction_vertex_distance=-3.05)
    found = foci(lb.trace(None, lb.Wearer(eye), AHEAD))
    near, far = 1000 / 3, 500.0
    assert found.distance[0] == pytest.approx([near, far], abs=1e-9)
    lines = ellipse(found.blur[0])
    assert lines.semi_minor == pytest.approx(0, abs=1e-12)
    assert np.degrees(lines.orientation) == pytest.approx([30, 120], abs=1e-6)
    assert lines.semi_major == pytest.approx([2 * (1 - near / far), 2 * (far / near - 1)], abs=1e-9)


def test_accommodation_moves_the_foci_by_its_dioptres_and_parallel_light_has_none():
    field = lb.trace(None, lb.Wearer(lb.Eye()), AHEAD)
    assert foci(field, 4.0).distance[0] == pytest.approx(250.0, abs=1e-9)
    assert foci(field, -4.0).distance[0] == pytest.approx(-250.0, abs=1e-9)
    resting = foci(field)
    assert np.isinf(resting.distance).all()
    assert np.isnan(resting.blur).all()


def test_behind_a_lens_ellipses_shrink_to_lines_at_the_foci(worn):
    lens, wearer, _ = worn
    field = lb.trace(lens, wearer, lb.GazeGrid(5, 5, 0.4, 0.4))
    used = np.linspace(2.0, 4.0, 25)
    found = foci(field, used)
    for k in range(2):
        distance = found.distance[:, k]
        there = np.isfinite(distance) & (distance > 0)
        assert there.any()
        part = field.take(there)
        lines = part.eoc(distance[there], used[there])
        assert lines.semi_minor == pytest.approx(0, abs=1e-9)
        assert lines.semi_major == pytest.approx(ellipse(found.blur[there, k]).semi_major, abs=1e-9)


def test_real_rays_of_a_narrow_pupil_meet_in_the_focal_lines(lens_of):
    lens = lens_of(surfaces.sphere(90.0), surfaces.toric(1 / 120, 1 / 100, 25.0), 3.0)
    wearer = lb.Wearer(lb.Eye(pupil_diameter=0.1), lb.Wear(pantoscopic_angle=0.15))
    field = lb.trace(lens, wearer, [[0.2, -0.3, 1.0]])
    found = foci(field, 4.0)
    assert abs(np.diff(1000 / found.distance[0])) > 0.5
    start, rays = trace_pupil(field, field.vergence(np.inf, 4.0), gauss_pupil())
    assert np.linalg.norm(start - start.mean(axis=1, keepdims=True), axis=-1).max() < 0.05
    for k in range(2):
        at = field.origin + found.distance[:, k, None] * field.direction
        along = (at[:, None] - rays.exit) @ field.direction[0] / (rays.direction @ field.direction[0])
        spot = (rays.exit + along[..., None] * rays.direction - at[:, None])[0] @ field.frame[0, :2].T
        line = ellipse(found.blur[0, k])
        across = np.array([-np.sin(line.orientation), np.cos(line.orientation)])
        length = np.abs(spot @ [np.cos(line.orientation), np.sin(line.orientation)]).max()
        assert length == pytest.approx(line.semi_major, rel=0.06)
        assert np.abs(spot @ across).max() < 2e-3 * length


def test_failed_rays_have_no_foci():
    field = lb.trace(None, lb.Wearer(lb.Eye()), AHEAD)
    failed = field.with_status(np.array([True]), lb.Status.MISSED_FRONT)
    assert np.isnan(foci(failed, 3.0).distance).all()
