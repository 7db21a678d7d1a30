"""lensbench gallery, scenes: designs side by side, and what there is to look at."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .options import add_verb, count, kind_of, measure_option, scene_of, scene_options, write

if TYPE_CHECKING:
    from ..scenes.scene import Scene


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "gallery", write_gallery, "several lenses side by side as seen, under one scale of defocus")
    verb.add_argument("lens", type=Path, nargs="+", help="lens files")
    verb.add_argument(
        "-w", "--wearer", type=Path, help="one wearer for all; else each as assumed from its lens's order"
    )
    scene_options(verb)
    verb.add_argument("--look", metavar="NAME", default="intermediate", help="middle of the pictures (intermediate)")
    verb.add_argument("--way", choices=["veil", "colours"], default="veil", help="how the defocus is drawn")
    measure_option(verb)
    verb.add_argument("--passes", type=count, default=64, help="pictures blended for the blur (64)")
    verb.add_argument("--small", type=Path, metavar="FILE", help="a small copy of the sheet, for a page (.png)")
    verb.add_argument("-o", "--output", type=Path, default=Path("gallery"), metavar="DIR", help="folder (gallery)")
    verb = add_verb(verbs, "scenes", list_scenes, "the built-in scenes and their looks, or those of --scene")
    scene_options(verb, default=None)
    verb.add_argument("--json", action="store_true", help="as JSON")
    verb.add_argument("-o", "--output", type=Path, metavar="FILE", help="a contact sheet of the looks instead (.png)")


def write_gallery(args: argparse.Namespace) -> None:
    """lensbench gallery LENS LENS."""
    from ..formats import load_lens, load_wearer
    from ..output import require_folder
    from ..report.gallery import gallery_cases, gallery_pictures, gallery_sheet, small_png
    from ..views.maps import png_bytes
    from ..workbench import assumed_wearer

    require_folder(args.output)
    if args.small is not None:
        kind_of(args.small, ".png")
    wearer = load_wearer(args.wearer) if args.wearer else None
    pairs = [(lens, wearer or assumed_wearer(lens)) for lens in map(load_lens, args.lens)]
    scene = scene_of(args)
    cases = gallery_cases(pairs, scene, args.look, 560, args.measure or "defocus")
    scale, rows = gallery_pictures(cases, args.passes, args.way)
    who = wearer.name if wearer else "each by a wearer of the refraction that it was ordered for"
    sheet = gallery_sheet(cases, scale, rows, f"Looking at the {scene.name} through {len(cases)} lenses, {who}")
    for row, pictures in rows.items():
        for path, picture in zip(args.lens, pictures, strict=True):
            write(args.output / f"{path.stem}_{row}.png", png_bytes(picture))
    write(args.output / "gallery.png", png_bytes(sheet))
    if args.small is not None:
        write(args.small, small_png(sheet))


def list_scenes(args: argparse.Namespace) -> None:
    """lensbench scenes."""
    from ..output import to_json
    from ..scenes.builtin import SCENES, load_scene
    from ..scenes.facts import scene_facts

    scenes = [scene_of(args)] if args.scene else [load_scene(name) for name in SCENES]
    if args.output is not None:
        _write_sheet(args.output, scenes)
        return
    facts = [scene_facts(scene) for scene in scenes]
    if args.json:
        print(to_json(facts))
        return
    for fact in facts:
        size = f"{fact['triangles']} triangles, edges up to {fact['widest_edge']:.1f} degrees"
        print(f"{fact['name']}: {fact['about']} ({size})")
        for name, k in fact["looks"].items():
            print(
                f"  {name:<14}{k['distance']:>8.0f} mm   elevation {k['elevation']:+6.1f}   azimuth {k['azimuth']:+6.1f}"
            )


def _write_sheet(path: Path, scenes: "list[Scene]") -> None:
    from ..report.gallery import contact_sheet, small_png

    kind_of(path, ".png")
    write(path, small_png(contact_sheet(scenes), 1600, 1_000_000))
