"""lensbench doctor, bench: what this installation has, and how quick it is."""

import argparse
import subprocess
import sys
from pathlib import Path
from typing import Any

from .options import add_verb


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "doctor", print_doctor, "versions, graphics driver, threads")
    verb.add_argument("--json", action="store_true")
    verb = add_verb(verbs, "bench", run_benchmarks, "measured speed against its targets (in a checkout of LensBench)")
    verb.add_argument("--json", action="store_true", help="print the figures as JSON")


def print_doctor(args: argparse.Namespace) -> None:
    """lensbench doctor."""
    from ..doctor import examine
    from ..output import to_json

    found = examine()
    if args.json:
        print(to_json(found))
    else:
        print("\n".join(f"{name:<22} {value}" for name, value in found.items()))


def run_benchmarks(args: argparse.Namespace) -> None:
    """lensbench bench: the checkout's benchmarks/, which write reports/bench.json and bench.html."""
    from ..errors import LensBenchError

    checkout = Path(__file__).parents[2]
    if not (checkout / "benchmarks" / "__main__.py").is_file():
        raise LensBenchError("bench: the benchmarks are part of a checkout of LensBench, not of an installed package")
    options = ["--json"] if args.json else []
    if subprocess.run([sys.executable, "-m", "benchmarks", *options], cwd=checkout).returncode:
        raise LensBenchError("bench: the benchmarks did not come to their end")
