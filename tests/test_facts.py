"""What is said of a lens and a wearer in words and numbers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lensbench as lb
from lensbench.optics import surfaces
from lensbench.optics.lens import Lens, Order, Points, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.report.facts import lens_facts, misfit, prescription_text, wearer_facts
from lensbench.workbench import assumed_wearer

SAMPLES = Path(__file__).parent.parent / "sample_lenses"


def facts_of(lens):
    return {fact.label: fact for fact in lens_facts(lens)}


def test_a_plano_disc():
    """Weight pi r^2 t rho of a 50 mm disc of CR-39, 2 mm thick: 5.18 g."""
    facts = facts_of(Lens(surfaces.plane(), surfaces.plane(), 2.0, MATERIALS["CR-39"], circle_outline(50.0)))
    assert facts["Weight"].value == pytest.approx(np.pi * 25**2 * 2 * 1.32 / 1000, rel=1e-9)
    assert facts["Weight"].text == "5.2 g"
    assert facts["Maximum edge thickness"].value == pytest.approx(2.0)
    assert facts["Front surface"].text.startswith("plane; surface power +0.00 D")


def test_edges_and_base_curve_of_a_minus_lens():
    lens = lb.load_lens(SAMPLES / "sphere_minus_4_R.toml")
    sag = [r - np.sqrt(r**2 - 32.5**2) for r in (1 / lens.front.p[0], 1 / lens.back.p[0])]
    facts = facts_of(replace(lens, outline=circle_outline(65.0, (2.0, 0.0))))
    near, far = (
        2.0 - sum(s * (r - np.sqrt(r**2 - at**2)) for s, r in ((1, 1 / lens.front.p[0]), (-1, 1 / lens.back.p[0])))
        for at in (30.5, 34.5)
    )
    assert facts["Minimum edge thickness"].value["mm"] == pytest.approx(near, abs=1e-6)
    assert facts["Maximum edge thickness"].value == pytest.approx(far, abs=1e-6)
    assert facts_of(lens)["Maximum edge thickness"].value == pytest.approx(2.0 - sag[0] + sag[1], abs=1e-9)
    assert facts["Front surface"].value["mean_surface_power_D"] == pytest.approx(498 * lens.front.p[0])
    assert facts["Back surface"].value["mean_surface_power_D"] == pytest.approx(-498 * lens.back.p[0])


def test_pose_and_constants_are_said():
    back = surfaces.conic(0.01, -0.5, [1e-7], tilt=(0.0, np.radians(2.0)), decentration=(1.0, -2.0))
    text = facts_of(Lens(surfaces.plane(), back, 2.0, MATERIALS["CR-39"], circle_outline(20)))["Back surface"].text
    for words in ("radius 100 mm", "conic constant -0.5", "a4 = 1e-07", "decentred by 1, -2 mm", "tilted by 0, 2 deg"):
        assert words in text


@pytest.mark.parametrize(
    ("power", "text"),
    [
        ((-1.25, 0.0, 0.0), "-1.25"),
        ((-0.001, 0.0, 0.0), "+0.00"),
        ((1.0, -0.5, 0.3), "+1.00 / -0.50 x 180"),
        ((0.0, 1.0, 20.0), "+1.00 / -1.00 x 110"),
    ],
)
def test_prescriptions_as_written(power, text):
    assert prescription_text(Order(*power).power()) == text


def test_everything_that_matters_of_the_wearer_is_said():
    text = " ".join(f"{f.label}: {f.text};" for f in wearer_facts(lb.load_wearer(SAMPLES / "young_astigmat.toml")))
    for words in (
        "-2.00 / -1.50 x 20 D, 13 mm",
        "11.90 D",
        "2.86 mm",
        "Pantoscopic angle: 8.0°",
        "Face-form angle: 5.0°",
    ):
        assert words in text
    assert "pupillary distance: 32 mm" in text


def test_angles_and_abbe_numbers_say_which_they_are():
    wear = lb.Wear(pantoscopic_angle=np.radians(8.0), face_form_angle=np.radians(15.0))
    (panto,) = (fact for fact in wearer_facts(lb.Wearer(wear=wear)) if fact.label == "Pantoscopic angle")
    assert panto.text == "8.0° against the horizontal plane, 8.28° in the vertical plane"
    assert panto.value == pytest.approx(8.0)
    assert "V_d = 41" in facts_of(lb.load_lens(SAMPLES / "regular_R.toml"))["Material"].text


def test_a_wearer_who_does_not_fit_the_order():
    lens = lb.load_lens(SAMPLES / "wide_near_R.toml")
    assert misfit(lens, assumed_wearer(lens)) == ""
    assert "-3.00 / -1.00 x 30" in misfit(lens, lb.load_wearer(SAMPLES / "paper_eye.toml"))
    assert misfit(replace(lens, ordered=None, points=Points()), lb.Wearer()) == ""
