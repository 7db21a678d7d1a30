"""Damaged files of every text and mesh format: they load, or say in one sentence what is wrong; never a traceback."""

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_power_map import X, columns_text
from test_vca_job import ORDER, trace_text
from test_zmx import zmx

from lensbench.errors import InputError
from lensbench.formats import read_file
from lensbench.formats.bspline_file import bspline_text
from lensbench.formats.mesh import stl_bytes
from lensbench.formats.registry import HEAD, format_of
from lensbench.optics import surfaces
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.optics.polar_mesh import lens_triangles

LENS = Lens(surfaces.sphere(90.0), surfaces.sphere(120.0), 3.0, MATERIALS["CR-39"], circle_outline(40.0))
COARSE = trimesh.Trimesh(*lens_triangles(LENS, 5, 24))
GOOD = {
    "job.lms": ("".join(f"{k}={v}\r\n" for k, v in ORDER.items()) + trace_text("R")).encode(),
    "lens.zmx": zmx().encode(),
    "wide.zmx": zmx().encode("utf-16"),
    "surface.json": bspline_text(
        surfaces.bspline([0.0] * 3 + [9.0] * 3, [0.0] * 3 + [9.0] * 3, np.eye(3), 2), (0, 9, 0, 9)
    ).encode(),
    "map.csv": columns_text(1 + X / 50, -0.5 + 0 * X, 30 + X).encode(),
    "lens.stl": COARSE.export(file_type="stl"),
    "text.stl": COARSE.export(file_type="stl_ascii").encode(),
    "lens.ply": COARSE.export(file_type="ply"),
    "lens.obj": COARSE.export(file_type="obj").encode(),
}
DAMAGE = st.lists(st.tuples(st.floats(0, 1), st.integers(0, 40), st.binary(max_size=12)), min_size=1, max_size=3)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of the mesh reader, on numbers that are none
@pytest.mark.parametrize("name", GOOD)
@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(damage=DAMAGE, cut=st.floats(0, 1))
def test_a_damaged_file_loads_or_says_what_is_wrong(tmp_path, name, damage, cut):
    data = GOOD[name]
    for where, length, put in damage:
        at = int(where * len(data))
        data = data[:at] + put + data[at + length :]
    path = tmp_path / name
    path.write_bytes(data[: int(cut * len(data) * 1.5)])
    try:
        read_file(path)
    except InputError as error:
        said = str(error)
    else:
        said = str(path)
    assert str(path) in said
    assert "\n" not in said
    assert len(said) < 500


def test_the_writer_of_meshes_and_their_reader_agree_on_the_kind(tmp_path):
    assert format_of(tmp_path / "no_extension", stl_bytes(LENS)[:HEAD]).name == "STL"
