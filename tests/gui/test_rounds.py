"""Windows that are opened and closed again and again leave nothing behind. LENSBENCH_ROUNDS=50 for the long form."""

import ctypes
import gc
import os
import sys
import time
import weakref
from pathlib import Path

import psutil
import pytest
from PySide6.QtCore import QEvent, QSettings
from vtkmodules.vtkRenderingCore import vtkRenderWindow

from lensbench.gui.main_window import MainWindow

SAMPLES = Path(__file__).parents[2] / "sample_lenses"
ROUNDS = int(os.environ.get("LENSBENCH_ROUNDS", "3"))
KEPT, MOST_GROWTH = 16, 6.0  # rounds until every cache is full; MB a round after them


@pytest.fixture
def one_round(qapp, tmp_path):
    settings = QSettings(str(tmp_path / "rounds.ini"), QSettings.Format.IniFormat)

    def run():
        window = MainWindow(settings)
        window.show()
        window.files.open([SAMPLES / "regular_R.toml", SAMPLES / "presbyope_60.toml"])
        end = time.monotonic() + 120
        while not all(v.answered for v in window.viewports):
            qapp.processEvents()
            assert time.monotonic() < end, "the pictures did not come"
            time.sleep(0.002)
        alive = [weakref.ref(v.content.stage.stage) for v in window.viewports if hasattr(v.content, "stage")]
        assert alive
        alive += [weakref.ref(window), weakref.ref(window.viewports[0]), weakref.ref(window.lane._thread)]
        window.document.saved()
        assert window.close()
        window.lane.wait()
        window.deleteLater()
        qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        qapp.processEvents()
        return alive

    return run


def give_back():
    """Let the C library return to the system what is free (glibc keeps it otherwise)."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).malloc_trim(0)


def windows_of_vtk():
    gc.collect()
    return sum(isinstance(thing, vtkRenderWindow) for thing in gc.get_objects())


def test_rounds_of_opening_and_closing_leave_nothing(one_round):
    process, before, sizes = psutil.Process(), windows_of_vtk(), []
    for _ in range(ROUNDS):
        alive = one_round()
        assert windows_of_vtk() == before
        assert [found() for found in alive] == [None] * len(alive)
        give_back()
        sizes.append(process.memory_info().rss / 1e6)
    if ROUNDS > 2 * KEPT:  # what is kept for the last lenses has come to rest
        growth = (sizes[-1] - sizes[KEPT]) / (ROUNDS - 1 - KEPT)
        assert growth < MOST_GROWTH, f"{growth:.1f} MB a round: {[round(size) for size in sizes]} MB"
