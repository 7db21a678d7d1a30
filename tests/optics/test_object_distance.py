"""Object distance as a function of the lowering of the gaze."""

import numpy as np
import pytest

from lensbench.optics.eye import Wear, Wearer
from lensbench.optics.gaze import direction_from_angles, trace
from lensbench.optics.object_distance import NEAR_LOWERING, model_distance, proximity


def test_default_is_a_smooth_step_to_the_near_distance():
    angles = np.radians([-40, 0, 16, 32, 60])
    assert proximity(Wear(), angles) == pytest.approx([0, 0, 1.25, 2.5, 2.5])
    assert proximity(Wear(near_distance=330.0), NEAR_LOWERING) == pytest.approx(1000 / 330)
    steps = np.diff(proximity(Wear(), np.linspace(0, NEAR_LOWERING, 50)))
    assert (steps > 0).all()
    assert steps[0] < 0.1 * steps[24]


def test_the_wearers_own_points_are_met_and_nothing_overshoots():
    points = ((-0.1, np.inf), (0.2, 800.0), (0.35, 800.0), (0.5, 330.0))
    wear = Wear(object_distances=points)
    assert proximity(wear, [p[0] for p in points]) == pytest.approx([0, 1.25, 1.25, 1000 / 330])
    between = proximity(wear, np.linspace(-1, 1, 400))
    assert (np.diff(between) >= -1e-12).all()
    assert (between[0], between[-1]) == pytest.approx((0.0, 1000 / 330))


def test_distances_count_from_the_cornea():
    wearer = Wearer(wear=Wear(14.0))
    for azimuth in (0.0, 0.3):
        field = trace(
            None, wearer, [direction_from_angles(azimuth, -NEAR_LOWERING), direction_from_angles(azimuth, 0.1)]
        )
        near, far = model_distance(field)
        point = field.origin[0] + near * field.direction[0]
        assert np.linalg.norm(point - [0, 0, -14.0]) == pytest.approx(400.0, abs=1e-9)
        assert np.isinf(far)
