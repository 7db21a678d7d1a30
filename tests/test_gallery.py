"""The gallery draws all designs alike: one scale, one size, each its own name; sheets are small enough for a page."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

import lensbench as lb
from lensbench.cli import main
from lensbench.errors import InputError
from lensbench.scenes.builtin import load_scene
from lensbench.scenes.scene import Look, Scene, rectangle
from lensbench.workbench import assumed_wearer

pytest.importorskip("vtkmodules")

from lensbench.report import gallery

STRIPES = (
    np.where((np.arange(64) // 4 % 2)[None, :, None], 230, 30).astype(np.uint8).repeat(64, axis=0).repeat(3, axis=2)
)
WALL = Scene(
    "wall",
    (rectangle("wall", [0, 0, 400], [-800, 0, 0], [0, 800, 0], STRIPES),),
    looks={"middle": Look((0.0, 0.0, 400.0), "wall")},
)


def cases_of(*names):
    lenses = [lb.load_lens(f"sample_lenses/{name}.toml") for name in names]
    return gallery.gallery_cases([(lens, assumed_wearer(lens)) for lens in lenses], WALL, None, 96)


def test_all_designs_share_one_scale_and_the_worse_one_is_whiter():
    cases = cases_of("sphere_plus_4_R", "regular_R")
    scale, rows = gallery.gallery_pictures(cases, 4)
    blur = [np.nanmean(case.defocus.defocus) for case in cases]
    whitened = [(v.astype(float) - s).mean() for s, v in zip(rows["seen"], rows["defocus"], strict=True)]
    assert scale.limit >= np.degrees(np.nanpercentile(cases[int(np.argmax(blur))].defocus.defocus, 90)) * 60
    assert np.argmax(blur) == np.argmax(whitened)
    assert min(whitened) >= 0


def test_the_sheet_holds_every_picture_unchanged():
    cases = cases_of("sphere_plus_4_R", "regular_R")
    scale, rows = gallery.gallery_pictures(cases, 2)
    sheet = gallery.gallery_sheet(cases, scale, rows, "Two lenses")
    for pictures in rows.values():
        for picture in pictures:
            windows = np.lib.stride_tricks.sliding_window_view(sheet[..., 1], (96, 8))
            assert (windows == picture[:, 40:48, 1]).all(axis=(2, 3)).any()


def test_a_small_picture_is_small():
    noise = np.random.default_rng(2).integers(0, 4, (80, 180, 3), dtype=np.uint8) * 80
    data = gallery.small_png(noise, 160, 5000)
    assert len(data) < 5000
    width, height = Image.open(BytesIO(data)).size
    assert width / height == pytest.approx(180 / 80, rel=0.05)


def test_a_contact_sheet_has_a_picture_for_each_look():
    scenes = [load_scene("chart"), WALL]
    sheet = gallery.contact_sheet(scenes, 1, (80, 60))
    assert sheet.shape[1] >= 4 * 80
    assert sheet.shape[0] >= 2 * 60
    with pytest.raises(InputError, match="no looks"):
        gallery.contact_sheet([Scene("empty", ())], 1)


def test_the_command_writes_a_picture_for_each_lens_and_the_sheets(tmp_path, capsys):
    lenses = [f"sample_lenses/{name}_R.toml" for name in ("regular", "occupational")]
    small = tmp_path / "small.png"
    assert main(["gallery", *lenses, "--passes", "1", "-o", str(tmp_path / "g"), "--small", str(small)]) == 0
    names = {path.name for path in (tmp_path / "g").iterdir()}
    expected = {f"{lens}_R_{row}.png" for lens in ("regular", "occupational") for row in ("seen", "defocus")}
    assert names == {"gallery.png", *expected}
    assert small.stat().st_size < 400_000
    assert main(["gallery", *lenses, "--look", "moon", "-o", str(tmp_path)]) == 2
    assert "has no 'moon'; it has far" in capsys.readouterr().err
