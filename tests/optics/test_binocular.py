"""Two eyes behind two lenses: plane geometry, thin lenses, prisms and Listing's law."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from lensbench.optics import surfaces
from lensbench.optics.binocular import Pair, fixate, helmholtz_angles, listing_torsion
from lensbench.optics.conventions import power_matrix
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.gaze import direction_from_angles
from lensbench.optics.lens import polygon_outline
from lensbench.optics.mirror import mirrored, mirrored_wearer

THIN, N = 1e-3, 1.6
EYES = {"R": -30.0, "L": 33.0}


def thin(lens_of, power, side, **more):
    """A thin lens with its front bent like the vertex sphere, so that every line of sight meets it squarely."""
    bent = 1 / 26.5
    return lens_of(
        surfaces.conic(bent), surfaces.conic(bent - power / (1000 * (N - 1))), THIN, index=N, side=side, **more
    )


def pair_of(right, left):
    return Pair(
        right, left, Wearer(wear=Wear(13.0, pupillary_distance=30)), Wearer(wear=Wear(13.0, pupillary_distance=33))
    )


def plano_pair(lens_of):
    return pair_of(*(lens_of(surfaces.plane(), surfaces.plane(), THIN, side=side) for side in "RL"))


# -- gaze and imbalance ------------------------------------------------------------------------------------------------


def test_planos_leave_the_eyes_where_they_would_look_naked(lens_of):
    points = np.array([[0.0, 0.0, 400.0], [80.0, -120.0, 350.0], [-300.0, 100.0, 900.0]])
    fixation = fixate(plano_pair(lens_of), points)
    for field, x in ((fixation.right, EYES["R"]), (fixation.left, EYES["L"])):
        line = points - [x, 0.0, 0.0]
        assert field.directions == pytest.approx(line / np.linalg.norm(line, axis=1, keepdims=True), abs=1e-5)
    assert fixation.vertical_imbalance() == pytest.approx(np.zeros(3), abs=1e-3)
    assert fixation.induced_vergence() == pytest.approx(np.zeros(3), abs=1e-3)
    assert fixation.vergence()[0] == pytest.approx(np.arctan(30 / 400) + np.arctan(33 / 400), abs=1e-5)
    assert fixation.balance().magnification_difference == pytest.approx(np.zeros(3), abs=1e-4)


@pytest.mark.parametrize("side", ["R", "L"])
def test_a_prism_base_up_before_one_eye(lens_of, side):
    wedge = lens_of(surfaces.plane(tilt=(0.05, 0.0)), surfaces.plane(), 6.0, index=1.5, side=side)
    assert wedge.thickness(0.0, 10.0) > wedge.thickness(0.0, -10.0)
    planos = plano_pair(lens_of)
    pair = replace(planos, right=wedge) if side == "R" else replace(planos, left=wedge)
    fixation = fixate(pair, pair.points([[0.0, 0.0, 1.0]], np.inf))
    prism = 100 * np.tan(np.arcsin(1.5 * np.sin(0.05)) - 0.05)
    assert fixation.vertical_imbalance()[0] == pytest.approx(prism if side == "R" else -prism, rel=2e-3)


@pytest.mark.parametrize(("out", "sign"), [(True, 1), (False, -1)])
def test_prisms_base_out_ask_for_convergence(lens_of, out, sign):
    wedges = [
        lens_of(
            surfaces.plane(tilt=(0.0, (1 if s == "R" else -1) * (0.05 if out else -0.05))),
            surfaces.plane(),
            6.0,
            index=1.5,
            side=s,
        )
        for s in "RL"
    ]
    assert (wedges[0].thickness(-10.0, 0.0) > wedges[0].thickness(10.0, 0.0)) == out
    pair = pair_of(*wedges)
    each = np.arcsin(1.5 * np.sin(0.05)) - 0.05
    induced = fixate(pair, pair.points([[0.0, 0.0, 1.0]], np.inf)).induced_vergence()[0]
    assert induced == pytest.approx(sign * 100 * np.tan(2 * each), rel=5e-3)


def test_anisometropes_look_down(lens_of):
    """Thin lenses: an object at the slope u is seen at the slope u / (1 - q F), q from the lens to the centre of rotation."""
    pair = pair_of(
        *(
            lens_of(surfaces.conic(p / 1200), surfaces.conic(-p / 1200), 0.5, index=N, side=s)
            for p, s in ((-1.0, "R"), (-4.0, "L"))
        )
    )
    u, q = -0.02, 0.0265
    fixation = fixate(pair, pair.points(direction_from_angles([0.0], [np.arctan(u)]), np.inf))
    seen = {s: np.arctan(u / (1 - q * p)) for p, s in ((-1.0, "R"), (-4.0, "L"))}
    assert fixation.vertical_imbalance()[0] == pytest.approx(100 * np.tan(seen["L"] - seen["R"]), rel=0.01)
    balance = fixation.balance()
    assert balance.mean_power_difference[0] == pytest.approx(3.0, abs=0.02)
    assert balance.magnification_difference[0] == pytest.approx((1 + q * 4) / (1 + q) - 1, abs=0.003)


@pytest.mark.parametrize("power", [-6.0, 0.0, 4.0])
def test_inset_of_the_line_of_sight(lens_of, power):
    """i = d / (1 + s (1/w - F)), s from the lens to the object, w from the centre of rotation to the lens (Prentice's rule)."""
    pair = pair_of(
        *(lens_of(surfaces.conic(power / 1200), surfaces.conic(-power / 1200), 0.5, index=N, side=s) for s in "RL")
    )
    s, w = 380.0, 26.5
    right, left = fixate(pair, [[0.0, 0.0, w + s]]).lens_points()
    for points, d in ((right, 30.0), (left, -33.0)):
        assert points[0] == pytest.approx([d / (1 + s * (1 / w - power / 1000)), 0.0], rel=0.015, abs=1e-9)


def test_conjugate_gazes_of_a_symmetrical_pair(lens_of, spline_arrays):
    right = lens_of(surfaces.bspline(*spline_arrays()), surfaces.toric(0.008, 0.011, 25.0), 4.0, side="R")
    wearer = Wearer(Eye(power_matrix(-1.0, -1.5, 25.0)), Wear(13.0, 0.15, 0.09, (1.5, -2.5)))
    pair = Pair(right, mirrored(right), wearer, mirrored_wearer(wearer))
    middle = [[0.0, -150.0, 380.0], [0.0, 60.0, 2000.0]]
    balance = fixate(pair, middle).balance()
    for name in ("vertical_imbalance", "mean_power_difference", "magnification_difference"):
        assert getattr(balance, name) == pytest.approx(np.zeros(2), abs=1e-8)
    here, there = (fixate(pair, [[x, -100.0, 400.0]]).balance() for x in (90.0, -90.0))
    assert here.vertical_imbalance == pytest.approx(-there.vertical_imbalance, abs=1e-8)
    assert here.mean_power_difference == pytest.approx(-there.mean_power_difference, abs=1e-8)
    assert here.induced_vergence == pytest.approx(there.induced_vergence, abs=1e-8)
    assert here.cyclo_difference == pytest.approx(there.cyclo_difference, abs=1e-10)
    assert abs(here.vertical_imbalance[0]) > 0.01


def test_a_pair_has_a_right_and_a_left_lens(lens_of):
    pair = plano_pair(lens_of)
    with pytest.raises(ValueError, match="side R"):
        Pair(pair.left, pair.right, pair.left_wearer, pair.right_wearer)


def test_a_point_past_the_edge_of_one_lens_is_not_fixated(lens_of):
    pair = plano_pair(lens_of)
    small = replace(
        pair, left=replace(pair.left, outline=polygon_outline([[20, 20], [-20, 20], [-20, -20], [20, -20]]))
    )
    fixation = fixate(small, [[0.0, 0.0, 400.0], [700.0, 0.0, 400.0]])
    assert fixation.status[0] == 0 != fixation.status[1]
    assert np.isnan(fixation.balance()).any(axis=0).tolist() == [False, True]


# -- torsion -----------------------------------------------------------------------------------------------------------


@given(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6))
def test_listings_law_in_helmholtz_angles(azimuth, elevation):
    direction = np.array([[np.sin(azimuth), np.cos(azimuth) * np.sin(elevation), np.cos(azimuth) * np.cos(elevation)]])
    back = helmholtz_angles(direction)
    assert (back[0][0], back[1][0]) == pytest.approx((azimuth, elevation), abs=1e-12)
    half = np.tan(azimuth / 2) * np.tan(elevation / 2)
    assert np.tan(listing_torsion(direction)[0] / 2) == pytest.approx(half, abs=1e-12)


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-0.1, 0.1))
def test_the_turned_plane_holds_the_rotation_vectors(azimuth, elevation, turn):
    """By scipy's rotations: the turn from straight ahead into the eye's position is about an axis of the turned plane."""
    direction = direction_from_angles([azimuth], [elevation])
    torsion = listing_torsion(direction, turn)[0]
    a, e = helmholtz_angles(direction)
    helmholtz = Rotation.from_euler("XYZ", [-e[0], a[0], torsion])
    assert helmholtz.apply([0, 0, 1]) == pytest.approx(direction[0], abs=1e-12)
    across = np.array([np.sin(turn), 0.0, np.cos(turn)])
    axis = helmholtz.as_rotvec()
    assert axis @ across == pytest.approx(0, abs=1e-9)


def test_with_a_quarter_of_the_convergence_the_meridians_stay_level(lens_of):
    fixation = fixate(plano_pair(lens_of), [[0.0, -200.0, 350.0]])
    plain, turned = fixation.cyclo_difference()[0], fixation.cyclo_difference(0.25)[0]
    assert plain < np.radians(-1)
    assert abs(turned) < 0.02 * abs(plain)
