"""Meshes: written and read, and powers found again from facets; files are made here by trimesh and by our writer."""

import numpy as np
import pytest
import trimesh

from lensbench.errors import InputError
from lensbench.formats.mesh import read_mesh, stl_bytes
from lensbench.optics import surfaces
from lensbench.optics.conventions import astigmatism, mean_power
from lensbench.optics.lens import ellipse_outline
from lensbench.optics.materials import MATERIALS
from lensbench.optics.polar_mesh import lens_triangles

X, Y = np.meshgrid(np.linspace(-18, 18, 13), np.linspace(-14, 14, 11))


@pytest.fixture
def lens(lens_of, spline_arrays):
    return lens_of(
        surfaces.bspline(*spline_arrays()), surfaces.toric(0.008, 0.011, 130.0), 4.0, outline=ellipse_outline(52, 42)
    )


def test_the_skin_is_closed_and_has_the_lens_volume(lens):
    skin = trimesh.Trimesh(*lens_triangles(lens, 120, 720))
    assert skin.is_watertight
    assert skin.volume == pytest.approx(lens.weight() / lens.material.density * 1000, rel=3e-4)


@pytest.mark.parametrize("kind", [".stl", ".ply", ".obj"])
def test_powers_come_back_from_facets(lens, tmp_path, kind):
    path = tmp_path / f"lens{kind}"
    if kind == ".stl":
        path.write_bytes(stl_bytes(lens))
    else:
        trimesh.Trimesh(*lens_triangles(lens, 36, 200)).export(path)
    body = read_mesh(path)
    again = body.lens(MATERIALS["MR-8"])
    assert again.thickness(X, Y) == pytest.approx(lens.thickness(X, Y), abs=1e-4)
    for mine, theirs in ((again.front, lens.front), (again.back, lens.back)):
        error = mine.surface_power(X, Y, 1.6) - theirs.surface_power(X, Y, 1.6)
        assert np.abs(mean_power(error)).max() < 0.005
        assert astigmatism(error).max() < 0.005
    assert "power noise about" in body.understood[0]


def test_the_noise_that_is_stated_is_the_noise_that_is_there(lens_of, tmp_path):
    lens = lens_of(surfaces.sphere(100.0), surfaces.sphere(120.0), 4.0, outline=ellipse_outline(60, 60))
    points, triangles = lens_triangles(lens)
    points[:, 2] += np.random.default_rng(3).normal(0, 2e-4, len(points))
    path = tmp_path / "noisy.ply"
    trimesh.Trimesh(points, triangles, process=False).export(path)
    body = read_mesh(path)
    stated = float(body.understood[0].split("power noise about ")[1].split()[0])
    error = body.front.surface_power(X, Y, 1.6) - lens.front.surface_power(X, Y, 1.6)
    assert 0.3 < np.sqrt(np.mean(astigmatism(error) ** 2)) / stated < 3


def test_a_mesh_off_its_axis_and_upside_down(lens, tmp_path):
    points, triangles = lens_triangles(lens)
    path = tmp_path / "turned.ply"
    trimesh.Trimesh(points * [-1, 1, -1] + [100, 7, 30], triangles, process=False).export(path)
    body = read_mesh(path)
    assert any("turned" in line for line in body.understood)
    assert any("moved" in line for line in body.understood)
    assert body.front.sag(X, Y) == pytest.approx(lens.front.sag(X, Y), abs=1e-4)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("empty.stl", b"", "not a mesh"),
        ("cut.stl", b"LensBench".ljust(80) + b"\xff\xff\xff\x3f" + b"\x00" * 100, "not a mesh"),
        ("words.obj", b"hello\nworld\n", "not a mesh"),
        ("words.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", "not a mesh"),
        ("tiny.obj", b"v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\n", "3 vertices"),
        ("metres.obj", b"v 0 0 0\nv 0.01 0 0\nv 0 0.01 0\nf 1 2 3\n", "in mm"),
    ],
)
def test_bad_meshes_say_so(tmp_path, name, content, words):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=words) as failure:
        read_mesh(path)
    assert name in str(failure.value)
