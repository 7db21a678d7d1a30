"""A lens against its order or its verification power: by focimeter, with the tolerances of ANSI Z80.1."""

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

import lensbench as lb
from lensbench.cli import main
from lensbench.layers import PointsLayer, Request, VerificationLayer
from lensbench.optics.compensation import verification_power
from lensbench.optics.conventions import power_matrix
from lensbench.optics.lens import Order
from lensbench.optics.tolerances import power_lines
from lensbench.report.verification import row_of, sentences
from lensbench.session import LensOnTable
from lensbench.workbench import assumed_wearer, run

ANSI_2015, ANSI_2010 = lb.load_tolerances(), lb.load_tolerances("ANSI Z80.1-2010")
SAMPLES = Path(__file__).parent.parent / "sample_lenses"


def lines_of(lens):
    return {line.name: line for line in verified(lens).lines}


def verified(lens):
    return run(Request(lens, assumed_wearer(lens), VerificationLayer()))


@pytest.fixture(scope="module")
def toric():
    return lb.load_lens(SAMPLES / "toric_R.toml")


@pytest.fixture(scope="module")
def progressive():
    return lb.load_lens(SAMPLES / "regular_R.toml")


def test_a_lens_made_to_its_order_is_within(toric):
    lines = lines_of(toric)
    assert list(lines) == ["sphere", "cylinder", "axis", "prism"]
    assert all(line.within and line.excess == 0 for line in lines.values())
    sphere = lines["sphere"]
    assert (sphere.expected, sphere.measured, sphere.tolerance) == pytest.approx((-2.0, -2.0, 0.13), abs=1e-4)


@pytest.mark.parametrize(
    ("order", "found", "name", "tolerance", "excess"),
    [
        (Order(-3.0), (-3.20, 0, 180), "sphere", 0.13, 0.07),
        (Order(-8.0), (-8.20, 0, 180), "sphere", 0.16, 0.04),
        (Order(-8.0, addition=2.0), (-8.10, 0, 180), "sphere", 0.16, 0.0),
        (Order(-6.0, -2.0), (-6.15, -2.0, 180), "sphere", 0.13, 0.02),
        (Order(-8.0, 2.0, 90.0), (-6.15, -2.0, 180), "sphere", 0.13, 0.02),
        (Order(-7.0, -2.0), (-7.0, -2.3, 180), "sphere", 0.14, 0.0),
        (Order(1.0, -3.0), (1.0, -3.2, 180), "cylinder", 0.15, 0.05),
        (Order(1.0, -5.0), (1.0, -5.1, 180), "cylinder", 0.20, 0.0),
        (Order(1.0, -5.0, addition=1.0), (1.0, -5.3, 180), "cylinder", 0.25, 0.05),
        (Order(1.0, -0.5, 90.0), (1.0, -0.5, 100.0), "axis", 7.0, 3.0),
        (Order(1.0, -2.0, 180.0), (1.0, -2.0, 2.5), "axis", 2.0, 0.5),
        (Order(1.0, -2.0, 1.0), (1.0, -2.0, 180.0), "axis", 2.0, 0.0),
    ],
)
def test_tolerances(order, found, name, tolerance, excess):
    line = {line.name: line for line in power_lines(ANSI_2015, order, power_matrix(*found))}[name]
    assert line.tolerance == pytest.approx(tolerance)
    assert line.excess == pytest.approx(excess, abs=1e-9)
    assert line.within == (excess == 0)


@pytest.mark.parametrize(
    ("order", "found", "tolerance", "excess"),
    [
        (Order(-6.0, -2.0), (-6.15, -2.0, 180), 0.16, 0.0),
        (Order(-6.0, -1.0), (-6.0, -1.2, 180), 0.14, 0.06),
        (Order(3.0, -1.0), (3.2, -1.0, 180), 0.13, 0.07),
    ],
)
def test_the_edition_of_2010_judges_the_meridian_of_highest_power(order, found, tolerance, excess):
    line = power_lines(ANSI_2010, order, power_matrix(*found))[0]
    assert line.name == "power in the meridian of highest power"
    assert line.tolerance == pytest.approx(tolerance)
    assert line.excess == pytest.approx(excess, abs=1e-9)


def test_a_weak_cylinder_has_no_axis_to_hold():
    assert "axis" not in {line.name for line in power_lines(ANSI_2015, Order(1.0, -0.1), power_matrix(1.0, -0.1, 40.0))}


def test_addition_is_read_on_the_surface_that_holds_it(progressive):
    """Both samples hold the same progression, one on the front and one on the back."""
    front = lines_of(progressive)["addition"]
    back = lines_of(lb.load_lens(SAMPLES / "back_progressive_R.toml"))["addition"]
    surface = np.diff(
        [progressive.front.surface_power(x, y, progressive.index).trace() / 2 for x, y in ((0.0, 8.0), (2.5, -12.0))]
    )
    assert front.measured == pytest.approx(surface[0], abs=0.02)
    assert back.measured == pytest.approx(front.measured, abs=0.03)


def test_prism_is_held_against_the_order_by_focimeter(progressive):
    """The order names the prism that the focimeter shows, whatever pantoscopic angle the lens is worn at."""
    lens = replace(progressive, ordered=replace(progressive.ordered, prism=1.54, prism_base=275.0))
    tilted = lb.Wearer(wear=lb.Wear(pantoscopic_angle=0.3))
    for wearer in (lb.Wearer(), tilted):
        reading = {r.name: r for r in run(Request(lens, wearer, PointsLayer()))}["prism_reference_point"]
        assert (reading.lensmeter_prism, reading.lensmeter_prism_base) == pytest.approx((1.546, 275.1), abs=0.05)
        assert reading.prism_error < 0.02
    assert lines_of(lens)["prism"].within
    unordered = replace(progressive, ordered=replace(progressive.ordered, prism=0.0))
    off = lines_of(unordered)["prism"]
    assert not off.within
    assert off.excess == pytest.approx(1.546 - 0.33, abs=0.01)


@pytest.mark.parametrize("path", sorted(SAMPLES.glob("*_R.toml")), ids=lambda path: path.stem)
def test_the_samples_are_as_ordered(path):
    found = verified(lb.load_lens(path))
    assert [line.name for line in found.lines if not line.within] == []
    assert found.remarks == ()


def test_the_verb_prints_a_line_each(capsys):
    assert main(["verify", str(SAMPLES / "wide_near_R.toml")]) == 0
    text = capsys.readouterr().out.splitlines()
    assert text[4].split() == ["addition", "(D)", "2.00", "1.89", "-0.11", "0.12", "within"]
    assert "Judged by ANSI Z80.1-2015 against the order: -3.00 / -1.00 x 30 D" in text[7]
    assert main(["verify", str(SAMPLES / "toric_R.toml"), "--json", "--tolerances", "ansi z80.1-2010"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["edition"] == "ANSI Z80.1-2010"
    assert found["lines"][0]["name"] == "power in the meridian of highest power"
    assert found["lines"][2]["unit"] == "deg"


def test_prism_is_shown_with_its_base_so_that_the_difference_can_be_followed(progressive):
    line = lines_of(progressive)["prism"]
    wanted, found, off = (
        size * np.array([np.cos(np.radians(base)), np.sin(np.radians(base))])
        for size, base in zip((line.expected, line.measured, line.deviation), line.bases, strict=True)
    )
    assert found - wanted == pytest.approx(off, abs=1e-12)
    assert row_of(line)[2:5] == ("1.50 base 270°", "1.55 base 275°", "0.14 base 344°")


def test_numbers_of_a_line_as_text():
    axis = power_lines(ANSI_2015, Order(1.0, -2.0, 174.4), power_matrix(1.0, -2.004, 175.0))
    assert row_of(axis[1])[2:] == ("-2.00", "-2.00", "+0.00", "0.13", "within")
    assert row_of(axis[2])[1:] == ("°", "174.4", "175.0", "+0.6", "2.0", "within")
    assert row_of(replace(axis[1], within=False, excess=np.nan)).verdict == "no reading"


def test_an_addition_that_cannot_be_read_is_said(progressive):
    points = replace(progressive.points, near_reference_point=None, distance_reference_point=None, near_inset=None)
    found = verified(replace(progressive, points=points))
    assert "addition" not in {line.name for line in found.lines}
    said = " ".join(sentences(found))
    assert "Addition 2.00 D not read: no near reference point is named." in said
    assert "power read at the prism reference point" in said


def test_a_lens_that_is_right_as_worn_is_held_against_its_verification_power(toric):
    """The order -6.00 / -2.00 x 170 at 12 degrees pantoscopic and 8 degrees face form angle."""
    order = Order(-6.0, -2.0, 170.0)
    wearer = lb.Wearer(wear=lb.Wear(13.0, np.radians(12.0), np.radians(8.0)))
    made = verification_power(toric, wearer, order).lens
    by_order = lb.verification(replace(made, verification_power=None), ANSI_2015)
    assert {line.name for line in by_order.lines if not line.within} == {"sphere", "cylinder", "axis"}
    assert not by_order.by_verification_power
    found = run(Request(made, wearer, VerificationLayer()))
    assert found.by_verification_power
    assert all(line.within and abs(line.deviation) < 1e-6 for line in found.lines)
    assert found.compensated.power() == pytest.approx(made.verification_power.power(), abs=1e-8)
    assert sentences(found)[0].startswith(
        "Judged by ANSI Z80.1-2015 against the verification power of its file: -5.81 / -1.64 x 174 D"
    )


def test_compensate_writes_a_lens_that_verifies(capsys, tmp_path):
    wearer, made = tmp_path / "wearer.toml", tmp_path / "made.toml"
    wear = "[wear]\npantoscopic_angle = 12\nface_form_angle = 8\n"
    wearer.write_text(f'format = "lensbench-wearer/1"\nage = 30\n[eye]\npupil_diameter = 4\n{wear}', encoding="utf-8")
    call = ["compensate", str(SAMPLES / "toric_R.toml"), "-w", str(wearer)]
    assert main([*call, "--ordered", "-6", "-2", "170", "-o", str(made)]) == 0
    assert main(["verify", str(made), "-w", str(wearer), "--json"]) == 0
    found = json.loads(capsys.readouterr().out.partition("\n")[2])
    assert found["by_verification_power"]
    assert all(line["within"] for line in found["lines"])
    assert [found["compensated"][name] for name in ("sphere", "cylinder", "axis")] == pytest.approx(
        [-5.813, -1.644, 174.37], abs=0.005
    )
    assert main([*call, "--verification", "-5.8128", "-1.6438", "174.366"]) == 0
    assert "as worn             -6.00 / -2.00 x 170 D" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--ordered", "-60", "0", "0"], "sphere: -60 is not from -40 to 40"),
        (["--addition", "9"], "addition: 9 is not from 0 to 5"),
        (["-o", "lens.step"], "cannot write .step"),
    ],
)
def test_compensate_refuses(options, words, capsys):
    assert main(["compensate", str(SAMPLES / "toric_R.toml"), *options]) == 2
    assert words in capsys.readouterr().err


def test_the_verification_power_travels_with_the_lens(toric, tmp_path):
    lens = replace(toric, verification_power=Order(-1.9, -1.4, 22.0, prism=0.5, prism_base=10.0))
    lb.write(tmp_path / "lens.toml", lens)
    assert asdict(lb.load_lens(tmp_path / "lens.toml").verification_power) == asdict(lens.verification_power)
    assert lb.mirrored(lens).verification_power.axis == 158.0


def test_what_a_verification_table_leaves_out_is_as_ordered(tmp_path):
    path = tmp_path / "lens.toml"
    text = (SAMPLES / "toric_R.toml").read_text(encoding="utf-8")
    path.write_text(f"{text}\n[verification]\nsphere = -1.9\naxis = 22.0\n", encoding="utf-8")
    assert asdict(lb.load_lens(path).verification_power) == {
        **asdict(lb.load_lens(SAMPLES / "toric_R.toml").ordered), "sphere": -1.9, "axis": 22.0
    }  # fmt: skip


def test_another_order_in_the_window_has_another_verification_power(toric):
    lens = replace(toric, verification_power=Order(-1.9, -1.4, 22.0))
    on_table = LensOnTable(Path("lens.toml"), lens, lens)
    assert on_table.edited(centre_thickness=2.0).lens.verification_power is lens.verification_power
    assert on_table.edited(ordered=Order(-3.0)).lens.verification_power is None


def test_nothing_to_verify(tmp_path, capsys):
    path = tmp_path / "lens.toml"
    path.write_text((SAMPLES / "toric_R.toml").read_text(encoding="utf-8").split("[ordered]")[0], encoding="utf-8")
    assert main(["verify", str(path)]) == 2
    assert "holds no order" in capsys.readouterr().err


def test_without_an_order_there_is_nothing_to_verify(toric):
    assert verified(replace(toric, ordered=None)) is None


def test_where_no_ray_passes_the_verdict_is_not_within(toric):
    points = replace(toric.points, distance_reference_point=(500.0, 0.0))
    line = lines_of(replace(toric, points=points))["cylinder"]
    assert np.isnan(line.measured)
    assert not line.within
