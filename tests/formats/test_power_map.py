"""Maps of lens mappers: files written here in the layouts that are read, from known powers or from a design itself."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

import lensbench as lb
from lensbench.cli import main
from lensbench.errors import InputError
from lensbench.formats import load_power_map
from lensbench.layers import AgainstLayer, Request
from lensbench.optics import surfaces
from lensbench.optics.conventions import power_matrix, sphere_cylinder_axis
from lensbench.optics.lens import ellipse_outline
from lensbench.optics.lensmeter import back_vertex_power
from lensbench.workbench import run

G = np.arange(-24.0, 25.0, 4.0)
X, Y = np.meshgrid(G, G)
REGULAR = "sample_lenses/regular_R.toml"


@pytest.fixture
def lens(lens_of):
    return lens_of(surfaces.sphere(100.0), surfaces.toric(0.009, 0.012, 30.0), 4.0, outline=ellipse_outline(56, 44))


def columns_text(sphere, cylinder, axis, head="x;y;sph;cyl;axis", mark=";", decimal="."):
    lines = [head.replace(";", mark)]
    for row in np.stack([X, Y, sphere, cylinder, axis], -1).reshape(-1, 5):
        lines.append(mark.join("" if np.isnan(v) else f"{v:.6f}".replace(".", decimal) for v in row))
    return "\r\n".join(lines) + "\r\n"


def saved(folder, text, name="map.csv"):
    path = folder / name
    path.write_text(text, newline="")
    return path


@pytest.mark.parametrize(
    ("head", "mark", "decimal"),
    [
        ("x;y;sph;cyl;axis", ";", "."),
        ("X [mm];Y [mm];Sphere (D);Cylinder (D);Axis (deg)", ",", "."),
        ("x_mm;y_mm;S;C;A", "\t", ","),
        ("x;y;sph;cyl;ax", ";", ","),
        ("x;y;sph;cyl;axis", " ", "."),
    ],
)
def test_columns_by_their_names(tmp_path, head, mark, decimal):
    sphere, cylinder = 1 + X / 50, -0.5 + Y / 100
    found = load_power_map(saved(tmp_path, columns_text(sphere, cylinder, 30 + X, head, mark, decimal)))
    assert found.x == pytest.approx(G)
    assert found.mean == pytest.approx(sphere + cylinder / 2, abs=1e-6)
    assert found.astigmatism == pytest.approx(-cylinder, abs=1e-6)
    assert found.axis == pytest.approx(30 + X, abs=1e-6)


def test_plus_and_minus_cylinders_are_one(tmp_path):
    minus = load_power_map(saved(tmp_path, columns_text(1 + 0 * X, -0.5 + 0 * X, 100 + 0 * X)))
    plus = load_power_map(saved(tmp_path, columns_text(0.5 + 0 * X, 0.5 + 0 * X, 10 + 0 * X)))
    for name in ("mean", "astigmatism", "axis"):
        assert getattr(minus, name) == pytest.approx(getattr(plus, name))


def test_a_matrix_of_one_quantity(tmp_path):
    rows = [["mean power (D)", *G[::-1]], *([y, *(2 + G[::-1] / 50 + y / 100)] for y in G)]
    found = load_power_map(saved(tmp_path, "\n".join(";".join(map(str, row)) for row in rows)))
    assert found.mean == pytest.approx(2 + X / 50 + Y / 100)
    assert found.measured == ["mean"]


@pytest.mark.parametrize("behind", [False, True])
def test_a_map_of_the_design_itself_differs_by_what_was_added(tmp_path, lens, behind):
    power = back_vertex_power(lens, X.ravel(), Y.ravel()).power + power_matrix(0.1, 0.25, 70)
    sphere, cylinder, axis = (v.reshape(X.shape) for v in sphere_cylinder_axis(power))
    sphere[3, 4] = np.nan
    if behind:
        sphere, cylinder, axis = sphere[:, ::-1], cylinder[:, ::-1], 180 - axis[:, ::-1]
    measured = load_power_map(saved(tmp_path, columns_text(sphere, cylinder, axis)))
    layer = AgainstLayer(measured.mirrored() if behind else measured)
    found = run(Request(lens, lb.Wearer(), layer))
    inside = lens.outline.contains(X, Y)
    inside[3, 4] = False
    assert found.mean[inside] == pytest.approx(0.225, abs=1e-5)
    assert found.astigmatic[inside] == pytest.approx(0.25, abs=1e-5)
    assert np.isnan(found.mean[~inside]).all()


def test_as_worn(tmp_path, lens):
    wearer = lb.Wearer()
    worn = lb.look_through(lens, wearer, X.ravel(), Y.ravel()).as_worn_power(500.0)
    text = columns_text(*(v.reshape(X.shape) for v in worn))
    found = run(Request(lens, wearer, AgainstLayer(load_power_map(saved(tmp_path, text)), "worn", 500.0)))
    assert np.nanmax(np.abs(found.mean)) < 1e-5
    assert np.nanmax(found.astigmatic) < 1e-5


def test_the_command_writes_numbers_a_table_and_a_picture(tmp_path, capsys):
    lens = lb.load_lens(REGULAR)
    power = back_vertex_power(lens, X.ravel(), Y.ravel()).power + power_matrix(0.1, 0.0, 0)
    path = saved(
        tmp_path, columns_text(*(np.nan_to_num(v, nan=np.nan).reshape(X.shape) for v in sphere_cylinder_axis(power)))
    )
    assert main(["against", REGULAR, str(path), "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    assert numbers["mean_power"]["rms_D"] == pytest.approx(0.1, abs=1e-4)
    assert numbers["mean_power"]["within_tolerance"] == 1
    for name in ("against.png", "against.csv"):
        assert main(["against", REGULAR, str(path), "-o", str(tmp_path / name)]) == 0
    rows = list(csv.DictReader((tmp_path / "against.csv").open()))
    assert float(rows[0]["mean_power_difference_D"]) == pytest.approx(0.1, abs=1e-4)
    assert main(["check", str(path)]) == 0
    assert "Measured astigmatism" in capsys.readouterr().out


BAD = [
    ("", "is empty"),
    ("x;y;sph;cyl;axis\n", "0 points are no map"),
    ("x;y;sph;cyl;axis\n0;0;1;abc;0\n", "line 2, column 4: 'abc' is not a number"),
    ("x;y;sph;cyl;axis\n0;0;1\n", "line 2: 3 columns where the first line names 5"),
    ("x;y;sph;cyl;axis\n;0;1;0;0\n0;1;1;0;0\n1;0;1;0;0\n1;1;1;0;0\n", "a point has no x or no y"),
    ("x;y;mean\n" + "".join(f"{k};{k * k / 7:.3f};1\n" for k in range(40)), "they lie on no grid"),
    ("mean;0;1\n0;1;2\n1;1\n", "line 3: 2 columns where the first line has 3"),
    ("mean;0;1\n0;1;2\n", "a matrix needs two x and two y"),
    ("mean;0;1\n0;1;x\n1;1;2\n", "line 2, column 3: 'x' is not a number"),
]


@pytest.mark.parametrize(("text", "words"), BAD)
def test_bad_maps_say_so(tmp_path, text, words):
    with pytest.raises(InputError) as failure:
        load_power_map(saved(tmp_path, text))
    assert words in str(failure.value)


def test_a_map_beside_the_lens_says_so(tmp_path, lens):
    found = load_power_map(saved(tmp_path, columns_text(1 + 0 * X, 0 * X, 0 * X)))
    far = replace(found, x=found.x + 200)
    with pytest.raises(InputError, match="no measured point lies where"):
        run(Request(lens, lb.Wearer(), AgainstLayer(far)))
