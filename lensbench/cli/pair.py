"""lensbench pair: two lenses for one face."""

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import add_verb, deliver, distance, kind_of, output_option

if TYPE_CHECKING:
    from ..optics.binocular import Pair
    from ..optics.eye import Wearer


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    summary = "both eyes: convergence path, imbalance, differences right less left, as PNG, SVG, CSV (path) or JSON"
    verb = add_verb(verbs, "pair", write_pair, summary)
    verb.add_argument("right", type=Path, help="file of the right lens, or of both")
    verb.add_argument("left", type=Path, nargs="?", help="file of the left lens (the mirror image of the right one)")
    verb.add_argument("--material", default="", metavar="NAME", help="by name, or n_d/V_d (Abbe number): 1.592/41")
    verb.add_argument(
        "-w",
        "--wearer",
        type=Path,
        help="wearer file of the right eye, or of both; assumed from the order if not given",
    )
    verb.add_argument(
        "--left-wearer", type=Path, metavar="FILE", help="of the left eye (the mirror image of the right)"
    )
    verb.add_argument(
        "-d",
        "--distance",
        type=distance_or_model,
        default="model",
        help="of what both eyes fixate: 40cm, inf or model (model)",
    )
    verb.add_argument(
        "--l2",
        type=part_of_vergence,
        default=0.0,
        metavar="PART",
        help="Listing's planes turn outward by this part of the convergence (0)",
    )
    output_option(verb, "pair.png")


def distance_or_model(text: str) -> float | str:
    """A distance, or "model" for the wearer's own distances by lowering of the gaze."""
    return text if text == "model" else distance(text)


def part_of_vergence(text: str) -> float:
    """A number from 0 to 1."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1:
        raise argparse.ArgumentTypeError(f"{text!r} is no part of the convergence; write a number from 0 to 1")
    return value


def write_pair(args: argparse.Namespace) -> None:
    """lensbench pair RIGHT [LEFT]."""
    from dataclasses import asdict

    from ..pair import PairRequest, run_pair
    from ..report.tables import path_csv

    kind = kind_of(args.output, ".png", ".svg", ".csv", ".json")
    request = PairRequest(load_both(args), args.distance, l2=args.l2)
    result = run_pair(request)
    deliver(args, kind, asdict(result), partial(path_csv, result.path), partial(_picture, request, result))


def load_both(args: argparse.Namespace) -> "Pair":
    """The lenses and wearers that the options name."""
    from ..formats import load_pair, load_wearer
    from ..optics.binocular import Pair
    from ..optics.mirror import mirrored, mirrored_wearer
    from ..workbench import assumed_wearer

    read = load_pair(args.right, "" if args.left is None else "R", args.material)
    if args.left is not None:
        read = (*read, *load_pair(args.left, "L", args.material))
    found = {lens.side: (lens, told) for lens, told in read}
    if "R" not in found:
        raise InputError(f'{args.right}: is a left lens (side = "L"); the right one stands first')
    right, right_told = found["R"]
    left, left_told = found.get("L", (mirrored(right), None))
    if args.wearer:
        right_told, left_told = load_wearer(args.wearer, "R"), _other_eye(args.wearer)
    if args.left_wearer:
        left_told = load_wearer(args.left_wearer, "L")
    if left_told is None and right_told is not None:
        left_told = mirrored_wearer(right_told)
    return Pair(right, left, right_told or assumed_wearer(right), left_told or assumed_wearer(left))


def _other_eye(path: Path) -> "Wearer":
    """The left eye of a file for both eyes, or the mirror image of the one eye in it."""
    from ..formats import load_wearer, read_file
    from ..optics.mirror import mirrored_wearer

    both = any(hasattr(item, "wearer") for item in read_file(path).items)
    return load_wearer(path, "L") if both else mirrored_wearer(load_wearer(path))


def _picture(request: Any, result: Any) -> Any:
    from ..report.tables import distance_text
    from ..views.pair import pair_figure

    return pair_figure(request, result, distance_text(request.distance))
