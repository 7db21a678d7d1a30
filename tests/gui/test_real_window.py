"""The window on a real (virtual) X screen, in a process of its own; and many windows, one after the other."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SPHERE = HERE.parents[1] / "sample_lenses" / "sphere_minus_4_R.toml"


@pytest.fixture(scope="module")
def screen():
    """The number of a virtual X screen."""
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is not installed")
    read, write = os.pipe()
    words = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1600x1000x24", "-nolisten", "tcp"]
    server = subprocess.Popen(words, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as told:
        number = told.readline().strip()
    yield f":{number}"
    server.terminate()
    server.wait(10)


def on_screen(screen):
    return {**os.environ, "QT_QPA_PLATFORM": "xcb", "DISPLAY": screen}


def test_a_window_on_a_screen_is_opened_edited_probed_saved_and_closed(screen, tmp_path):
    ended = subprocess.run(
        [sys.executable, str(HERE / "real_window.py"), str(SPHERE), str(tmp_path)],
        env=on_screen(screen), capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr[-2000:]
    assert not re.search(r"plugin|QObject|QThread|QPainter|Traceback", ended.stderr), ended.stderr
    assert (tmp_path / "a.lensbench.json").exists()


@pytest.mark.parametrize("tests", ["gui", "test_jitter_pass.py"])
def test_the_tests_of_window_and_view_once_more_with_a_display(screen, tests):
    """OpenGL by GLX, where it is by EGL without a display."""
    words = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", f"--ignore={HERE / Path(__file__).name}"]
    ended = subprocess.run(
        [sys.executable, *words, str(HERE.parent / tests)],
        env=on_screen(screen), capture_output=True, text=True, timeout=1200, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout[-4000:]
