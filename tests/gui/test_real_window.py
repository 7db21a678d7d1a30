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


def test_a_window_on_a_screen_is_opened_edited_probed_saved_and_closed(screen, tmp_path):
    environment = {**os.environ, "QT_QPA_PLATFORM": "xcb", "DISPLAY": screen}
    ended = subprocess.run(
        [sys.executable, str(HERE / "real_window.py"), str(SPHERE), str(tmp_path)],
        env=environment, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr[-2000:]
    assert not re.search(r"plugin|QObject|QThread|QPainter|Traceback", ended.stderr), ended.stderr
    assert (tmp_path / "a.lensbench.json").exists()
