"""The field's algebra: blur identities, accommodation rules, gaze solving and symmetry."""

from dataclasses import replace

import naive
import numpy as np
import pytest

from lensbench.optics import surfaces
from lensbench.optics.conventions import Status, listing_frame, power_matrix, sphere_cylinder_axis
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.field import ACCOMMODATION_RULES, ellipse
from lensbench.optics.gaze import GazeGrid, direction_from_angles, look_at, look_through, trace, worn_pose
from lensbench.optics.lens import circle_outline, polygon_outline

DISTANCE = 400.0
STRONG = Eye(power_matrix(1.0, -2.5, 60.0), accommodation=6.0)


@pytest.fixture(scope="module")
def field(worn, gazes):
    return trace(worn[0], worn[1], gazes)


# -- blur --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rule", [*ACCOMMODATION_RULES, 0.7])
def test_blur_is_the_written_out_matrix(field, rule):
    eye, used = field.wearer.eye, field.accommodation(DISTANCE, rule)
    for k, mine in enumerate(field.blur(DISTANCE, rule)):
        vergence = eye.pupil_refraction - used[k] * np.eye(2)
        slow = naive.blur(field.transfer[k], vergence, DISTANCE, eye.pupil_diameter / 2)
        assert mine == pytest.approx(slow, abs=1e-12)


def test_blur_is_the_retinal_blur_magnified(field):
    q = field.transfer[:, :2, 2:] / DISTANCE + field.transfer[:, 2:, 2:]
    assert field.blur(DISTANCE) == pytest.approx(DISTANCE * q @ field.retinal_blur(DISTANCE), abs=1e-12)


def test_required_vergence_makes_no_blur_and_is_symmetric(field):
    required = field.required_vergence(DISTANCE)
    assert required == pytest.approx(np.swapaxes(required, 1, 2), abs=1e-11)
    for transfer, vergence in zip(field.transfer, required, strict=True):
        assert naive.blur(transfer, vergence, DISTANCE, 2.0) == pytest.approx(np.zeros((2, 2)), abs=1e-12)


@pytest.mark.parametrize(
    "quantity",
    ["required_vergence", "accommodation", "angular_blur", "retinal_blur", "as_worn_matrix", "magnification"],
)
def test_infinity_is_the_limit(field, quantity):
    far, infinite = getattr(field, quantity)(1e9), getattr(field, quantity)(np.inf)
    assert np.isfinite(infinite).all()
    assert infinite == pytest.approx(far, abs=2e-5)


def test_many_distances_at_once_are_one_after_the_other(field):
    distances = np.array([250.0, 1000.0, np.inf])
    for quantity in (field.angular_blur, field.as_worn_matrix, field.accommodation, field.gaze_derivative):
        together = quantity(distances[:, None])
        assert together.shape[:2] == (3, 41)
        for row, s in zip(together, distances, strict=True):
            assert np.array_equal(row, quantity(s))


@pytest.mark.parametrize("distance", [0.0, -5.0])
def test_distances_behind_the_lens_are_refused(field, distance):
    with pytest.raises(ValueError, match="positive"):
        field.blur(distance)


def test_an_ellipse_at_infinity_has_no_size(field):
    with pytest.raises(ValueError, match="angular_blur"):
        field.eoc(np.inf)


def test_ellipse_is_the_singular_value_decomposition():
    matrices = np.random.default_rng(1).normal(size=(200, 2, 2))
    u, sigma, _ = np.linalg.svd(matrices)
    mine = ellipse(matrices)
    assert mine.semi_major == pytest.approx(sigma[:, 0], abs=1e-13)
    assert mine.semi_minor == pytest.approx(sigma[:, 1], abs=1e-13)
    assert np.cos(mine.orientation) * u[:, 1, 0] == pytest.approx(np.sin(mine.orientation) * u[:, 0, 0], abs=1e-9)
    assert ((mine.orientation >= 0) & (mine.orientation < np.pi)).all()


def test_another_eye_needs_no_new_trace(field):
    eye = replace(STRONG, pupil_diameter=5.5)
    fresh = trace(field.lens, replace(field.wearer, eye=eye), field.directions)
    for quantity in ("blur", "as_worn_matrix", "defocus", "apparent_blur"):
        assert np.array_equal(getattr(field.with_eye(eye), quantity)(DISTANCE), getattr(fresh, quantity)(DISTANCE))
    with pytest.raises(ValueError, match="new trace"):
        field.with_eye(replace(eye, centre_of_rotation=14.0))


# -- accommodation -----------------------------------------------------------------------------------------------------


def over_all_accommodations(field, amplitude, measure):
    """The accommodation (n,) that makes measure(M (m, 2, 2), S - S* (m, 2, 2)) least, in steps of 1/1000 D."""
    a = np.arange(0, amplitude + 5e-4, 1e-3)
    vergences = field.wearer.eye.pupil_refraction - a[:, None, None] * np.eye(2)
    best = []
    for transfer in field.transfer:
        q = transfer[:2, 2:] + DISTANCE * transfer[2:, 2:]
        required = -1000 * np.linalg.solve(q, transfer[:2, :2] + DISTANCE * transfer[2:, :2])
        blur = naive.blur(transfer, vergences, DISTANCE, 2.0)
        best.append(a[np.argmin(measure(blur, vergences - required))])
    return np.array(best)


def frobenius(matrices):
    return np.sum(matrices**2, axis=(1, 2))


def unlike_a_circle(matrices):
    singular = np.linalg.svd(matrices, compute_uv=False)
    return singular[:, 0] - singular[:, 1]


MEASURES = {
    "retina": lambda blur, defocus: frobenius(defocus),
    "object": lambda blur, defocus: frobenius(blur),
    "paper": lambda blur, defocus: unlike_a_circle(blur),
}


@pytest.mark.parametrize("rule", ["retina", "object"])
@pytest.mark.parametrize("amplitude", [0.0, 1.5, 6.0])
def test_accommodation_by_dense_search(field, rule, amplitude):
    field = field.with_eye(replace(STRONG, accommodation=amplitude))
    used = field.accommodation(DISTANCE, rule)
    assert used == pytest.approx(over_all_accommodations(field, amplitude, MEASURES[rule]), abs=6e-4)
    assert ((used >= 0) & (used <= amplitude)).all()


@pytest.mark.parametrize(("axis", "roundness"), [(60.0, 1e-9), (105.0, 0.03)], ids=["aligned", "crossed"])
def test_paper_rule_gives_the_circle_of_least_confusion(lens_of, axis, roundness):
    """Exactly a circle where all axes are the eye's (60 degrees) or across it; else the roundest that there is."""
    lens = lens_of(surfaces.toric(0.009, 0.012, 150.0), surfaces.toric(0.009, 0.008, axis))
    field = trace(lens, Wearer(STRONG), [[0.0, 0.0, 1.0]])
    used = field.accommodation(DISTANCE, "paper")
    assert 0.5 < used[0] < 5.5
    assert used == pytest.approx(over_all_accommodations(field, 6.0, MEASURES["paper"]), abs=6e-4)
    eoc = field.eoc(DISTANCE, "paper")
    assert eoc.semi_major > 0.1
    assert eoc.semi_minor == pytest.approx(eoc.semi_major, rel=roundness)


def test_rules_agree_without_astigmatism(lens_of):
    lens, eye = lens_of(surfaces.sphere(110.0), surfaces.sphere(130.0)), Eye(accommodation=5.0)
    field = trace(lens, Wearer(eye), [[0.0, 0.0, 1.0]])
    used = [field.accommodation(DISTANCE, rule)[0] for rule in ACCOMMODATION_RULES]
    assert 0.1 < used[0] < 4.9
    assert used == pytest.approx([used[0]] * 3, abs=1e-12)
    assert field.blur(DISTANCE)[0] == pytest.approx(np.zeros((2, 2)), abs=1e-12)


@pytest.mark.parametrize("rule", ACCOMMODATION_RULES)
def test_accommodation_stays_within_its_limits(field, rule):
    amplitude = 1.0
    far_sighted = field.with_eye(Eye(15.0 * np.eye(2), accommodation=amplitude))
    near_sighted = field.with_eye(Eye(-15.0 * np.eye(2), accommodation=amplitude))
    assert far_sighted.accommodation(DISTANCE, rule) == pytest.approx(np.full(41, amplitude), abs=0)
    assert near_sighted.accommodation(DISTANCE, rule) == pytest.approx(np.zeros(41), abs=0)


def test_a_number_is_taken_as_it_is(field):
    assert field.accommodation(DISTANCE, 33.0) == pytest.approx(np.full(41, 33.0), abs=0)
    with pytest.raises(ValueError, match="unknown accommodation rule 'best'"):
        field.accommodation(DISTANCE, "best")


# -- finding gazes -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reach", [250.0, 1e6])
def test_look_at_meets_its_points(worn, gazes, reach):
    lens, wearer, _ = worn
    points = reach * gazes
    field = look_at(lens, wearer, points)
    assert (field.status == Status.OK).all()
    along = field.distances_to(points)
    assert field.origin + along[:, None] * field.direction == pytest.approx(points, abs=1e-9 * reach)
    assert np.linalg.norm(field.directions, axis=1) == pytest.approx(np.ones(41), abs=1e-14)


def test_the_naked_eye_looks_straight_at_its_points():
    points = np.array([[30.0, -40.0, 200.0], [0.0, 0.0, 5000.0]])
    field = look_at(None, Wearer(), points)
    reach = np.linalg.norm(points - field.wearer.centre_of_rotation, axis=1)
    assert field.distances_to(points) == pytest.approx(reach - field.wearer.eye.pupil_from_rotation)
    assert np.cross(field.direction, points - field.origin) == pytest.approx(np.zeros((2, 3)), abs=1e-11)


def test_look_through_leaves_at_the_asked_points(worn):
    lens, wearer, _ = worn
    x, y = np.meshgrid(np.linspace(-15, 15, 5), np.linspace(-15, 15, 5))
    field = look_through(lens, wearer, x, y)
    leave = worn_pose(lens, wearer.wear).to_lens(field.origin)
    assert leave[:, 0] == pytest.approx(x.ravel(), abs=1e-8)
    assert leave[:, 1] == pytest.approx(y.ravel(), abs=1e-8)


@pytest.mark.parametrize("distance", [350.0, np.inf])
def test_gaze_derivative_by_turning_the_eye(field, distance):
    lens, wearer, step = field.lens, field.wearer, 1e-3
    for k in range(0, 41, 8):
        e1, e2 = naive.across(field.directions[k])
        turns = [field.directions[k] + h * step * e for e in (e1, e2) for h in naive.FIRST]
        turned = trace(lens, wearer, turns)
        along = field.direction[k]
        if np.isfinite(distance):
            at = field.origin[k] + distance * along
            arrived = naive.landing(turned.origin, turned.direction, at, along) / distance
        else:
            arrived = turned.direction @ np.array(naive.across(along)).T / (turned.direction @ along)[:, None]
        slow = np.einsum("h,ahi->ia", list(naive.FIRST.values()), arrived.reshape(2, 6, 2)) / step
        assert field.gaze_derivative(distance)[k] == pytest.approx(slow, abs=1e-8)


def test_apparent_blur_undoes_the_gaze_derivative(field):
    seen = field.gaze_derivative(DISTANCE) @ field.apparent_blur(DISTANCE)
    assert seen == pytest.approx(field.angular_blur(DISTANCE), abs=1e-12)


def test_grids_of_gaze():
    grid = GazeGrid(5, 3, np.radians(40), np.radians(20), centre=(0.1, -0.3))
    d = grid.directions().reshape(3, 5, 3)
    assert d[1, 2] == pytest.approx([np.sin(0.1) * np.cos(0.3), -np.sin(0.3), np.cos(0.1) * np.cos(0.3)], abs=1e-15)
    assert np.degrees(np.arccos(np.clip(d[1] @ d[1, 2], -1, 1)))[[0, 4]] == pytest.approx([40, 40], abs=1e-6)
    assert np.tan(np.arccos(d[1] @ d[1, 2]))[3] == pytest.approx(np.tan(np.radians(40)) / 2, abs=1e-9)
    assert d[2, 2, 1] > d[0, 2, 1]
    assert d[1, 4, 0] > d[1, 0, 0]
    angles = replace(grid, kind="angles").directions().reshape(3, 5, 3)
    assert np.arcsin(angles[..., 1]) == pytest.approx(
        np.broadcast_to([[-0.3 - np.radians(20)], [-0.3], [-0.3 + np.radians(20)]], (3, 5))
    )


# -- symmetry ----------------------------------------------------------------------------------------------------------


def turn_z(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


def turned_lens(lens_of, degrees):
    corners = np.array([[18.0, 12.0], [-16.0, 14.0], [-19.0, -11.0], [15.0, -13.0]]) @ turn_z(degrees).T
    front = surfaces.biconic(0.009, 0.012, 20.0 + degrees, -0.5, 0.8, decentration=tuple(turn_z(degrees) @ [1.0, 2.0]))
    back = surfaces.toric(0.008, 0.014, 130.0 + degrees)
    return lens_of(front, back, 4.0, outline=polygon_outline(corners, (0.0, 0.0)))


@pytest.mark.parametrize("degrees", [17.0, 90.0, 200.0, -61.0])
def test_turning_everything_about_the_line_of_sight(lens_of, gazes, degrees):
    turn, fields = turn_z(degrees), []
    for angle in (0.0, degrees):
        eye = Eye(power_matrix(-2.0, -1.5, 25.0 + angle), accommodation=1.0)
        wear = Wear(decentration=tuple(turn_z(angle) @ [1.5, -2.5]))
        gaze = np.column_stack([gazes[:, :2] @ turn_z(angle).T, gazes[:, 2]])
        fields.append(trace(turned_lens(lens_of, angle), Wearer(eye, wear), gaze))
    here, there = fields
    assert set(here.status) == {Status.OK, Status.OUTSIDE_OUTLINE}
    assert np.array_equal(there.status, here.status)
    for quantity in ("blur", "as_worn_matrix", "retinal_blur", "magnification"):
        expected = turn @ getattr(here, quantity)(DISTANCE) @ turn.T
        assert getattr(there, quantity)(DISTANCE) == pytest.approx(expected, abs=1e-10, nan_ok=True)
    assert there.prism().prism == pytest.approx(here.prism().prism, abs=1e-10, nan_ok=True)
    assert there.eoc(DISTANCE).semi_major == pytest.approx(here.eoc(DISTANCE).semi_major, abs=1e-11, nan_ok=True)


def test_mirrored_lens_of_the_other_eye(lens_of, gazes, spline_arrays):
    tx, ty, c, degree = spline_arrays()
    flip, fields = np.diag([-1.0, 1.0]), []
    for side, sign in (("R", 1), ("L", -1)):
        front = surfaces.bspline(sign * tx[::sign], ty, c[:, ::sign], degree, tilt=(0.02, 0.03 * sign))
        back = surfaces.toric(0.008, 0.014, 90 + 40 * sign, decentration=(0.4 * sign, 0.3))
        lens = lens_of(front, back, side=side, outline=circle_outline(50.0, (2.0 * sign, 1.0)))
        wear = Wear(13.0, 0.15, 0.09, (1.5 * sign, -2.5))
        eye = Eye(power_matrix(-1.0, -1.5, 90 + 65 * sign), accommodation=2.0)
        fields.append(trace(lens, Wearer(eye, wear), gazes * [sign, 1, 1]))
    right, left = fields
    assert np.array_equal(right.status, left.status)
    for quantity in ("blur", "as_worn_matrix", "magnification"):
        expected = flip @ getattr(right, quantity)(DISTANCE) @ flip
        assert getattr(left, quantity)(DISTANCE) == pytest.approx(expected, abs=1e-10, nan_ok=True)
    assert left.origin == pytest.approx(right.origin * [-1, 1, 1], abs=1e-11, nan_ok=True)
    assert left.prism().base == pytest.approx((180 - right.prism().base) % 360, abs=1e-8, nan_ok=True)
    axes = [sphere_cylinder_axis(f.as_worn_matrix()).axis for f in fields]
    assert axes[1] == pytest.approx((180 - axes[0]) % 180, abs=1e-7, nan_ok=True)


def test_arrays_are_read_only(field):
    for array in (field.directions, field.entry, field.origin, field.direction, field.transfer, field.status):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    failed = field.with_status(np.arange(len(field.status)) == 0, Status.NOT_CONVERGED)
    for array in (failed.transfer, Eye(np.zeros((2, 2))).refraction, surfaces.sphere(90.0).p):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@pytest.mark.parametrize("distance", [300.0, np.inf])
def test_magnification_turns_the_naked_line_into_the_gaze(worn, distance):
    """By finite differences: points turned about the centre of rotation, and the gazes that meet them."""
    lens, wearer, _ = worn
    gaze = np.array([[0.2, -0.3, 1.0]])
    here = trace(lens, wearer, gaze)
    reach, h = min(distance, 1e9), 1e-5
    centre = wearer.centre_of_rotation
    line = here.origin + reach * here.direction - centre
    length, naked = np.linalg.norm(line), listing_frame(line / np.linalg.norm(line))[0]
    for k in range(2):
        turned = [look_at(lens, wearer, centre + line + sign * h * length * naked[k]).directions for sign in (1, -1)]
        seen = here.gaze_frame[0, :2] @ (turned[0] - turned[1])[0] / (2 * h)
        assert here.magnification(distance)[0, :, k] == pytest.approx(seen, abs=1e-6)


@pytest.mark.parametrize("distance", [250.0, 400.0])
def test_magnification_is_that_of_a_line_turned_at_its_length(lens_of, distance):
    """Where the line to the object and the outgoing ray part most: -10 D at 25, -25 degrees. The object turns about the centre
    of rotation, its distance from there kept; moved across the outgoing ray instead it would come to 1e-4 and more of another.
    """
    lens, wearer, h = lens_of(surfaces.sphere(265.0), surfaces.sphere(48.0), 1.5), Wearer(), 1e-4
    here = trace(lens, wearer, [direction_from_angles(np.radians(25.0), np.radians(-25.0))], within_outline=False)
    centre = wearer.centre_of_rotation
    line = (here.origin + distance * here.direction - centre)[0]
    length, naked = np.linalg.norm(line), listing_frame(line / np.linalg.norm(line))
    for k in range(2):
        turned = [length * (np.cos(h) * naked[2] + sign * np.sin(h) * naked[k]) for sign in (1, -1)]
        gaze = look_at(lens, wearer, centre + np.array(turned), within_outline=False).directions
        seen = here.gaze_frame[0, :2] @ (gaze[0] - gaze[1]) / (2 * h)
        assert here.magnification(distance)[0, :, k] == pytest.approx(seen, abs=1e-7)
