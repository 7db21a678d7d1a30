"""Files that are wrong: one clear sentence with the place, whatever the bytes, and memory bounded by the file's size."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from lensbench.cli import main
from lensbench.errors import LensBenchError
from lensbench.formats import Reading, read_file

G = np.linspace(-6, 6, 7)
Z = np.round(np.add.outer(G[::-1] ** 2, G**2) / 240, 6)


def rows(separator, start=""):
    return "".join(start + separator.join(f"{v:.6f}" for v in row) + "\n" for row in Z)


SDF = f"SURFMT=1;R;F;7;7;12;12;0\n{rows(';', 'ZZ=')}"
HMF = f"File Version=1.2\n[Properties]\nCount=7\nInterval=2\n[Data]\n{rows(',')}"
XYZ = "".join(
    f"{x:g} {y:g} {z:.6f}\n" for y, line in zip(G[::-1], Z, strict=True) for x, z in zip(G, line, strict=True)
)
CSV = "x,y,sag\n" + XYZ.replace(" ", ",")
DAT = "7 7 2 2 0 0 0\n" + "".join(f"{z:.6f} 0 0 0 0\n" for z in Z.ravel())
INT = "title\nGRD 7 7 SUR WVL 0.5 SSZ 2\n" + "\n".join(" ".join(f"{1000 * z:.0f}" for z in row) for row in Z) + "\n"
VALUE = f"{Z[1, 1]:.6f}"

BAD = {
    # name: (file name, content, words that its sentence holds)
    "sdf truncated": ("a.sdf", "\n".join(SDF.splitlines()[:5]), "truncated"),
    "sdf truncated within a row": ("a.sdf", SDF[:-20], "line 8"),
    "sdf a value too many": ("a.sdf", SDF.replace(VALUE, VALUE + ";0.5", 1), "line 3"),
    "sdf a row too many": ("a.sdf", SDF + SDF.splitlines()[-1], "line 9"),
    "sdf NaN": ("a.sdf", SDF.replace(VALUE, "NaN", 1), "line 3, value 2"),
    "sdf infinite": ("a.sdf", SDF.replace(VALUE, "inf", 1), "line 3, value 2"),
    "sdf overflow": ("a.sdf", SDF.replace(VALUE, "1e999", 1), "line 3, value 2"),
    "sdf decimal comma": ("a.sdf", SDF.replace(VALUE, VALUE.replace(".", ","), 1), "decimal point"),
    "sdf commas for semicolons": ("a.sdf", SDF.replace(";", ","), "SURFMT has 1 fields"),
    "sdf commas in one row": ("a.sdf", SDF[:60] + SDF[60:150].replace(";", ",") + SDF[150:], "line"),
    "sdf a word": ("a.sdf", SDF.replace(VALUE, "deep", 1), "'deep' is not a number"),
    "sdf underscores": ("a.sdf", SDF.replace(VALUE, "1_0", 1), "line 3"),
    "sdf a mile": ("a.sdf", SDF.replace(VALUE, "1609344", 1), "not a sag"),
    "sdf no header": ("a.sdf", SDF.replace("SURFMT", "SURFACE"), "SURFMT"),
    "sdf header cut": ("a.sdf", "SURFMT=1;R;F;7\n", "line 1"),
    "sdf header words": ("a.sdf", SDF.replace("7;7;12;12", "seven;7;12;12"), "field 4"),
    "sdf fractional counts": ("a.sdf", SDF.replace("7;7;12;12", "7.5;7;12;12"), "field 4"),
    "sdf negative counts": ("a.sdf", SDF.replace("7;7;12;12", "-7;7;12;12"), "field 4"),
    "sdf binary format": ("a.sdf", SDF.replace("SURFMT=1", "SURFMT=2"), "line 1"),
    "sdf huge counts": ("a.sdf", SDF.replace("7;7;12;12", "99999999;99999999;12;12"), "field 4"),
    "sdf a gigabyte announced": ("a.sdf", SDF.replace("7;7;12;12", "3900;3900;12;12"), "points"),
    "sdf most points announced": ("a.sdf", SDF.replace("7;7;12;12", "2000;2000;12;12"), "line 2"),
    "sdf no extent": ("a.sdf", SDF.replace("7;7;12;12", "7;7;0;12"), "positive"),
    "sdf extent NaN": ("a.sdf", SDF.replace("7;7;12;12", "7;7;nan;12"), "field 6"),
    "sdf a side of its own": ("a.sdf", SDF.replace(";R;", ";X;"), "must be R or L"),
    "sdf empty": ("a.sdf", "", "SURFMT"),
    "sdf too few points": ("a.sdf", "SURFMT=1;R;F;4;4;9;9;0\n" + "ZZ=0;0;0;0\n" * 4, "6 x 6"),
    "sdf hardly any value": ("a.sdf", "SURFMT=1;R;F;9;9;9;9;0\n" + "ZZ=0;?;?;?;?;?;?;?;?\n" * 9, "only 9 of 81"),
    "sdf second block cut": ("a.sdf", SDF + SDF.replace(";R;", ";L;")[:200], "line"),
    "hmf truncated": ("a.hmf", "\n".join(HMF.splitlines()[:9]), "truncated"),
    "hmf truncated within a row": ("a.hmf", HMF[:-20], "line 12"),
    "hmf no data": ("a.hmf", HMF.replace("[Data]", "[Dato]"), "[Data]"),
    "hmf no count": ("a.hmf", HMF.replace("Count", "Cont"), "Count="),
    "hmf no interval": ("a.hmf", HMF.replace("Interval", "Inter"), "Interval="),
    "hmf interval zero": ("a.hmf", HMF.replace("Interval=2", "Interval=0"), "line 4"),
    "hmf count a word": ("a.hmf", HMF.replace("Count=7", "Count=many"), "line 3"),
    "hmf count too small": ("a.hmf", HMF.replace("Count=7", "Count=6"), "too many"),
    "hmf huge count": ("a.hmf", HMF.replace("Count=7", "Count=1000000000"), "line 3"),
    "hmf semicolons": ("a.hmf", HMF.replace(",", ";"), "separated by commas"),
    "hmf NaN": ("a.hmf", HMF.replace(VALUE, "nan", 1), "line 7, value 2"),
    "hmf empty": ("a.hmf", "", "[Data]"),
    "xyz two values": ("a.xyz", XYZ + "1 2\n", "line 50"),
    "xyz two columns": ("a.xyz", "1 2\n" * 60, "x y z"),
    "xyz a value too many": ("a.xyz", "1 2 3 4\n" + XYZ, "line 1"),
    "xyz separators mixed": ("a.xyz", XYZ + "7;7;0.5\n", "line"),
    "xyz NaN in x": ("a.xyz", XYZ.replace("-6 6 ", "nan 6 ", 1), "line 1, x"),
    "xyz a word": ("a.xyz", XYZ.replace("-6 4 ", "-6 four ", 1), "y"),
    "xyz decimal commas": ("a.xyz", XYZ.replace(".", ","), "decimal points"),
    "xyz far away": ("a.xyz", XYZ + "1e6 0 0\n", "line 50, x"),
    "xyz too few": ("a.xyz", "".join(XYZ.splitlines(True)[:9]), "too few"),
    "xyz on one line": ("a.xyz", "".join(f"{k} 0 {k * k / 200}\n" for k in range(60)), "one line"),
    "xyz empty": ("a.xyz", "", "empty"),
    "xyz comments only": ("a.xyz", "# nothing\n! here\n", "empty"),
    "csv header without sag": ("a.txt", CSV.replace("sag", "colour"), "line 1"),
    "csv a cell empty": ("a.csv", CSV.replace("-6,6,", ",6,", 1), "line 2, x"),
    "dat truncated": ("a.dat", "\n".join(DAT.splitlines()[:30]), "truncated"),
    "dat too long": ("a.dat", DAT + "0 0 0 0 0\n", "too many"),
    "dat header cut": ("a.dat", DAT.replace("7 7 2 2 0 0 0", "7 7 2"), "line 1"),
    "dat counts zero": ("a.dat", DAT.replace("7 7 2 2", "0 7 2 2"), "nx"),
    "dat unit unknown": ("a.dat", DAT.replace("2 2 0 0 0", "2 2 9 0 0"), "unitflag"),
    "dat pitch negative": ("a.dat", DAT.replace("7 7 2 2", "7 7 -2 2"), "delx"),
    "dat huge counts": ("a.dat", DAT.replace("7 7 2 2", "1000000 1000000 2 2"), "nx"),
    "dat NaN": ("a.dat", DAT.replace(VALUE, "nan", 1), "line 10, value 1"),
    "dat three values": ("a.dat", DAT.replace(f"{VALUE} 0 0 0 0", f"{VALUE} 0 0", 1), "line 10"),
    "dat metres": ("a.dat", DAT.replace("2 2 0 0 0", "0.002 0.002 3 0 0").replace(VALUE, "2.5", 1), "line 10"),
    "dat empty": ("a.dat", "", "empty"),
    "int truncated": ("a.int", INT[:-20], "truncated"),
    "int too long": ("a.int", INT + "5 5 5\n", "more numbers"),
    "int a wavefront": ("a.int", INT.replace("SUR", "WFR"), "SUR"),
    "int no scale": ("a.int", INT.replace("SSZ 2", ""), "SSZ"),
    "int scale zero": ("a.int", INT.replace("SSZ 2", "SSZ 0"), "SSZ"),
    "int more than 16 bits": ("a.int", INT.replace("\n300", "\n99999", 1), "line 3"),
    "int huge counts": ("a.int", INT.replace("GRD 7 7", "GRD 4000000 7"), "line 2"),
    "int Zernike": ("a.int", INT.replace("GRD", "ZRN"), "GRD"),
    "rubbish, sdf": ("a.sdf", bytes(range(256)) * 20, "not text"),
    "rubbish, xyz": ("a.xyz", b"\x00\x01\x02" * 500, "not text"),
    "rubbish without name": ("lens", bytes(range(255, 0, -1)) * 8, "is not read"),
    "half a UTF-16 file": ("a.sdf", SDF.encode("utf-16")[:-1], "not text"),
    "UTF-16 cut in a row": ("a.sdf", SDF.encode("utf-16")[:-40], "line 8"),
    "old Mac lines, truncated": ("a.sdf", "\r".join(SDF.splitlines()[:5]), "truncated"),
    "byte order mark, truncated": ("a.sdf", b"\xef\xbb\xbf" + SDF[:-40].encode(), "line 8"),
    "another kind": ("notes.md", "# notes\n", "is not read"),
}  # fmt: skip


def understood(path):
    """What the tool does with a surface file: read it, and fit every surface in it."""
    for item in read_file(path).items:
        if hasattr(item, "fitted"):
            item.fitted(Reading("R", "F"))


def saved(folder, name, content):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_there_are_enough_of_them():
    assert len(BAD) >= 60


@pytest.mark.parametrize(
    "good", [("a.sdf", SDF), ("a.hmf", HMF), ("a.xyz", XYZ), ("a.csv", CSV), ("a.dat", DAT), ("a.int", INT)]
)
def test_what_they_were_made_of_is_good(tmp_path, good):
    understood(saved(tmp_path, *good))


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_gets_one_sentence(tmp_path, case, capsys):
    name, content, words = BAD[case]
    path = saved(tmp_path, name, content)
    tracemalloc.start()
    with pytest.raises(LensBenchError) as caught:
        understood(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    sentence = str(caught.value)
    assert words in sentence
    assert name in sentence
    assert "\n" not in sentence
    assert len(sentence) < 600
    assert peak < 8e6 + 100 * len(content)
    assert main(["map", str(path), "--side", "R", "-o", str(tmp_path / "m.csv")]) in (1, 2)
    printed = capsys.readouterr()
    assert len(printed.err.splitlines()) == 1
    assert not (tmp_path / "m.csv").exists()


WOUNDS = ["", "?", ";", ",", "\n", "\r", "\x00", "nan", "-", "1e9", "9" * 30, "SURFMT=", "é", " ", "=", "1;2", "\t"]
SEEDS = [SDF, HMF, XYZ, CSV, DAT, INT]
NAMES = [
    "a.sdf",
    "a.hmf",
    "a.xyz",
    "a.csv",
    "a.txt",
    "a.dat",
    "a.grd",
    "a.int",
    "a.lms",
    "a.json",
    "a.zmx",
    "a.toml",
    "a",
]


def attempt(folder, name, content):
    path = folder / name
    path.write_bytes(content)
    try:
        understood(path)
    except LensBenchError as error:
        assert "\n" not in str(error)  # noqa: PT017
        assert name in str(error)  # noqa: PT017


@settings(max_examples=150)
@given(st.sampled_from(NAMES), st.binary(max_size=300))
@example("a.sdf", b"SURFMT=1;R;F;7;7;1e308;1e308;0\nZZ=" + b"1e308;" * 7)
def test_any_bytes_give_a_sentence_or_a_surface(tmp_path_factory, name, content):
    attempt(tmp_path_factory.mktemp("fuzz"), name, content)


@settings(max_examples=250)
@given(
    st.sampled_from(SEEDS), st.sampled_from(NAMES), st.integers(0, 10**6), st.integers(0, 12),
    st.sampled_from(WOUNDS),
    st.sampled_from(["utf-8", "utf-16", "latin-1"]),
)  # fmt: skip
def test_a_good_file_with_a_wound_gives_a_sentence_or_a_surface(tmp_path_factory, seed, name, at, cut, put, encoding):
    at %= len(seed)
    attempt(tmp_path_factory.mktemp("fuzz"), name, (seed[:at] + put + seed[at + cut :]).encode(encoding))
