"""lensbench doctor: what this installation has."""

import argparse
from typing import Any

from .options import add_verb


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "doctor", print_doctor, "versions, graphics driver, threads")
    verb.add_argument("--json", action="store_true")


def print_doctor(args: argparse.Namespace) -> None:
    """lensbench doctor."""
    from ..doctor import examine
    from ..output import to_json

    found = examine()
    if args.json:
        print(to_json(found))
    else:
        print("\n".join(f"{name:<22} {value}" for name, value in found.items()))
