"""Distortion, skew and swim against plane geometry and a slow twin of a lens of revolution."""

import naive
import numpy as np
import pytest

from lensbench.optics import distortion, surfaces
from lensbench.optics.eye import Wear, Wearer
from lensbench.optics.gaze import direction_from_angles, trace

TURN = np.array([[np.cos(0.2), -np.sin(0.2)], [np.sin(0.2), np.cos(0.2)]])


@pytest.mark.parametrize(
    ("matrix", "area", "anisotropy", "rotation", "skew"),
    [
        (1.3 * np.eye(2), 1.3, 0, 0, 0),
        (1.3 * TURN, 1.3, 0, 0.2, 0),
        (np.diag([1.2, 1.0]), np.sqrt(1.2), 0.2, 0, 0),
        (TURN @ np.diag([1.0, 1.1]) @ TURN.T, np.sqrt(1.1), 0.1, 0, None),
        (np.array([[1.0, 0.3], [0.0, 1.0]]), 1, None, np.arctan2(-0.3, 2), np.arctan(0.3)),
    ],
)
def test_what_a_matrix_does(matrix, area, anisotropy, rotation, skew):
    expected = {"area_magnification": area, "anisotropy": anisotropy, "rotation": rotation, "skew": skew}
    for name, value in expected.items():
        if value is not None:
            assert getattr(distortion, name)(matrix) == pytest.approx(value, abs=1e-12)


def test_the_naked_eye_sees_the_chart_where_it_is():
    tangents = np.array([[0.0, 0.0], [0.4, -0.2], [-0.5, 0.5]])
    for depth in (300.0, np.inf):
        assert distortion.seen_chart(None, Wearer(), tangents, depth).apparent == pytest.approx(tangents, abs=1e-9)
    field = trace(None, Wearer(), [direction_from_angles(0.3, -0.2)])
    assert distortion.swim(field, 500.0) == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize(("power", "sign"), [(5.0, 1), (-5.0, -1)])
def test_plus_lenses_make_pincushions_and_minus_lenses_barrels(lens_of, power, sign):
    lens = lens_of(surfaces.conic(6 / 600), surfaces.conic((6 - power) / 600), 5.0)
    chart = distortion.seen_chart(lens, Wearer(), [[0.1, 0.0], [0.3, 0.0], [0.0, -0.3]])
    near, far, below = np.linalg.norm(chart.apparent, axis=1)
    assert sign * (far / 0.3 - near / 0.1) > 0.005
    assert below == pytest.approx(far)
    assert chart.apparent[2] == pytest.approx([0, -far], abs=1e-12)


def test_a_chart_beyond_the_edge_is_not_seen(lens_of):
    from lensbench.optics.lens import circle_outline

    lens = lens_of(surfaces.sphere(90.0), surfaces.sphere(100.0), 3.0, outline=circle_outline(30.0))
    chart = distortion.seen_chart(lens, Wearer(), [[0.1, 0.0], [0.8, 0.0]], 1000.0)
    assert np.isfinite(chart.apparent[0]).all()
    assert np.isnan(chart.apparent[1]).all()
    assert chart.status[1] != 0


def test_swim_of_a_lens_of_revolution(lens_of):
    """Radial and tangential magnification m_r, m_t of the angle from the axis: |gradient|^2 = m_r'^2 + m_t'^2 +
    2 ((m_r - m_t) / sin)^2, from slow rays."""
    front, back = naive.conic_sag(1 / 80), naive.conic_sag(1 / 130)
    lens, wearer = lens_of(surfaces.sphere(80.0), surfaces.sphere(130.0), 5.0), Wearer(wear=Wear(14.0))
    start = wearer.centre_of_rotation

    def object_angle(gaze_angle):
        gaze = direction_from_angles(0.0, gaze_angle)
        point = start + wearer.eye.pupil_from_rotation * gaze
        _, _, out = naive.trace((back, front), lens, wearer.wear, point, gaze)
        return np.arctan2(out[1], out[2])

    def magnifications(angle):
        radial = 1 / naive.first_derivative(lambda h: object_angle(angle + h), 0.01)
        return np.array([radial, np.sin(angle) / np.sin(object_angle(angle))])

    for angle in (0.15, 0.4):
        field = trace(lens, wearer, [direction_from_angles(0.0, angle), direction_from_angles(angle, 0.0)])
        radial, tangential = magnifications(angle)
        slopes = naive.first_derivative(lambda h, at=angle: magnifications(at + h), 0.02)
        squares = np.sum(slopes**2) + 2 * ((radial - tangential) / np.sin(angle)) ** 2
        assert field.magnification()[0] == pytest.approx(np.diag([tangential, radial]), abs=1e-6)
        assert distortion.anisotropy(field.magnification()) == pytest.approx(radial / tangential - 1, abs=1e-6)
        assert distortion.swim(field) == pytest.approx(np.sqrt(squares / 2), rel=1e-4)
