"""lensbench verify: a lens against its order."""

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import add_verb, lens_choice

if TYPE_CHECKING:
    from ..optics.tolerances import ToleranceLine


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "verify", print_verification, "lens-meter readings against the order, ANSI Z80.1 tolerances")
    verb.add_argument("lens", type=Path, help="lens file")
    lens_choice(verb)
    verb.add_argument("--json", action="store_true")


def print_verification(args: argparse.Namespace) -> None:
    """lensbench verify LENS."""
    from ..formats import load_pair
    from ..optics.tolerances import STANDARD, verification
    from ..output import to_json

    lens, _ = load_pair(args.lens, args.side, args.material)[0]
    lines = verification(lens)
    if not lines:
        raise InputError(f"{args.lens}: holds no order to verify the lens against")
    if args.json:
        print(to_json({"standard": STANDARD, "lines": [asdict(line) for line in lines]}))
        return
    width = max(len(line.name) for line in lines)
    print(f"{'':<{width}}  {'ordered':>8}  {'measured':>8}  {'off by':>7}  {'allowed':>7}")
    for line in lines:
        print(f"{line.name:<{width}}  {_line_text(line)}")


def _line_text(line: "ToleranceLine") -> str:
    """Numbers and verdict of a line."""
    verdict = (
        "within" if line.within else "no reading" if line.excess != line.excess else f"outside by {line.excess:.2f}"
    )
    numbers = f"{line.ordered:8.2f}  {line.measured:8.2f}  {line.deviation:7.2f}  {line.tolerance:7.2f}"
    return f"{numbers}  {line.unit:<4}  {verdict}"
