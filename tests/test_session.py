"""The session file: what was on the table comes back; what is wrong in it is one sentence."""

import json
from dataclasses import asdict, fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lensbench.errors import InputError
from lensbench.layers import EYES
from lensbench.optics.lens import Order
from lensbench.quantities import QUANTITIES
from lensbench.session import FORMAT, KINDS, SPLITS, Pane, Workbench, load_session, save_session

SAMPLES = Path(__file__).parents[1] / "sample_lenses"


def between(low, high):
    """Numbers of six digits: the file keeps seven."""
    return st.floats(low, high).map(lambda value: float(f"{value:.6g}"))


some_panes = st.builds(
    Pane,
    kind=st.sampled_from(list(KINDS)),
    quantity=st.sampled_from(list(QUANTITIES)),
    lens=st.sampled_from([None, 0, 1]),
    minus=st.sampled_from([None, 0, 1]),
    low=between(-5, 0),
    high=between(1, 5),
    step=st.none() | between(0.125, 2),
    eye=st.sampled_from(EYES),
    azimuth=between(-80, 80),
    elevation=between(-80, 80),
    width=between(5, 120),
    split=st.booleans(),
)
changes = st.fixed_dictionaries(
    {
        "panes": st.tuples(*[some_panes] * 4),
        "split": st.sampled_from(SPLITS),
        "scene": st.sampled_from(["room", "a place/of mine.toml", "<b>&"]),
        "lens": st.sampled_from([0, 1]),
        "distance": st.sampled_from([np.inf, "scene", "model"]) | between(200, 1e5),
        "accommodation": st.sampled_from(["retina", "object", "paper"]),
        "depths": st.lists(between(150, 4000), min_size=1, max_size=9).map(tuple),
        "head_turn": between(-60, 60),
        "head_tilt": between(-60, 60),
    }
)


@pytest.fixture(scope="module")
def table():
    """Two lenses, one of them edited, and the wearers that came with them."""
    bench = Workbench().with_lens(SAMPLES / "sphere_minus_4_R.toml").with_lens(SAMPLES / "toric_R.toml")
    edited = bench.lenses[1].edited(centre_thickness=3.5, material="MR-8", ordered=Order(-1.0, -0.5, 30.0))
    return replace(bench, lenses=(bench.lenses[0], edited))


@settings(max_examples=8)
@given(change=changes, window=st.sampled_from(["", "QkI="]))
def test_what_lies_on_the_table_comes_back(table, tmp_path_factory, change, window):
    bench = replace(table, **change)
    path = tmp_path_factory.mktemp("session") / "a.lensbench.json"
    save_session(bench, path, window)
    back, state = load_session(path)
    assert state == window
    for name in (field.name for field in fields(Workbench)):
        if name not in ("lenses", "wearers"):
            assert getattr(back, name) == getattr(bench, name), name


def test_lenses_and_wearers_come_back_with_their_edits(table, tmp_path):
    path = tmp_path / "a.lensbench.json"
    save_session(table, path)
    back, _ = load_session(path)
    for found, meant in zip(back.lenses, table.lenses, strict=True):
        assert found.path.resolve() == meant.path.resolve()
        assert asdict(found.edits) == asdict(meant.edits)
        assert found.lens.centre_thickness == meant.lens.centre_thickness
        assert found.lens.material == meant.lens.material
        assert (found.lens.ordered is None) == (meant.lens.ordered is None)
        assert found.lens.ordered is None or asdict(found.lens.ordered) == asdict(meant.lens.ordered)
    for found, meant in zip(back.wearers, table.wearers, strict=True):
        assert found.name == meant.name
        np.testing.assert_allclose(found.eye.refraction, meant.eye.refraction, atol=1e-9)
        assert asdict(found.wear) == asdict(meant.wear)


def test_lens_files_are_named_relative_to_the_session(table, tmp_path):
    folder = tmp_path / "deep"
    folder.mkdir()
    (tmp_path / "lens.toml").write_bytes((SAMPLES / "sphere_minus_4_R.toml").read_bytes())
    save_session(Workbench().with_lens(tmp_path / "lens.toml"), folder / "a.lensbench.json")
    assert json.loads((folder / "a.lensbench.json").read_text())["lenses"][0]["file"] == "../lens.toml"
    moved = tmp_path.rename(tmp_path.with_name(tmp_path.name + "-moved"))
    assert len(load_session(moved / "deep" / "a.lensbench.json")[0].lenses) == 1


def with_value(*keys_and_value):
    *keys, last, value = keys_and_value

    def change(data):
        for key in keys:
            data = data[key]
        data[last] = value

    return change


BAD = {
    "another format": (with_value("format", "lensbench-lens/1"), "it must hold format"),
    "unknown key": (with_value("zoom", 2), "zoom"),
    "three viewports": (with_value("split", 3), "split"),
    "three panes": (lambda data: data["panes"].pop(), "panes"),
    "unknown kind": (with_value("panes", 0, "kind", "cake"), "panes.0.kind"),
    "unknown quantity": (with_value("panes", 1, "quantity", "taste"), "panes.1.quantity"),
    "a lens that is not there": (with_value("panes", 1, "lens", 7), "panes.1"),
    "a step of nothing": (with_value("panes", 1, "step", 0.0), "panes.1.step"),
    "a lens beyond the last": (with_value("lens", 5), "no lens 5"),
    "a wearer beyond the last": (with_value("wearer", 9), "no wearer 9"),
    "nobody as ordered": (with_value("as_ordered", 9), "as_ordered: there is no wearer 9"),
    "no wearer": (with_value("wearers", []), "wearers"),
    "a distance in words": (with_value("distance", "far"), "distance"),
    "no depths": (with_value("depths", []), "depths"),
    "a head turned round": (with_value("head_turn", 180.0), "head_turn"),
    "a lens file that is not there": (with_value("lenses", 0, "file", "gone.toml"), "gone.toml"),
    "an unknown material": (with_value("lenses", 0, "material", "cheese"), "cheese"),
    "a side of neither eye": (with_value("lenses", 0, "side", "U"), "lenses.0.side"),
    "a pupil of nothing": (with_value("wearers", 0, "eye", "pupil_diameter", 0.0), "pupil_diameter"),
    "an order beyond reason": (with_value("lenses", 0, "ordered", {"sphere": 99.0}), "sphere"),
    "a distance before the lens": (with_value("distance", -100.0), "distance"),
    "a depth behind the eye": (with_value("depths", [-300.0]), "depths"),
    "an upside-down scale": (lambda data: data["panes"][0].update(low=2.0, high=1.0), "panes.0"),
    "half a scale": (lambda data: data["panes"][0].update(low=2.0), "panes.0"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_session_is_one_sentence(name, table, tmp_path):
    change, named = BAD[name]
    path = tmp_path / "bad.lensbench.json"
    save_session(table, path)
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))
    with pytest.raises(InputError) as error:
        load_session(path)
    assert str(path) in str(error.value) or "gone.toml" in str(error.value)
    assert named in str(error.value)
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '"' + FORMAT + '"', "\x00\xff"])
def test_what_is_no_session_is_one_sentence(text, tmp_path):
    path = tmp_path / "bad.lensbench.json"
    path.write_text(text, encoding="latin-1")
    with pytest.raises(InputError, match=r"bad\.lensbench\.json: "):
        load_session(path)


def test_a_table_without_a_lens_is_a_session(tmp_path):
    save_session(Workbench(), tmp_path / "a.lensbench.json")
    back, _ = load_session(tmp_path / "a.lensbench.json")
    assert back.lenses == ()
    assert back.active_lens is None


def test_a_lens_taken_off_leaves_panes_and_indices_right(table):
    bench = replace(table, lens=1).with_pane(0, lens=1, minus=0).with_pane(1, lens=0)
    left = bench.without_lens(0)
    assert left.active_lens is table.lenses[1].lens
    assert (left.panes[0].lens, left.panes[0].minus, left.panes[1].lens) == (0, None, None)
    assert left.without_lens(0).active_lens is None


def test_each_lens_has_the_wearer_of_its_order_until_one_is_chosen(tmp_path):
    names = ("sphere_minus_4_R.toml", "regular_R.toml")
    bench = Workbench()
    for name in names:
        bench = bench.with_lens(SAMPLES / name)
    assert len(bench.wearers) == 1
    save_session(bench, tmp_path / "a.lensbench.json")
    back, _ = load_session(tmp_path / "a.lensbench.json")
    for table in (bench, back):
        for entry in table.lenses:
            worn = table.worn_by(entry.lens)
            np.testing.assert_allclose(worn.eye.refraction, entry.lens.ordered.power(), atol=1e-9)
            assert worn.eye.accommodation == max(0.0, 2 * (2.5 - entry.lens.ordered.addition))
            assert table.worn_by(entry.lens) is worn, "the same question has the same answer"
    chosen = bench.with_wearer(replace(bench.active_wearer, name="chosen"))
    assert {chosen.worn_by(entry.lens) for entry in chosen.lenses} == {chosen.wearers[1]}
    assert chosen.as_ordered == 0


def test_a_wearer_who_came_first_stays(tmp_path):
    mine = Workbench().with_wearer(replace(Workbench().active_wearer, name="mine"))
    assert mine.with_lens(SAMPLES / "regular_R.toml").wearers == mine.wearers
