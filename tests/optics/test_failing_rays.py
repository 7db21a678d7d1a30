"""What becomes of rays that fail: their status, NaN everywhere, and no harm to their neighbours."""

import naive
import numba
import numpy as np
import pytest

from lensbench.optics import surfaces
from lensbench.optics.conventions import Status
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.gaze import ENOUGH, GazeGrid, _Rays, _through, look_at, trace, trace_rays, worn_pose
from lensbench.optics.lens import box_outline, circle_outline

DISTANCE = 400.0
TWENTY_DEGREES, FIFTY_DEGREES = [0.0, np.sin(0.35), np.cos(0.35)], [0.0, np.sin(0.87), np.cos(0.87)]
AHEAD = [0.0, 0.0, 1.0]


def failing(lens_of):
    """By name: lens, gaze, expected status."""
    plane = surfaces.plane()
    return {
        "back": (lens_of(plane, surfaces.sphere(10.0), 6.0), FIFTY_DEGREES, Status.MISSED_BACK),
        "front": (lens_of(surfaces.sphere(8.0), plane, 10.0), FIFTY_DEGREES, Status.MISSED_FRONT),
        "crossed": (lens_of(surfaces.sphere(60.0), plane, 1.0), FIFTY_DEGREES, Status.MISSED_FRONT),
        "spline ends": (
            lens_of(surfaces.bspline([-4.0] * 3 + [4.0] * 3, [-4.0] * 3 + [4.0] * 3, np.zeros((3, 3)), 2), plane),
            TWENTY_DEGREES,
            Status.MISSED_FRONT,
        ),
        "outline": (lens_of(plane, plane, outline=circle_outline(15.0)), TWENTY_DEGREES, Status.OUTSIDE_OUTLINE),
        "total reflection": (
            lens_of(surfaces.plane(tilt=(0.7, 0.0)), plane, 30.0),
            AHEAD,
            Status.TOTAL_INTERNAL_REFLECTION,
        ),
    }


FAILURES = ["back", "front", "crossed", "spline ends", "outline", "total reflection"]


def test_rays_must_enter_and_leave_within_the_outline(lens_of, gazes):
    """A thick lens of 16 mm, tilted and decentred: some rays cross the edge between its surfaces."""
    lens = lens_of(surfaces.plane(), surfaces.plane(), 9.0, outline=circle_outline(16.0))
    wearer = Wearer(wear=Wear(13.0, 0.3, 0.2, (2.0, -3.0)))
    rays = trace_rays(lens, wearer.wear, wearer.centre_of_rotation + 10.45 * gazes, gazes)
    inside = []
    for points in (rays.entry, rays.exit):
        x, y, _ = naive.pose(0.3, -0.2).T @ (points - [2.0, -3.0, 0.0]).T
        inside.append(np.hypot(x, y) < 8)
    assert (inside[0] != inside[1]).any()
    expected = np.where(inside[0] & inside[1], Status.OK, Status.OUTSIDE_OUTLINE)
    assert np.array_equal(trace(lens, wearer, gazes).status, expected)


def test_the_outline_is_the_lens_own_for_every_ray_of_every_block(lens_of):
    """Rays by the edge of a frame-shaped lens, in the listed order and in one that mixes them: as Outline.contains says."""
    lens = lens_of(surfaces.plane(), surfaces.sphere(200.0), 2.0, outline=box_outline(45.0, 30.0))
    wear = Wear()
    start = np.random.default_rng(3).uniform(-25.0, 25.0, (1000, 3)) * [1.0, 1.0, 0.0] - [0.0, 0.0, 20.0]
    start = start[np.argsort(np.hypot(start[:, 0], start[:, 1]))]
    for points in (start, np.random.default_rng(4).permutation(start)):
        directions = np.tile(AHEAD, (len(points), 1))
        free = trace_rays(lens, wear, points, directions)
        on_lens = [worn_pose(lens, wear).to_lens(at) for at in (free.entry, free.exit)]
        inside = np.logical_and(*(lens.outline.contains(at[:, 0], at[:, 1]) for at in on_lens))
        assert 0.2 < inside.mean() < 0.8
        out, status = _through(lens, wear, _Rays(points.T, 0.0, directions.T), within_outline=True)
        assert np.array_equal(status, np.where(inside, Status.OK, Status.OUTSIDE_OUTLINE))
        assert np.array_equal(np.isnan(out[:, :1000]).any(axis=0), ~inside)


def test_many_rays_sought_by_several_threads_are_those_of_one(lens_of):
    """Two thirds of the rays miss a back surface that is half a ball of 8 mm."""
    lens = lens_of(surfaces.plane(), surfaces.sphere(8.0), 9.0)
    gaze = GazeGrid(96, 96, 0.9, 0.9)
    several = trace(lens, Wearer(), gaze, within_outline=False)
    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        one = trace(lens, Wearer(), gaze, within_outline=False)
    finally:
        numba.set_num_threads(threads)
    assert (one.status != Status.OK).sum() > 2 * ENOUGH
    assert np.array_equal(several.status, one.status)
    assert np.array_equal(several.transfer, one.transfer, equal_nan=True)


@pytest.mark.parametrize("name", FAILURES)
def test_status_of_failing_rays(lens_of, name):
    lens, gaze, status = failing(lens_of)[name]
    other = np.array([0.0, -np.sin(0.1), np.cos(0.1)])
    field = trace(lens, Wearer(Eye(accommodation=1.0)), [other, gaze, other])
    alone = trace(lens, field.wearer, [other])
    assert list(field.status) == [Status.OK, status, Status.OK]
    results = [field.entry, field.origin, field.direction, field.transfer, *field.as_worn_power(DISTANCE)]
    results += [
        field.angular_blur(np.inf),
        *field.eoc(DISTANCE),
        *field.prism(),
        field.magnification(),
        field.defocus(300.0),
    ]
    assert all(np.isnan(values[1]).all() for values in results)
    assert all(np.isfinite(values[[0, 2]]).all() for values in results)
    assert np.array_equal(field.transfer[[0, 2]], np.repeat(alone.transfer, 2, axis=0))


@pytest.mark.parametrize(
    "name",
    ["outline", "front", "crossed", "spline ends", "total reflection"],
)
def test_look_at_keeps_the_status(lens_of, name):
    lens, gaze, status = failing(lens_of)[name]
    points = 500 * np.array([gaze, AHEAD, [0.0, -0.05, 1.0]])
    field = look_at(lens, Wearer(), points)
    assert field.status[0] == status
    assert field.status[2] == Status.OK
    assert np.isnan(field.origin[0]).all()


@pytest.mark.parametrize(
    "steep",
    [
        surfaces.sphere(12.0),
        surfaces.sphere(-15.0),
        surfaces.conic(0.03, -3.0),
        surfaces.conic(0.02, 0.0, [3e-6]),
        surfaces.biconic(0.03, 0.01, 20.0, -2.0, 3.0),
        surfaces.toric(0.02, 0.03, 30.0),
        surfaces.conic(0.03, 2.0),
        surfaces.toric(0.05, 0.0, 30.0),
        surfaces.toric(0.02, 0.09, 30.0),
    ],
    ids=["ball", "hollow ball", "hyperboloid", "asphere", "biconic", "torus", "oblate", "tube", "tight torus"],
)
def test_a_ray_that_meets_a_steep_surface_is_no_miss(lens_of, steep):
    """Against a walk along each ray in steps of 0.01 mm, gazes up to 59 degrees."""
    gazes = GazeGrid(15, 15, np.radians(50), np.radians(50)).directions()
    start, way = [0.0, 0.0, -26.5] + 10.45 * gazes, np.arange(0, 60, 0.01)
    x, y, z = np.moveaxis(start[:, None] + way[:, None] * gazes[:, None], -1, 0)
    above = z - steep.sag(x, y)
    meets = np.any((above < 0)[:, :-1] & (above >= 0)[:, 1:], axis=1)
    never = np.nanmax(above, axis=1) < -0.5
    status = trace_rays(lens_of(surfaces.plane(), steep, 200.0), Wear(13.0), start, gazes).status
    assert meets.any()
    missed = np.isin(status, [Status.MISSED_BACK, Status.NOT_CONVERGED])
    assert not missed[meets].any()
    assert missed[never].all()


def test_rays_beyond_the_outline_can_be_asked_for(lens_of):
    lens, points = (
        lens_of(surfaces.sphere(90.0), surfaces.plane(), outline=box_outline(20.0, 10.0)),
        [[0.0, 300.0, 500.0]],
    )
    assert look_at(lens, Wearer(), points).status[0] == Status.OUTSIDE_OUTLINE
    free = look_at(lens, Wearer(), points, within_outline=False)
    assert free.status[0] == Status.OK
    assert free.origin + free.distances_to(points)[:, None] * free.direction == pytest.approx(
        np.array(points), abs=1e-6
    )


def test_a_crowd_of_rays_is_traced_like_each_alone(worn, gazes):
    lens, wearer, _ = worn
    start = [0.0, 0.0, -26.5] + 10 * gazes
    crowd = trace_rays(lens, wearer.wear, start, gazes)
    for k in (0, 17, 40):
        alone = trace_rays(lens, wearer.wear, start[k], gazes[k])
        assert np.array_equal(crowd.transfer[k], alone.transfer[0])
        assert np.array_equal(crowd.exit[k], alone.exit[0])


def test_points_that_the_lens_hides(lens_of):
    """Behind the eye, and within the lens: no gaze, and no harm to the point before the lens."""
    lens = lens_of(surfaces.sphere(90.0), surfaces.sphere(100.0), 4.0)
    field = look_at(lens, Wearer(), [[0.0, 0.0, -500.0], [0.0, 0.0, 2.0], [0.0, 0.0, 500.0]])
    assert list(field.status) == [Status.NOT_CONVERGED, Status.NOT_CONVERGED, Status.OK]


def test_a_surface_behind_the_pupil_is_missed(lens_of):
    lens = lens_of(surfaces.sphere(90.0), surfaces.sphere(100.0), 4.0)
    start = [[0.0, 0.0, -10.0], [0.0, 0.0, 1.0]]
    assert list(trace_rays(lens, Wear(), start, [AHEAD, AHEAD]).status) == [Status.OK, Status.MISSED_BACK]


def test_look_at_finds_every_gaze_of_a_strong_lens(lens_of):
    """Also where the straight line to the point would be reflected within the lens."""
    lens = lens_of(surfaces.sphere(250.0), surfaces.sphere(75.0), 2.0, outline=circle_outline(65.0))
    seen = trace(lens, Wearer(), GazeGrid(61, 61, np.radians(48), np.radians(48)))
    ok = seen.status == Status.OK
    found = look_at(lens, Wearer(), (seen.origin + 2000.0 * seen.direction)[ok])
    assert (found.status == Status.OK).all()
    assert found.directions == pytest.approx(seen.directions[ok], abs=1e-9)


def test_a_gaze_that_is_no_number(lens_of):
    lens = lens_of(surfaces.plane(), surfaces.plane())
    for field in (trace(lens, Wearer(), [[np.nan] * 3]), trace(None, Wearer(), [[np.nan] * 3])):
        assert field.status[0] != Status.OK
        assert np.isnan(field.transfer).all()
    with pytest.raises(ValueError, match="no direction"):
        trace(lens, Wearer(), [[0.0, 0.0, 0.0]])
