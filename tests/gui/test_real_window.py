"""The window on a real (virtual) X screen, in a process of its own; and many windows, one after the other."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SPHERE, PROGRESSIVE = (HERE.parents[1] / "sample_lenses" / name for name in ("sphere_minus_4_R.toml", "regular_R.toml"))


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


def run_on(screen, script, *words):
    """Run a script on the screen by itself; it must end well, and Qt have nothing to say."""
    environment = {**os.environ, "QT_QPA_PLATFORM": "xcb", "DISPLAY": screen}
    ended = subprocess.run(
        [sys.executable, str(HERE / script), *map(str, words)],
        env=environment, capture_output=True, text=True, timeout=400, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr[-2000:]
    assert not re.search(r"plugin|QObject|QThread|QPainter|Traceback", ended.stderr), ended.stderr


def test_a_window_on_a_screen_is_opened_edited_probed_saved_and_closed(screen, tmp_path):
    run_on(screen, "real_window.py", SPHERE, tmp_path)
    assert (tmp_path / "a.lensbench.json").exists()


def test_two_views_in_two_plotters_on_a_screen_do_not_mix(screen):
    run_on(screen, "two_plotters.py", PROGRESSIVE)


def test_every_picture_of_the_view_on_a_screen_is_that_of_a_fresh_one(screen, tmp_path):
    run_on(screen, "real_view_window.py", PROGRESSIVE, SPHERE, tmp_path)
