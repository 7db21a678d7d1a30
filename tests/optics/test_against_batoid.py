"""Real rays against batoid: positions to 1e-9 mm, directions to 1e-12."""

from dataclasses import replace

import naive
import numpy as np
import pytest
from scipy.interpolate import BSpline

from lensbench.optics import surfaces
from lensbench.optics.eye import Wear, Wearer
from lensbench.optics.gaze import trace, trace_rays

batoid = pytest.importorskip("batoid")

INDEX, THICKNESS = 1.6, 6.0
A4, A6 = 2e-7, -3e-11


def knot_spline(arrays):
    """The cubic spline as a table of values and derivatives at its knots: the same polynomials in every cell."""
    tx, ty, c, degree = arrays
    x, y = np.unique(tx), np.unique(ty)

    def derivative(by_x, by_y):
        rows = BSpline(ty, c, degree)(y, nu=by_y)
        return BSpline(tx, rows.T, degree)(x, nu=by_x).T

    return batoid.Bicubic(x, y, derivative(0, 0), derivative(1, 0), derivative(0, 1), derivative(1, 1))


def rough_cubic():
    """knots_x, knots_y, coefficients, degree: a convex surface with random lumps of 1 um in knots 4 mm apart."""
    knots = np.r_[[-48.0] * 4, np.arange(-44, 45, 4), [48.0] * 4]
    greville = np.array([knots[k + 1 : k + 4].mean() for k in range(knots.size - 4)])
    x, y = np.meshgrid(greville, greville)
    lumps = 1e-3 * np.random.default_rng(3).normal(size=x.shape)
    return knots, knots, -(x**2 + y**2) / 230 - 3e-5 * y * x**2 + lumps, 3


SPLINE = rough_cubic()
FRONTS = {
    "sphere": (surfaces.sphere(90.0), batoid.Sphere(-90.0)),
    "hollow sphere": (surfaces.sphere(-300.0), batoid.Sphere(300.0)),
    "plane": (surfaces.plane(), batoid.Plane()),
    "ellipsoid": (surfaces.conic(1 / 100, 0.7), batoid.Quadric(-100.0, 0.7)),
    "hyperboloid": (surfaces.conic(1 / 85, -1.8), batoid.Quadric(-85.0, -1.8)),
    "asphere": (surfaces.conic(1 / 85, -0.6, [A4, A6]), batoid.Asphere(-85.0, -0.6, [-A4, -A6])),
    "bicubic spline": (surfaces.bspline(*SPLINE), knot_spline(SPLINE)),
}
BACK = surfaces.sphere(110.0, decentration=(0.4, 0.3), tilt=(-0.015, 0.01)), batoid.Sphere(-110.0)


def batoid_rays(lens, wear, shapes, start, direction):
    """Entry, exit (n, 3) mm and direction (n, 3)."""
    turn = naive.pose(wear.pantoscopic_angle, -wear.face_form_angle)
    foot = np.array([0.0, 0.0, lens.back_height(0.0, 0.0)])
    rays = batoid.RayVector(*start.T.copy(), *direction.T.copy())
    air, glass, hits = batoid.ConstMedium(1.0), batoid.ConstMedium(lens.index), []
    crossings = (shapes[0], lens.back, 0.0, (air, glass)), (shapes[1], lens.front, THICKNESS, (glass, air))
    for shape, surface, z, media in crossings:
        vertex = turn @ ([*surface.decentration, z] - foot) + [*wear.decentration, 0.0]
        there = batoid.CoordSys(vertex, turn @ naive.pose(*surface.tilt))
        rays = batoid.refract(shape, rays, *media, coordSys=there).toCoordSys(batoid.globalCoordSys)
        hits.append(rays.r.copy())
    return hits[0], hits[1], rays.v / np.linalg.norm(rays.v, axis=1, keepdims=True)


@pytest.mark.parametrize("kind", FRONTS)
@pytest.mark.parametrize("wear", [Wear(), Wear(13.0, 0.15, 0.09, (1.5, -2.5))], ids=["straight", "tilted"])
def test_rays(lens_of, gazes, kind, wear):
    front, twin = FRONTS[kind]
    lens = lens_of(replace(front, decentration=(-0.7, 1.1), tilt=(0.02, -0.03)), BACK[0], THICKNESS, index=INDEX)
    start = [0.0, 0.0, -26.5] + 10.45 * gazes
    rays = trace_rays(lens, wear, start, gazes)
    entry, leave, direction = batoid_rays(lens, wear, (BACK[1], twin), start, gazes)
    assert rays.entry == pytest.approx(entry, abs=1e-9)
    assert rays.exit == pytest.approx(leave, abs=1e-9)
    assert rays.direction == pytest.approx(direction, abs=1e-12)


@pytest.mark.parametrize("kind", ["asphere", "bicubic spline"])
def test_as_worn_vergence_of_a_tilted_wrapped_decentred_lens(lens_of, gazes, kind):
    """batoid's rays that leave the pupil with the slopes of the required vergence are parallel in the scene."""
    front, twin = FRONTS[kind]
    wearer = Wearer(wear=Wear(13.0, 0.2, 0.15, (2.5, -3.0)))
    lens = lens_of(front, BACK[0], THICKNESS, index=INDEX)
    field = trace(lens, wearer, gazes[::5])
    straight = trace(lens, Wearer(wear=Wear(13.0)), gazes[::5])
    assert np.abs(field.required_vergence() - straight.required_vergence()).max() > 0.1
    h = 0.01
    for gaze, vergence in zip(field.directions, field.required_vergence() / 1000, strict=True):
        offsets = h * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
        across = np.array(naive.across(gaze))
        start = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * gaze + offsets @ across
        direction = gaze + offsets @ vergence @ across
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        _, _, out = batoid_rays(lens, wearer.wear, (BACK[1], twin), start, direction)
        assert np.abs(out[[0, 2]] - out[[1, 3]]).max() / (2 * h) < 1e-7  # 1/mm: 0.1 mD
