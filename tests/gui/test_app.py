"""Starting the window where it cannot stand: one sentence, before Qt would abort."""

import subprocess
import sys

import pytest

from lensbench.errors import LensBenchError
from lensbench.gui import app
from lensbench.views import offscreen

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems always have a display")


@pytest.fixture(autouse=True)
def no_display(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    offscreen.display_answers.cache_clear()
    yield
    offscreen.display_answers.cache_clear()


def test_no_display_at_all():
    with pytest.raises(LensBenchError, match="neither DISPLAY nor WAYLAND_DISPLAY is set"):
        app.start([])


@pytest.mark.parametrize("platform", [None, "xcb"])
def test_a_display_that_does_not_answer(monkeypatch, platform):
    monkeypatch.setenv("DISPLAY", ":4711")
    if platform:
        monkeypatch.setenv("QT_QPA_PLATFORM", platform)
        monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-0")
    with pytest.raises(LensBenchError, match="no X server answers at DISPLAY=:4711"):
        app.start([])


def test_the_command_says_it_and_ends():
    done = subprocess.run([sys.executable, "-m", "lensbench", "gui"], capture_output=True, text=True, timeout=60)
    assert done.returncode != 0
    assert "needs a display" in done.stderr
    assert "Traceback" not in done.stderr
