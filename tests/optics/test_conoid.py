"""The conoid of a gaze: thin-lens textbook distances of its focal lines, and the field that it is made of."""

from dataclasses import replace

import numpy as np
import pytest

from lensbench.layers import ConoidLayer, Request
from lensbench.optics import surfaces
from lensbench.optics.conoid import gaze_conoids
from lensbench.optics.conventions import Status, power_matrix
from lensbench.optics.eye import Eye, Wearer
from lensbench.optics.gaze import trace
from lensbench.optics.lens import Outline
from lensbench.workbench import run

AHEAD = np.array([[0.0, 0.0, 1.0]])


def naked(refraction, amplitude=0.0):
    return trace(None, Wearer(Eye(refraction, 0.0, amplitude, entrance_pupil=0.0)), AHEAD)


def test_a_naked_myope_focuses_at_the_far_points_of_its_meridians():
    """-2.00 -1.00 x 30, seen from its pupil: lines at 1/3 m and 1/2 m, least confusion at 1/2.5 m, where it is a circle."""
    found = gaze_conoids(naked(power_matrix(-2.0, -1.0, 30.0)), 400.0)
    assert found.relaxed.focal_lines == pytest.approx((1000 / 3, 500.0))
    assert found.relaxed.least_confusion == pytest.approx(400.0)
    circle, line = found.relaxed.eoc(400.0), found.relaxed.eoc(1000 / 3)
    assert circle.semi_major == pytest.approx(2.0 * 0.2)
    assert circle.semi_minor == pytest.approx(2.0 * 0.2)
    assert line.semi_major == pytest.approx(2.0 * (1 - 2 / 3))
    assert np.degrees(line.orientation) == pytest.approx(30.0)  # light of the steeper meridian, at 120, is in focus
    greater, lesser = found.relaxed.signed_axes(np.array([0.0, 1000 / 3, 400.0, 500.0, 600.0]))
    assert greater == pytest.approx([2.0, 2 / 3, 0.4, 0.0, -0.4], abs=1e-12)
    assert lesser == pytest.approx([2.0, 0.0, -0.4, -1.0, -1.6], abs=1e-12)


def test_parallel_and_diverging_light_has_its_focus_at_infinity_and_behind():
    assert gaze_conoids(naked(np.zeros((2, 2))), 400.0).relaxed.focal_lines == (np.inf, np.inf)
    assert gaze_conoids(naked(power_matrix(2.0)), 400.0).relaxed.focal_lines == pytest.approx((-500.0, -500.0))


def test_the_tense_eye_focuses_nearer_and_the_used_state_at_the_object():
    found = gaze_conoids(naked(power_matrix(-1.0), 4.0), 400.0)
    assert found.tense.least_confusion == pytest.approx(200.0)
    assert found.used.accommodation == pytest.approx(1.5)
    assert found.used.least_confusion == pytest.approx(400.0)


@pytest.mark.parametrize("rule", ["retina", "object", "paper", 1.0])
def test_conoids_are_the_blur_of_the_field(worn, rule):
    lens, wearer, _ = worn
    field = trace(
        lens, replace(wearer, eye=replace(wearer.eye, accommodation=3.0)), np.array([[0.1, -0.2, 0.97]]) / 0.9955
    )
    found = gaze_conoids(field, 700.0, rule)
    for state, used in (("relaxed", 0.0), ("tense", 3.0), ("used", rule)):
        conoid = found.states[state]
        for s in (1.0, 300.0, 2500.0):
            assert conoid.blur(s) == pytest.approx(field.blur(s, conoid.accommodation)[0], abs=1e-9)
        assert conoid.accommodation == pytest.approx(field.accommodation(700.0, used)[0])
        for line in conoid.focal_lines:
            assert not np.isfinite(line) or conoid.eoc(line).semi_minor == pytest.approx(0, abs=1e-6)


def test_a_gaze_that_misses_the_lens_has_no_conoid(lens_of):
    lens = lens_of(surfaces.sphere(90.0), surfaces.sphere(130.0))
    small = replace(lens, outline=Outline((0.0, 0.0), np.zeros(1), np.full(1, 20.0)))
    found = run(Request(small, Wearer(), ConoidLayer(np.radians(75), 0.0)))
    assert found.status != Status.OK
    assert np.isnan(found.used.at_exit).all()
