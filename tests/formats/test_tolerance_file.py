"""Tables of tolerances: those of the package, one's own, and what is refused."""

import pytest

import lensbench as lb
from lensbench.cli import main
from lensbench.errors import InputError
from lensbench.formats.tolerance_file import FOLDER
from lensbench.optics.conventions import power_matrix
from lensbench.optics.lens import Order
from lensbench.optics.tolerances import power_lines

TEXT = (FOLDER / "ansi_z80_1_2015.toml").read_text(encoding="utf-8")


def own(folder, *changes):
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "own.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_editions_differ_in_what_of_the_power_they_judge():
    newest, older = lb.load_tolerances(), lb.load_tolerances("ansi z80.1-2010")
    assert (newest.edition, newest.power) == ("ANSI Z80.1-2015", "sphere")
    assert (older.edition, older.power) == ("ANSI Z80.1-2010", "highest meridian")
    assert newest.progressive == older.progressive
    assert newest.source
    assert newest.source != older.source


def test_steps_may_depend_on_the_power_of_the_lens(tmp_path):
    """As in tables whose tolerance of the cylinder grows with the power: both must be within a step."""
    small = "{ up_to = 2.00, power_up_to = 3.0, tolerance = 0.09 }, { up_to = 2.00, tolerance = 0.12 }"
    steps = f"[{small}, {{ tolerance = 0.2, share = 0.01 }}]"
    table = lb.load_tolerances(
        own(
            tmp_path,
            ("[{ up_to = 2.00, tolerance = 0.13 }, { up_to = 4.50, tolerance = 0.15 }, { share = 0.04 }]", steps),
        )
    )
    allowed = [
        {line.name: line.tolerance for line in power_lines(table, order, power_matrix(0.0))}["cylinder"]
        for order in (Order(-1.0, -2.0), Order(-1.5, -2.0), Order(0.0, -2.5))
    ]
    assert allowed == pytest.approx([0.09, 0.12, 0.225])


def test_the_report_of_a_verification_names_ones_own_edition(tmp_path, capsys):
    path = own(
        tmp_path, ('edition = "ANSI Z80.1-2015"', 'edition = "house rules"'), ("tolerance = 0.13", "tolerance = 0.001")
    )
    lens = FOLDER.parent.parent.parent / "sample_lenses" / "toric_R.toml"
    assert main(["verify", str(lens), "--tolerances", str(path)]) == 0
    text = capsys.readouterr().out
    assert "Judged by house rules against the order" in text


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ((("{ share = 0.02 }", "{ up_to = 20.0, share = 0.02 }"),), "single_vision.power: the last step must hold"),
        ((("{ share = 0.02 }", "{ }"),), "each step needs a tolerance"),
        ((('power = "sphere" ', 'power = "cylinder" '),), "power: input should be 'sphere' or 'highest meridian'"),
        ((("prism = 0.33 ", "prisms = 0.33 "),), "unknown key 'prisms'; did you mean 'prism'"),
        ((('edition = "ANSI Z80.1-2015"', 'edition = ""'),), "edition"),
    ],
)
def test_a_table_that_is_not_whole_is_refused(tmp_path, changes, words):
    path = own(tmp_path, *changes)
    with pytest.raises(InputError, match=r"own\.toml") as caught:
        lb.load_tolerances(path)
    assert words in str(caught.value)


def test_an_edition_that_is_not_known(tmp_path):
    with pytest.raises(InputError, match=r"'ISO' is not known; there are ANSI Z80.1-2010, ANSI Z80.1-2015"):
        lb.load_tolerances("ISO")
    with pytest.raises(InputError, match=r"none.toml"):
        lb.load_tolerances(tmp_path / "none.toml")
