"""How long the user of the window waits: slider to picture, the longest time without an answer to the mouse, and the start."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from statistics import median
from typing import Any

from .figures import Figure
from .timing import ROOT

FILES = [ROOT / "sample_lenses" / name for name in ("regular_R.toml", "presbyope_60.toml")]
TARGETS: dict[str, tuple[str, float | None]] = {
    "window shown": ("s", None),
    "window with the lens in space and the map of the sample lens": ("s", 3.0),
    "window with all pictures of the sample lens": ("s", None),
    "slider to map of 128 x 128": ("ms", 60.0),
    "slider to lens in space": ("ms", None),
    "longest gap of the event loop, one map dragged": ("ms", 50.0),
    "longest gap of the event loop, four views dragged": ("ms", 50.0),
}
DRAGS, DRAGGING = 11, 2.5  # steps of a slider that are timed one by one; seconds of a drag without a rest


def window_latency() -> list[Figure]:
    """Medians of the steps of a slider, ms; longest gap of the event loop, ms; start until all pictures stand, s.

    Measured in processes of their own, drawn into memory; the second start is told, when the computer has read the files.
    """
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    runs = [
        subprocess.run(
            [sys.executable, "-m", "benchmarks.window"], env=environment, cwd=ROOT, capture_output=True, text=True
        )
        for _ in range(2)
    ]
    if runs[-1].returncode:
        raise RuntimeError(f"the window's benchmark failed: {runs[-1].stderr[-500:]}")
    found = json.loads(runs[-1].stdout.splitlines()[-1])
    return [Figure(name, found[name], unit, at_most=most) for name, (unit, most) in TARGETS.items()]


class Stopwatch:
    """A window with the sample lens, and the events of Qt."""

    def __init__(self) -> None:
        self.since = time.perf_counter()
        from PySide6.QtCore import QSettings
        from PySide6.QtWidgets import QApplication

        from lensbench.gui.main_window import MainWindow

        self.app = QApplication([])
        settings = QSettings(str(ROOT / "reports" / "bench.ini"), QSettings.Format.IniFormat)
        self.window = MainWindow(settings)
        self.window.show()
        self.app.processEvents()
        self.shown = time.perf_counter() - self.since
        self.window.files.open(FILES)
        self.until(self.lens_is_shown)
        self.usable = time.perf_counter() - self.since
        self.until(self.pictures_stand)
        self.stood = time.perf_counter() - self.since

    def until(self, holds: Callable[[], bool], most: float = 300.0) -> None:
        """Run the window until something holds."""
        end = time.perf_counter() + most
        while not holds():
            self.app.processEvents()
            time.sleep(0.0005)  # as an event loop that waits: one that spins would keep Python from the lane
            if time.perf_counter() > end:
                raise RuntimeError(f"{holds.__name__}: not within {most} s")

    def lens_is_shown(self) -> bool:
        """Whether the first two viewports, the lens in space and a map, have been answered."""
        return all(viewport.answered for viewport in self.window.viewports[:2])

    def pictures_stand(self) -> bool:
        """Whether no viewport waits for an answer."""
        shown = self.window.viewports[: self.window.document.workbench.split]
        return not self.window.lane.busy and all(v.answered and not v.state.text() for v in shown)

    def split(self, count: int, **pane: Any) -> None:
        """Show so many viewports, the first one of a kind."""
        self.window.document.edit("split", lambda bench: replace(bench.with_pane(0, **pane), split=count))
        self.until(self.pictures_stand)

    def slider(self) -> Any:
        """That of the pantoscopic angle."""
        from lensbench.gui.form import Form

        forms = self.window.findChildren(Form)
        return next(form.rows["Pantoscopic angle"].slider for form in forms if "Pantoscopic angle" in form.rows)

    def steps(self) -> float:
        """Median time (ms) from a step of the slider to the painted picture of the first viewport."""
        slider, times = self.slider(), []
        for k in range(DRAGS + 2):
            since = time.perf_counter()
            slider.setValue(slider.minimum() + 10 + k)
            self.until(lambda: not self.window.viewports[0].state.text())
            self.window.viewports[0].content.repaint()
            times.append(time.perf_counter() - since)
            self.until(self.pictures_stand)
        return 1000 * median(times[2:])

    def longest_gap(self, seconds: float) -> float:
        """Longest time (ms) between two turns of the event loop while a slider is dragged without a rest."""
        slider, gaps, last, k = self.slider(), [], time.perf_counter(), 0
        end = last + seconds
        while last < end:
            if k % 4 == 0:
                slider.setValue(slider.minimum() + 5 + k // 4 % 30)
            k += 1
            self.app.processEvents()
            now = time.perf_counter()
            gaps.append(now - last)
            last = now
            time.sleep(0.002)
        return 1000 * max(gaps)


def main() -> int:
    """Measure in this process; prints one line of JSON."""
    watch = Stopwatch()
    found = dict(zip(TARGETS, (watch.shown, watch.usable, watch.stood), strict=False))
    found["longest gap of the event loop, four views dragged"] = watch.longest_gap(DRAGGING)
    watch.until(watch.pictures_stand)
    watch.split(1, kind="map", quantity="astigmatism")
    found["slider to map of 128 x 128"] = watch.steps()
    found["longest gap of the event loop, one map dragged"] = watch.longest_gap(DRAGGING)
    watch.until(watch.pictures_stand)
    watch.split(1, kind="lens", quantity="mean_power")
    found["slider to lens in space"] = watch.steps()
    watch.window.document.saved()
    watch.window.close()
    print(json.dumps(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
