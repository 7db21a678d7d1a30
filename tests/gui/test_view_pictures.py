"""The picture of the simulated view, beside a fresh one drawn off screen in a window of OpenGL of its own, after every kind
of edit. Other stages are shown beside it, which make their own OpenGL current.
"""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtGui import QAction, QImage
from PySide6.QtTest import QTest

from lensbench.gui import view_content
from lensbench.gui.main_window import MainWindow
from lensbench.session import Pane, Workbench
from lensbench.views.jitter import render_view

SAMPLES = Path(__file__).parents[2] / "sample_lenses"
PASSES, VIEW, SIZE = 6, 1, (1500, 800)
PANES = (Pane("lens"), Pane("view"), Pane("map", "astigmatism"), Pane("profile"))


def pixels(image):
    """The image (h, w, 3) as numbers that can be subtracted."""
    image = image.convertToFormat(QImage.Format.Format_RGBX8888)
    return np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)[..., :3].astype(int)


def wear(**changes):
    def make(bench):
        wearer = bench.active_wearer
        return replace(bench, wearers=(replace(wearer, wear=replace(wearer.wear, **changes)), *bench.wearers[1:]))

    return make


def eye(**changes):
    def make(bench):
        wearer = bench.active_wearer
        return replace(bench, wearers=(replace(wearer, eye=replace(wearer.eye, **changes)), *bench.wearers[1:]))

    return make


def edited_lens(bench):
    return replace(bench, lenses=(bench.lenses[0].edited(centre_thickness=4.0, material="MR-8"), *bench.lenses[1:]))


EDITS = {
    "vertex distance": wear(vertex_distance=18.0),
    "pantoscopic angle": wear(pantoscopic_angle=0.0),
    "refraction": eye(refraction=np.diag([-1.0, -2.0])),
    "pupil": eye(pupil_diameter=6.0),
    "lens": edited_lens,
    "rule of accommodation": lambda bench: replace(bench, accommodation="object"),
    "head": lambda bench: replace(bench, head_turn=12.0, head_tilt=-8.0),
    "look": lambda bench: bench.with_pane(VIEW, azimuth=15.0, elevation=-30.0, width=80.0),
    "without the lens": lambda bench: bench.with_pane(VIEW, eye="naked"),
    "pinhole": lambda bench: bench.with_pane(VIEW, eye="pinhole"),
    "split picture": lambda bench: bench.with_pane(VIEW, eye="lens", split=True),
    "scene": lambda bench: replace(bench, scene="chart"),
    "another pane": lambda bench: bench.with_pane(0, kind="ellipses"),
    "four viewports": lambda bench: replace(bench, split=4),
    "table of one lens": lambda bench: bench.without_lens(1),
}


@pytest.fixture(scope="module")
def table():
    """Two lenses and a wearer, the stage of a lens beside the view."""
    bench = Workbench().with_lens(SAMPLES / "sphere_minus_4_R.toml").with_lens(SAMPLES / "toric_R.toml")
    return replace(bench, wearers=(bench.active_wearer,), as_ordered=None, lens=0, wearer=0, panes=PANES, split=2)


@pytest.fixture
def seeing(window, table, settle, monkeypatch):
    """The window with the table."""
    monkeypatch.setattr(view_content, "PASSES", PASSES)
    window.resize(*SIZE)
    window.statusBar()  # as when files were read
    window.document.open(table)
    rest(window, settle)
    return window


def rest(window, settle):
    """Wait until all pictures of a window are as they stay."""
    settle(window)
    until = time.monotonic() + 60
    while not all(viewport.content.at_rest for viewport in window.viewports[: window.document.workbench.split]):
        QTest.qWait(5)
        assert time.monotonic() < until, "the pictures do not come to rest"


def assert_fresh(window, settle):
    """The view shows what is drawn anew of what the workbench says."""
    rest(window, settle)
    bench, content = window.document.workbench, window.viewports[VIEW].content
    _, ask = content.question(bench, bench.panes[VIEW])
    seen, _ = ask()
    ratio = content.devicePixelRatioF()
    size = round(content.width() * ratio), round(content.height() * ratio)
    fresh = render_view(replace(seen, layer=replace(seen.layer, size=size)), PASSES)
    apart = np.abs(pixels(content.picture()) - fresh).max(axis=2)
    assert apart.max() <= 1, f"{apart.mean():.1f} codes apart in the mean, {(apart > 1).mean():.1%} of it"


@pytest.mark.parametrize("name", EDITS)
def test_the_view_after_an_edit_and_its_undoing_is_as_a_fresh_one(seeing, settle, name):
    before = pixels(seeing.viewports[VIEW].content.picture())
    seeing.document.edit(name, EDITS[name])
    assert_fresh(seeing, settle)
    seeing.document.undo()
    assert_fresh(seeing, settle)
    np.testing.assert_array_equal(pixels(seeing.viewports[VIEW].content.picture()), before)
    seeing.document.redo()
    assert_fresh(seeing, settle)


def test_the_view_of_flipped_lenses_is_as_a_fresh_one(seeing, settle):
    first = pixels(seeing.viewports[VIEW].content.picture())
    for _ in range(3):
        next(a for a in seeing.findChildren(QAction) if a.shortcut().toString() == "Space").trigger()
        assert_fresh(seeing, settle)
    assert seeing.document.workbench.lens == 1
    assert np.abs(pixels(seeing.viewports[VIEW].content.picture()) - first).mean() > 1


def test_two_views_side_by_side_are_as_fresh_ones(seeing, settle):
    seeing.document.edit("Views", lambda bench: bench.with_pane(0, kind="view", eye="naked"))
    for distance in (18.0, 8.0, 13.0):
        seeing.document.edit("Distance", wear(vertex_distance=distance))
        assert_fresh(seeing, settle)


def test_a_session_opened_anew_shows_the_pictures_of_the_window_that_saved_it(
    table, settle, open_files, qtbot, settings, tmp_path, monkeypatch
):
    monkeypatch.setattr(view_content, "PASSES", PASSES)
    path, windows = tmp_path / "a.lensbench.json", [MainWindow(settings), MainWindow(settings)]
    for window in windows:
        qtbot.addWidget(window, before_close_func=lambda window: window.document.saved())
        window.resize(*SIZE)
        window.statusBar()  # as when files were read
        window.show()
    saving, opened = windows
    saving.document.open(replace(table, split=4))
    for name in ("split picture", "refraction", "head"):
        rest(saving, settle)
        saving.document.edit(name, EDITS[name])
    rest(saving, settle)
    assert saving.files.save(path)
    open_files(opened, [path])
    rest(opened, settle)
    assert_fresh(opened, settle)
    for one, two in zip(saving.viewports, opened.viewports, strict=True):
        apart = np.abs(pixels(one.content.picture()) - pixels(two.content.picture())).max(axis=2)
        assert apart.max() <= 1, one.asker
