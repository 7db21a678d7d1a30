"""The command line: verbs parse, call and print. Exit codes: 0 ok, 2 bad usage or bad input, 1 failure."""

import argparse
import math
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import __version__
from .errors import InputError, LensBenchError

if TYPE_CHECKING:
    from .optics.eye import Wearer
    from .optics.lens import Lens

UNITS_IN_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    try:
        args = parser().parse_args(arguments)
        args.run(args)
    except ModuleNotFoundError as error:
        print(f'lensbench: {error.name} is not installed: pip install "lensbench[report]"', file=sys.stderr)
        return 1
    except LensBenchError as error:
        print(f"lensbench: {error}", file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:
        return 1
    return 0


def parser() -> argparse.ArgumentParser:
    """All verbs and their options."""
    top = argparse.ArgumentParser(prog="lensbench", description="What a spectacle lens does, and what its wearer sees.")
    top.add_argument("--version", action="version", version=f"lensbench {__version__}")
    verbs = top.add_subparsers(required=True, metavar="COMMAND")

    report = _verb(verbs, "report", write_report, "write a full report of a lens: index.html, PNGs, results.json")
    _lens_and_wearer(report)
    report.add_argument(
        "--object-distance", type=distance, nargs="+", metavar="D", help="for the defocus maps (inf 78cm 40cm)"
    )
    report.add_argument("-o", "--output", type=Path, default=None, metavar="DIR", help="folder (reports/<lens file>)")

    one_map = _verb(verbs, "map", write_map, "one map over the lens as PNG, SVG, CSV or JSON")
    _lens_and_wearer(one_map)
    one_map.add_argument("-q", "--quantity", default="mean_power", help="mean_power, astigmatism, defocus, prism, ...")
    one_map.add_argument("-d", "--distance", type=distance_or_scene, default=math.inf, help="40cm, 6m, inf or scene")
    one_map.add_argument("--on-lens", action="store_true", help="on the lens in three dimensions (PNG)")
    _accommodation(one_map)
    _output(one_map, "map.png")

    view = _verb(verbs, "view", write_view, "what the wearer sees of the built-in scene, as PNG")
    _lens_and_wearer(view)
    view.add_argument(
        "--look", choices=["far", "intermediate", "near"], default="far", help="gaze at the picture's centre"
    )
    view.add_argument("--gaze", type=float, nargs=2, metavar=("AZ", "EL"), help="the same in degrees, left and up")
    view.add_argument("--eye", choices=["lens", "naked", "pinhole"], default="lens")
    view.add_argument("--size", type=int, nargs=2, default=(960, 720), metavar=("W", "H"))
    view.add_argument("--fov", type=float, default=50.0, help="horizontal field of view, degrees (50)")
    view.add_argument("--passes", type=int, default=48, help="pictures blended for the blur (48)")
    _accommodation(view)
    _output(view, "view.png")

    eoc = _verb(verbs, "eoc", write_ellipses, "ellipses of confusion at chosen depths, as PNG, CSV or JSON")
    _lens_and_wearer(eoc)
    eoc.add_argument("--depths", type=distance, nargs="+", default=[270.0, 780.0, 3400.0], help="(27cm 78cm 340cm)")
    eoc.add_argument("-n", type=int, default=32, help="ellipses along each side (32)")
    eoc.add_argument("--voxels", type=int, nargs=3, metavar=("NX", "NY", "NZ"), help="write the blur field (.npz)")
    eoc.add_argument("--near", type=distance, default=200.0, help="nearest voxel plane (20cm)")
    eoc.add_argument("--far", type=distance, default=10000.0, help="farthest voxel plane (10m)")
    _accommodation(eoc)
    _output(eoc, "eoc.png")

    check = _verb(verbs, "check", check_file, "validate a lens, wearer or surface file and say what it holds")
    check.add_argument("file", type=Path)
    check.add_argument("--json", action="store_true")

    doctor = _verb(verbs, "doctor", print_doctor, "versions, graphics driver, threads")
    doctor.add_argument("--json", action="store_true")
    return top


def _verb(verbs: Any, name: str, run: Any, summary: str) -> argparse.ArgumentParser:
    verb: argparse.ArgumentParser = verbs.add_parser(name, help=summary, description=summary)
    verb.set_defaults(run=run)
    return verb


def _lens_and_wearer(verb: argparse.ArgumentParser) -> None:
    verb.add_argument("lens", type=Path, help="lens file (.toml)")
    verb.add_argument(
        "-w", "--wearer", type=Path, help="wearer file (.toml); assumed from the lens's order if not given"
    )


def _accommodation(verb: argparse.ArgumentParser) -> None:
    verb.add_argument("--accommodation", default="retina", help="rule: retina, object or paper; or dioptres")


def _output(verb: argparse.ArgumentParser, default: str) -> None:
    verb.add_argument("-o", "--output", type=Path, default=Path(default), metavar="FILE", help=f"({default})")
    verb.add_argument("--json", action="store_true", help="numbers to standard output instead of a file")


def distance(text: str) -> float:
    """A distance with its unit, in mm: 40cm, 0.4m, 400mm or inf."""
    if text.lower() in ("inf", "infinity"):
        return math.inf
    match = re.fullmatch(r"([0-9]*\.?[0-9]+)\s*(mm|cm|m)", text.strip())
    if match is None or float(match[1]) <= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is no distance; write it with its unit: 40cm, 0.4m, 400mm, or inf")
    return float(match[1]) * UNITS_IN_MM[match[2]]


def distance_or_scene(text: str) -> float | str:
    """A distance, or "scene" for whatever each ray meets in the built-in scene."""
    return "scene" if text == "scene" else distance(text)


def accommodation(text: str) -> float | str:
    """An accommodation rule's name, or dioptres."""
    from .optics.field import ACCOMMODATION_RULES

    if text in ACCOMMODATION_RULES:
        return text
    try:
        return float(text)
    except ValueError:
        raise InputError(
            f"--accommodation: {text!r} is none of {', '.join(ACCOMMODATION_RULES)}, nor a number"
        ) from None


def _load(args: argparse.Namespace) -> tuple["Lens", "Wearer"]:
    from .formats import load_lens, load_wearer
    from .workbench import assumed_wearer

    lens = load_lens(args.lens)
    return lens, load_wearer(args.wearer) if args.wearer else assumed_wearer(lens)


def _kind(path: Path, *allowed: str) -> str:
    if path.suffix.lower() not in allowed:
        raise InputError(
            f"{path}: cannot write {path.suffix or 'a file without extension'}; name one of {', '.join(allowed)}"
        )
    return path.suffix.lower()


def _print_written(path: Path) -> None:
    print(path)


def write_report(args: argparse.Namespace) -> None:
    """lensbench report LENS."""
    from .report.build import DEFAULT_DISTANCES, build_report
    from .report.progress import Progress

    folder = args.output or Path("reports") / args.lens.stem
    progress = Progress(sys.stderr)
    progress.step("load")
    lens, wearer = _load(args)
    build_report(lens, wearer, folder, tuple(args.object_distance or DEFAULT_DISTANCES), progress)
    progress.done()
    _print_written(folder / "index.html")


def write_map(args: argparse.Namespace) -> None:
    """lensbench map LENS."""
    from .layers import MapLayer, Request
    from .output import to_json, write_file
    from .scenes.builtin import load_scene
    from .workbench import run

    kind = _kind(args.output, ".png", ".svg", ".csv", ".json")
    lens, wearer = _load(args)
    scene = load_scene("room") if args.distance == "scene" else None
    layer = MapLayer(args.quantity, args.distance, accommodation(args.accommodation))
    result = run(Request(lens, wearer, layer, scene))
    if args.json or kind == ".json":
        text = to_json(
            {name: getattr(result, name) for name in ("quantity", "label", "unit", "x", "y", "values", "status")}
        )
        print(text) if args.json else write_file(args.output, text)
    elif kind == ".csv":
        from .report.tables import map_csv

        write_file(args.output, map_csv(result))
    else:
        _draw_map(args, lens, wearer, result)
    if not args.json:
        _print_written(args.output)


def _draw_map(args: argparse.Namespace, lens: "Lens", wearer: "Wearer", result: Any) -> None:
    from .report.tables import distance_text
    from .views.maps import map_figure, save_picture

    subtitle = distance_text(args.distance)
    if args.on_lens:
        from .views.lens3d import map_on_lens

        save_picture(map_on_lens(lens, wearer, result, subtitle=subtitle), args.output)
    else:
        save_picture(map_figure(lens, result, subtitle=subtitle), args.output)


def write_view(args: argparse.Namespace) -> None:
    """lensbench view LENS."""
    from .layers import Request, ViewLayer
    from .scenes.builtin import load_scene
    from .workbench import look, run

    _kind(args.output, ".png")
    if args.json:
        raise InputError("view: a picture has no numbers to print; leave out --json")
    lens, wearer = _load(args)
    gaze = tuple(map(math.radians, args.gaze)) if args.gaze else look(args.look, lens, wearer)
    if not 5 <= args.fov <= 120 or min(args.size) < 16 or max(args.size) > 8192 or not 1 <= args.passes <= 4096:
        raise InputError("view: --fov must be 5 to 120 degrees, --size 16 to 8192 pixels, --passes 1 to 4096")
    rule = accommodation(args.accommodation)
    layer = ViewLayer(args.eye, *gaze, math.radians(args.fov / 2), tuple(args.size), rule)
    seen = run(Request(lens, wearer, layer, load_scene("room")))
    from .views.jitter import render_view
    from .views.maps import save_picture

    save_picture(render_view(seen, args.passes), args.output)
    _print_written(args.output)


def write_ellipses(args: argparse.Namespace) -> None:
    """lensbench eoc LENS."""
    from .layers import EllipseLayer, Request
    from .output import to_json, write_file
    from .report.tables import ellipse_rows, ellipses_csv
    from .workbench import run

    lens, wearer = _load(args)
    rule = accommodation(args.accommodation)
    if args.voxels:
        _write_voxels(args, lens, wearer, rule)
        return
    kind = _kind(args.output, ".png", ".svg", ".csv", ".json")
    sheets = run(Request(lens, wearer, EllipseLayer(tuple(args.depths), args.n, accommodation=rule)))
    if args.json or kind == ".json":
        text = to_json(ellipse_rows(sheets))
        print(text) if args.json else write_file(args.output, text)
    elif kind == ".csv":
        write_file(args.output, ellipses_csv(sheets))
    else:
        from .views.ellipses import ellipse_figure
        from .views.maps import save_picture

        save_picture(ellipse_figure(lens, wearer, sheets), args.output)
    if not args.json:
        _print_written(args.output)


def _write_voxels(args: argparse.Namespace, lens: "Lens", wearer: "Wearer", rule: float | str) -> None:
    import io

    import numpy as np

    from .layers import Request, VoxelLayer
    from .output import write_file
    from .workbench import run

    path = args.output if args.output != Path("eoc.png") else Path("blur_field.npz")
    _kind(path, ".npz")
    voxels = run(Request(lens, wearer, VoxelLayer(*args.voxels, args.near, args.far, accommodation=rule)))
    buffer = io.BytesIO()
    np.savez_compressed(buffer, blur=voxels.blur, u=voxels.u, v=voxels.v, depth=voxels.depth, status=voxels.status)
    write_file(path, buffer.getvalue())
    _print_written(path)


def check_file(args: argparse.Namespace) -> None:
    """lensbench check FILE."""
    from .formats import load
    from .output import to_json
    from .report.facts import file_facts

    facts = file_facts(load(args.file))
    if args.json:
        print(to_json({fact.label: fact.value for fact in facts}))
    else:
        width = max(len(fact.label) for fact in facts)
        print("\n".join(f"{fact.label:<{width}}  {fact.text}" for fact in facts))


def print_doctor(args: argparse.Namespace) -> None:
    """lensbench doctor."""
    from .doctor import examine
    from .output import to_json

    found = examine()
    if args.json:
        print(to_json(found))
    else:
        print("\n".join(f"{name:<22} {value}" for name, value in found.items()))
