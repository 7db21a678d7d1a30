"""lensbench conoid: how light spreads along one gaze."""

import argparse
import math
from typing import Any

from ..errors import InputError
from .options import (
    accommodation,
    accommodation_option,
    add_verb,
    deliver,
    distance_or_name,
    factor,
    gaze_angle,
    kind_of,
    lens_and_wearer,
    load_case,
    output_option,
    scene_of,
    scene_options,
    unsaid,
)


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    about = "how light from the pupil spreads along one gaze, relaxed, tense and as used, as PNG, CSV or JSON"
    verb = add_verb(verbs, "conoid", write_conoid, about)
    lens_and_wearer(verb)
    verb.add_argument(
        "--gaze",
        type=gaze_angle,
        nargs=2,
        default=(0.0, 0.0),
        metavar=("AZ", "EL"),
        help="degrees to the wearer's left and up (0 0)",
    )
    verb.add_argument(
        "-d", "--distance", type=distance_or_name, help="of the object from the front surface: inf, scene, model (40cm)"
    )
    unsaid(verb, distance=400.0)
    scene_options(verb)
    verb.add_argument("--exaggeration", type=factor, metavar="X", help="across the ray, in space; else what suits")
    accommodation_option(verb)
    output_option(verb, "conoid.png")


def write_conoid(args: argparse.Namespace) -> None:
    """lensbench conoid LENS."""
    from ..layers import ConoidLayer, Request
    from ..optics.conventions import Status
    from ..report.facts import gaze_text, viewer_text
    from ..report.tables import conoid_csv, conoid_numbers
    from ..workbench import run

    kind = kind_of(args.output, ".png", ".csv", ".json")
    lens, wearer = load_case(args)
    azimuth, elevation = (math.radians(angle) for angle in args.gaze)
    rule = accommodation(args.accommodation)
    scene = scene_of(args) if args.distance == "scene" else None
    found = run(Request(lens, wearer, ConoidLayer(azimuth, elevation, args.distance, rule), scene))
    if found.status != Status.OK:
        reason = Status(found.status).name.lower().replace("_", " ")
        raise InputError(f"--gaze: no ray passes the lens along {args.gaze[0]:g} {args.gaze[1]:g} ({reason})")

    def picture() -> Any:
        from ..views.conoid import conoid_picture

        about = gaze_text(azimuth, elevation), viewer_text(wearer, rule)
        return conoid_picture(lens, wearer, found, args.exaggeration, about)

    deliver(args, kind, conoid_numbers(found), lambda: conoid_csv(found), picture)
