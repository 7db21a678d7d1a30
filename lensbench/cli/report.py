"""lensbench report: everything about a lens in one page."""

import argparse
import sys
from pathlib import Path
from typing import Any

from .options import add_verb, distance, lens_and_wearer, load_case, scene_of, scene_options


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "report", write_report, "write a full report of a lens: index.html, PNGs, results.json")
    lens_and_wearer(verb)
    verb.add_argument(
        "--object-distance", type=distance, nargs="+", metavar="D", help="for the defocus maps (inf 78cm 40cm)"
    )
    scene_options(verb)
    verb.add_argument("-o", "--output", type=Path, default=None, metavar="DIR", help="folder (reports/<lens file>)")


def write_report(args: argparse.Namespace) -> None:
    """lensbench report LENS."""
    from ..report.build import DEFAULT_DISTANCES, build_report
    from ..report.progress import Progress

    folder = args.output or Path("reports") / args.lens.stem
    progress = Progress(sys.stderr)
    progress.step("load")
    lens, wearer = load_case(args)
    scene = scene_of(args)
    build_report(lens, wearer, folder, tuple(args.object_distance or DEFAULT_DISTANCES), progress, scene)
    progress.done()
    print(folder / "index.html")
