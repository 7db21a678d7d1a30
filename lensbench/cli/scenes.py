"""lensbench scenes: what there is to look at."""

import argparse
from typing import Any

from .options import add_verb, scene_of, scene_options


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "scenes", list_scenes, "the built-in scenes and their looks, or those of --scene")
    scene_options(verb, default=None)
    verb.add_argument("--json", action="store_true", help="as JSON")


def list_scenes(args: argparse.Namespace) -> None:
    """lensbench scenes."""
    from ..output import to_json
    from ..scenes.builtin import SCENES, load_scene
    from ..scenes.facts import scene_facts

    facts = [scene_facts(s) for s in ([scene_of(args)] if args.scene else map(load_scene, SCENES))]
    if args.json:
        print(to_json(facts))
        return
    for fact in facts:
        widest = f"{fact['triangles']} triangles, edges up to {fact['widest_edge']:.1f} degrees"
        print(f"{fact['name']}: {fact['about']} ({widest})")
        for name, k in fact["looks"].items():
            print(
                f"  {name:<14} {k['distance']:>9.0f} mm   elevation {k['elevation']:+6.1f}   azimuth {k['azimuth']:+6.1f}"
            )
