"""lensbench view: what the wearer sees."""

import argparse
import math
from pathlib import Path
from typing import Any

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
    scene_of,
    scene_options,
    write,
    write_picture,
)


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "view", write_view, "what the wearer sees of a scene, as PNG or OpenEXR")
    lens_and_wearer(verb)
    scene_options(verb)
    verb.add_argument(
        "--look", metavar="NAME", help="what the picture is centred on: a look of the scene, such as near"
    )
    verb.add_argument("--gaze", type=gaze_angle, nargs=2, metavar=("AZ", "EL"), help="the same in degrees, left and up")
    verb.add_argument("--eye", choices=["lens", "naked", "pinhole"], default="lens")
    verb.add_argument("--size", type=int, nargs=2, default=(960, 720), metavar=("W", "H"))
    verb.add_argument("--fov", type=float, default=50.0, help="horizontal field of view, degrees (50)")
    verb.add_argument("--passes", type=count, default=48, help="pictures blended for the blur (48)")
    accommodation_option(verb)
    verb.add_argument("-o", "--output", type=Path, default=Path("view.png"), metavar="FILE", help="(view.png)")


def write_view(args: argparse.Namespace) -> None:
    """lensbench view LENS."""
    from ..layers import Request, ViewLayer
    from ..workbench import look, run

    kind = kind_of(args.output, ".png", ".exr")
    if not 5 <= args.fov <= 120 or min(args.size) < 16 or max(args.size) > 8192:
        raise InputError("view: --fov must be 5 to 120 degrees, --size 16 to 8192 pixels")
    lens, wearer = load_case(args)
    scene = scene_of(args)
    gaze = tuple(map(math.radians, args.gaze)) if args.gaze else look(args.look, lens, wearer, scene)
    rule = accommodation(args.accommodation)
    layer = ViewLayer(args.eye, *gaze, math.radians(args.fov / 2), tuple(args.size), rule)
    seen = run(Request(lens, wearer, layer, scene))
    if kind == ".exr":
        write_exr(args.output, seen, args.passes)
        return
    from ..views.jitter import render_view

    write_picture(args.output, render_view(seen, args.passes))


def write_exr(path: Path, seen: Any, passes: int, seed: int = 0) -> None:
    """Write a view's linear light and the optics of its pixels as OpenEXR, and say its name."""
    from ..imaging.exr import exr_bytes
    from ..views.jitter import Studio

    with Studio() as studio:
        light = studio.light(seen, passes, seed)
    write(path, exr_bytes(light, seen))
