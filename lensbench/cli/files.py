"""lensbench check: how a file was understood."""

import argparse
from pathlib import Path
from typing import Any

from .options import add_verb


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "check", check_file, "validate a lens, wearer or surface file and say what it holds")
    verb.add_argument("file", type=Path)
    verb.add_argument("--json", action="store_true")


def check_file(args: argparse.Namespace) -> None:
    """lensbench check FILE."""
    from ..formats import read_file
    from ..output import to_json
    from ..report.facts import file_facts

    facts = [fact for item in read_file(args.file).items for fact in file_facts(item)]
    if args.json:
        print(to_json({fact.label: fact.value for fact in facts}))
    else:
        width = max(len(fact.label) for fact in facts)
        print("\n".join(f"{fact.label:<{width}}  {fact.text}" for fact in facts))
