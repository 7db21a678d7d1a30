"""Job files: written here after the standard's grammar, with a surface file made of a known surface."""

import contextlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lensbench as lb
from lensbench.errors import InputError
from lensbench.formats import load_pair, read_file
from lensbench.formats.registry import Contents
from lensbench.formats.surface_data import Fitted, Reading
from lensbench.formats.vca_records import Records
from lensbench.optics import surfaces
from lensbench.optics.mirror import mirrored

ORDER = {
    "DO": "B", "JOB": "1001", "SPH": "-1.50;-1.25", "CYL": "-0.75;-0.50", "AX": "10;170", "ADD": "2.00;2.00",
    "PRVM": "0.5;0.5", "PRVA": "90;270", "LIND": "1.592", "LMATTYPE": "5", "CTHICK": "3.0;3.0", "FRNT": "119.6",
    "BVD": "12.5", "PANTO": "7", "ZTILT": "4;4", "IPD": "31.5;32.5", "SEGHT": "18;18", "HBOX": "50;50",
    "VBOX": "32;32", "DBL": "18", "BCSGUP": "4;4", "ERDRUP": "8;8", "ERNRUP": "-12;-12", "ERNRIN": "2.5;2.5",
    "LDPATH": r"C:\LDS\OUT\1001.SDF", "_PRIVATE": "x",
}  # fmt: skip
X, Y = np.meshgrid(np.linspace(-20, 20, 11), np.linspace(-14, 14, 9))


def back_depth(x, y, nasal):
    """Depth of a back surface with a near zone below, inset towards the nose."""
    return (x**2 + y**2) / 240 + 0.4 * np.exp(-((x - nasal * 2.5) ** 2 + (y + 14) ** 2) / 200)


def surface_text(sides="RL", n=61, half=30.0):
    g = np.linspace(-half, half, n)
    x, y = np.meshgrid(g, g[::-1])
    blocks = []
    for side in sides:
        z = back_depth(x, y, 1 if side == "R" else -1)
        rows = "".join("ZZ=" + ";".join(f"{v:.6f}" for v in row) + "\r\n" for row in z)
        blocks.append(f"SURFMT=1;{side};B;{n};{n};{2 * half:g};{2 * half:g};0\r\n{rows}")
    return "".join(blocks)


def trace_text(side="R", radii=None, angles=None, name="TRCFMT", more=""):
    values = np.full(72, 24.0) if radii is None else radii
    rows = [";".join(str(round(100 * v)) for v in part) for part in np.array_split(values, len(values) // 10 + 1)]
    spacing = "E" if angles is None else "U"
    head = f"{name}=1;{len(values)};{spacing};{side};F\r\n" + "".join(f"R={row}\r\n" for row in rows)
    return head + ("" if angles is None else "A=" + ";".join(str(round(100 * a)) for a in angles) + "\r\n") + more


def job(folder, changes=(), more="", surface=None, name="job.lms"):
    records = {**ORDER, **dict(changes)}
    text = "".join(f"{label}={value}\r\n" for label, value in records.items() if value is not None)
    path = folder / name
    path.write_bytes((text + more).encode())
    if surface is not None:
        (folder / "1001.sdf").write_text(surface)
    return path


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    path = job(tmp_path_factory.mktemp("job"), more=trace_text("R") + trace_text("L"), surface=surface_text())
    return load_pair(path)


def test_a_pair_with_its_order_and_its_wearers(pair):
    (right, eye), (left, other) = pair
    assert (right.side, left.side) == ("R", "L")
    assert (right.ordered.sphere, right.ordered.cylinder, right.ordered.axis, right.ordered.addition) == (
        -1.5,
        -0.75,
        10,
        2,
    )
    assert (left.ordered.sphere, left.ordered.prism, left.ordered.prism_base) == (-1.25, 0.5, 270)
    assert right.material.name == "MR-8"
    assert right.index == 1.592
    assert right.centre_thickness == 3.0
    assert eye.wear.vertex_distance == 12.5
    assert np.degrees(eye.wear.pantoscopic_angle) == pytest.approx(7)
    assert np.degrees(other.wear.face_form_angle) == pytest.approx(4)
    assert (eye.wear.pupillary_distance, other.wear.pupillary_distance) == (31.5, 32.5)
    assert eye.prescription == pytest.approx(right.ordered.power(), abs=1e-12)


@pytest.mark.parametrize(
    ("records", "expected"),
    [
        ({}, None),
        ({"LDDRSPH": "-1.42;-1.20"}, (-1.42, -0.75, 10.0, 2.0, 0.5, 90.0)),
        ({"LDDRSPH": "-1.42", "LDDRCYL": "-0.68", "LDDRAX": "12", "LDADD": "1.87", "LDPRVM": "0.6", "LDPRVA": "95"},
         (-1.42, -0.68, 12.0, 1.87, 0.6, 95.0)),
        ({"LDDRSPH": "-1.50", "LDNRSPH": "0.25"}, (-1.5, -0.75, 10.0, 1.75, 0.5, 90.0)),
    ],
    ids=["none", "the rest as ordered", "all", "near less distance"],
)  # fmt: skip
def test_the_powers_to_verify_are_the_lenses(tmp_path, records, expected):
    lens, _ = load_pair(job(tmp_path, records, surface=surface_text()))[0]
    found = lens.verification_power
    if expected is None:
        assert found is None
        return
    assert (found.sphere, found.cylinder, found.axis, found.addition, found.prism, found.prism_base) == pytest.approx(
        expected
    )
    assert lens.expected_by_focimeter is found
    assert lens.ordered.sphere == -1.5


def test_the_lens_is_the_surface_file_and_the_front_curve(pair):
    for (lens, _), nasal in zip(pair, (1, -1), strict=True):
        assert lens.front.describe() == "sphere, radius 119.6 mm"
        depth = back_depth(X, Y, nasal)
        assert lens.back.sag(X, Y) - lens.back.sag(0, 0) == pytest.approx(back_depth(0, 0, nasal) - depth, abs=2e-6)


def test_points_and_boxing_centre(pair):
    (right, _), (left, _) = pair
    assert right.points.named()["near_reference_point"] == (2.5, -12)
    assert left.points.named()["near_reference_point"] == (-2.5, -12)
    # the right eye lies (50 + 18) / 2 - 31.5 = 2.5 mm towards the nose (+x) of the boxing centre and 18 - 16 = 2 mm above
    assert right.outline.centre == pytest.approx((-2.5, 4 - 2))
    assert left.outline.centre == pytest.approx((1.5, 4 - 2))
    assert right.outline.radius(0.3) == pytest.approx(24, abs=0.03)


def test_the_left_lens_of_a_symmetric_job_is_the_mirrored_right_one(tmp_path):
    same = {
        label: value.partition(";")[0] for label, value in ORDER.items() if ";" in value and label not in ("AX", "PRVA")
    }
    radii = 20 + 4 * np.cos(np.radians(5 * np.arange(72)) - 0.4)
    same |= {"AX": "10;170", "PRVA": "30;150"}
    (right, _), (left, _) = load_pair(job(tmp_path, same.items(), trace_text("R", radii), surface_text()))
    other = mirrored(right)
    assert left.ordered == other.ordered or vars_of(left.ordered) == pytest.approx(vars_of(other.ordered))
    angle = np.linspace(0, 2 * np.pi, 100)
    assert left.outline.radius(angle) == pytest.approx(other.outline.radius(angle), abs=1e-9)
    assert left.thickness(X / 2, Y / 2) == pytest.approx(other.thickness(X / 2, Y / 2), abs=1e-6)


def vars_of(order):
    return [order.sphere, order.cylinder, order.axis, order.addition, order.prism, order.prism_base]


def test_unequal_angles_and_edge_thickness(tmp_path):
    angles = np.sort(np.random.default_rng(1).uniform(0, 359.9, 90))
    plain = load_pair(job(tmp_path, surface=surface_text(), more=trace_text("R", np.full(90, 21.0), angles)))[0][0]
    assert plain.outline.radius(np.radians(angles)) == pytest.approx(21, abs=0.011)
    at = np.radians(5.0 * np.arange(72))
    cx, cy = plain.outline.centre
    edge = plain.thickness(cx + 20 * np.cos(at), cy + 20 * np.sin(at))
    thick = "T=" + ";".join(str(round(100 * t)) for t in edge) + "\r\n"
    more = trace_text("R", np.full(90, 21.0), angles) + trace_text("R", np.full(72, 20.0), name="STHKFMT", more=thick)
    facts = {label: value for label, _, value in read_file(job(tmp_path, more=more)).items[0].facts()}
    assert facts["Edge thickness (right)"] < 0.006  # half of the last digit, 0.01 mm


@pytest.mark.parametrize(
    ("front", "tooling", "radius"),
    [("5.00", None, 106.0), ("5.00", "1.498", 99.6), ("25", None, 21.2), ("25.01", None, 25.01), ("-90", None, -90)],
)
def test_front_curves_in_dioptres_and_mm(tmp_path, front, tooling, radius):
    changes = {"FRNT": front, "TIND": tooling, "CTHICK": "9", "DIA": "20", "SEGHT": None, "DO": "R"}
    lens, _ = load_pair(job(tmp_path, changes.items(), surface=surface_text()))[0]
    assert 1 / lens.front.p[0] == pytest.approx(radius)


def test_the_back_curve_is_concave_whatever_its_sign(tmp_path):
    text = surface_text("R").replace(";B;", ";F;")
    for back in ("-6.0", "6.0", "88.333333", "-88.333333"):
        changes = {"FRNT": None, "BACK": back, "DO": "R", "DIA": "40"}
        lens, _ = load_pair(job(tmp_path, changes.items(), surface=text))[0]
        assert 1 / lens.back.p[0] == pytest.approx(530 / 6)


def test_a_surface_within_the_job_itself(tmp_path):
    path = job(tmp_path, more=surface_text("R"), name="all.oma")
    assert [lens.side for lens, _ in load_pair(path)] == ["R"]
    assert read_file(path).format.name == "VCA job"


def test_an_order_alone_is_a_wearer_and_says_why_it_is_no_lens(tmp_path):
    path = job(tmp_path)
    assert lb.load_wearer(path, "L").wear.pupillary_distance == 32.5
    with pytest.raises(InputError, match="does not lie beside"):
        lb.load_lens(path)
    assert any("1001.SDF" in text for _, text, _ in read_file(path).items[0].facts())


class Undecided:
    """A surface of which somebody has to say how it lies."""

    source, side, face = "1001.sdf", "R", "B"

    def fitted(self, reading):
        if reading.first_point is None:
            raise InputError("1001.sdf: say --orientation")
        return Fitted(surfaces.sphere(120.0), ())


def test_a_surface_that_does_not_tell_how_it_lies_asks_for_it(tmp_path, monkeypatch):
    path = job(tmp_path, surface=surface_text("R"))
    monkeypatch.setattr("lensbench.formats.vca_job.read_file", lambda _: Contents(path, None, (Undecided(),)))
    found = read_file(path).items[0]
    assert any("say --orientation" in text for _, text, _ in found.facts())
    with pytest.raises(InputError, match=r"right lens: 1001\.sdf: say --orientation"):
        found.lens()
    assert found.lens(told=Reading(first_point="top-left")).back.describe() == "sphere, radius 120 mm"
    assert found.wearer("R").wear.pupillary_distance == 31.5


def test_a_material_can_be_put_in_its_place_and_a_side_chosen(tmp_path):
    path = job(tmp_path, surface=surface_text())
    lens = lb.load_lens(path, side="L", material="MR-174")
    assert (lens.side, lens.material.name) == ("L", "MR-174")


@given(st.lists(st.sampled_from(["R", "L"]), min_size=1, max_size=1), st.sampled_from(["", "?", " "]))
def test_blanks_and_question_marks_say_nothing(tmp_path_factory, side, blank):
    path = tmp_path_factory.mktemp("blank") / "job.lds"
    values = (f"{blank};-2.5", f"-2.5;{blank}")[side[0] == "L"]
    path.write_text(f"JOB=1\nDO=B\nSPH={values}\n")
    assert Records(path).number("SPH", side[0], -40, 40) is None
    assert Records(path).number("SPH", "L" if side[0] == "R" else "R", -40, 40) == -2.5


BAD = [
    ({"SPH": "abc;0"}, "", "line 3: SPH: 'abc' is not a number"),
    ({"SPH": "-1,50;0"}, "", "write a decimal point"),
    ({"SPH": "99;0"}, "", "line 3: SPH: 99 is outside -40 to 40"),
    ({"AX": "nan;0"}, "", "AX: nan is outside 0 to 180"),
    ({"DO": "X"}, "", "DO: 'X' is none of R, L and B"),
    ({"LIND": None}, "", "LIND (right): the index"),
    ({"CTHICK": None}, "", "CTHICK (right): the centre thickness is missing"),
    ({"FRNT": "60", "CTHICK": "1;3"}, "", "must be more than"),
    ({"FRNT": None}, "", "FRNT (right): the front is neither"),
    ({"DIA": "90"}, "", "does not reach the outline"),
    ({}, "TRCFMT=4;400;E;R;F\r\n", "format '4' (packed binary) is not read"),
    ({}, "TRCFMT=1;1000000000;E;R;F\r\n", "a shape has 8 to 10000"),
    ({}, "TRCFMT=1;72;X;R;F\r\n", "needs 1;count;E or U"),
    ({}, "TRCFMT=1;72;E;R;F\r\nR=2400;2400\r\n", "announces 72 values, but R= has 2"),
    ({}, "TRCFMT=1;8;E;R;F\r\nR=1;2;x;4;5;6;7;8\r\n", "R: 'x' is not a whole number"),
    ({}, "TRCFMT=1;8;E;R;F\r\nR=24;24;24;24;24;24;24;24\r\n", "0.01 mm"),
    ({}, "TRCFMT=1;8;U;R;F\r\nR=" + ";".join(["2400"] * 8) + "\r\nA=" + ";".join(["9"] * 8) + "\r\n", "must rise"),
]


@pytest.mark.parametrize(("changes", "more", "words"), BAD)
def test_bad_jobs_say_so(tmp_path, changes, more, words):
    path = job(tmp_path, changes.items(), more, surface_text())
    with pytest.raises(InputError) as failure:
        load_pair(path)
    assert words in str(failure.value)
    assert str(failure.value).startswith(str(path))


@given(st.binary(max_size=300), st.integers(0, 600))
def test_no_rubbish_gets_past_the_reader(tmp_path_factory, rubbish, at):
    folder = tmp_path_factory.mktemp("fuzz")
    path = job(folder, more=trace_text("R"), surface=surface_text(n=9))
    data = path.read_bytes()
    path.write_bytes(data[:at] + rubbish + data[at:])
    with contextlib.suppress(InputError):
        read_file(path)
