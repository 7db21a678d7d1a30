"""Verification power: against a closed form for a thin tilted lens, against real rays, and both ways round."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lensbench as lb
from lensbench.errors import InputError
from lensbench.optics import surfaces
from lensbench.optics.compensation import power_as_worn, power_by_focimeter, power_worn, verification_power
from lensbench.optics.conventions import carry_vergence
from lensbench.optics.gaze import trace_rays
from lensbench.optics.lens import Lens, Order, Points, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.optics.ordered import wearer_as_ordered
from lensbench.readings import point_readings

SAMPLES = Path(__file__).parent.parent.parent / "sample_lenses"
ORDER = Order(-6.0, -2.0, 170.0)  # the order, the pantoscopic and the face-form angle of a lens that was failed wrongly
WEAR = lb.Wear(13.0, np.radians(12.0), np.radians(8.0))


def single_vision(back, thickness=2.0, side="R"):
    return Lens(surfaces.sphere(150.0), back, thickness, MATERIALS["MR-8"], circle_outline(40), side, "d")


def thin_lens_power(ordered, wear, side, index):
    """Power of a thin lens that gives the ordered power as worn, by the generalised Coddington equations.

    With C = diag(cos i, 1) in the plane of incidence and across it: C W C = (n cos i' - cos i) / (n - 1) P.
    """
    turn = wear.rotation(side)
    normal, ahead = turn[:, 2], turn[2]
    cos = normal[2]
    cos_inside = np.sqrt(1 - (1 - cos**2) / index**2)
    worn_basis, lens_basis = (
        np.stack([t, [-t[1], t[0]]], axis=1)
        for t in (normal[:2] / np.hypot(*normal[:2]), -ahead[:2] / np.hypot(*ahead[:2]))
    )
    squeezed = np.diag([cos, 1.0])
    power = squeezed @ worn_basis.T @ ordered.power() @ worn_basis @ squeezed * (index - 1) / (index * cos_inside - cos)
    return lens_basis @ power @ lens_basis.T


@pytest.mark.parametrize("side", ["R", "L"])
@pytest.mark.parametrize("order", [ORDER, Order(4.0, -1.0, 30.0), Order(-3.0)])
def test_a_thin_lens_follows_coddington(side, order):
    lens = single_vision(surfaces.sphere(100.0), 1e-6, side)
    found = verification_power(lens, wearer_as_ordered(order, WEAR), order)
    expected = thin_lens_power(order, WEAR, side, lens.index)
    assert found.verification_power.power() == pytest.approx(expected, abs=1e-5)
    assert np.abs(expected - order.power()).max() > 0.1


@pytest.mark.parametrize(
    "back",
    [
        surfaces.sphere(100.0),
        surfaces.plane(),
        surfaces.toric(0.010, 0.012, 40.0),
        surfaces.biconic(0.010, 0.012, 40.0, -0.5, -0.8),
        surfaces.conic(0.010, -0.5, [1e-8]),
        surfaces.sphere(100.0, decentration=(1.0, 2.0), tilt=(0.01, -0.02)),
    ],
    ids=["sphere", "plane", "toric", "biconic", "asphere", "prism wedge"],
)
def test_the_lens_that_is_made_gives_the_order_by_real_rays(back):
    """Rays from the eye's side, aimed as light of the ordered vergence, leave the lens parallel."""
    found = verification_power(single_vision(back), wearer_as_ordered(ORDER, WEAR), ORDER)
    field = lb.look_through(found.lens, wearer_as_ordered(ORDER, WEAR), [0.0], [0.0])
    h = 0.05 * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
    frame, radius = field.gaze_frame[0], field.wearer.vertex_sphere_radius
    at_vertex = field.wearer.centre_of_rotation + (radius - 2.0) * frame[2]
    vergence = carry_vergence(ORDER.power(), 2.0) / 1000
    direction = np.column_stack([h @ vergence, np.ones(4)]) @ frame
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    out = trace_rays(found.lens, WEAR, at_vertex + h @ frame[:2], direction).direction
    left_over = 1000 * (out[::2] - out[1::2]) @ np.linalg.svd(field.direction)[2][1:].T / 0.1
    assert left_over == pytest.approx(0.0, abs=2e-4)
    assert power_by_focimeter(found.lens) == pytest.approx(found.verification_power.power(), abs=1e-9)


@pytest.mark.parametrize("path", sorted(SAMPLES.glob("*_R.toml")), ids=lambda path: path.stem)
def test_there_and_back(path):
    lens = lb.load_lens(path)
    wearer = wearer_as_ordered(lens.ordered, WEAR)
    there = verification_power(lens, wearer, lens.ordered)
    back = power_as_worn(lens, wearer, there.verification_power)
    assert back.as_worn.power() == pytest.approx(lens.ordered.power(), abs=1e-8)
    assert back.as_worn.addition == pytest.approx(lens.ordered.addition, abs=1e-8)
    assert power_worn(there.lens, wearer) == pytest.approx(lens.ordered.power(), abs=1e-8)


def test_the_addition_is_what_makes_near_right_as_worn():
    """The lens whose focimeter addition is the verification one is as much short of it by focimeter as of the order as worn."""
    lens = lb.load_lens(SAMPLES / "regular_R.toml")
    wearer = wearer_as_ordered(lens.ordered, WEAR)
    found = verification_power(lens, wearer, lens.ordered)
    readings = {r.name: r for r in point_readings(found.lens, wearer)}
    worn = readings["near_reference_point"].mean_power - readings["distance_reference_point"].mean_power
    line = {k.name: k for k in lb.verification(found.lens, lb.load_tolerances()).lines}["addition"]
    assert worn - lens.ordered.addition == pytest.approx(line.deviation, abs=1e-8)


def test_untilted_and_thin_nothing_is_to_be_compensated():
    lens = single_vision(surfaces.sphere(100.0), 1e-6)
    found = verification_power(lens, wearer_as_ordered(ORDER, lb.Wear()), ORDER)
    assert found.verification_power.power() == pytest.approx(ORDER.power(), abs=1e-6)


def test_a_lens_with_a_spline_on_its_back_keeps_its_progression():
    lens = lb.load_lens(SAMPLES / "back_progressive_R.toml")
    found = verification_power(lens, wearer_as_ordered(lens.ordered, WEAR), lens.ordered)
    x, y = np.array([0.0, 2.0, -9.0]), np.array([0.0, -12.0, 7.0])
    change = found.lens.back_height(x, y) - lens.back_height(x, y)
    added = -(power_by_focimeter(found.lens) - power_by_focimeter(lens)) / (1000 * (lens.index - 1))
    points = np.stack([x, y])
    assert change == pytest.approx(-np.einsum("in,ij,jn->n", points, added, points) / 2, abs=2e-3)
    assert change[0] == pytest.approx(0, abs=1e-12)
    assert np.abs(change).max() > 0.005


def test_a_decentred_asphere_still_reaches_the_edge():
    lens = single_vision(surfaces.conic(0.010, -0.5, [1e-8], decentration=(4.0, -3.0)))
    made = verification_power(lens, wearer_as_ordered(ORDER, WEAR), ORDER).lens
    assert np.isfinite(made.thickness(*lens.outline.points())).all()


def test_what_cannot_be_made_is_said():
    points = Points(distance_reference_point=(500.0, 0.0))
    lens = replace(single_vision(surfaces.sphere(100.0)), name="minute", points=points)
    with pytest.raises(InputError, match="minute: no back surface"):
        power_as_worn(lens, wearer_as_ordered(ORDER), ORDER)
