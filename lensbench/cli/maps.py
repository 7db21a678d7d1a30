"""lensbench map, eoc, voxels: what one lens does, as pictures and numbers."""

import argparse
import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import (
    accommodation,
    accommodation_option,
    add_verb,
    count,
    deliver,
    depth,
    distance,
    distance_or_name,
    factor,
    field_of_view,
    kind_of,
    lens_and_wearer,
    load_case,
    output_option,
    say_misfit,
    scene_of,
    scene_options,
    unsaid,
    write,
)

if TYPE_CHECKING:
    from ..layers import MapLayer
    from ..optics.eye import Wearer
    from ..optics.lens import Lens


MESHES = (".vtp", ".vtu", ".vti")


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    _add_map(verbs)
    _add_against(verbs)
    _add_distortion(verbs)
    _add_eoc(verbs)
    _add_voxels(verbs)


def _add_map(verbs: Any) -> None:
    verb = add_verb(verbs, "map", write_map, "one map over the lens as PNG, SVG, CSV, JSON or for ParaView")
    lens_and_wearer(verb)
    verb.add_argument("-q", "--quantity", default="mean_power", help="mean_power, astigmatism, defocus, prism, ...")
    verb.add_argument("-d", "--distance", type=distance_or_name, help="40cm, 6m, inf, scene or model (inf)")
    unsaid(verb, distance=math.inf)
    scene_options(verb)
    verb.add_argument("--on-lens", action="store_true", help="on the lens in three dimensions (PNG)")
    accommodation_option(verb)
    output_option(verb, "map.png")


def _add_against(verbs: Any) -> None:
    verb = add_verb(verbs, "against", write_against, "a lens against its map from a lens mapper, as PNG, CSV or JSON")
    lens_and_wearer(verb)
    verb.add_argument("measured", type=Path, help="power map (.csv)")
    verb.add_argument("--by", choices=["lensmeter", "worn"], default="lensmeter", help="how the map was measured")
    verb.add_argument("-d", "--distance", type=distance, default=math.inf, help="of a map as worn (inf)")
    verb.add_argument("--from-behind", action="store_true", help="the map's x runs as seen from the eye's side")
    verb.add_argument("--tolerance", type=float, default=0.12, metavar="D", help="dioptres (0.12)")
    output_option(verb, "against.png")


def _add_distortion(verbs: Any) -> None:
    verb = add_verb(
        verbs, "distortion", write_distortion, "how the eye sees a chart of upright lines, as PNG, SVG, CSV or JSON"
    )
    lens_and_wearer(verb)
    verb.add_argument("-d", "--depth", type=distance, help="of the chart, from the eye: 40cm or inf (inf)")
    unsaid(verb, depth=math.inf)
    verb.add_argument("-n", type=count, default=13, help="lines each way (13)")
    output_option(verb, "distortion.png")


def _add_eoc(verbs: Any) -> None:
    verb = add_verb(verbs, "eoc", write_ellipses, "ellipses of confusion at chosen depths, as PNG, SVG, CSV or JSON")
    lens_and_wearer(verb)
    verb.add_argument("--depths", type=depth, nargs="+", help="straight ahead from the cornea (27cm 78cm 340cm)")
    unsaid(verb, depths=(270.0, 780.0, 3400.0))
    verb.add_argument("-n", type=count, default=32, help="ellipses along each side (32)")
    verb.add_argument(
        "--fov", type=field_of_view, default=math.radians(28), metavar="DEG", help="full angle each way (56)"
    )
    verb.add_argument(
        "--exaggeration", type=factor, metavar="X", help="of all ellipses in the picture; else what suits"
    )
    accommodation_option(verb)
    output_option(verb, "eoc.png")


def _add_voxels(verbs: Any) -> None:
    verb = add_verb(
        verbs, "voxels", write_voxels, "the blur field of a view frustum, a matrix a voxel, as .npz or .vti"
    )
    lens_and_wearer(verb)
    verb.add_argument("-n", type=count, nargs=3, default=[64, 64, 64], metavar=("NX", "NY", "NZ"), help="(64 64 64)")
    verb.add_argument("--near", type=depth, default=200.0, help="nearest plane, from the cornea (20cm)")
    verb.add_argument("--far", type=depth, default=10000.0, help="farthest plane, from the cornea (10m)")
    verb.add_argument(
        "--fov", type=field_of_view, default=math.radians(28), metavar="DEG", help="full angle each way (56)"
    )
    verb.add_argument("--exaggeration", type=factor, default=1.0, metavar="X", help="of all matrices (1)")
    verb.add_argument("--ndc", action="store_true", help="also as 2 x 2 matrices in the picture's NDC")
    accommodation_option(verb)
    verb.add_argument(
        "-o", "--output", type=Path, default=Path("blur_field.npz"), metavar="FILE", help="(blur_field.npz)"
    )


def write_map(args: argparse.Namespace) -> None:
    """lensbench map LENS."""
    from ..layers import MapLayer, Request
    from ..quantities import QUANTITIES
    from ..report.tables import map_csv, map_numbers
    from ..workbench import run

    kind = kind_of(args.output, *([".png"] if args.on_lens else [".png", ".svg", ".csv", ".json", *MESHES]))
    lens, wearer = load_case(args)
    scene = scene_of(args) if args.distance == "scene" else None
    layer = MapLayer(args.quantity, args.distance, accommodation(args.accommodation))
    result = run(Request(lens, wearer, layer, scene))
    if not QUANTITIES[result.quantity].about:
        say_misfit(lens, wearer)
    if kind in MESHES and not args.json:
        write(args.output, _map_mesh(args, kind, lens, wearer, result))
        return
    picture = partial(_map_picture, args, lens, wearer, layer, result)
    deliver(args, kind, map_numbers(result), partial(map_csv, result), picture)


def _map_picture(args: argparse.Namespace, lens: "Lens", wearer: "Wearer", layer: "MapLayer", result: Any) -> Any:
    from ..report.tables import map_words

    words = map_words(lens, wearer, layer)
    if args.on_lens:
        from ..views.lens3d import map_on_lens

        return map_on_lens(lens, wearer, result, **words)
    from ..views.maps import map_figure

    return map_figure(lens, result, **words)


def _map_mesh(args: argparse.Namespace, kind: str, lens: "Lens", wearer: "Wearer", result: Any) -> bytes:
    from ..quantities import QUANTITIES
    from ..report.tables import distance_text
    from ..views import meshes

    make = {
        ".vtp": lambda: meshes.map_mesh(lens, result),
        ".vtu": lambda: meshes.map_solid(lens, result),
        ".vti": lambda: meshes.map_image(result),
    }[kind]
    about = {
        "lens": lens.name,
        "side": lens.side,
        "wearer": wearer.name,
        "quantity": result.label,
        "unit": result.unit,
        "objects": QUANTITIES[result.quantity].about or distance_text(args.distance),
        "accommodation": args.accommodation,
        "frame": "lens frame, mm: x to the wearer's left, y up, z to the scene",
    }
    return meshes.vtk_file(make(), about)


def write_against(args: argparse.Namespace) -> None:
    """lensbench against LENS MAP."""
    from ..formats import load_power_map
    from ..layers import AgainstLayer, Request
    from ..report.tables import deviation_csv, deviation_numbers
    from ..views.against import deviation_figure
    from ..workbench import run

    kind = kind_of(args.output, ".png", ".csv", ".json")
    if not args.tolerance > 0:
        raise InputError(f"--tolerance: {args.tolerance:g} D; it must be more than 0")
    lens, wearer = load_case(args)
    measured = load_power_map(args.measured)
    layer = AgainstLayer(measured.mirrored() if args.from_behind else measured, args.by, args.distance)
    found = run(Request(lens, wearer, layer))
    numbers = deviation_numbers(found, args.tolerance)
    deliver(args, kind, numbers, partial(deviation_csv, found), partial(deviation_figure, lens, found, args.tolerance))


def write_distortion(args: argparse.Namespace) -> None:
    """lensbench distortion LENS."""
    from ..layers import DistortionLayer, Request
    from ..report.tables import distance_text, distortion_csv, distortion_numbers
    from ..workbench import run

    kind = kind_of(args.output, ".png", ".svg", ".csv", ".json")
    lens, wearer = load_case(args)
    grid = run(Request(lens, wearer, DistortionLayer(args.depth, args.n)))

    def picture() -> Any:
        from ..views.distortion import distortion_figure

        return distortion_figure(lens, grid, distance_text(args.depth).replace("objects", "chart"))

    deliver(args, kind, distortion_numbers(grid), partial(distortion_csv, grid), picture)


def write_ellipses(args: argparse.Namespace) -> None:
    """lensbench eoc LENS."""
    from ..layers import EllipseLayer, Request
    from ..report.tables import ellipse_rows, ellipses_csv
    from ..workbench import run

    kind = kind_of(args.output, ".png", ".svg", ".csv", ".json")
    lens, wearer = load_case(args)
    layer = EllipseLayer(tuple(args.depths), args.n, args.fov, accommodation(args.accommodation))
    sheets = run(Request(lens, wearer, layer))
    say_misfit(lens, wearer)
    picture = partial(_ellipse_picture, args, lens, wearer, sheets)
    deliver(args, kind, ellipse_rows(sheets), partial(ellipses_csv, sheets), picture)


def _ellipse_picture(args: argparse.Namespace, lens: "Lens", wearer: "Wearer", sheets: Any) -> Any:
    from ..report.facts import small_print
    from ..views.ellipses import ellipse_figure

    notes = small_print(lens, wearer, accommodation(args.accommodation))
    return ellipse_figure(lens, wearer, sheets, args.exaggeration, notes=notes)


def write_voxels(args: argparse.Namespace) -> None:
    """lensbench voxels LENS."""
    from ..layers import Request, VoxelLayer
    from ..report.tables import voxels_about, voxels_npz
    from ..workbench import run

    kind = kind_of(args.output, ".npz", ".vti")
    lens, wearer = load_case(args)
    rule = accommodation(args.accommodation)
    layer = VoxelLayer(*args.n, args.near, args.far, args.fov, rule, args.exaggeration, args.ndc)
    found = run(Request(lens, wearer, layer))
    about = voxels_about(lens, wearer, found)
    if kind == ".npz":
        write(args.output, voxels_npz(found, about))
        return
    from ..views.meshes import voxel_image, vtk_file

    write(args.output, vtk_file(voxel_image(found), about))
