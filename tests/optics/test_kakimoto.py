"""The paper's two schemes, where they must agree with the gaze field: they are faithful yardsticks."""

from dataclasses import replace

import kakimoto
import numpy as np
import pytest

from lensbench.optics import surfaces
from lensbench.optics.conventions import power_matrix
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.field import ellipse
from lensbench.optics.gaze import GazeGrid, trace
from lensbench.optics.voxels import distance_to_plane

PLANES = np.array([250.0, 700.0, 3400.0])
GRID = GazeGrid(7, 6, 0.4, 0.35)


def by_table_1(field, roots=None):
    out = np.empty((4, PLANES.size, field.status.size))
    kakimoto.previous(kakimoto.chief_rays(field), field.lens.index, kakimoto.eye_of(field.wearer), PLANES, roots, out)
    return np.moveaxis(out.reshape(2, 2, PLANES.size, -1), (0, 1), (-2, -1))


def by_table_2(field):
    columns, out = np.empty((16, field.status.size)), np.empty((4, PLANES.size, field.status.size))
    kakimoto.conoid_rays(kakimoto.chief_rays(field), field.lens.index, kakimoto.eye_of(field.wearer), None, columns)
    kakimoto.conoid_voxels(columns, PLANES, out)
    return np.moveaxis(out.reshape(2, 2, PLANES.size, -1), (0, 1), (-2, -1))


@pytest.mark.parametrize("amplitude", [0.0, 3.0])
def test_table_1_has_the_blur_on_the_retina(worn, amplitude):
    """The ellipse of Table 1 is the field's retinal blur, seen from the pupil at the length of the way to the object."""
    lens, wearer, _ = worn
    field = trace(lens, replace(wearer, eye=replace(wearer.eye, accommodation=amplitude)), GRID)
    pupil = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * field.directions
    ways = np.linalg.norm(field.entry - pupil, axis=1) + np.linalg.norm(field.origin - field.entry, axis=1)
    for plane, mine in zip(PLANES, by_table_1(field), strict=True):
        distance = distance_to_plane(field, plane)
        theirs, ours = ellipse(mine), ellipse(field.retinal_blur(distance) * (distance + ways)[:, None, None])
        assert theirs.semi_major == pytest.approx(ours.semi_major, rel=5e-8, abs=5e-8)
        assert theirs.semi_minor == pytest.approx(ours.semi_minor, rel=5e-8, abs=5e-8)


def test_table_2_is_the_blur_where_wave_and_spread_share_their_axes(lens_of):
    """A centred lens of spheres and a relaxed eye with a spherical error: eq. 11 has no angle to go wrong with."""
    lens = lens_of(surfaces.sphere(90.0), surfaces.sphere(130.0))
    field = trace(lens, Wearer(Eye(power_matrix(-1.5)), Wear()), GRID)
    for plane, mine in zip(PLANES, by_table_2(field), strict=True):
        blur = ellipse(field.blur(distance_to_plane(field, plane)))
        assert ellipse(mine).semi_major == pytest.approx(blur.semi_major, rel=1e-8)
        assert ellipse(mine).semi_minor == pytest.approx(blur.semi_minor, rel=1e-8)


def test_table_2_has_no_answer_for_a_relaxed_emmetrope(lens_of):
    lens = lens_of(surfaces.sphere(90.0), surfaces.sphere(130.0))
    assert np.isnan(by_table_2(trace(lens, Wearer(), GRID))).all()


def test_roots_are_angles(worn):
    lens, wearer, _ = worn
    field = trace(lens, wearer, GRID)
    by_roots, by_angle = ellipse(by_table_1(field, roots=True)), ellipse(by_table_1(field))
    np.testing.assert_allclose(by_roots.semi_major, by_angle.semi_major, rtol=1e-6, atol=1e-9)


def test_both_loops_say_the_same(worn):
    lens, wearer, _ = worn
    field = trace(lens, wearer, GRID)
    rows, eye, n = kakimoto.chief_rays(field), kakimoto.eye_of(wearer), field.status.size
    columns, by_plane, by_ray = np.empty((16, n)), np.empty((4, PLANES.size, n)), np.empty((4, n, PLANES.size))
    kakimoto.previous(rows, lens.index, eye, PLANES, None, by_plane)
    kakimoto.previous_by_ray(rows, lens.index, eye, PLANES, None, by_ray)
    np.testing.assert_allclose(by_ray, np.swapaxes(by_plane, 1, 2), rtol=1e-9, atol=1e-12)
    kakimoto.conoid_rays(rows, lens.index, eye, None, columns)
    kakimoto.conoid_voxels(columns, PLANES, by_plane)
    kakimoto.conoid_voxels_by_ray(columns, PLANES, by_ray)
    np.testing.assert_allclose(by_ray, np.swapaxes(by_plane, 1, 2), rtol=1e-9, atol=1e-12)
