"""lensbench report, compare: everything about a lens, or about several side by side, in one page."""

import argparse
import math
import sys
from pathlib import Path
from typing import Any

from .options import (
    accommodation,
    accommodation_option,
    add_verb,
    distance,
    lens_and_wearer,
    lens_choice,
    load_case,
    load_cases,
    progress_option,
    scene_of,
    scene_options,
    unsaid,
    write,
)


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    _add_report(verbs)
    _add_compare(verbs)


def _add_report(verbs: Any) -> None:
    verb = add_verb(verbs, "report", write_report, "write a full report of a lens: index.html, PNGs, results.json")
    lens_and_wearer(verb)
    verb.add_argument(
        "--object-distance", type=distance, nargs="+", metavar="D", help="for the defocus maps (inf 78cm 40cm)"
    )
    verb.set_defaults(distance=None, depths=None)
    unsaid(verb, distance=math.inf, depths=(270.0, 780.0, 3400.0))
    accommodation_option(verb)
    scene_options(verb)
    progress_option(verb)
    verb.add_argument("-o", "--output", type=Path, default=None, metavar="DIR", help="folder (reports/<lens file>)")


def _add_compare(verbs: Any) -> None:
    verb = add_verb(verbs, "compare", write_comparison, "several lenses side by side: index.html, PNGs, zones.csv")
    verb.add_argument(
        "lenses", type=Path, nargs="+", metavar="LENS", help="lens files of one side; the first is the reference"
    )
    lens_choice(verb)
    progress_option(verb)
    verb.add_argument(
        "-w", "--wearer", type=Path, help="wearer file (.toml); assumed from the first lens's order if not given"
    )
    verb.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("reports") / "comparison",
        metavar="DIR|FILE",
        help="folder (reports/comparison), or a .csv file for the measures of the zones alone",
    )


def write_report(args: argparse.Namespace) -> None:
    """lensbench report LENS."""
    from ..report.build import DEFAULT_DISTANCES, Terms, build_report
    from ..report.progress import Progress

    folder = args.output or Path("reports") / args.lens.stem
    progress = Progress(sys.stderr, args.progress)
    progress.step("load")
    lens, wearer = load_case(args)
    scene = scene_of(args)
    own = () if isinstance(args.distance, str) else (args.distance,)
    distances = args.object_distance or dict.fromkeys((*DEFAULT_DISTANCES, *own))
    terms = Terms(tuple(distances), tuple(args.depths), accommodation(args.accommodation))
    build_report(lens, wearer, folder, terms, progress, scene)
    progress.done()
    print(folder / "index.html")


def write_comparison(args: argparse.Namespace) -> None:
    """lensbench compare LENS LENS ..."""
    from ..compare import compare
    from ..report.comparison import build_comparison, zones_csv
    from ..report.progress import Progress

    progress = Progress(sys.stderr, args.progress)
    progress.step("load")
    cases = [case for path in args.lenses for case in load_cases(args, path)]
    wearer = cases[0][1]
    lenses = [lens for lens, _ in cases]
    if args.output.suffix.lower() == ".csv":
        write(args.output, zones_csv(compare(lenses, wearer)))
        return
    build_comparison(lenses, wearer, args.output, progress)
    progress.done()
    print(args.output / "index.html")
