"""lensbench verify, compensate: a lens against its order; what a focimeter must read of a lens that is right as worn."""

import argparse
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import add_verb, kind_of, lens_and_wearer, load_case

if TYPE_CHECKING:
    from ..optics.compensation import Compensation
    from ..optics.lens import Lens, Order

SIZES = (("sphere", -40.0, 40.0), ("cylinder", -20.0, 20.0), ("axis", 0.0, 180.0), ("addition", 0.0, 5.0))


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "verify", print_verification, "focimeter readings against the order, with tolerances")
    lens_and_wearer(verb)
    verb.add_argument(
        "--tolerances", metavar="EDITION|FILE", help="ANSI Z80.1-2015 (default), ANSI Z80.1-2010, a .toml"
    )
    verb.add_argument("--json", action="store_true")
    verb = add_verb(verbs, "compensate", print_compensation, "ordered power as worn <-> power to verify by focimeter")
    lens_and_wearer(verb)
    given = verb.add_mutually_exclusive_group()
    power = {"type": float, "nargs": 3, "metavar": ("SPHERE", "CYLINDER", "AXIS")}
    given.add_argument("--ordered", **power, help="power wanted as worn (the lens's order)")
    given.add_argument("--verification", **power, help="power that a focimeter reads: what is it as worn?")
    verb.add_argument("--addition", type=float, metavar="D", help="that goes with it (the order's)")
    verb.add_argument("-o", "--output", type=Path, metavar="FILE.toml", help="the lens made so, as a lens file")
    verb.add_argument("--json", action="store_true", help="numbers to standard output")


def print_verification(args: argparse.Namespace) -> None:
    """lensbench verify LENS."""
    from ..formats.tolerance_file import load_tolerances
    from ..layers import Request, VerificationLayer
    from ..output import to_json
    from ..report.verification import row_of, sentences
    from ..workbench import run

    table = load_tolerances(args.tolerances) if args.tolerances else None
    found = run(Request(*load_case(args), VerificationLayer(table)))
    if found is None:
        raise InputError(f"{args.lens}: holds no order to verify the lens against")
    if args.json:
        print(to_json(asdict(found)))
        return
    rows = [row_of(line) for line in found.lines]
    cells = [("", "expected", "measured", "off by", "allowed", ""), *((f"{r[0]} ({r[1]})", *r[2:]) for r in rows)]
    widths = [max(len(line[k]) for line in cells) for k in range(5)]
    for name, *numbers, verdict in cells:
        texts = [f"{text:>{width}}" for text, width in zip(numbers, widths[1:], strict=True)]
        print("  ".join([f"{name:<{widths[0]}}", *texts, verdict]).rstrip())
    print("\n".join(["", *sentences(found)]))


def print_compensation(args: argparse.Namespace) -> None:
    """lensbench compensate LENS."""
    from ..optics.compensation import power_as_worn, verification_power
    from ..output import to_json
    from ..report.facts import order_text, wear_text

    if args.output:
        kind_of(args.output, ".toml")
    lens, wearer = load_case(args)
    given = _given(args, lens)
    found = (power_as_worn if args.verification else verification_power)(lens, wearer, given)
    if args.output:
        _write_lens(args.output, found)
    if args.json:
        powers = {"as_worn": asdict(found.as_worn), "verification_power": asdict(found.verification_power)}
        print(to_json({**powers, "wear": asdict(wearer.wear)}))
    elif not args.output:
        print(f"as worn             {order_text(found.as_worn)}")
        print(f"verification power  {order_text(found.verification_power)}")
        print(f"position of wear    {wear_text(wearer.wear)}")


def _given(args: argparse.Namespace, lens: "Lens") -> "Order":
    """The power that the options name, or the lens's order. Raises InputError."""
    from ..optics.lens import Order

    named = args.ordered or args.verification
    if lens.ordered is None and named is None:
        raise InputError(f"{args.lens}: holds no order; give the power: --ordered SPHERE CYLINDER AXIS")
    values = dict(zip(("sphere", "cylinder", "axis"), named or (), strict=False))
    if args.addition is not None:
        values["addition"] = args.addition
    for name, low, high in SIZES:
        if name in values and not low <= values[name] <= high:
            raise InputError(f"{name}: {values[name]:g} is not from {low:g} to {high:g}")
    return replace(lens.ordered or Order(), **values)


def _write_lens(path: Path, found: "Compensation") -> None:
    """The lens that was made, its order and its verification power."""
    from ..formats import write
    from ..formats.lens_file import check_body

    check_body(path, found.lens)
    print(write(path, found.lens))
