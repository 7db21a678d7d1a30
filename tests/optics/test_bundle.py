"""Finite bundles: closed forms, power vectors as the pupil shrinks, batoid, a slow twin, and Zernike polynomials."""

from dataclasses import replace
from math import sqrt

import naive
import numpy as np
import pytest

from lensbench.optics import surfaces
from lensbench.optics.conventions import power_matrix, power_vector
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.gaze import direction_from_angles, trace
from lensbench.optics.pupil import gauss_pupil, vogel_pupil, zernike

AHEAD = [[0.0, 0.0, 1.0]]


def with_pupil(field, diameter):
    return field.with_eye(replace(field.wearer.eye, pupil_diameter=diameter))


# -- pupil samples and polynomials -------------------------------------------------------------------------------------


def test_zernikes_are_orthonormal_over_the_disc():
    pupil = gauss_pupil(8, 20)
    z = zernike(pupil.points)
    assert z.T @ (pupil.weights[:, None] * z) == pytest.approx(np.eye(28), abs=1e-12)


@pytest.mark.parametrize(
    ("j", "value"),
    [
        (1, lambda x, y: 2 * y),
        (2, lambda x, y: 2 * x),
        (3, lambda x, y: 2 * sqrt(6) * x * y),
        (4, lambda x, y: sqrt(3) * (2 * (x * x + y * y) - 1)),
        (5, lambda x, y: sqrt(6) * (x * x - y * y)),
        (7, lambda x, y: sqrt(8) * (3 * (x * x + y * y) - 2) * y),
        (8, lambda x, y: sqrt(8) * (3 * (x * x + y * y) - 2) * x),
        (12, lambda x, y: sqrt(5) * (6 * (x * x + y * y) ** 2 - 6 * (x * x + y * y) + 1)),
    ],
)
def test_zernikes_as_the_standard_writes_them(j, value):
    points = vogel_pupil(50).points
    assert zernike(points)[:, j] == pytest.approx(value(*points.T), abs=1e-12)


def test_both_samplings_share_the_disc_equally():
    for pupil, tolerance in ((gauss_pupil(), 1e-12), (vogel_pupil(4000), 2e-3)):
        x, y = pupil.points.T
        assert pupil.weights.sum() == pytest.approx(1)
        means = [pupil.weights @ f for f in (x, y, x * x, y * y, x * y, (x * x + y * y) ** 2)]
        assert means == pytest.approx([0, 0, 1 / 4, 1 / 4, 0, 1 / 3], abs=tolerance)


# -- closed forms ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("refraction", "distance"), [(-3.0, np.inf), (2.0, 500.0), (0.0, 250.0)])
def test_naked_eye_is_a_pure_defocus(refraction, distance):
    """All rays of a point meet the ideal eye's pupil in a sphere: c20 = -r^2 M / (4 sqrt 3), and hardly anything else."""
    eye = Eye(refraction * np.eye(2), refraction_vertex_distance=-3.05)
    field = trace(None, Wearer(eye), [direction_from_angles(0.2, -0.1)])
    bundle = field.bundle(distance, 0.0)
    wave = bundle.wavefront()
    error = refraction - (-1000 / distance)
    assert wave.zernike()[0, 4] == pytest.approx(-error * 4 / (4 * sqrt(3)), rel=1e-4)
    assert np.abs(np.delete(wave.zernike()[0], [0, 4])).max() < 1e-4
    assert wave.defocus() == pytest.approx(field.defocus(distance, 0.0), rel=1e-4)
    assert bundle.angular_eoc().semi_major == pytest.approx(2 * abs(error) / 1000, rel=1e-9)


def test_spherical_aberration_of_one_refracting_sphere(lens_of):
    """The ray of the height h through a plano-convex lens, plane side to the eye, exactly: a parallel pencil from the pupil
    goes straight through the plane, and the sphere bends it by asin(n h / R) - asin(h / R)."""
    radius, n, thickness = 50.0, 1.5, 4.0
    lens = lens_of(surfaces.sphere(radius), surfaces.plane(), thickness, index=n)
    field = trace(lens, Wearer(Eye(pupil_diameter=6.0)), AHEAD)
    pupil = gauss_pupil()
    bundle = field.bundle(300.0, 0.0, pupil)
    h = 3.0 * np.hypot(*pupil.points.T)
    bend = np.arcsin(n * h / radius) - np.arcsin(h / radius)
    sag = radius - np.sqrt(radius**2 - h**2)
    lands = h - (300.0 + sag) * np.tan(bend)
    assert np.linalg.norm(bundle.spot()[0], axis=-1) == pytest.approx(np.abs(lands), abs=1e-11)
    radial = np.sum(bundle.spot()[0] * pupil.points, axis=-1) / np.hypot(*pupil.points.T)
    assert radial == pytest.approx(lands, abs=1e-11)


def test_seidel_spherical_aberration_of_a_thin_lens(lens_of):
    """Object at infinity, plano-convex, convex side to the object, against the sphere of its focus: W040 of a thin lens
    (Welford 1986) in c40."""
    n, power, r = 1.5, 5.0, 1.5
    lens = lens_of(surfaces.sphere(1000 * (n - 1) / power), surfaces.plane(), 0.02, index=n)
    focused = Eye(power * np.eye(2), 0.0, pupil_diameter=2 * r, entrance_pupil=0.0)
    wearer = Wearer(focused, Wear(1e-3))
    wave = trace(lens, wearer, AHEAD).bundle(np.inf, 0.0).wavefront()
    k, shape, conjugate = power / 1000, 1.0, -1.0
    seidel = (
        r**4 * k**3 / 4
        * ((n / (n - 1)) ** 2 + (n + 2) / (n * (n - 1) ** 2) * (shape + 2 * (n * n - 1) / (n + 2) * conjugate) ** 2
           - n / (n + 2) * conjugate**2)
    )  # fmt: skip
    assert abs(wave.zernike()[0, 12]) == pytest.approx(1000 * seidel / 8 / (6 * sqrt(5)), rel=0.02)


# -- the first-order limit ---------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def field(worn, gazes):
    return trace(worn[0], worn[1], gazes[::5])


@pytest.mark.parametrize("distance", [350.0, np.inf])
def test_second_order_terms_are_the_power_vector(field, distance):
    """What is left falls with the square of the pupil, towards the residual defocus S - S*."""
    left = []
    for diameter in (2.0, 1.0):
        eye = with_pupil(field, diameter)
        r, c = diameter / 2, eye.bundle(distance).wavefront().zernike()
        seen = np.stack([-4 * sqrt(3) * c[:, 4], -2 * sqrt(6) * c[:, 5], -2 * sqrt(6) * c[:, 3]]) / r**2
        left.append(np.abs(seen - power_vector(eye.residual_defocus(distance))).max())
    assert left[1] < 0.02  # D
    assert left[0] / left[1] == pytest.approx(4, rel=0.1)


@pytest.mark.parametrize("distance", [350.0, np.inf])
def test_second_moments_become_the_first_order_ellipse(field, distance):
    small = with_pupil(field, 0.05)
    bundle = small.bundle(distance, 0.0)
    for mine, first in (
        (bundle.angular_blur(), small.angular_blur(distance, 0.0)),
        (bundle.wavefront().retinal_blur(), small.retinal_blur(distance, 0.0)),
    ):
        square = first @ np.swapaxes(first, 1, 2)
        assert mine @ mine == pytest.approx(square, abs=2e-3 * np.abs(square).max())
    assert bundle.angular_eoc().semi_major == pytest.approx(
        np.linalg.norm(small.angular_blur(distance, 0.0), 2, axis=(1, 2)), rel=2e-3
    )


def test_spread_is_the_gradient_of_the_aberration(field):
    """By differences of pupils: W at x + h less W at x - h."""
    from lensbench.optics.pupil import Pupil

    h, r = 1e-3, field.wearer.eye.pupil_diameter / 2
    at = np.array([[0.5, -0.3], [-0.7, 0.4]])
    steps = np.array([[0, 0], [h, 0], [-h, 0], [0, h], [0, -h]])
    points = (at[:, None] + steps).reshape(-1, 2)
    wave = field.bundle(400.0, pupil=Pupil(points, np.full(10, 0.1))).wavefront()
    w = wave.aberration.reshape(-1, 2, 5) / 1000
    slope = np.stack([w[..., 1] - w[..., 2], w[..., 3] - w[..., 4]], axis=-1) / (2 * h * r)
    assert wave.spread.reshape(-1, 2, 5, 2)[:, :, 0] == pytest.approx(slope, abs=2e-7)


# -- against other tracers ---------------------------------------------------------------------------------------------


def test_spots_against_a_slow_twin(worn, gazes):
    lens, wearer, sags = worn
    field = trace(lens, wearer, gazes[3:4])
    pupil = gauss_pupil(2, 3)
    spot = field.bundle(500.0, 1.0, pupil).spot()[0]
    vergence = (wearer.eye.pupil_refraction - np.eye(2)) / 1000
    gaze, across = gazes[3], np.array(naive.across(gazes[3]))
    centre = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * gaze
    for point, mine in zip(pupil.points, spot, strict=True):
        x = wearer.eye.pupil_diameter / 2 * point
        direction = gaze + (vergence @ x) @ across
        _, leave, out = naive.trace(sags, lens, wearer.wear, centre + x @ across, direction / np.linalg.norm(direction))
        at = field.origin[0] + 500.0 * field.direction[0]
        assert mine == pytest.approx(naive.landing(leave[None], out[None], at, field.direction[0])[0], abs=1e-8)


def test_aberrations_against_batoid(lens_of, gazes):
    """Paths and slopes of batoid's rays: a parallel pencil from the scene, its optical path up to the pupil plane."""
    batoid = pytest.importorskip("batoid")
    from test_against_batoid import A4, A6

    radius, n, thickness = 85.0, 1.6, 5.0
    lens = lens_of(surfaces.conic(1 / radius, -0.6, [A4, A6]), surfaces.sphere(110.0), thickness, index=n)
    wearer = Wearer(Eye(power_matrix(-1.0, -1.0, 30.0), pupil_diameter=5.0), Wear(13.0))
    field = trace(lens, wearer, gazes[10:11])
    pupil = gauss_pupil()
    wave = field.bundle(np.inf, 0.0, pupil).wavefront()
    along = field.direction[0]
    across = np.array(naive.across(along))
    footprint = np.stack(np.meshgrid(*[np.linspace(-4, 4, 41)] * 2), axis=-1).reshape(-1, 2)
    start = field.origin[0] + 30 * along + footprint @ across
    rays = batoid.RayVector(*start.T.copy(), *np.repeat(-along[:, None], len(start), axis=1), t=0.0)
    air, glass = batoid.ConstMedium(1.0), batoid.ConstMedium(n)
    front = batoid.CoordSys(np.array([0, 0, thickness]))
    batoid.refract(batoid.Asphere(-radius, -0.6, [-A4, -A6]), rays, air, glass, coordSys=front)
    batoid.refract(batoid.Sphere(-110.0), rays, glass, air, coordSys=batoid.CoordSys(np.zeros(3)))
    centre = wearer.centre_of_rotation + wearer.eye.pupil_from_rotation * gazes[10]
    frame = np.array([*naive.across(gazes[10]), gazes[10]])
    batoid.intersect(batoid.Plane(), rays, coordSys=batoid.CoordSys(centre, frame.T.copy()))
    x, path = (rays.toCoordSys(batoid.CoordSys(centre, frame.T.copy())).r[:, :2], rays.t)
    inside = np.hypot(*x.T) < 3.0
    basis = zernike(x[inside] / 3.0, 12)
    fit = np.linalg.lstsq(basis, path[inside], rcond=None)[0]
    assert np.abs(basis @ fit - path[inside]).max() < 1e-8
    at = 2.5 * pupil.points
    sloped = at @ field.vergence(np.inf, 0.0)[0] / 1000
    ideal = -np.sum(at * sloped, axis=1) / (1 + np.sqrt(1 + np.sum(sloped**2, axis=1)))
    there = zernike(np.vstack([[0, 0], at]) / 3.0, 12) @ fit
    expected = 1000 * (ideal - (there[1:] - there[0]))
    assert wave.aberration[0] == pytest.approx(expected, abs=1e-4)  # um
    assert np.ptp(expected) > 1.0


# -- pictures of a point -----------------------------------------------------------------------------------------------


def test_psf_of_a_myope_is_an_even_disc():
    eye = Eye(-2.0 * np.eye(2), refraction_vertex_distance=-3.05, pupil_diameter=4.0)
    bundle = trace(None, Wearer(eye), AHEAD).bundle(np.inf, pupil=vogel_pupil(60_000))
    pixel, size = 0.25e-3, 41
    image = bundle.wavefront().psf(pixel, size)[0]
    axis = (np.arange(size) - size // 2) * pixel
    radius = np.hypot(*np.meshgrid(axis, axis))
    assert image.sum() == pytest.approx(1)
    even = pixel**2 / (np.pi * 0.004**2)
    assert image[radius < 0.0035] == pytest.approx(np.full((radius < 0.0035).sum(), even), rel=0.15)
    assert image[radius > 0.0045].sum() == 0


def test_psf_is_the_right_way_up(lens_of):
    """A myope sees the light of the pupil's upper left quarter up and to the left, and counts what falls outside."""
    from lensbench.optics.pupil import Pupil

    eye = Eye(-2.0 * np.eye(2), refraction_vertex_distance=-3.05, pupil_diameter=4.0)
    corner = Pupil(np.array([[0.5, 0.6]]), np.ones(1))
    wave = trace(None, Wearer(eye), AHEAD).bundle(np.inf, pupil=corner).wavefront()
    row, column = np.argwhere(wave.psf(1e-3, 9)[0])[0]
    assert (row, column) == (6, 6)
    assert wave.psf(1e-4, 3).sum() == 0


def test_failed_rays_give_no_number(lens_of):
    lens = lens_of(surfaces.sphere(14.0), surfaces.plane(), 9.0)
    field = trace(lens, Wearer(Eye(pupil_diameter=8.0)), [direction_from_angles(0.0, e) for e in (0.0, 0.35, 1.2)])
    bundle = field.bundle(400.0)
    assert np.isnan(bundle.angular_blur()[1:]).all()
    assert np.isnan(bundle.wavefront().zernike()[1:]).all()
    assert np.isnan(bundle.wavefront().psf(1e-3, 5)[2]).all()


def test_at_infinity_a_spot_has_no_millimetres(field):
    bundle = field.bundle(np.inf)
    for ask in (bundle.spot, bundle.eoc):
        with pytest.raises(ValueError, match="infinity"):
            ask()
