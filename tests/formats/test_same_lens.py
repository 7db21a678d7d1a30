"""The same lens out of different files gives the same as-worn map, within what each file says of itself."""

from dataclasses import replace

import numpy as np
import pytest

import lensbench as lb
from lensbench.formats import write
from lensbench.formats.registry import Writing
from lensbench.layers import MapLayer, Request
from lensbench.optics.conventions import Status
from lensbench.workbench import assumed_wearer, run

REGULAR = "sample_lenses/regular_R.toml"
LENS_FILE = """
format = "lensbench-lens/1"
side = "R"
material = { name = "1.60", n_d = 1.5945, n_e = 1.598, abbe = 41.0, density = 1.30 }
centre_thickness = 2.8
outline = { shape = "circle", diameter = 60 }
[front]
type = "grid"
file = "FRONT"
[back]
type = "grid"
file = "BACK"
"""


@pytest.fixture(scope="module")
def lens():
    return lb.load_lens(REGULAR)


@pytest.fixture(scope="module")
def worn(lens):
    def as_worn(other):
        wearer = assumed_wearer(lens)
        found = [run(Request(other, wearer, MapLayer(q, 400.0, samples=41))) for q in ("mean_power", "astigmatism")]
        inside = np.hypot(*np.meshgrid(found[0].x, found[0].y)) < 28.5
        return np.array([np.where(inside & (m.status == Status.OK), m.values, np.nan) for m in found])

    return as_worn


def from_step(folder, lens):
    write(folder / "lens.step", lens)
    return lens_file(folder, lens, "lens.step", "lens.step")


def from_json(folder, lens):
    for face in ("front", "back"):
        write(folder / f"{face}.json", lens, writing=Writing(face=face[0].upper()))
    return lens_file(folder, lens, "front.json", "back.json")


def from_stl(folder, lens):
    write(folder / "lens.stl", lens)
    return lens_file(folder, lens, "lens.stl", "lens.stl")


def lens_file(folder, lens, front, back):
    path = folder / "lens.toml"
    text = LENS_FILE.replace("FRONT", front).replace("BACK", back).replace("2.8", repr(lens.centre_thickness))
    path.write_text(text)
    return replace(lb.load_lens(path), points=lens.points)


@pytest.mark.parametrize(("read_again", "within"), [(from_step, 1e-6), (from_json, 1e-8), (from_stl, 0.03)])
def test_the_same_lens_from_different_files(tmp_path, lens, worn, read_again, within):
    again = worn(read_again(tmp_path, lens))
    assert np.nanmax(np.abs(again - worn(lens))) < within
