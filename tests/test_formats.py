"""Lens, wearer and surface files: what they mean, and one clear sentence for each way in which they can be wrong."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lensbench as lb
from lensbench.errors import InputError
from lensbench.formats import load
from lensbench.formats.point_grid import PointGrid
from lensbench.formats.sdf import read as read_sdf
from lensbench.formats.surface_data import Reading
from lensbench.optics.conventions import power_matrix
from lensbench.optics.lens import Points

SAMPLES = Path(__file__).parent.parent / "sample_lenses"

LENS = """
format = "lensbench-lens/1"
name = "test"
side = "R"
material = "CR-39"
centre_thickness = 2.0
outline = { shape = "circle", diameter = 60 }
[front]
type = "sphere"
radius = 120.0
[back]
type = "sphere"
radius = 100.0
"""

WEARER = """
format = "lensbench-wearer/1"
age = 45
[eye]
pupil_diameter = 4.0
"""


def write(folder: Path, text: str, name: str = "file.toml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def sdf_text(values: np.ndarray, width: float, height: float) -> str:
    rows = "".join("ZZ=" + ";".join(f"{v:.6f}" for v in row) + "\n" for row in values)
    return f"SURFMT=1;R;F;{values.shape[1]};{values.shape[0]};{width};{height};0\n{rows}"


def saddle(x, y):
    return x**2 / 200 + y**2 / 300 + x * y / 900 + x**3 / 9e5 - x**2 * y / 8e5


def test_every_sample_loads():
    for path in SAMPLES.glob("*.toml"):
        assert isinstance(load(path), lb.Lens | lb.Wearer)


def test_keys_become_the_lens(tmp_path):
    lens = lb.load_lens(write(tmp_path, LENS + "[ordered]\nsphere = -1.25\ncylinder = -0.5\naxis = 30\n"))
    assert (lens.side, lens.name, lens.centre_thickness, lens.index) == ("R", "test", 2.0, 1.5)
    assert lens.front.sag(30.0, 0.0) == pytest.approx(np.sqrt(120**2 - 30**2) - 120, abs=1e-12)
    assert lens.ordered.power() == pytest.approx(power_matrix(-1.25, -0.5, 30))
    assert lens.outline.box == pytest.approx((-30, 30, -30, 30), abs=1e-3)


@pytest.mark.parametrize(
    ("given_as", "radius"),
    [("radius = 88.0", 88.0), ("curvature = 0.01", 100.0), ("power = -6.0\nindex = 1.53", 1000 * 0.53 / 6)],
)
def test_three_ways_to_state_a_curvature(tmp_path, given_as, radius):
    lens = lb.load_lens(write(tmp_path, LENS.replace("radius = 100.0", given_as)))
    assert lens.back.p[0] == pytest.approx(1 / radius, rel=1e-14)


@pytest.mark.parametrize(
    ("surface", "depth_at_10_20"),
    [
        ('type = "plane"', 0.0),
        ('type = "conic"\nradius = 100\nconic_constant = -1.0\nasphere = [1e-7]', 500 / 200 + 1e-7 * 500**2),
        ('type = "toric"\naxis = 90\nradius = [100, 1e12]', 100 - np.sqrt(100**2 - 20**2)),
        ('type = "biconic"\naxis = 0\nradius = [100, 50]\nconic_constant = [-1, -1]', 100 / 200 + 400 / 100),
    ],
)
def test_surface_kinds(tmp_path, surface, depth_at_10_20):
    text = LENS.replace('type = "sphere"\nradius = 120.0', surface).replace(
        "centre_thickness = 2.0", "centre_thickness = 20.0"
    )
    lens = lb.load_lens(write(tmp_path, text))
    assert lens.front.sag(10.0, 20.0) == pytest.approx(-depth_at_10_20, abs=1e-9)


def test_bspline_surface(tmp_path):
    knots = [-40.0, -40.0, -40.0, 40.0, 40.0, 40.0]
    flat = f'type = "bspline"\ndegree = 2\nknots_x = {knots}\nknots_y = {knots}\ncoefficients = [[-8,8,-8],[-8,8,-8],[-8,8,-8]]'
    text = LENS.replace('type = "sphere"\nradius = 120.0', flat).replace(
        "centre_thickness = 2.0", "centre_thickness = 20.0"
    )
    lens = lb.load_lens(write(tmp_path, text))
    x = np.linspace(-30, 30, 7)
    t = (x + 40) / 80
    bernstein = -8 * (1 - t) ** 2 + 8 * 2 * t * (1 - t) - 8 * t**2
    assert lens.front.sag(x, 5.0) == pytest.approx(bernstein, abs=1e-12)


ORIENTATIONS = [
    (v, h, r, z)
    for v in ("top", "bottom")
    for h in ("left", "right")
    for r in ("horizontal", "vertical")
    for z in (1, -1)
]


@pytest.mark.parametrize(("vertical", "horizontal", "rows", "sign"), ORIENTATIONS)
def test_a_grid_means_the_same_in_every_orientation(vertical, horizontal, rows, sign):
    x, y = np.linspace(-20, 20, 21), np.linspace(-15, 15, 16)
    grid = sign * np.round(saddle(*np.meshgrid(x, y)), 6)
    grid = grid[::-1] if vertical == "top" else grid
    grid = grid[:, ::-1] if horizontal == "right" else grid
    width, height = (40.0, 30.0) if rows == "horizontal" else (30.0, 40.0)
    grid = grid if rows == "horizontal" else grid.T
    reading = Reading(first_point=f"{vertical}-{horizontal}", rows=rows, z_towards="eye" if sign < 0 else "scene")
    surface = PointGrid("g", grid, width, height, 1e-6).fitted(reading).surface
    assert surface.sag(7.3, -4.1) == pytest.approx(saddle(7.3, -4.1), abs=2e-6)


@given(st.integers(6, 12), st.integers(6, 12), st.floats(5, 80), st.floats(5, 80))
def test_sdf_round_trip(tmp_path_factory, nx, ny, width, height):
    x, y = np.meshgrid(np.linspace(-width / 2, width / 2, nx), np.linspace(-height / 2, height / 2, ny))
    path = write(tmp_path_factory.mktemp("sdf"), sdf_text(saddle(x, y), width, height), "a.sdf")
    (grid,) = read_sdf(path)
    assert grid.values == pytest.approx(saddle(x, y), abs=0.51e-6)
    assert (grid.width, grid.height, grid.digit, grid.side, grid.face) == (width, height, 1e-6, "R", "F")


def test_sdf_with_both_sides_crlf_and_byte_order_mark(tmp_path):
    one = sdf_text(np.arange(49.0).reshape(7, 7), 6, 6)
    path = tmp_path / "both.sdf"
    path.write_bytes(b"\xef\xbb\xbf" + (one + one.replace(";R;", ";L;")).replace("\n", "\r\n").encode())
    assert [g.side for g in read_sdf(path)] == ["R", "L"]


def test_the_wearers_own_object_distances(tmp_path):
    points = "[wear]\nobject_distances = [[-5, inf], [12.0, 800], [30, 350.0]]\n"
    wear = lb.load_wearer(write(tmp_path, WEARER + points)).wear
    assert np.array(wear.object_distances) == pytest.approx(
        np.array([[np.radians(-5), np.inf], [np.radians(12), 800], [np.radians(30), 350]])
    )


def test_wearer_by_age_and_luminance(tmp_path):
    wearer = lb.load_wearer(write(tmp_path, WEARER.replace("pupil_diameter = 4.0", "luminance = 100\nfield_area = 60")))
    assert wearer.eye.accommodation == pytest.approx(5.0)
    assert wearer.eye.pupil_diameter == pytest.approx(4.33, abs=0.005)


def test_decentration_and_tilt_of_a_surface(tmp_path):
    lens = lb.load_lens(write(tmp_path, LENS + "decentration = [3.0, -2.0]\ntilt = [0.0, 2.0]\n"))
    axis = np.array([np.sin(np.radians(2)), 0, np.cos(np.radians(2))])
    centre = np.array([3.0, -2.0, 0.0]) - 100 * axis
    x, y = np.array([0.0, 10.0]), np.array([5.0, -20.0])
    on_sphere = centre[2] + np.sqrt(100**2 - (x - centre[0]) ** 2 - (y - centre[1]) ** 2)
    assert lens.back_height(x, y) == pytest.approx(on_sphere, abs=1e-10)


def test_left_lens_mirrors_the_inset(tmp_path):
    points = "[points]\nnear_reference_point = [-2.5, -12]\nnear_inset = 2.5\n"
    lens = lb.load_lens(write(tmp_path, LENS.replace('"R"', '"L"') + points))
    assert isinstance(lens.points, Points)
    assert lens.points.near_reference_point == (-2.5, -12)


BAD_LENSES = {
    "unknown key, nearest named": (LENS.replace("centre_thickness", "center_thickness"), "centre_thickness"),
    "unknown key in a table": (LENS.replace("radius = 120.0", "radius = 120.0\nradios = 2.0"), "radius"),
    "missing key": (LENS.replace("centre_thickness = 2.0\n", ""), "centre_thickness: this key is missing"),
    "wrong type": (LENS.replace("centre_thickness = 2.0", 'centre_thickness = "thin"'), "centre_thickness"),
    "not a number": (LENS.replace("centre_thickness = 2.0", "centre_thickness = nan"), "centre_thickness"),
    "thickness below zero": (
        LENS.replace("radius = 100.0", "radius = 150.0").replace("= 120.0", "= 90.0"),
        "mm thick at x",
    ),
    "unknown material": (LENS.replace("CR-39", "CR-40"), "polycarbonate"),
    "unknown surface type": (LENS.replace('type = "sphere"\nradius = 120.0', 'type = "ball"'), "front"),
    "two ways": (LENS.replace("radius = 120.0", "radius = 120.0\ncurvature = 0.01"), "exactly one of"),
    "no way": (LENS.replace("radius = 120.0", ""), "exactly one of"),
    "zero radius": (LENS.replace("radius = 120.0", "radius = 0"), "plane"),
    "surface too small": (LENS.replace("radius = 120.0", "radius = 25.0"), "does not reach the outline"),
    "outline incomplete": (LENS.replace("diameter", "width"), "diameter"),
    "outline self-cut": (
        LENS.replace(
            'shape = "circle", diameter = 60', 'shape = "points", points = [[0,0],[10,0],[1,1],[0,10],[-9,-9],[0.5,9]]'
        ),
        "star-shaped",
    ),
    "inset to the wrong side": (LENS + "[points]\nnear_reference_point = [-2, -12]\nnear_inset = 2\n", "near_inset"),
    "unknown format": (LENS.replace("lens/1", "lens/9"), "lensbench-lens/1"),
    "syntax": (LENS.replace("side =", "side"), "line 4"),
    "missing point file": (LENS.replace('type = "sphere"\nradius = 120.0', 'type = "grid"\nfile = "no.sdf"'), "no.sdf"),
    "knots that do not fit": (
        LENS.replace(
            'type = "sphere"\nradius = 120.0',
            'type = "bspline"\ndegree = 3\nknots_x = [0, 1]\nknots_y = [0, 1]\ncoefficients = [[0]]',
        ),
        "knots",
    ),
    "a wearer, not a lens": (WEARER, "wearer"),
    "material of the wrong kind": (LENS.replace('"CR-39"', "5"), "material: must be a table, not 5"),
    "mistyped type": (
        LENS.replace('type = "sphere"\nradius = 120.0', 'typ = "sphere"\nradius = 120.0'),
        "front: the key 'type'",
    ),
    "no key of pydantic's": (
        LENS.replace('type = "sphere"\nradius = 120.0', 'type = "grid"\nfile = "a.sdf"\nfirst_point = "middle"'),
        "toml: front.first_point:",
    ),
    "a list for a table": (LENS.replace('{ shape = "circle", diameter = 60 }', "[1, 2]"), "outline: must be a table"),
    "text for a number": (LENS.replace("radius = 120.0", 'radius = "120"'), "front.radius"),
    "truth for a number": (LENS.replace("radius = 120.0", "radius = true"), "front.radius"),
    "nearly a material": (LENS.replace("CR-39", "CR39"), "did you mean 'CR-39'?"),
    "a point outside": (LENS + "[points]\nfitting_point = [100, 0]\n", "points.fitting_point"),
}


@pytest.mark.parametrize("case", BAD_LENSES)
def test_bad_lens_file(tmp_path, case):
    text, expected = BAD_LENSES[case]
    sentence_about(
        lambda: lb.load_lens(write(tmp_path, text)), "file.toml" if "point file" not in case else "no.sdf", expected
    )


BAD_WEARERS = {
    "neither age nor amplitude": (WEARER.replace("age = 45", ""), "accommodation"),
    "no pupil": (WEARER.replace("pupil_diameter = 4.0", ""), "luminance"),
    "luminance without age": (
        WEARER.replace("age = 45", "").replace("pupil_diameter = 4.0", "luminance = 10\naccommodation = 1"),
        "age",
    ),
    "unknown key": (WEARER.replace("pupil_diameter", "pupil_diametre"), "pupil_diameter"),
    "pupil out of range": (WEARER.replace("4.0", "-4.0"), "pupil_diameter"),
    "a lens, not a wearer": (LENS, "lensbench-wearer/1"),
    "one object distance": (WEARER + "[wear]\nobject_distances = [[0, 800]]", "two or more pairs"),
    "falling lowering": (WEARER + "[wear]\nobject_distances = [[20, 800], [10, 400]]", "rising"),
    "too near an object": (WEARER + "[wear]\nobject_distances = [[0, 800], [10, 4]]", "100 mm or more"),
    "no distance": (WEARER + "[wear]\nobject_distances = [[0, nan], [10, 400]]", "100 mm or more"),
}


@pytest.mark.parametrize("case", BAD_WEARERS)
def test_bad_wearer_file(tmp_path, case):
    text, expected = BAD_WEARERS[case]
    sentence_about(lambda: lb.load_wearer(write(tmp_path, text)), "file.toml", expected)


GOOD_SDF = sdf_text(np.arange(49.0).reshape(7, 7) / 100, 6, 6)
BAD_SDFS = {
    "truncated": ("\n".join(GOOD_SDF.splitlines()[:5]), "truncated"),
    "truncated within a row": (GOOD_SDF[:-20], "line 8"),
    "a value too many": (GOOD_SDF.replace("ZZ=0.07", "ZZ=0.5;0.07"), "line 3"),
    "a row too many": (GOOD_SDF + GOOD_SDF.splitlines()[-1], "line 9"),
    "not a number": (GOOD_SDF.replace("0.080000", "nan"), "line 3, value 2"),
    "a word": (GOOD_SDF.replace("0.080000", "0,08"), "line 3, value 2"),
    "no header": (GOOD_SDF.replace("SURFMT", "SURFACE"), "SURFMT"),
    "header cut": ("SURFMT=1;R;F;7\n", "line 1"),
    "header words": (GOOD_SDF.replace("7;7;6;6", "seven;7;6;6"), "line 1"),
    "binary format": (GOOD_SDF.replace("SURFMT=1", "SURFMT=2"), "line 1"),
    "huge counts": (GOOD_SDF.replace("7;7;6;6", "99999999;99999999;6;6"), "line 1"),
    "no extent": (GOOD_SDF.replace("7;7;6;6", "7;7;0;6"), "positive"),
    "empty": ("", "SURFMT"),
}


@pytest.mark.parametrize("case", BAD_SDFS)
def test_bad_sdf(tmp_path, case):
    text, expected = BAD_SDFS[case]
    sentence_about(lambda: read_sdf(write(tmp_path, text, "a.sdf")), "a.sdf", expected)


def test_binary_rubbish_is_no_sdf(tmp_path):
    path = tmp_path / "a.sdf"
    path.write_bytes(bytes(range(256)))
    sentence_about(lambda: read_sdf(path), "a.sdf", "not text")


def test_missing_files(tmp_path):
    for name in ("none.toml", "none.sdf"):
        sentence_about(lambda name=name: load(tmp_path / name), name, "no such file")


def test_a_grid_of_the_other_side_or_face(tmp_path):
    write(tmp_path, sdf_text(np.zeros((9, 9)), 60, 60), "flat.sdf")
    grid = 'type = "grid"\nfile = "flat.sdf"'
    sphere = 'type = "sphere"\nradius = 120.0'
    assert lb.load_lens(write(tmp_path, LENS.replace(sphere, grid)))
    left = LENS.replace('"R"', '"L"').replace(sphere, grid)
    sentence_about(lambda: lb.load_lens(write(tmp_path, left)), "flat.sdf", "side L")
    on_back = LENS.replace('[back]\ntype = "sphere"\nradius = 100.0', f"[back]\n{grid}")
    sentence_about(lambda: lb.load_lens(write(tmp_path, on_back)), "flat.sdf", "face B")


def test_an_outline_may_repeat_its_points(tmp_path):
    square = "[[20, 20], [-20, 20], [-20, 20], [-20, -20], [20, -20], [20, 20]]"
    outline = f'{{ shape = "points", points = {square} }}'
    lens = lb.load_lens(write(tmp_path, LENS.replace('{ shape = "circle", diameter = 60 }', outline)))
    assert lens.outline.box == pytest.approx((-20, 20, -20, 20))


def test_a_file_of_another_kind(tmp_path):
    sentence_about(lambda: load(write(tmp_path, "", "notes.md")), "notes.md", ".toml")


def test_too_few_points(tmp_path):
    write(tmp_path, sdf_text(np.zeros((4, 4)), 60, 60), "few.sdf")
    text = LENS.replace('type = "sphere"\nradius = 120.0', 'type = "grid"\nfile = "few.sdf"')
    sentence_about(lambda: lb.load_lens(write(tmp_path, text)), "few.sdf", "6 x 6")


@given(st.binary(max_size=400))
def test_any_bytes_give_a_sentence_or_a_surface(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("fuzz") / "a.sdf"
    path.write_bytes(b"SURFMT=1;R;F;3;3;6;6;0\nZZ=" + content)
    sentence = ""
    try:
        read_sdf(path)
    except InputError as error:
        sentence = str(error)
    assert not sentence or "a.sdf" in sentence


def sentence_about(action, file: str, expected: str) -> None:
    with pytest.raises(InputError) as caught:
        action()
    sentence = str(caught.value)
    assert file in sentence
    assert expected in sentence
    assert "\n" not in sentence
