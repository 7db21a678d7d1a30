"""Our JSON B-spline and the VTK file: what is written comes back."""

import json

import numpy as np
import pytest
import pyvista as pv

import lensbench as lb
from lensbench.errors import InputError
from lensbench.formats.bspline_file import bspline_text, read
from lensbench.formats.vtp import vtp_text
from lensbench.optics import surfaces
from lensbench.optics.conventions import mean_power
from lensbench.optics.lens import ellipse_outline

X, Y = np.meshgrid(np.linspace(-20, 20, 21), np.linspace(-15, 15, 17))


def written(folder, text, name="surface.json"):
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_a_spline_comes_back_to_the_last_digit(tmp_path, spline_arrays, degree):
    knots = np.array([-30.0] * (degree + 1) + [-12.0, 3.0, 8.0] + [30.0] * (degree + 1))
    coefficients = np.random.default_rng(degree).normal(size=(knots.size - degree - 1,) * 2)
    surface = surfaces.bspline(knots, knots, coefficients, degree, decentration=(1.5, -2.0), tilt=(0.1, -0.02))
    (found,) = read(written(tmp_path, bspline_text(surface, (0, 0, 0, 0), side="L", face="back")))
    again = found.surface
    assert again.sag(X, Y) == pytest.approx(surface.sag(X, Y), abs=1e-12)
    assert again.derivatives(X, Y).fxx == pytest.approx(surface.derivatives(X, Y).fxx, abs=1e-11)
    assert (again.decentration, found.side, found.face) == ((1.5, -2.0), "L", "B")
    assert again.tilt == pytest.approx(surface.tilt, abs=1e-15)


def test_any_surface_can_be_written(tmp_path, shape):
    surface, _ = shape
    (found,) = read(written(tmp_path, bspline_text(surface, (-24, 24, -20, 20))))
    again = found.surface
    assert again.sag(X, Y) == pytest.approx(surface.sag(X, Y), abs=1e-9)
    assert again.derivatives(X, Y).fyy == pytest.approx(surface.derivatives(X, Y).fyy, abs=1e-7)


def test_a_sphere_that_ends_within_the_box(tmp_path):
    surface = surfaces.sphere(26.0)
    (found,) = read(written(tmp_path, bspline_text(surface, (-20, 20, -20, 20))))
    again = found.surface
    assert again.sag(X * 0.8, Y * 0.8) == pytest.approx(surface.sag(X * 0.8, Y * 0.8), abs=1e-4)


GOOD = {"format": "lensbench-bspline/1", "degree": 2, "knots_x": [0, 0, 0, 1, 1, 1], "knots_y": [0, 0, 0, 1, 1, 1]}
GOOD["coefficients"] = [[0.0] * 3] * 3


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "line 1, column 1: not valid JSON"),
        ('{"format": "lensbench-bspline/1",\n "degree": }', "line 2, column 12: not valid JSON"),
        ("[" * 100_000, "not valid JSON"),
        ("[1, 2]", "must be a table"),
        (json.dumps(GOOD | {"degree": 6}), "degree"),
        (json.dumps(GOOD | {"format": "other"}), "format"),
        (json.dumps(GOOD | {"knots": [1]}), "unknown key 'knots'; did you mean 'knots_"),
        (json.dumps(GOOD | {"coefficients": [[0.0] * 3] * 4}), "knots_y"),
        (json.dumps(GOOD | {"coefficients": [[0.0, float("nan"), 0.0]] * 3}), "coefficients"),
        (json.dumps(GOOD | {"knots_x": [0, 0, 1, 0, 1, 1]}), "knots_x: knots must rise"),
    ],
)
def test_bad_files_say_so(tmp_path, text, words):
    path = written(tmp_path, text)
    with pytest.raises(InputError) as failure:
        read(path)
    assert words in str(failure.value)
    assert str(path) in str(failure.value)
    assert len(str(failure.value)) < 400


def test_vtk_reads_the_lens_with_its_powers(tmp_path, lens_of):
    lens = lens_of(surfaces.sphere(90.0), surfaces.sphere(150.0), 4.0, outline=ellipse_outline(56, 44, (1.0, 2.0)))
    wearer = lb.Wearer()
    skin = pv.read(written(tmp_path, vtp_text(lens, wearer, 400.0), "lens.vtp"))
    assert skin.volume == pytest.approx(lens.weight() / lens.material.density * 1000, rel=1e-3)
    assert skin.is_manifold
    assert sorted(set(skin.cell_data["part"])) == [0, 1, 2]
    assert skin.point_data["thickness_mm"] == pytest.approx(lens.thickness(*skin.points[:, :2].T), abs=1e-9)
    front = skin.points[: skin.n_points // 2]
    assert front[:, 2] == pytest.approx(lens.front_height(*front[:, :2].T), abs=1e-9)
    inner = lens.outline.contains(*(1.001 * front[:, :2]).T)
    worn = lb.look_through(lens, wearer, *front[inner, :2].T).as_worn_matrix(400.0)
    mine = skin.point_data["as_worn_mean_power_D"][: skin.n_points // 2]
    assert mine[inner] == pytest.approx(mean_power(worn), abs=1e-9)
    assert np.isfinite(mine).all()
    assert np.nanmax(np.abs(skin.point_data["front_mean_power_D"] - 600 / 90)) < 1e-9
