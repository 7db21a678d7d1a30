"""The command line: verbs parse, call and print. Exit codes: 0 ok, 2 bad usage or bad input, 1 failure."""

import argparse
import math
import re
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import __version__
from .errors import InputError, LensBenchError

if TYPE_CHECKING:
    from .optics.eye import Wearer
    from .optics.lens import Lens
    from .scenes.scene import Scene

UNITS_IN_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(encoding="utf-8")
    try:
        args = parser().parse_args(arguments)
        args.run(args)
    except ModuleNotFoundError as error:
        if str(error.name).startswith("lensbench"):
            raise
        print(f'lensbench: {error.name} is not installed: pip install "lensbench[report]"', file=sys.stderr)
        return 1
    except LensBenchError as error:
        print(f"lensbench: {error}", file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:
        return 1
    except KeyboardInterrupt:
        print("lensbench: stopped", file=sys.stderr)
        return 130
    return 0


def parser() -> argparse.ArgumentParser:
    """All verbs and their options."""
    top = argparse.ArgumentParser(prog="lensbench", description="What a spectacle lens does, and what its wearer sees.")
    top.add_argument("--version", action="version", version=f"lensbench {__version__}")
    verbs = top.add_subparsers(required=True, metavar="COMMAND")
    for add in (_add_report, _add_map, _add_view, _add_eoc, _add_voxels, _add_check, _add_doctor):
        add(verbs)
    return top


def _add_report(verbs: Any) -> None:
    verb = _verb(verbs, "report", write_report, "write a full report of a lens: index.html, PNGs, results.json")
    _lens_and_wearer(verb)
    verb.add_argument(
        "--object-distance", type=distance, nargs="+", metavar="D", help="for the defocus maps (inf 78cm 40cm)"
    )
    verb.add_argument("-o", "--output", type=Path, default=None, metavar="DIR", help="folder (reports/<lens file>)")


def _add_map(verbs: Any) -> None:
    verb = _verb(verbs, "map", write_map, "one map over the lens as PNG, SVG, CSV or JSON")
    _lens_and_wearer(verb)
    verb.add_argument("-q", "--quantity", default="mean_power", help="mean_power, astigmatism, defocus, prism, ...")
    verb.add_argument("-d", "--distance", type=distance_or_scene, default=math.inf, help="40cm, 6m, inf or scene")
    verb.add_argument("--on-lens", action="store_true", help="on the lens in three dimensions (PNG)")
    _accommodation(verb)
    _output(verb, "map.png")


def _add_view(verbs: Any) -> None:
    verb = _verb(verbs, "view", write_view, "what the wearer sees of the built-in scene, as PNG")
    _lens_and_wearer(verb)
    verb.add_argument(
        "--look", choices=["far", "intermediate", "near"], default="far", help="gaze at the picture's centre"
    )
    verb.add_argument("--gaze", type=gaze_angle, nargs=2, metavar=("AZ", "EL"), help="the same in degrees, left and up")
    verb.add_argument("--eye", choices=["lens", "naked", "pinhole"], default="lens")
    verb.add_argument("--size", type=int, nargs=2, default=(960, 720), metavar=("W", "H"))
    verb.add_argument("--fov", type=float, default=50.0, help="horizontal field of view, degrees (50)")
    verb.add_argument("--passes", type=count, default=48, help="pictures blended for the blur (48)")
    _accommodation(verb)
    verb.add_argument("-o", "--output", type=Path, default=Path("view.png"), metavar="FILE", help="(view.png)")


def _add_eoc(verbs: Any) -> None:
    verb = _verb(verbs, "eoc", write_ellipses, "ellipses of confusion at chosen depths, as PNG, SVG, CSV or JSON")
    _lens_and_wearer(verb)
    verb.add_argument("--depths", type=depth, nargs="+", default=[270.0, 780.0, 3400.0], help="(27cm 78cm 340cm)")
    verb.add_argument("-n", type=count, default=32, help="ellipses along each side (32)")
    _accommodation(verb)
    _output(verb, "eoc.png")


def _add_voxels(verbs: Any) -> None:
    verb = _verb(verbs, "voxels", write_voxels, "the blur field of a view frustum, a matrix a voxel, as .npz")
    _lens_and_wearer(verb)
    verb.add_argument("-n", type=count, nargs=3, default=[64, 64, 64], metavar=("NX", "NY", "NZ"), help="(64 64 64)")
    verb.add_argument("--near", type=depth, default=200.0, help="nearest plane (20cm)")
    verb.add_argument("--far", type=depth, default=10000.0, help="farthest plane (10m)")
    _accommodation(verb)
    verb.add_argument(
        "-o", "--output", type=Path, default=Path("blur_field.npz"), metavar="FILE", help="(blur_field.npz)"
    )


def _add_check(verbs: Any) -> None:
    verb = _verb(verbs, "check", check_file, "validate a lens, wearer or surface file and say what it holds")
    verb.add_argument("file", type=Path)
    verb.add_argument("--json", action="store_true")


def _add_doctor(verbs: Any) -> None:
    verb = _verb(verbs, "doctor", print_doctor, "versions, graphics driver, threads")
    verb.add_argument("--json", action="store_true")


def _verb(verbs: Any, name: str, run: Any, summary: str) -> argparse.ArgumentParser:
    verb: argparse.ArgumentParser = verbs.add_parser(name, help=summary, description=summary, allow_abbrev=False)
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
    if match is None:
        raise argparse.ArgumentTypeError(f"{text!r} is no distance; write it with its unit: 40cm, 0.4m, 400mm, or inf")
    value = float(match[1]) * UNITS_IN_MM[match[2]]
    if not 10 <= value <= 1e9:
        raise argparse.ArgumentTypeError(f"{text!r} is no object distance; it must be 1cm to 1000km, or inf")
    return value


def depth(text: str) -> float:
    """A finite distance with its unit, in mm."""
    value = distance(text)
    if math.isinf(value):
        raise argparse.ArgumentTypeError("a depth must be finite: 27cm, 6m")
    return value


def count(text: str) -> int:
    """A whole number from 1 to 512."""
    if not text.isdecimal() or not 1 <= int(text) <= 512:
        raise argparse.ArgumentTypeError(f"{text!r} is no count; write a whole number from 1 to 512")
    return int(text)


def gaze_angle(text: str) -> float:
    """An angle of gaze in degrees, within 80 of straight ahead."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= 80:
        raise argparse.ArgumentTypeError(f"{text!r} is no angle of gaze; write degrees from -80 to 80")
    return value


def distance_or_scene(text: str) -> float | str:
    """A distance, or "scene" for whatever each ray meets in the built-in scene."""
    return "scene" if text == "scene" else distance(text)


def accommodation(text: str) -> float | str:
    """An accommodation rule's name, or dioptres."""
    from .optics.field import ACCOMMODATION_RULES

    if text in ACCOMMODATION_RULES:
        return text
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 <= value <= 20:
        raise InputError(f"--accommodation: {text!r} is none of {', '.join(ACCOMMODATION_RULES)}, nor 0 to 20 dioptres")
    return value


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


def _write(path: Path, content: str | bytes) -> None:
    from .output import write_file

    write_file(path, content)
    print(path)


def _write_picture(path: Path, picture: Any) -> None:
    from .views.maps import save_picture

    save_picture(picture, path)
    print(path)


def _deliver(
    args: argparse.Namespace, kind: str, numbers: Any, table: Callable[[], str], picture: Callable[[], Any]
) -> None:
    """Print the numbers as JSON if asked to; else write the file in the kind that its name says."""
    from .output import to_json

    if args.json:
        print(to_json(numbers))
    elif kind == ".json":
        _write(args.output, to_json(numbers))
    elif kind == ".csv":
        _write(args.output, table())
    else:
        _write_picture(args.output, picture())


def _room() -> "Scene":
    from .scenes.builtin import load_scene

    return load_scene("room")


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
    print(folder / "index.html")


def write_map(args: argparse.Namespace) -> None:
    """lensbench map LENS."""
    from .layers import MapLayer, Request
    from .report.tables import map_csv, map_numbers
    from .workbench import run

    kind = _kind(args.output, *([".png"] if args.on_lens else [".png", ".svg", ".csv", ".json"]))
    lens, wearer = _load(args)
    scene = _room() if args.distance == "scene" else None
    layer = MapLayer(args.quantity, args.distance, accommodation(args.accommodation))
    result = run(Request(lens, wearer, layer, scene))
    picture = partial(_map_picture, args, lens, wearer, result)
    _deliver(args, kind, map_numbers(result), partial(map_csv, result), picture)


def _map_picture(args: argparse.Namespace, lens: "Lens", wearer: "Wearer", result: Any) -> Any:
    from .report.tables import distance_text

    subtitle = distance_text(args.distance)
    if args.on_lens:
        from .views.lens3d import map_on_lens

        return map_on_lens(lens, wearer, result, subtitle=subtitle)
    from .views.maps import map_figure

    return map_figure(lens, result, subtitle=subtitle)


def write_view(args: argparse.Namespace) -> None:
    """lensbench view LENS."""
    from .layers import Request, ViewLayer
    from .views.jitter import render_view
    from .workbench import look, run

    _kind(args.output, ".png")
    if not 5 <= args.fov <= 120 or min(args.size) < 16 or max(args.size) > 8192:
        raise InputError("view: --fov must be 5 to 120 degrees, --size 16 to 8192 pixels")
    lens, wearer = _load(args)
    gaze = tuple(map(math.radians, args.gaze)) if args.gaze else look(args.look, lens, wearer)
    rule = accommodation(args.accommodation)
    layer = ViewLayer(args.eye, *gaze, math.radians(args.fov / 2), tuple(args.size), rule)
    seen = run(Request(lens, wearer, layer, _room()))
    _write_picture(args.output, render_view(seen, args.passes))


def write_ellipses(args: argparse.Namespace) -> None:
    """lensbench eoc LENS."""
    from .layers import EllipseLayer, Request
    from .report.tables import ellipse_rows, ellipses_csv
    from .workbench import run

    kind = _kind(args.output, ".png", ".svg", ".csv", ".json")
    lens, wearer = _load(args)
    layer = EllipseLayer(tuple(args.depths), args.n, accommodation=accommodation(args.accommodation))
    sheets = run(Request(lens, wearer, layer))
    picture = partial(_ellipse_picture, lens, wearer, sheets)
    _deliver(args, kind, ellipse_rows(sheets), partial(ellipses_csv, sheets), picture)


def _ellipse_picture(lens: "Lens", wearer: "Wearer", sheets: Any) -> Any:
    from .views.ellipses import ellipse_figure

    return ellipse_figure(lens, wearer, sheets)


def write_voxels(args: argparse.Namespace) -> None:
    """lensbench voxels LENS."""
    from .layers import Request, VoxelLayer
    from .report.tables import voxels_npz
    from .workbench import run

    _kind(args.output, ".npz")
    lens, wearer = _load(args)
    layer = VoxelLayer(*args.n, args.near, args.far, accommodation=accommodation(args.accommodation))
    _write(args.output, voxels_npz(run(Request(lens, wearer, layer))))


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
