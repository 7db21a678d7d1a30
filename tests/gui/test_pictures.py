"""What can be done with a picture: its scale, the clipboard, files."""

import threading
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtGui import QGuiApplication, QImage

from lensbench.errors import InputError
from lensbench.gui.pictures import ScaleDialog
from lensbench.session import Pane


def test_a_scale_is_set_and_undone(ready):
    ready.pictures.set_scale(0, -8.0, 0.0, 0.5)
    assert ready.document.workbench.panes[0] == replace(Pane("map"), low=-8.0, high=0.0, step=0.5)
    ready.document.undo()
    assert ready.document.workbench.panes[0].low is None


@pytest.mark.parametrize(
    "scale", [(1.0, None, None), (None, 1.0, None), (2.0, 1.0, None), (1.0, 1.0, 0.1), (0.0, 1.0, 0.0)]
)
def test_what_is_no_scale_is_refused(ready, scale):
    with pytest.raises(InputError, match="scale"):
        ready.pictures.set_scale(0, *scale)
    assert not ready.document.undo_name


def test_the_dialog_reads_numbers_of_either_comma(ready):
    dialog = ScaleDialog(ready, ready.document.workbench.panes[0])
    for line, text in zip(dialog.lines.values(), ("-1,5", "2.5", ""), strict=True):
        line.setText(text)
    assert dialog.values() == (-1.5, 2.5, None)
    dialog.lines["Step"].setText("much")
    with pytest.raises(InputError, match="numbers"):
        dialog.values()
    dialog.deleteLater()


def test_a_scale_is_shared_as_it_is_seen(ready, settle):
    shown = ready.viewports[0].content.bands.levels
    ready.document.edit("Quantity", lambda bench: bench.with_pane(1, quantity="mean_power"))
    ready.pictures.share_scale(0)
    settle(ready)
    for viewport in ready.viewports[:2]:
        np.testing.assert_allclose(viewport.content.bands.levels[[0, -1]], shown[[0, -1]])


def test_a_kept_scale_stays_when_the_map_changes(ready, settle):
    before = ready.viewports[0].content.bands.levels
    ready.pictures.act("keep", 0)
    ready.document.edit("Distance", lambda bench: replace(bench, distance=300.0))
    settle(ready)
    levels = ready.viewports[0].content.bands.levels
    assert (levels[0], levels[-1]) == (before[0], before[-1])


def test_the_clipboard_gets_what_is_seen(ready):
    ready.pictures.act("copy", 0)
    image = QGuiApplication.clipboard().image()
    assert image.size() == ready.viewports[0].content.picture().size()
    assert len({image.pixel(x, y) for x in range(0, image.width(), 9) for y in range(0, image.height(), 9)}) > 3


def test_png_is_what_is_seen_and_svg_is_lines(ready, tmp_path):
    ready.pictures.save(0, tmp_path / "a.png")
    assert QImage(str(tmp_path / "a.png")).size() == ready.viewports[0].content.picture().size()
    ready.pictures.save(0, tmp_path / "a.svg")
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert "<svg" in text
    assert "<path" in text
    assert "objects at infinity" in text
    assert "accommodation rule retina" in text
    assert "written" in ready.log.toPlainText()


@pytest.mark.parametrize(("name", "why"), [("a.exr", "simulated view"), ("a.bmp", "saved as"), ("a", "saved as")])
def test_what_cannot_be_saved_is_said(ready, tmp_path, name, why):
    with pytest.raises(InputError, match=why):
        ready.pictures.save(0, tmp_path / name)
    assert list(tmp_path.glob("a*")) == []


def test_a_folder_that_is_a_file_is_said(ready, tmp_path):
    (tmp_path / "no").write_text("file")
    with pytest.raises(InputError, match=r"a\.png"):
        ready.pictures.save(0, tmp_path / "no" / "a.png")


def test_views_are_saved_with_their_channels(ready, settle, tmp_path, qtbot):
    exr = pytest.importorskip("OpenEXR")
    ready.document.edit("View", lambda bench: replace(bench.with_pane(0, kind="view"), split=1))
    settle(ready)
    content = ready.viewports[0].content
    with pytest.raises(InputError, match="in lines"):
        ready.pictures.save(0, tmp_path / "a.svg")
    qtbot.waitUntil(lambda: content.passes >= 3, timeout=20000)
    size = content.seen.layer.size
    ready.pictures.save(0, tmp_path / "a.exr")
    assert not ready.close(), "before the file is written"
    qtbot.waitUntil(lambda: not ready.pictures.being_saved, timeout=60000)
    assert ready.log.toPlainText().endswith(f"written: {tmp_path / 'a.exr'}")
    with exr.File(str(tmp_path / "a.exr")) as file:
        pixels = file.parts[0].channels
        assert len(file.parts) > 1
        name = next(iter(pixels))
        assert pixels[name].pixels.shape[1::-1] == size


def test_a_view_that_is_given_up_is_not_written(ready, settle, tmp_path, qtbot):
    ready.document.edit("View", lambda bench: replace(bench.with_pane(0, kind="view"), split=1))
    settle(ready)
    gate = threading.Event()
    ready.lane.ask("held", lambda: gate.wait(20))
    ready.pictures.save(0, tmp_path / "a.exr")
    ready.stop()
    assert f"not written: {tmp_path / 'a.exr'}" in ready.log.toPlainText()
    assert not ready.pictures.being_saved
    gate.set()
    qtbot.waitUntil(lambda: not ready.lane.busy, timeout=60000)
    assert not (tmp_path / "a.exr").exists()
