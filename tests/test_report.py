"""The report: one page that needs no network, pictures that are there, numbers that are those of the workbench."""

import io
import json
import math
import re
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import lensbench as lb
from lensbench.layers import LensMap, PointsLayer, Request
from lensbench.report import build
from lensbench.report.progress import Progress
from lensbench.workbench import run

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
HOSTILE = 'Lens <script>alert("x")</script> & $\\frac$ co'


@pytest.fixture(scope="module")
def wearer():
    return lb.load_wearer(SAMPLES / "presbyope_60.toml")


@pytest.fixture(scope="module")
def folder(tmp_path_factory, wearer):
    lens = replace(lb.load_lens(SAMPLES / "regular_R.toml"), name=HOSTILE)
    folder = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "PASSES", 3)
        patch.setattr(build, "PINHOLE_PASSES", 2)
        build.build_report(lens, wearer, folder, build.Terms((math.inf, 400.0)), Progress(io.StringIO()))
    return folder


def test_the_page_needs_nothing_else(folder):
    page = (folder / "index.html").read_text(encoding="utf-8")
    references = re.findall(r'(?:src|href)="([^"]*)"', page)
    assert references
    assert all(r.startswith(("data:image/png;base64,", "#")) for r in references)
    assert "http" not in re.sub(r'src="data:[^"]*"', "", page)


def test_text_from_files_is_escaped(folder):
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_every_picture_of_the_page_lies_beside_it(folder):
    page = (folder / "index.html").read_text(encoding="utf-8")
    pictures = sorted(folder.glob("*.png"))
    assert len(pictures) == page.count("data:image/png") >= 14
    for path in pictures:
        with Image.open(path) as picture:
            assert min(picture.size) > 300
            assert len(picture.convert("RGB").getcolors(1 << 24)) > 50


def test_numbers_are_those_of_the_workbench(folder, wearer):
    found = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    lens = lb.load_lens(SAMPLES / "regular_R.toml")
    for printed, reading in zip(found["reference_points"], run(Request(lens, wearer, PointsLayer())), strict=True):
        for name, value in asdict(reading).items():
            expected = "inf" if value == math.inf else value
            assert printed[name] == (pytest.approx(expected, rel=1e-6) if isinstance(expected, float) else expected)
    assert found["conventions"] == "lensbench-conventions/1"
    assert set(found["maps"]) >= {"mean_power", "astigmatism", "thickness"}
    assert len(found["ellipses"]) == 3
    assert len(found["defocus"]) == 4


def test_first_order_against_real_rays_is_said(folder):
    found = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    rows = found["first_order_against_real_rays"]
    assert [row["objects"] for row in rows] == list(found["defocus"])
    assert all(0 < row["deviation_median"] <= row["deviation_p90"] < 2 for row in rows)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert f"{rows[1]['deviation_median']:.2f}; {rows[1]['deviation_p90']:.2f}" in page
    assert "ANSI Z80.1-2015" in page
    assert page.count("<td>within</td>") == 4


def test_every_number_has_a_unit(folder):
    found = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    rows = [*found["reference_points"], found["profile"], *found["ellipses"]]
    numeric = {k for row in rows for k, v in row.items() if isinstance(v, float | list)} - {"status"}
    assert numeric <= set(found["units"])
    assert all(m["unit"] for m in [*found["maps"].values(), *found["defocus"].values()])


def test_the_views_differ_as_they_should(folder):
    """With the lens the page is sharper than without it; every look shows something else."""
    contrast = {}
    for look in ("far", "near"):
        with Image.open(folder / f"view_{look}.png") as picture:
            grey = np.asarray(picture.convert("L"), dtype=float)
            third = grey.shape[1] // 3
            contrast[look] = [
                np.abs(np.diff(grey[80:-80, k * third + 60 : (k + 1) * third - 60])).mean() for k in range(3)
            ]
    assert contrast["near"][0] > 1.1 * contrast["near"][1]
    assert contrast["near"][2] > contrast["near"][0]
    assert contrast["far"] != contrast["near"]


def test_the_asked_distances_are_shown_on_one_scale(folder):
    found = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert list(found["defocus"]) == [
        "objects at infinity",
        "objects at 40 cm",
        "objects at the wearer's distance for each gaze",
        "objects of the scene",
    ]
    assert sorted(p.name for p in folder.glob("defocus*")) == [
        "defocus_400.png",
        "defocus_inf.png",
        "defocus_model.png",
        "defocus_scene.png",
    ]
    bars = []
    for path in sorted(folder.glob("defocus*")):
        with Image.open(path) as picture:
            bars.append(np.asarray(picture)[100:550, 700:])
    assert all(np.array_equal(bar, bars[0]) for bar in bars)


def test_readings_stand_in_the_page(folder):
    page = (folder / "index.html").read_text(encoding="utf-8")
    near = json.loads((folder / "results.json").read_text(encoding="utf-8"))["reference_points"][-1]
    assert f"{near['sphere']:+.2f} / {near['cylinder']:+.2f} x {near['axis']:.0f}" in page
    assert f"{near['mean_error']:+.2f}" in page


def test_a_failure_on_the_way_leaves_nothing_behind(tmp_path, wearer, monkeypatch):
    lens = lb.load_lens(SAMPLES / "sphere_minus_4_R.toml")

    def fail(*_, **__):
        raise RuntimeError("the driver died")

    monkeypatch.setattr(build, "view_pictures", fail)
    with pytest.raises(RuntimeError):
        build.build_report(lens, wearer, tmp_path / "report", build.Terms((400.0,)), Progress(io.StringIO()))
    assert not (tmp_path / "report").exists()


def test_progress_is_silent_unless_on_a_terminal():
    stream = io.StringIO()
    progress = Progress(stream)
    progress.step("one")
    progress.done()
    assert stream.getvalue() == ""
    assert set(progress.seconds) == {"one"}


def test_failed_rays_are_counted():
    status = np.array([[0, 0, 3], [0, 2, 5]], dtype=np.int8)
    lens_map = LensMap("mean_power", "Mean", "D", np.arange(3.0), np.arange(2.0), np.zeros((2, 3)), status)
    assert build._failed(lens_map) == "20.0% missed front, 20.0% total internal reflection"
    assert build._failed(replace(lens_map, status=np.zeros((2, 3), dtype=np.int8))) == ""


def test_progress_names_its_steps_on_a_terminal():
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    stream = Terminal()
    progress = Progress(stream)
    for step in ("maps", "views"):
        progress.step(step)
    progress.done()
    assert "maps ..." in stream.getvalue()
    assert re.search(r"s \(maps [0-9.]+, views [0-9.]+\)\n$", stream.getvalue())
