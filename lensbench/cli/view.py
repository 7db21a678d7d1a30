"""lensbench view, sweep: what the wearer sees."""

import argparse
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import (
    accommodation,
    accommodation_option,
    add_verb,
    count,
    gaze_angle,
    kind_of,
    lens_and_wearer,
    load_case,
    measure_option,
    say_misfit,
    scene_of,
    scene_options,
    unsaid,
    write,
    write_picture,
)

if TYPE_CHECKING:
    from ..layers import Request, SeenScene

EYES = ("lens", "naked", "pinhole", "perfect")


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "view", write_view, "what the wearer sees of a scene, as PNG or OpenEXR")
    _view_options(verb)
    verb.add_argument(
        "--head", type=gaze_angle, nargs=2, metavar=("TURN", "TILT"),
        help="turn of the head (and lens) about the eye, degrees left and up; the eye keeps its target (0 0)",
    )  # fmt: skip
    unsaid(verb, head=(0.0, 0.0))
    verb.add_argument("-o", "--output", type=Path, default=Path("view.png"), metavar="FILE", help="(view.png)")
    verb = add_verb(verbs, "sweep", write_sweep, "the head turns while the eye keeps its target: animation and sheet")
    _view_options(verb)
    verb.add_argument("--from", dest="start", type=gaze_angle, nargs=2, default=(-20.0, 0.0), metavar=("TURN", "TILT"))
    verb.add_argument("--to", dest="end", type=gaze_angle, nargs=2, default=(20.0, 0.0), metavar=("TURN", "TILT"))
    verb.add_argument("--frames", type=count, default=25, help="from one end to the other (25)")
    verb.add_argument("--rate", type=float, default=12.0, help="frames a second (12)")
    verb.add_argument("--sheet", type=Path, metavar="FILE", help="contact sheet, PNG (beside the animation)")
    verb.add_argument(
        "-o", "--output", type=Path, default=Path("sweep.gif"), metavar="FILE", help=".mp4, .gif, .apng (sweep.gif)"
    )


def _view_options(verb: argparse.ArgumentParser) -> None:
    lens_and_wearer(verb)
    scene_options(verb)
    verb.add_argument(
        "--look", metavar="NAME", help="what the picture is centred on: a look of the scene, such as near"
    )
    verb.add_argument("--gaze", type=gaze_angle, nargs=2, metavar=("AZ", "EL"), help="the same in degrees, left and up")
    verb.add_argument(
        "--eye", choices=EYES, default="lens",
        help="lens; naked; pinhole: through the lens, unblurred; perfect: without the lens, unblurred",
    )  # fmt: skip
    verb.add_argument("--split", action="store_true", help="the left half without the lens")
    verb.add_argument("--defocus", choices=["veil", "colours"], help="draw the defocus map over it, with its scale")
    measure_option(verb)
    verb.add_argument("--size", type=int, nargs=2, default=(960, 720), metavar=("W", "H"))
    verb.add_argument("--bare", action="store_true", help="no caption of lens, wearer and distance below")
    verb.add_argument("--fov", type=float, default=50.0, help="horizontal field of view, degrees (50)")
    verb.add_argument("--passes", type=count, default=48, help="pictures blended for the blur (48)")
    verb.add_argument("--seed", type=int, default=0, help="order of the pupil's points (0)")
    verb.add_argument("--exposure", type=float, default=0.0, metavar="EV", help="brighter by so many stops (0)")
    accommodation_option(verb)


def write_view(args: argparse.Namespace) -> None:
    """lensbench view LENS."""
    from ..views.jitter import Studio

    kind = kind_of(args.output, ".png", ".exr")
    if kind == ".exr" and (args.defocus or args.exposure):
        raise InputError(
            "view: --defocus and --exposure are for PNG; an OpenEXR file holds light and optics as they are"
        )
    request = _request(args)
    with Studio() as studio:
        if kind == ".exr":
            _write_exr(args, studio, request)
        else:
            picture, seen = _pictures(args, studio, [request])
            write_picture(args.output, _captioned(args, picture[0], seen[0]))


def _write_exr(args: argparse.Namespace, studio: Any, request: "Request") -> None:
    """Write a view's linear light and the optics of its pixels as OpenEXR, and say its name."""
    from ..imaging.exr import exr_bytes
    from ..workbench import run

    seen = run(request)
    write(args.output, exr_bytes(studio.light(seen, args.passes, args.seed), seen))


def write_sweep(args: argparse.Namespace) -> None:
    """lensbench sweep LENS."""
    import numpy as np

    from ..output import require_folder
    from ..views.jitter import Studio
    from ..views.sweep import KINDS, contact_sheet, there_and_back, titled, write_animation

    kind_of(args.output, *KINDS)
    sheet = args.sheet or args.output.with_name(f"{args.output.stem}_sheet.png")
    kind_of(sheet, ".png")
    if sheet == args.output:
        raise InputError(f"{sheet}: the animation and its sheet need two names")
    if not 0.5 <= args.rate <= 60:
        raise InputError("sweep: --rate must be 0.5 to 60 frames a second")
    for path in (args.output, sheet):
        require_folder(path.parent)
    heads = np.linspace(args.start, args.end, args.frames)
    first = _request(args, tuple(heads[0]))
    turned = [replace(first.layer, head_turn=math.radians(t), head_tilt=math.radians(v)) for t, v in heads]
    with Studio() as studio:
        pictures, seen = _pictures(args, studio, [replace(first, layer=layer) for layer in turned])
    frames = [titled(picture, _head_text(*head)) for picture, head in zip(pictures, heads, strict=True)]
    frames = [_captioned(args, frame, seen[0]) for frame in frames]
    write_animation(args.output, there_and_back(frames), args.rate)
    print(args.output)
    write_picture(sheet, contact_sheet(frames))


def _head_text(turn: float, tilt: float) -> str:
    sides = (turn, "left", "right"), (tilt, "up", "down")
    parts = [f"{abs(angle):.0f}° {plus if angle > 0 else minus}" for angle, plus, minus in sides if round(angle)]
    return f"head {', '.join(parts) or 'straight'}"


def _request(args: argparse.Namespace, head: tuple[float, float] | None = None) -> "Request":
    """The question that the options ask; head: its turn and tilt in degrees, else as the options say."""
    from ..layers import Request, ViewLayer
    from ..workbench import look

    if not 5 <= args.fov <= 120 or min(args.size) < 16 or max(args.size) > 8192:
        raise InputError("view: --fov must be 5 to 120 degrees, --size 16 to 8192 pixels")
    if not abs(args.exposure) <= 16:
        raise InputError("view: --exposure must be -16 to 16 stops")
    if args.measure and not args.defocus:
        raise InputError("view: --measure is of the defocus map: say --defocus veil or colours")
    if args.seed < 0:
        raise InputError("view: --seed must not be negative")
    if (args.split or args.defocus) and args.eye not in ("lens", "pinhole"):
        raise InputError(f"view: --split and --defocus show what the lens does: not with --eye {args.eye}")
    lens, wearer = load_case(args)
    scene = scene_of(args)
    turn, tilt = head or args.head
    gaze = tuple(map(math.radians, args.gaze)) if args.gaze else look(args.look, lens, wearer, scene)
    layer = ViewLayer(
        args.eye, *gaze, math.radians(args.fov / 2), tuple(args.size), accommodation(args.accommodation),
        math.radians(turn), math.radians(tilt), args.split,
    )  # fmt: skip
    if layer.through_lens:
        say_misfit(lens, wearer)
    return Request(lens, wearer, layer, scene)


def _pictures(args: argparse.Namespace, studio: Any, requests: "list[Request]") -> tuple[list[Any], "list[SeenScene]"]:
    """The pictures of several requests, under the defocus map and above its scale where the options ask for it, and what is
    seen in each.
    """
    from ..layers import DefocusLayer
    from ..workbench import run

    seen = [run(request) for request in requests]
    drawn = [studio.picture(each, args.passes, args.seed, 2.0**args.exposure) for each in seen]
    if args.defocus:
        from ..views.defocus import under_scale

        found = [run(replace(r, layer=DefocusLayer(r.layer, args.measure or "defocus"))) for r in requests]
        drawn = under_scale(drawn, found, args.defocus)
    return drawn, seen


def _captioned(args: argparse.Namespace, picture: Any, seen: "SeenScene") -> Any:
    """The picture above what is said of it, unless that is not wanted."""
    from ..report.facts import view_text
    from ..views.jitter.picture import captioned

    return picture if args.bare else captioned(picture, view_text(seen))
