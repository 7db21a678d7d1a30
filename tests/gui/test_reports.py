"""Report and comparison from the window: the command line's own process; its end, its errors, its cancel."""

import sys
from pathlib import Path

import psutil
import pytest
from PySide6.QtCore import QProcess
from PySide6.QtGui import QDesktopServices

from lensbench.session import load_session

PLUS = Path(__file__).parents[2] / "sample_lenses" / "sphere_plus_4_R.toml"


@pytest.fixture
def opened(monkeypatch):
    """Pages that would be shown in the browser."""
    pages = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: pages.append(url.toLocalFile()))
    return pages


def ended(window):
    return lambda: window.reports.process is None


def test_the_command_is_the_command_lines_on_the_session_as_it_is(window, tmp_path, monkeypatch, opened):
    heard = []
    monkeypatch.setattr(QProcess, "start", lambda self, program, words: heard.append((program, words)))
    window.reports.start("compare", tmp_path / "pages")
    ((program, words),) = heard
    assert program == sys.executable
    assert words[:3] == ["-m", "lensbench", "compare"]
    assert len(load_session(Path(words[3]))[0].lenses) == 1
    window.reports.start("report", tmp_path / "pages")
    assert "one report at a time" in window.log.toPlainText()
    window.reports._over(0, tmp_path / "pages")
    assert opened == [str(tmp_path / "pages" / "index.html")]
    assert not Path(words[3]).exists()


def test_a_report_is_cancelled_and_leaves_nothing(window, tmp_path, qtbot, opened):
    window.reports.start("report", tmp_path / "pages")
    qtbot.waitUntil(lambda: window.reports.process.state() == QProcess.ProcessState.Running, timeout=20000)
    window.reports._dialog.canceled.emit()
    qtbot.waitUntil(ended(window), timeout=20000)
    assert window.log.toPlainText().splitlines()[-1] == "cancelled"
    assert not (tmp_path / "pages" / "index.html").exists()
    assert opened == []


def test_an_error_of_the_command_is_its_sentence(window, tmp_path, qtbot, opened, open_files):
    lens = tmp_path / "mine.toml"
    lens.write_bytes(PLUS.read_bytes())
    open_files(window, [lens])
    lens.unlink()
    window.reports.start("report", tmp_path / "pages")
    qtbot.waitUntil(ended(window), timeout=120000)
    last = window.log.toPlainText().splitlines()[-1]
    assert "mine.toml" in last
    assert not last.startswith("lensbench:")
    assert opened == []


def test_a_program_that_does_not_start_is_said(window, tmp_path, qtbot, opened, monkeypatch):
    monkeypatch.setattr(sys, "executable", str(tmp_path / "no python"))
    window.reports.start("report", tmp_path / "pages")
    qtbot.waitUntil(ended(window), timeout=10000)
    assert "cannot be started" in window.log.toPlainText()


def test_closing_ends_the_command(window, tmp_path, qtbot, opened):
    window.reports.start("report", tmp_path / "pages")
    process = window.reports.process
    qtbot.waitUntil(lambda: process.state() == QProcess.ProcessState.Running, timeout=20000)
    pid = process.processId()
    window.document.saved()
    window.close()
    qtbot.waitUntil(lambda: not psutil.pid_exists(pid) or psutil.Process(pid).status() == "zombie", timeout=10000)
