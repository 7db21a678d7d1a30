"""Whatever the user does, rays are traced in the lane's thread alone: kernels in parallel from two threads end the process."""

import threading
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent

from lensbench.optics import gaze
from lensbench.optics.kernels import surface, voxels
from lensbench.session import KINDS, Pane
from lensbench.views.jitter import shaders

SAMPLES = Path(__file__).parents[2] / "sample_lenses"
PLUS = SAMPLES / "sphere_plus_4_R.toml"


@pytest.fixture
def threads(monkeypatch):
    """Names of the threads that have entered a parallel kernel, or compiled one."""
    found = []

    def watched(run):
        return lambda *args, **kwargs: found.append(threading.current_thread().name) or run(*args, **kwargs)

    monkeypatch.setattr(gaze, "_through", watched(gaze._through))
    monkeypatch.setattr(surface, "compiled", watched(surface.compiled))
    monkeypatch.setattr(voxels, "fill", watched(voxels.fill))
    gaze._kernel.cache_clear()
    return found


def test_all_that_traces_goes_through_the_lane(threads, window, settle, open_files, tmp_path, qtbot, mouse):
    open_files(window, [PLUS])
    for kind in KINDS:
        window.document.edit("Kind", lambda bench, kind=kind: bench.with_pane(0, kind=kind))
        settle(window)
        window.pictures.save(0, tmp_path / f"{kind}.png")
        if window.viewports[0].content.figure() is not None:
            window.pictures.save(0, tmp_path / f"{kind}.svg")
    window.pictures.save(0, tmp_path / "view.exr")
    window.document.edit("Distance", lambda bench: replace(bench, distance="scene", head_turn=5.0))
    window.flip()
    window._side_by_side()
    settle(window)
    content = window.viewports[0].content
    at = content.pixel(5.0, -7.0)
    mouse(content, QEvent.Type.MouseMove, at.x(), at.y())
    qtbot.waitUntil(lambda: window.readings.probe_panel.text.text().startswith("<table"), timeout=10000)
    window.table.forms.widget(4).widget().rows["Centre thickness"].box.setValue(4.0)
    window.document.undo()
    settle(window)
    qtbot.waitUntil((tmp_path / "view.exr").exists, timeout=60000)
    assert len(threads) > 50
    assert set(threads) == {"lane"}


def test_where_the_driver_wants_every_vertex_traced_the_lane_does_it(threads, window, settle, monkeypatch, qtbot):
    monkeypatch.setitem(shaders.KINDS, "atlas", (shaders.KINDS["atlas"][0], "  this is no GLSL;\n", shaders.ZONE))
    window.document.edit("View", lambda bench: replace(bench, panes=(Pane("view"), *bench.panes[1:]), split=1))
    settle(window)
    content = window.viewports[0].content
    qtbot.waitUntil(lambda: content.passes > 0, timeout=60000)
    assert content.light().max() > 0.2
    window.document.edit("Head", lambda bench: replace(bench, head_turn=10.0))
    settle(window)
    assert set(threads) == {"lane"}
