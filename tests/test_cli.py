"""The command line: verbs, exit codes, and what is on disk afterwards."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import pyvista
from PIL import Image

from lensbench.cli import main
from lensbench.report.build import Terms

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
REGULAR = str(SAMPLES / "regular_R.toml")


def modules_after(statement: str) -> set[str]:
    code = f"import sys\n{statement}\nprint(*sys.modules)"
    return set(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split())


def test_help_imports_nothing_heavy():
    loaded = modules_after("from lensbench import cli; cli.parser().format_help()")
    assert not loaded & {"numpy", "numba", "scipy", "vtk", "vtkmodules", "pyvista", "matplotlib", "pydantic", "PIL"}


def test_optics_need_no_graphics_library():
    loaded = modules_after(
        "import lensbench.workbench, lensbench.formats, lensbench.scenes.scene, lensbench.optics.gaze"
    )
    assert not loaded & {"vtk", "vtkmodules", "pyvista", "matplotlib", "PySide6"}


def test_check_says_what_a_file_holds(capsys):
    assert main(["check", REGULAR]) == 0
    text = capsys.readouterr().out
    assert "Minimum edge thickness" in text
    assert "power noise" in text
    assert main(["check", str(SAMPLES / "presbyope_60.toml"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["Pupil diameter"] == 4.0
    assert main(["check", str(SAMPLES / "regular_R.sdf")]) == 0


def test_map_as_csv(tmp_path, capsys):
    path = tmp_path / "new folder" / "map.csv"
    assert main(["map", REGULAR, "-q", "prism", "-d", "inf", "-o", str(path)]) == 0
    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert set(rows[0]) == {"x_mm", "y_mm", "prism_cm/m", "status"}
    assert {row["status"] for row in rows} == {"OK"}
    assert capsys.readouterr().out.strip() == str(path)


@pytest.mark.parametrize("kind", ["vtp", "vtu", "vti"])
def test_map_for_vtk_programs(tmp_path, kind):
    pyvista = pytest.importorskip("pyvista")
    path = tmp_path / f"map.{kind}"
    assert main(["map", REGULAR, "-q", "astigmatism", "-d", "40cm", "-o", str(path)]) == 0
    mesh = pyvista.read(path)
    values = mesh.point_data["astigmatism_D"]
    assert 1.5 < np.nanmax(values) < 6
    assert mesh.bounds[:4] == pytest.approx([-30, 30, -30, 30], abs=1e-3)
    about = json.loads(mesh.field_data["about"][0])
    assert about["objects"] == "objects at 40 cm"
    assert about["unit"] == "D"


def test_maps_at_the_wearers_distances(capsys):
    seen = []
    for distance in ("inf", "model"):
        assert main(["map", REGULAR, "-q", "defocus", "-d", distance, "--json"]) == 0
        seen.append(np.array(json.loads(capsys.readouterr().out)["values"], dtype=float))
    middle = seen[0].shape[1] // 2
    assert seen[0][-5, middle] == seen[1][-5, middle]
    assert seen[0][20, middle] > 1.5 * seen[1][20, middle]


def test_ellipses_as_csv_and_json(tmp_path, capsys):
    path = tmp_path / "eoc.csv"
    assert main(["eoc", REGULAR, "--depths", "30cm", "2m", "-n", "6", "-o", str(path)]) == 0
    assert len(path.read_text(encoding="utf-8").splitlines()) == 1 + 2 * 36
    capsys.readouterr()
    assert main(["eoc", REGULAR, "--depths", "30cm", "2m", "-n", "6", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert {row["depth_mm"] for row in rows} == {300.0, 2000.0}


def test_voxels_as_npz(tmp_path):
    path = tmp_path / "blur.npz"
    assert main(["voxels", REGULAR, "-n", "6", "5", "4", "-o", str(path)]) == 0
    with np.load(path) as file:
        assert file["blur"].shape == (2, 2, 5, 6, 4)


def test_voxels_tell_their_camera_units_and_viewer(tmp_path):
    path, image = tmp_path / "blur.npz", tmp_path / "blur.vti"
    wanted = ["voxels", REGULAR, "-n", "6", "5", "4", "--fov", "40", "--ndc"]
    assert main([*wanted, "-o", str(path)]) == 0
    assert main([*wanted, "--exaggeration", "3", "-o", str(image)]) == 0
    with np.load(path) as file:
        about, blur, ndc, u = json.loads(str(file["about"])), file["blur"], file["ndc"], file["u"]
    assert u[-1] == pytest.approx(np.tan(np.radians(20)))
    assert about["camera"]["field_of_view_deg"] == pytest.approx(40)
    assert {"blur", "ndc", "depth"} <= set(about["units"])
    assert "pupil" in about["seen_by"]
    assert "rule retina" in about["seen_by"]
    shown = pyvista.read(image)
    assert shown.dimensions == (6, 5, 4)
    assert json.loads(shown.field_data["about"][0])["exaggeration"] == 3
    k = shown.find_closest_point((-1 + 2 * 4 / 5, -1 + 2 * 1 / 4, 2 / 3))
    np.testing.assert_allclose(shown["blur_mm"][k], 3 * blur[:, :, 1, 4, 2].ravel(), rtol=1e-6)
    np.testing.assert_allclose(shown["ndc"][k], 3 * ndc[:, :, 1, 4, 2].ravel(), rtol=1e-6)


def test_ellipses_name_eye_pupil_and_rule_and_are_drawn_as_asked(tmp_path):
    path = tmp_path / "eoc.svg"
    wanted = ["eoc", REGULAR, "-n", "5", "--fov", "30", "--exaggeration", "3", "--accommodation", "paper"]
    assert main([*wanted, "--depths", "40cm", "-o", str(path)]) == 0
    text = path.read_text()
    assert "pupil 4 mm, accommodation rule paper" in text
    assert "ellipses ×3" in text
    numbers = tmp_path / "eoc.json"
    assert main([*wanted, "--depths", "40cm", "-o", str(numbers)]) == 0
    rows = json.loads(numbers.read_text())
    naked_reach = 400 * np.tan(np.radians(15))
    assert max(row["x_mm"] for row in rows) == pytest.approx(naked_reach, rel=0.25)


MISFIT = ["-w", str(SAMPLES / "presbyope_60.toml")]
NEAR = str(SAMPLES / "wide_near_R.toml")
ORDERED = "was ordered as -3.00 / -1.00 x 30 D, but this wearer's prescription"


def test_a_lens_on_a_wearer_it_was_not_ordered_for_is_said(tmp_path, monkeypatch, capsys):
    captions = []
    monkeypatch.setattr("lensbench.views.jitter.Studio.picture", lambda *_: np.zeros((4, 4, 3), np.uint8))
    monkeypatch.setattr(
        "lensbench.views.jitter.picture.captioned", lambda picture, lines: captions.append(lines) or picture
    )
    wanted = {"map.svg": ["map", NEAR, "-d", "40cm"], "eoc.svg": ["eoc", NEAR, "-n", "4"], "view.png": ["view", NEAR]}
    for name, verb in wanted.items():
        assert main([*verb, *MISFIT, "-o", str(tmp_path / name)]) == 0
        said = capsys.readouterr().err
        assert said.startswith("lensbench: ")
        assert ORDERED in said
        text = " ".join(captions[-1]) if name == "view.png" else " ".join((tmp_path / name).read_text().split())
        for words in ("Wide-near progressive", "Emmetropic presbyope, 60 years: eye +0.00 D", "was ordered as -3.00"):
            assert words in text, name
    assert "objects at 40 cm" in (tmp_path / "map.svg").read_text()
    assert "6.0 m from the eye" in captions[0][0]
    for verb in (
        *wanted.values(),
        ["map", NEAR, "-q", "thickness", *MISFIT],
        ["view", NEAR, "--eye", "naked", *MISFIT],
    ):
        assert main([*verb, "-o", str(tmp_path / "fits.png")]) == 0
        assert not capsys.readouterr().err


def test_a_caption_stands_below_a_view_of_the_size_that_was_asked_for(tmp_path):
    pictures = []
    for name, bare in (("captioned", []), ("bare", ["--bare"])):
        assert main(["view", REGULAR, *SMALL, *bare, "-o", str(tmp_path / f"{name}.png")]) == 0
        with Image.open(tmp_path / f"{name}.png") as picture:
            pictures.append(np.asarray(picture))
    captioned, bare = pictures
    assert bare.shape == (48, 64, 3)
    np.testing.assert_array_equal(captioned[:48], bare)
    assert (captioned[48:] < 100).any()


def test_a_conoid_in_numbers_along_the_ray_and_as_a_picture(tmp_path, capsys):
    toric, wearer = str(SAMPLES / "toric_R.toml"), str(SAMPLES / "young_astigmat.toml")
    wanted = ["conoid", toric, "-w", wearer, "--gaze", "15", "-20", "-d", "27cm"]
    assert main([*wanted, "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    used = numbers["used"]
    assert min(used["focal_lines_mm"]) < used["least_confusion_mm"] < max(used["focal_lines_mm"])
    assert main([*wanted, "-o", str(tmp_path / "conoid.csv")]) == 0
    rows = list(csv.DictReader((tmp_path / "conoid.csv").open()))
    distance = np.array([float(row["distance_mm"]) for row in rows])
    for k, line in ((2, min(used["focal_lines_mm"])), (1, max(used["focal_lines_mm"]))):
        axis = np.array([float(row[f"used_axis_{k}_mm"]) for row in rows])
        assert np.interp(line, distance, axis) == pytest.approx(0, abs=1e-4)
    assert main([*wanted, "-o", str(tmp_path / "conoid.png")]) == 0
    with Image.open(tmp_path / "conoid.png") as picture:
        shades = np.asarray(picture.convert("RGB")).astype(int)
    space = shades[90:480]
    for red, green, blue in ((0xB3, 0x26, 0x1E), (0x1D, 0x7A, 0x46), (0x2F, 0x6F, 0xB5), (0xD9, 0x82, 0x2B)):
        assert (np.abs(space - [red, green, blue]).max(axis=-1) < 60).sum() > 5


def test_a_conoid_needs_a_gaze_through_the_lens(tmp_path, capsys):
    assert main(["conoid", REGULAR, "--gaze", "75", "0", "-o", str(tmp_path / "conoid.png")]) == 2
    assert "no ray passes the lens along 75 0" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_doctor_names_versions_and_threads(capsys):
    assert main(["doctor", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {"lensbench", "python", "numpy", "vtk", "threads"} <= set(found)


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", "nowhere.toml"],
        ["report", "nowhere.toml"],
        ["map", REGULAR, "-q", "beauty", "--json"],
        ["map", REGULAR, "-o", "map.xyz"],
        ["map", REGULAR, "--accommodation", "much", "--json"],
        ["map", REGULAR, "--accommodation", "nan", "--json"],
        ["map", REGULAR, "--accommodation", "-1", "--json"],
        ["voxels", REGULAR, "--near", "5m", "--far", "1m"],
        ["check", "."],
        ["eoc", REGULAR, "-o", "eoc"],
        ["view", REGULAR, "--fov", "500"],
        ["view", REGULAR, "--exposure", "99"],
        ["view", REGULAR, "--seed", "-1"],
        ["view", REGULAR, "--eye", "naked", "--split"],
        ["view", REGULAR, "--eye", "perfect", "--defocus", "veil"],
        ["view", REGULAR, "-o", "view.jpg"],
        ["sweep", REGULAR, "-o", "sweep.avi"],
        ["sweep", REGULAR, "--rate", "0"],
        ["sweep", REGULAR, "-o", "a.png", "--sheet", "a.png"],
        ["map", REGULAR, "-w", REGULAR, "--json"],
    ],
)
def test_bad_input_is_one_sentence_and_exit_2(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    printed = capsys.readouterr()
    assert printed.err.startswith("lensbench: ")
    assert len(printed.err.splitlines()) == 1
    assert not printed.out
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments",
    [
        *(["map", REGULAR, "-d", text] for text in ("40", "0cm", "-4m", "near", "1e3mm")),
        ["eoc", REGULAR, "--depths", "inf"],
        ["eoc", REGULAR, "-n", "0"],
        ["eoc", REGULAR, "--fov", "0"],
        ["eoc", REGULAR, "--exaggeration", "nan"],
        ["voxels", REGULAR, "--fov", "170"],
        ["voxels", REGULAR, "-n", "4", "4", "-4"],
        ["view", REGULAR, "--gaze", "180", "0"],
        ["paint", REGULAR],
    ],
)
def test_bad_usage_is_exit_2(arguments, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    assert "error:" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "folder", "distances"),
    [
        ([], Path("reports/regular_R"), (np.inf, 780.0, 400.0)),
        (["--object-distance", "inf", "1.5m", "-o", "here"], Path("here"), (np.inf, 1500.0)),
    ],
)
def test_report_asks_for_what_was_said(monkeypatch, capsys, options, folder, distances):
    asked = []
    monkeypatch.setattr("lensbench.report.build.build_report", lambda *given: asked.append(given))
    assert main(["report", REGULAR, "-w", str(SAMPLES / "paper_eye.toml"), *options]) == 0
    lens, wearer, *rest, _, scene = asked[0]
    assert rest == [folder, Terms(distances)]
    assert scene.name == "room"
    assert (lens.side, wearer.eye.accommodation) == ("R", 0.5)
    assert capsys.readouterr().out.strip() == str(folder / "index.html")


def test_view_asks_for_what_was_said(monkeypatch, tmp_path):
    asked = []

    def draw(studio, seen, *rest):
        asked.append((seen.layer, *rest))
        return np.zeros((4, 4, 3), np.uint8)

    monkeypatch.setattr("lensbench.views.jitter.Studio.picture", draw)
    options = [
        "--gaze",
        "10",
        "-20",
        "--eye",
        "pinhole",
        "--fov",
        "30",
        "--size",
        "64",
        "48",
        "--passes",
        "5",
        "--split",
    ]
    more = ["--head", "-5", "3", "--seed", "7", "--exposure", "-1", "--accommodation", "0.25"]
    assert main(["view", REGULAR, *options, *more, "-o", str(tmp_path / "v.png")]) == 0
    layer, *rest = asked[0]
    assert (layer.eye, layer.size, layer.accommodation, layer.split) == ("pinhole", (64, 48), 0.25, True)
    assert rest == [5, 7, 0.5]
    angles = [layer.azimuth, layer.elevation, layer.half_width, layer.head_turn, layer.head_tilt]
    assert np.degrees(angles) == pytest.approx([10, -20, 15, -5, 3])


SMALL = ["--size", "64", "48", "--passes", "2"]


def test_view_is_the_same_bytes_for_the_same_seed(tmp_path):
    for name, seed in (("a", "1"), ("b", "1"), ("c", "2")):
        assert (
            main(["view", REGULAR, *SMALL, "--passes", "6", "--seed", seed, "-o", str(tmp_path / f"{name}.png")]) == 0
        )
    a, b, c = ((tmp_path / f"{name}.png").read_bytes() for name in "abc")
    assert a == b != c


@pytest.mark.parametrize("kind", ["gif", "apng", "mp4"])
def test_sweep_writes_an_animation_and_a_contact_sheet(kind, tmp_path, capsys):
    import imageio.v3 as iio
    from PIL import Image

    path = tmp_path / f"s.{kind}"
    options = ["--from", "-10", "5", "--to", "20", "0", "--frames", "3", "--defocus", "veil", "--sheet"]
    assert main(["sweep", REGULAR, *SMALL, *options, str(tmp_path / "sheet.png"), "-o", str(path)]) == 0
    assert capsys.readouterr().out.split() == [str(path), str(tmp_path / "sheet.png")]
    frames = iio.imread(path, plugin="FFMPEG" if kind == "mp4" else "pillow")
    assert len(frames) == 4
    assert np.abs(frames[0].astype(int) - frames[2]).mean() > 1
    with Image.open(tmp_path / "sheet.png") as sheet:
        assert sheet.width > 3 * 64


def test_a_missing_package_is_named(monkeypatch, tmp_path, capsys):
    monkeypatch.delitem(sys.modules, "lensbench.views.maps", raising=False)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert main(["map", REGULAR, "-o", str(tmp_path / "map.png")]) == 1
    assert "matplotlib is not installed: pip install" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_output_that_cannot_be_written(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["map", REGULAR, "-o", str(tmp_path / "file" / "map.csv")]) == 2
    assert "cannot be written" in capsys.readouterr().err
