"""Rays meet a scene where geometry says."""

import numpy as np
import pytest

from lensbench.optics.conventions import unit
from lensbench.scenes.cast import first_hit
from lensbench.scenes.scene import Scene, rectangle

GREY = np.full((2, 2, 3), 128, dtype=np.uint8)


def test_first_hit_meets_a_tilted_plane_where_the_closed_form_does():
    normal = unit(np.array([0.2, -0.3, -1.0]))
    across = unit(np.cross(normal, [0.0, 1.0, 0.0]))
    centre = np.array([10.0, -20.0, 600.0])
    scene = Scene("plane", (rectangle("plane", centre, 900 * across, 900 * np.cross(normal, across), GREY),))
    chance = np.random.default_rng(3)
    origin = chance.uniform(-5, 5, (500, 3))
    direction = unit(chance.uniform([-0.5, -0.5, 1], [0.5, 0.5, 1], (500, 3)))
    exact = (centre - origin) @ normal / (direction @ normal)
    assert np.allclose(first_hit(scene, origin, 3 * direction), exact, rtol=2e-6)


def test_first_hit_says_what_it_does_not_meet():
    scene = Scene("wall", (rectangle("wall", [0, 0, 500], [-100, 0, 0], [0, 100, 0], GREY),))
    ahead, back, lost, aside = [0, 0, 1.0], [0, 0, -1.0], [np.nan, 0, 1.0], [1.0, 0, 0.1]
    found = first_hit(scene, np.zeros((4, 3)), [ahead, back, lost, aside])
    assert found[0] == pytest.approx(500)
    assert np.isinf(found[[1, 3]]).all()
    assert np.isnan(found[2])


def test_first_hit_takes_the_nearer_of_two():
    near, far = (rectangle(str(z), [0, 0, z], [-100, 0, 0], [0, 100, 0], GREY) for z in (300, 900))
    assert first_hit(Scene("two", (far, near)), [[0, 0, 0]], [[0, 0, 1]])[0] == pytest.approx(300)
