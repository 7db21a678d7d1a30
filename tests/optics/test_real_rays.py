"""Traced rays, their transfer matrices and finite bundles against a slow twin, differences, batoid and symmetry."""

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lensbench.optics import surfaces
from lensbench.optics.eye import Wear, Wearer
from lensbench.optics.gaze import direction_from_angles, trace, trace_rays

LEVER = 10.45
START = np.array([0.0, 0.0, -26.5])


def chief_rays(gazes):
    return START + LEVER * gazes, gazes


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def around(transverse, direction):
    """Offsets (..., 2) in the frame across `direction` as vectors (..., 3)."""
    return np.asarray(transverse) @ np.array(naive.across(direction))


def test_rays_match_the_slow_twin(worn, gazes):
    lens, wearer, sags = worn
    rays = trace_rays(lens, wearer.wear, *chief_rays(gazes))
    for k in range(0, 41, 4):
        entry, leave, direction = naive.trace(sags, lens, wearer.wear, START + LEVER * gazes[k], gazes[k])
        assert rays.entry[k] == pytest.approx(entry, abs=1e-9)
        assert rays.exit[k] == pytest.approx(leave, abs=1e-9)
        assert rays.direction[k] == pytest.approx(direction, abs=1e-11)


STEPS = np.array([0.05, 0.05, 0.002, 0.002])  # mm, mm, rad, rad


def difference_transfer(lens, wear, point, direction):
    """Transfer matrix (4, 4) by sixth-order central differences of real rays, and the traced one."""
    moves = np.concatenate([np.zeros((1, 4)), *(np.diag(k * STEPS) for k in naive.FIRST)])
    tilted = direction + around(moves[:, 2:], direction)
    rays = trace_rays(lens, wear, point + around(moves[:, :2], direction), unit(tilted))
    along = rays.direction[0]
    slopes = rays.direction @ np.array(naive.across(along)).T / (rays.direction @ along)[:, None]
    arrived = np.hstack([naive.landing(rays.exit, rays.direction, rays.exit[0], along), slopes])
    weights = np.array(list(naive.FIRST.values()))
    return np.einsum("k,kio->oi", weights, arrived[1:].reshape(-1, 4, 4)) / STEPS, rays.transfer[0]


def assert_same_blocks(mine, reference, rel):
    for rows in (slice(0, 2), slice(2, 4)):
        for columns in (slice(0, 2), slice(2, 4)):
            error = np.linalg.norm(mine[rows, columns] - reference[rows, columns])
            assert error < rel * np.linalg.norm(reference[rows, columns])


def assert_symplectic(transfer):
    j = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    assert np.abs(np.swapaxes(transfer, -1, -2) @ j @ transfer - j).max() < 1e-12


def test_transfer_is_the_derivative_of_real_rays(worn, gazes):
    lens, wearer, _ = worn
    for gaze in gazes[::4]:
        slow, mine = difference_transfer(lens, wearer.wear, START + LEVER * gaze, gaze)
        assert_same_blocks(mine, slow, rel=1e-7)


def test_transfer_is_symplectic(worn, gazes):
    lens, wearer, _ = worn
    assert_symplectic(trace(lens, wearer, gazes).transfer)


curvature = st.floats(0.004, 0.013)
tilt = st.tuples(st.floats(-0.06, 0.06), st.floats(-0.06, 0.06))
shift = st.tuples(st.floats(-3, 3), st.floats(-3, 3))
axis = st.floats(0, 180)
constant = st.floats(-1.5, 1.0)
shape_strategies = st.one_of(
    st.builds(surfaces.conic, curvature, constant, st.tuples(st.floats(-3e-7, 3e-7)), decentration=shift, tilt=tilt),
    st.builds(surfaces.toric, curvature, curvature, axis, decentration=shift, tilt=tilt),
    st.builds(surfaces.biconic, curvature, curvature, axis, constant, constant, decentration=shift, tilt=tilt),
)
wears = st.builds(
    Wear,
    pantoscopic_angle=st.floats(-0.1, 0.3),
    face_form_angle=st.floats(-0.1, 0.3),
    decentration=shift,
)


@given(shape_strategies, shape_strategies, wears, st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.sampled_from("RL"))
def test_transfer_of_any_lens(lens_of, front, back, wear, azimuth, elevation, side):
    lens, gaze = lens_of(front, back, 12.0, side=side), direction_from_angles(azimuth, elevation)
    slow, mine = difference_transfer(lens, wear, START + LEVER * gaze, gaze)
    assert_symplectic(mine)
    assert_same_blocks(mine, slow, rel=1e-7)


# -- finite pencils: what the first order leaves out -------------------------------------------------------------------

RING = np.exp(2j * np.pi * np.arange(24) / 24)
DISC = np.concatenate([RING.view(float).reshape(-1, 2), 0.5 * RING.view(float).reshape(-1, 2)])
RADII = 2.0 * 0.5 ** np.arange(5)


def left_out(field, vergence, distance, k=0):
    """For each pupil radius of RADII the rms, mm, of real landing points less M(s) d, and that of the points alone."""
    gaze = field.directions[k]
    pupil = field.wearer.centre_of_rotation + field.wearer.eye.pupil_from_rotation * gaze
    d = RADII[:, None, None] * DISC
    start, slope = (pupil + around(d, gaze)).reshape(-1, 3), gaze + around(d @ vergence / 1000, gaze)
    rays = trace_rays(field.lens, field.wearer.wear, start, unit(slope.reshape(-1, 3)))
    at = field.origin[k] + distance * field.direction[k]
    real = naive.landing(rays.exit, rays.direction, at, field.direction[k]).reshape(d.shape)
    first_order = d @ naive.blur(field.transfer[k], vergence, distance, 1.0).T
    return rms(real - first_order), rms(real)


def rms(points):
    return np.sqrt(np.mean(np.sum(points**2, axis=-1), axis=-1))


def order(values):
    return np.polyfit(np.log(RADII), np.log(values), 1)[0]


@pytest.mark.parametrize("distance", [270.0, 3400.0])
def test_first_order_leaves_out_the_second(worn, gazes, distance):
    lens, wearer, _ = worn
    field = trace(lens, wearer, gazes)
    for k in range(0, 41, 5):
        errors, sizes = left_out(field, wearer.eye.pupil_refraction, distance, k)
        assert order(errors) > 1.9
        assert errors[-1] < 0.02 * sizes[-1]


def test_on_the_axis_of_symmetry_it_leaves_out_the_third(lens_of):
    lens, wearer = lens_of(surfaces.sphere(80.0), surfaces.sphere(140.0), 5.0), Wearer()
    errors, _ = left_out(trace(lens, wearer, [[0.0, 0.0, 1.0]]), -2.0 * np.eye(2), 500.0)
    assert order(errors) > 2.9


@pytest.mark.parametrize("distance", [300.0, 2000.0])
def test_required_vergence_focuses_real_rays(worn, gazes, distance):
    """Its bundle misses the chief point in the second order only; one a quarter dioptre beside it, in the first."""
    lens, wearer, _ = worn
    field = trace(lens, wearer, gazes)
    for k in range(0, 41, 10):
        required = field.required_vergence(distance)[k]
        _, sharp = left_out(field, required, distance, k)
        _, blurred = left_out(field, required + 0.25 * np.eye(2), distance, k)
        assert required == pytest.approx(required.T, abs=1e-11)
        assert order(sharp) > 1.9
        assert np.log2(blurred[-2] / blurred[-1]) == pytest.approx(1, abs=0.1)


# -- symmetry ----------------------------------------------------------------------------------------------------------


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_rigid_turn_of_lens_and_rays(lens_of, about_x, about_y):
    """Only the Listing frames notice: they differ by a turn about the ray."""
    lens = lens_of(surfaces.toric(0.009, 0.012, 30.0, tilt=(0.03, 0.01)), surfaces.toric(0.005, 0.013, 80.0))
    turn = naive.pose(about_x, -about_y)
    gazes = direction_from_angles([0.1, -0.2, 0.3], [0.2, -0.3, 0.05])
    straight = trace_rays(lens, Wear(), *chief_rays(gazes))
    wear = Wear(pantoscopic_angle=about_x, face_form_angle=about_y)
    turned = trace_rays(lens, wear, (START + LEVER * gazes) @ turn.T, gazes @ turn.T)
    assert turned.exit == pytest.approx(straight.exit @ turn.T, abs=1e-11)
    assert turned.direction == pytest.approx(straight.direction @ turn.T, abs=1e-13)
    for k in range(3):
        before, after = (
            np.array(naive.across(turn @ d)) @ turn @ np.array(naive.across(d)).T
            for d in (gazes[k], straight.direction[k])
        )
        blocks = [np.block([[q, np.zeros((2, 2))], [np.zeros((2, 2)), q]]) for q in (before, after)]
        assert turned.transfer[k] == pytest.approx(blocks[1] @ straight.transfer[k] @ blocks[0].T, abs=1e-10)


@given(st.floats(-30, 30), st.floats(-30, 30))
def test_decentring_the_lens_is_moving_the_ray(lens_of, dx, dy):
    lens = lens_of(surfaces.toric(0.006, 0.009, 50.0), surfaces.sphere(140.0), 9.0)
    moved = np.array([dx, dy, 0.0])
    point, gaze = np.array([[1.0, 2.0, -15.0]]), direction_from_angles([0.1], [-0.1])
    here = trace_rays(lens, Wear(pantoscopic_angle=0.1), point, gaze)
    there = trace_rays(lens, Wear(pantoscopic_angle=0.1, decentration=(dx, dy)), point + moved, gaze)
    assert there.exit - moved == pytest.approx(here.exit, abs=1e-12)
    assert there.transfer == pytest.approx(here.transfer, abs=1e-11)
