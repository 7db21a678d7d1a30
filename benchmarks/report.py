"""A whole report, by step."""

import os
import tempfile
from pathlib import Path

import lensbench as lb

from .figures import Figure
from .timing import ROOT


def report_split() -> list[Figure]:
    """A whole report of the regular sample lens, warm: seconds by step."""
    from lensbench.report.build import Terms, build_report
    from lensbench.report.progress import Progress

    lens = lb.load_lens(ROOT / "sample_lenses" / "regular_R.toml")
    wearer = lb.load_wearer(ROOT / "sample_lenses" / "presbyope_60.toml")
    with tempfile.TemporaryDirectory() as folder, open(os.devnull, "w") as nowhere:
        build_report(lens, wearer, Path(folder), Terms(), Progress(nowhere))
        progress = Progress(nowhere)
        build_report(lens, wearer, Path(folder), Terms(), progress)
        progress.done()
    split = [Figure(f"report: {name}", seconds, "s") for name, seconds in progress.seconds.items()]
    return [*split, Figure("report: total", sum(progress.seconds.values()), "s")]
