"""The atlas gives the chief ray and the blur of any point as the field itself does."""

import naive
import numpy as np
import pytest

from lensbench.optics.atlas import field_atlas
from lensbench.optics.conventions import Status, unit
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.gaze import look_at
from lensbench.optics.lens import Lens

BOX = (-0.9, 0.9, -0.8, 0.7)


def scene_points():
    chance = np.random.default_rng(4)
    tangent = chance.uniform(-0.55, 0.55, (60, 2))
    reach = 1 / chance.uniform(1 / 8000, 1 / 300, 60)
    return reach[:, None] * unit(np.column_stack([tangent, np.ones(60)]))


@pytest.mark.parametrize("rule", ["retina", "object", "paper", 1.25])
def test_points_are_met_and_blurred_as_by_the_field(worn, rule):
    lens, wearer, _ = worn
    points = scene_points() + wearer.centre_of_rotation
    field = look_at(lens, wearer, points, within_outline=False)
    atlas = field_atlas(lens, wearer, BOX, 200)
    distance = field.distances_to(points)
    for k in np.flatnonzero(field.status == Status.OK):
        uv, spread = naive.seen_by_atlas(atlas, wearer.eye, points[k] - wearer.centre_of_rotation, rule)
        gaze = field.directions[k]
        assert uv == pytest.approx(gaze[:2] / gaze[2], abs=3e-5)
        blur = -field.gaze_frame[k, :2].T @ field.apparent_blur(distance, rule)[k]
        exact = (blur[:2] - np.outer(uv, blur[2])) / gaze[2]
        assert spread == pytest.approx(exact, abs=0.004 * np.abs(exact).max() + 2e-6)


def test_the_naked_eye_sees_straight():
    wearer = Wearer(Eye(), Wear())
    atlas = field_atlas(None, wearer, (-2.0, 2.0, -2.0, 2.0), 32)
    for point in scene_points():
        assert naive.seen_by_atlas(atlas, wearer.eye, point, 0.0)[0] == pytest.approx(point[:2] / point[2], abs=1e-6)


def test_where_no_ray_passes_the_nearest_deviation_stands(lens_of):
    from lensbench.optics.surfaces import sphere

    lens: Lens = lens_of(sphere(40.0), sphere(90.0))
    wearer = Wearer(Eye(), Wear(13.0))
    atlas = field_atlas(lens, wearer, (-2.5, 2.5, -2.5, 2.5), 64)
    assert np.isfinite(atlas.table).all()
    slope = atlas.table[0, :, :, 2:] - np.stack(np.meshgrid(atlas.u, atlas.v), axis=-1)
    assert np.abs(slope[0, 0]).max() < 2.0
    assert slope[0, 0] == pytest.approx(slope[1, 1], abs=0.3)
