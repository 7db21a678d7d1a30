"""lensbench check and convert: how a file was understood, and the same in another format."""

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import InputError
from .options import add_verb, completion, lens_choice, orientation_options, reading


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "check", check_file, "validate a lens, wearer or surface file and say what it holds")
    verb.add_argument("file", type=Path)
    verb.add_argument("--json", action="store_true")
    verb.add_argument("--side", choices=["R", "L"], default="", help="of a surface file that says none")
    orientation_options(verb)
    _add_convert(verbs)


def _add_convert(verbs: Any) -> None:
    verb = add_verb(verbs, "convert", convert, "a lens or surface file in another format, named by its extension")
    verb.add_argument("file", type=Path)
    verb.add_argument("output", type=Path)
    lens_choice(verb)
    group = verb.add_argument_group("what is written")
    group.add_argument("--mirror", action="store_true", help="the other side: right from left, left from right")
    group.add_argument("--pitch", type=float, help="distance of the points, mm (1)")
    group.add_argument("--size", type=float, nargs=2, metavar=("W", "H"), help="of the grid, mm (all of the surface)")
    group.add_argument("--decimals", type=int, default=6, help="of the sags (6)")
    group.add_argument("--as", dest="written_as", metavar="CORNER-WAY", help="order of the points (top-left-rows)")
    group.add_argument("--written-z", choices=["eye", "scene"], default="eye", help="side to which z is positive (eye)")


def check_file(args: argparse.Namespace) -> None:
    """lensbench check FILE."""
    from ..formats import read_file
    from ..output import to_json
    from ..report.facts import file_facts

    read = replace(reading(args), side=args.side)
    held = [file_facts(item, read) for item in read_file(args.file).items]
    if args.json:
        tables = [{fact.label: fact.value for fact in facts} for facts in held]
        print(to_json(tables[0] if len(tables) == 1 else tables))
    else:
        width = max(len(fact.label) for facts in held for fact in facts)
        print("\n".join(f"{fact.label:<{width}}  {fact.text}" for facts in held for fact in facts))


def convert(args: argparse.Namespace) -> None:
    """lensbench convert FILE OUTPUT."""
    from ..formats import Writing, write
    from ..formats.orientation import named

    if args.pitch is not None and not 0.01 <= args.pitch <= 20:
        raise InputError(f"--pitch: {args.pitch:g} mm is not from 0.01 to 20")
    if not 0 <= args.decimals <= 15:
        raise InputError(f"--decimals: {args.decimals} is not from 0 to 15")
    order = named(args.written_as or "top-left-rows")._replace(z_towards=args.written_z)
    face = {"front": "F", "back": "B", None: ""}[args.face]
    size = tuple(args.size) if args.size else None
    writing = Writing(args.pitch, size, order, args.decimals, "" if args.mirror else args.side, face)  # type: ignore[arg-type]
    things = _things(args)
    print(write(args.output, *things, writing=writing))


def _things(args: argparse.Namespace) -> list[Any]:
    """The file's lenses or, where the output takes surfaces and the file holds no more, its surfaces; mirrored if asked for."""
    from ..formats import Completion, load_pair, read_file
    from ..formats.body import BodySurface
    from ..formats.registry import write_format
    from ..optics.lens import Lens
    from ..optics.mirror import mirrored, mirrored_surface

    told = completion(args)
    items = read_file(args.file).items
    if not write_format(args.output).whole and not any(isinstance(i, Lens) or hasattr(i, "lens") for i in items):
        read = replace(told.reading, side=args.side)
        things = []
        for item in (i for i in items if hasattr(i, "fitted")):
            surface, facts, *_ = item.fitted(read)
            side, face = item.side or args.side, item.face or read.face
            print(
                f"lensbench: {next(t for label, t, _ in facts if label in ('Orientation', 'Surface'))}", file=sys.stderr
            )
            if args.mirror:
                surface, side = mirrored_surface(surface), {"R": "L", "L": "R"}.get(side, "")
            things.append(BodySurface(item.source, surface, side, face))
        return things
    lenses = [
        lens for lens, _ in load_pair(args.file, args.side, args.material, None if told == Completion() else told)
    ]
    for lens in lenses:
        if lens.note:
            print(f"lensbench: {lens.note}", file=sys.stderr)
    return [mirrored(lens) for lens in lenses] if args.mirror else lenses
