"""Pairs of lenses: the path over both, maps over the common gaze, the command and its page."""

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import lensbench as lb
from lensbench.cli import main
from lensbench.errors import InputError
from lensbench.layers import DistortionLayer, Request
from lensbench.optics.lens import circle_outline
from lensbench.optics.mirror import mirrored, mirrored_wearer
from lensbench.pair import LABELS, PairRequest, run_pair
from lensbench.workbench import run

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
REGULAR, WEARER = str(SAMPLES / "regular_R.toml"), str(SAMPLES / "presbyope_60.toml")


@pytest.fixture(scope="module")
def pair():
    lens, wearer = lb.load_lens(REGULAR), lb.load_wearer(WEARER)
    return lb.Pair(lens, mirrored(lens), wearer, mirrored_wearer(wearer))


@pytest.fixture(scope="module")
def result(pair):
    return run_pair(PairRequest(pair, samples=9))


def test_the_path_runs_from_far_to_near_along_the_corridor(pair, result):
    path = result.path
    far, near = np.argmin(np.abs(path.lowering)), np.argmin(np.abs(path.lowering - 32))
    assert path.distance[far] == 1e8
    assert path.distance[near] == pytest.approx(400 + 13.5)
    assert (path.right.x[near], path.right.y[near]) == pytest.approx((2.5, -13), abs=0.7)
    assert path.left.x == pytest.approx(-path.right.x, abs=1e-6)
    assert path.left.off_meridian == pytest.approx(path.right.off_meridian, abs=1e-6)
    assert np.abs(path.right.off_meridian).max() < 1.0
    assert path.vertical_imbalance == pytest.approx(np.zeros(path.lowering.size), abs=1e-6)


def test_maps_are_the_fixations_of_their_gazes(pair, result):
    j, i = 2, 7
    found = result.maps["vertical_imbalance"]
    azimuth, elevation = np.radians([found.azimuth[i], found.elevation[j]])
    direction = [np.sin(azimuth) * np.cos(elevation), np.sin(elevation), np.cos(azimuth) * np.cos(elevation)]
    balance = lb.fixate(pair, pair.points([direction], "model")).balance()
    assert found.values[j, i] == pytest.approx(balance.vertical_imbalance[0])
    assert result.maps["magnification_difference"].values[j, i] == pytest.approx(
        100 * balance.magnification_difference[0]
    )
    assert list(result.maps) == list(LABELS)
    assert np.array_equal(np.isnan(found.values), found.status != 0)


def test_lenses_that_no_common_gaze_passes(pair):
    apart = replace(pair, left=replace(pair.left, outline=circle_outline(4.0, (25.0, 25.0))))
    with pytest.raises(InputError, match="no gaze at which both eyes"):
        run_pair(PairRequest(apart, samples=5))


def test_the_page(tmp_path, capsys):
    path = tmp_path / "pair.png"
    assert main(["pair", REGULAR, "-w", WEARER, "-o", str(path)]) == 0
    with Image.open(path) as picture:
        assert min(picture.size) > 1000
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 200
    assert capsys.readouterr().out.strip() == str(path)


def test_numbers_of_a_pair(tmp_path, capsys):
    table = tmp_path / "path.csv"
    assert main(["pair", REGULAR, "-w", WEARER, "-d", "40cm", "-o", str(table)]) == 0
    rows = list(csv.DictReader(io.StringIO(table.read_text(encoding="utf-8"))))
    assert {row["distance_mm"] for row in rows} == {"400"}
    assert {"lowering_deg", "right_x_mm", "left_off_meridian_mm", "vertical_imbalance_cm/m"} <= set(rows[0])
    capsys.readouterr()
    assert main(["pair", REGULAR, "-w", WEARER, "--left-wearer", str(SAMPLES / "paper_eye.toml"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    difference = np.array(found["maps"]["mean_power_difference"]["values"], dtype=float)
    assert np.nanmedian(difference[40:]) == pytest.approx(-1.0, abs=0.1)  # the left eye is a myope of 1 D


def test_listings_planes_may_turn(capsys):
    seen = []
    for more in ([], ["--l2", "0.25"]):
        assert main(["pair", REGULAR, "-w", WEARER, *more, "--json"]) == 0
        found = json.loads(capsys.readouterr().out)["maps"]["cyclo_difference"]["values"]
        seen.append(np.nanmax(np.abs(np.array(found, dtype=float))))
    assert seen[1] < 0.2 * seen[0]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([REGULAR, REGULAR], "side R, not L"),
        ([REGULAR, "-o", "pair.xyz"], "cannot write .xyz"),
        ([REGULAR, "--left-wearer", REGULAR], "holds no wearer"),
    ],
)
def test_bad_pairs(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["pair", *arguments]) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("option", [["--l2", "2"], ["-d", "scene"]])
def test_bad_options(option):
    with pytest.raises(SystemExit):
        main(["pair", REGULAR, *option])


# -- the distortion grid -----------------------------------------------------------------------------------------------


def test_distortion_of_a_chart(pair):
    layer = DistortionLayer(1000.0, lines=5, half_angle=0.3, fineness=2)
    grid = run(Request(pair.right, pair.right_wearer, layer))
    assert grid.apparent.shape == (9, 9, 2)
    assert grid.object[0, 0] == pytest.approx([-np.tan(0.3), -np.tan(0.3)])
    chart = lb.seen_chart(pair.right, pair.right_wearer, [grid.object[6, 2]], 1000.0)
    assert grid.apparent[6, 2] == pytest.approx(chart.apparent[0])
    naked = run(Request(None, pair.right_wearer, layer))
    assert naked.apparent == pytest.approx(naked.object)


def test_distortion_command(tmp_path, capsys):
    path = tmp_path / "grid.png"
    assert main(["distortion", REGULAR, "-d", "1m", "-o", str(path)]) == 0
    with Image.open(path) as picture:
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 50
    capsys.readouterr()
    assert main(["distortion", REGULAR, "-n", "3", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert np.shape(found["object"]) == (3, 3, 2)
    assert found["depth"] == "inf"
    table = tmp_path / "grid.csv"
    assert main(["distortion", REGULAR, "-n", "3", "-o", str(table)]) == 0
    rows = list(csv.DictReader(io.StringIO(table.read_text(encoding="utf-8"))))
    assert [row["status"] for row in rows].count("OK") >= 5
    assert float(rows[4]["apparent_x"]) == pytest.approx(found["apparent"][1][1][0], abs=1e-5)
    assert found["apparent"][1][1] == pytest.approx(found["object"][1][1], abs=0.05)
