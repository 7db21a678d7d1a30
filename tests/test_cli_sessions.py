"""A session given to the command line: what it says is what is computed, options come before it, and none is passed over."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lensbench.cli import main
from lensbench.report.build import Terms
from lensbench.session import Workbench, save_session

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
REGULAR = str(SAMPLES / "regular_R.toml")
WEARER = str(SAMPLES / "paper_eye.toml")


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """The regular lens at 40 cm by the paper's rule, before the desk, the head turned."""
    from lensbench.formats import load_wearer

    bench = Workbench().with_lens(SAMPLES / "regular_R.toml").with_wearer(load_wearer(WEARER))
    bench = replace(bench, distance=400.0, accommodation="paper", depths=(350.0, 600.0), scene="desk", head_turn=8.0)
    path = tmp_path_factory.mktemp("session") / "s.lensbench.json"
    save_session(bench, path)
    return str(path)


def printed(capsys, *words):
    assert main(list(words)) == 0
    return json.loads(capsys.readouterr().out)


def test_a_map_is_that_of_the_sessions_distance_and_rule(session, capsys):
    of_session = printed(capsys, "map", session, "-q", "accommodation", "--json")
    said = ["-d", "40cm", "--accommodation", "paper"]
    of_file = printed(capsys, "map", REGULAR, "-w", WEARER, "-q", "accommodation", *said, "--json")
    assert of_session == of_file
    plain = printed(capsys, "map", REGULAR, "-w", WEARER, "-q", "accommodation", "--json")
    assert np.nanmax(np.array(plain["values"], dtype=float)) == 0 < np.nanmax(np.array(of_file["values"], dtype=float))


def test_an_option_comes_before_the_session(session, capsys):
    for options in (["-d", "inf", "--accommodation", "retina"], ["-d", "70cm", "--accommodation", "0.25"]):
        of_session = printed(capsys, "map", session, "-q", "defocus", *options, "--json")
        assert of_session == printed(capsys, "map", REGULAR, "-w", WEARER, "-q", "defocus", *options, "--json")


@pytest.mark.parametrize(
    ("verb", "said"),
    [
        ("eoc", ["--depths", "35cm", "60cm", "--accommodation", "paper"]),
        ("distortion", ["-d", "40cm"]),
        ("conoid", ["-d", "40cm", "--accommodation", "paper"]),
    ],
)
def test_other_verbs_take_what_the_session_says(session, capsys, verb, said):
    few = ["-n", "5"] if verb != "conoid" else ["--gaze", "5", "-20"]
    of_session = printed(capsys, verb, session, *few, "--json")
    assert of_session == printed(capsys, verb, REGULAR, "-w", WEARER, *few, *said, "--json")
    assert of_session != printed(capsys, verb, REGULAR, "-w", WEARER, *few, "--json")


def test_a_conoid_of_the_scene_ends_at_what_the_gaze_meets(capsys):
    found = printed(capsys, "conoid", REGULAR, "-d", "scene", "--scene", "desk", "--gaze", "0", "-25", "--json")
    assert 200 < found["distance_mm"] < 1500


def test_a_view_is_that_of_the_sessions_head_scene_and_rule(session, monkeypatch, tmp_path):
    seen = []
    monkeypatch.setattr(
        "lensbench.views.jitter.Studio.picture",
        lambda studio, one, *_: seen.append(one) or np.zeros((4, 4, 3), np.uint8),
    )
    assert main(["view", session, "-o", str(tmp_path / "v.png")]) == 0
    assert main(["view", session, "--head", "0", "2", "--scene", "room", "-o", str(tmp_path / "v.png")]) == 0
    assert [one.scene.name for one in seen] == ["desk", "room"]
    assert [one.layer.accommodation for one in seen] == ["paper", "paper"]
    heads = [(one.layer.head_turn, one.layer.head_tilt) for one in seen]
    np.testing.assert_allclose(np.degrees(heads), [(8, 0), (0, 2)], atol=1e-12)


def test_a_report_is_asked_for_what_the_session_says(session, monkeypatch):
    asked = []
    monkeypatch.setattr("lensbench.report.build.build_report", lambda *given: asked.append(given))
    assert main(["report", session]) == 0
    assert main(["report", session, "--object-distance", "1m", "--accommodation", "object", "--scene", "room"]) == 0
    of_session, said = ((given[3], given[5].name) for given in asked)
    assert of_session == (Terms((np.inf, 780.0, 400.0), (350.0, 600.0), "paper"), "desk")
    assert said == (Terms((1000.0,), (350.0, 600.0), "object"), "room")


LENS_OPTIONS = [
    ["--side", "R"], ["--material", "MR-8"], ["--index", "1.6"], ["--thickness", "9"], ["--front-radius", "80"],
    ["--back-radius", "80"], ["--diameter", "60"], ["--power", "1"], ["--face", "front"], ["--flip-z"],
    ["--orientation", "top-left-rows"], ["--z-towards", "eye"],
]  # fmt: skip


@pytest.mark.parametrize("option", LENS_OPTIONS)
def test_an_option_of_lens_files_is_refused_beside_a_session(session, capsys, option):
    assert main(["map", session, *option, "--json"]) == 2
    said = capsys.readouterr().err.strip()
    assert session in said
    assert option[0] in said
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize(
    "verb",
    ["report", "map", "eoc", "distortion", "voxels", "conoid", "view", "sweep", "verify", "compensate", "compare"],
)
def test_every_verb_refuses_it(session, capsys, tmp_path, monkeypatch, verb):
    monkeypatch.chdir(tmp_path)
    assert main([verb, session, "--thickness", "9"]) == 2
    assert "--thickness" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
