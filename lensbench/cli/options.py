"""What several verbs share: values with units, options, loading a case, writing an answer."""

import argparse
import math
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError

if TYPE_CHECKING:
    from ..formats.lone_surface import Completion
    from ..formats.surface_data import Reading
    from ..optics.eye import Wearer
    from ..optics.lens import Lens
    from ..scenes.scene import Scene
    from ..session import Workbench

UNITS_IN_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
OF_LENS_FILES = (
    "side", "material", "index", "thickness", "front_radius", "back_radius", "diameter", "power",
    "face", "orientation", "z_towards", "flip_z",
)  # fmt: skip

# ---- options ----


def add_verb(verbs: Any, name: str, run: Any, summary: str) -> argparse.ArgumentParser:
    """A verb with its function."""
    verb: argparse.ArgumentParser = verbs.add_parser(name, help=summary, description=summary, allow_abbrev=False)
    verb.set_defaults(run=run)
    return verb


def lens_and_wearer(verb: argparse.ArgumentParser) -> None:
    """The lens file and the wearer file."""
    verb.add_argument("lens", type=Path, help="lens file, or a session (.lensbench.json)")
    lens_choice(verb)
    verb.add_argument(
        "-w", "--wearer", type=Path, help="wearer file (.toml); assumed from the lens's order if not given"
    )
    unsaid(verb)


def lens_choice(verb: argparse.ArgumentParser) -> None:
    """--side, --material and all else that a lens file may leave open."""
    verb.add_argument(
        "--side", choices=["R", "L"], default="", help="which lens of a pair; of files that say none: right"
    )
    verb.add_argument("--material", default="", metavar="NAME", help="by name, or n_d/V_d (Abbe number): 1.592/41")
    group = verb.add_argument_group("files that hold surfaces only")
    for name, what in (
        ("thickness", "at the centre, mm"),
        ("front-radius", "of the other surface, mm; inf: a plane"),
        ("back-radius", "of the other surface, mm; inf: a plane"),
        ("diameter", "mm"),
        ("power", "distance power for which the other surface is chosen, D (0)"),
    ):
        group.add_argument(f"--{name}", type=float, metavar="X", help=what)
    group.add_argument("--index", type=float, help="refractive index, instead of --material")
    orientation_options(group)


def orientation_options(verb: Any) -> None:
    """--face, --orientation, --z-towards, --flip-z: how the points of a file lie, where that is not to be found from them."""
    verb.add_argument("--face", choices=["front", "back"], help="which face the surface is (front)")
    verb.add_argument(
        "--orientation",
        metavar="CORNER-WAY",
        help="first point, seen from the front, and how its row runs: top-left-rows, bottom-right-columns, ...",
    )
    verb.add_argument("--z-towards", choices=["eye", "scene"], help="the side to which z counts positive")
    verb.add_argument("--flip-z", action="store_true", help="turn the sign of z")


def unsaid(verb: argparse.ArgumentParser, **values: Any) -> None:
    """What options that are not given mean where no session says it: their values, by name."""
    verb.set_defaults(unsaid={**(verb.get_default("unsaid") or {}), **values})


def accommodation_option(verb: argparse.ArgumentParser) -> None:
    """--accommodation."""
    verb.add_argument("--accommodation", help="rule: retina, object or paper; or dioptres (retina)")
    unsaid(verb, accommodation="retina")


def scene_options(verb: argparse.ArgumentParser, default: str | None = "room") -> None:
    """--scene and where the wearer stands in a mesh."""
    what = "a built-in scene, a scene file (.toml), or a mesh (.glb, .gltf, .obj, .ply, .stl)"
    verb.add_argument("--scene", metavar="NAME|FILE", help=what + (f" ({default})" if default else ""))
    unsaid(verb, scene=default)
    verb.add_argument("--scene-unit", choices=["mm", "cm", "m", "in", "ft"], help="of a mesh (glTF: m)")
    for name, what in (("eye", "place of the eye"), ("ahead", "direction of the face"), ("up", "direction (0 1 0)")):
        verb.add_argument(f"--scene-{name}", type=float, nargs=3, metavar=("X", "Y", "Z"), help=f"{what}, in the mesh")


def measure_option(verb: argparse.ArgumentParser) -> None:
    """--measure."""
    verb.add_argument(
        "--measure",
        choices=["defocus", "ellipse_diagonal"],
        help="of the defocus map: rms diameter of the blur that the eye receives (the default), or 2|eps| as in the paper",
    )


def progress_option(verb: argparse.ArgumentParser) -> None:
    """--progress."""
    verb.add_argument(
        "--progress", action="store_true", help="a line a step on standard error, for programs that watch"
    )


def output_option(verb: argparse.ArgumentParser, default: str) -> None:
    """-o and --json."""
    verb.add_argument("-o", "--output", type=Path, default=Path(default), metavar="FILE", help=f"({default})")
    verb.add_argument("--json", action="store_true", help="numbers to standard output instead of a file")


# ---- values ----


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


def field_of_view(text: str) -> float:
    """A full angle in degrees, from 1 to 150; half of it in rad."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 1 <= value <= 150:
        raise argparse.ArgumentTypeError(f"{text!r} is no field of view; write degrees from 1 to 150")
    return math.radians(value / 2)


def factor(text: str) -> float:
    """A factor from 0.01 to 10000."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.01 <= value <= 10000:
        raise argparse.ArgumentTypeError(f"{text!r} is no factor; write a number from 0.01 to 10000")
    return value


def distance_or_name(text: str) -> float | str:
    """A distance, "scene" for whatever each ray meets in the scene, or "model" for the wearer's own distances."""
    return text if text in ("scene", "model") else distance(text)


def accommodation(text: str) -> float | str:
    """An accommodation rule's name, or dioptres."""
    from ..optics.field import ACCOMMODATION_RULES

    if text in ACCOMMODATION_RULES:
        return text
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 <= value <= 20:
        raise InputError(f"--accommodation: {text!r} is none of {', '.join(ACCOMMODATION_RULES)}, nor 0 to 20 dioptres")
    return value


# ---- loading and writing ----


def scene_of(args: argparse.Namespace) -> "Scene":
    """The scene that --scene names."""
    from ..formats.scene_file import find_scene

    place = {name: getattr(args, f"scene_{name}") for name in ("eye", "ahead", "up")}
    given = {name: None if value is None else (*value,) for name, value in place.items()}
    return find_scene(args.scene or args.unsaid["scene"], args.scene_unit, **given)


def load_case(args: argparse.Namespace) -> tuple["Lens", "Wearer"]:
    """The lens and its wearer; of a session the active ones, and what the session says is taken for the options not given."""
    bench = _session(args, args.lens) if is_session(args.lens) else None
    for name, value in args.unsaid.items():
        if getattr(args, name) is None:
            setattr(args, name, value if bench is None else _said_by(bench).get(name, value))
    if bench is None:
        return load_cases(args, args.lens)[0]
    return _case(args, bench, bench.lenses[bench.lens].lens)


def say_misfit(lens: "Lens", wearer: "Wearer") -> None:
    """Say on standard error that the lens was ordered for another wearer, where it was."""
    from ..report.facts import misfit

    if doubt := misfit(lens, wearer):
        print(f"lensbench: {doubt}", file=sys.stderr)


def is_session(path: Path) -> bool:
    """Whether a file is a session, by its name."""
    return path.name.endswith(".lensbench.json")


def _session(args: argparse.Namespace, path: Path) -> "Workbench":
    """What a session holds. Raises InputError without a lens, and for options that complete lens files."""
    from ..session import load_session

    given = [name for name in OF_LENS_FILES if getattr(args, name) not in (None, "", False)]
    if given:
        names = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise InputError(
            f"{path}: {names} of a session's lens is what the session says; edit it there, or name the lens file"
        )
    bench, _ = load_session(path)
    if not bench.lenses:
        raise InputError(f"{path}: the session holds no lens")
    return bench


def _said_by(bench: "Workbench") -> dict[str, Any]:
    """What a session says in place of options, by their names."""
    return {
        "distance": bench.distance,
        "depth": math.inf if isinstance(bench.distance, str) else bench.distance,
        "depths": bench.depths,
        "accommodation": bench.accommodation,
        "scene": bench.scene,
        "head": (bench.head_turn, bench.head_tilt),
    }


def _case(args: argparse.Namespace, bench: "Workbench", lens: "Lens") -> tuple["Lens", "Wearer"]:
    from ..formats import load_wearer

    return lens, load_wearer(args.wearer, lens.side) if args.wearer else bench.worn_by(lens)


def load_cases(args: argparse.Namespace, path: Path) -> list[tuple["Lens", "Wearer"]]:
    """The lens in a file, or all lenses of a session, each with its wearer: of --wearer, else of the file, else assumed. What
    was assumed of a file that holds surfaces only is said on standard error.
    """
    from ..formats import load_pair, load_wearer
    from ..workbench import assumed_wearer

    if is_session(path):
        bench = _session(args, path)
        return [_case(args, bench, entry.lens) for entry in bench.lenses]
    pair = load_pair(path, args.side, args.material, completion(args))
    lens, told = pair[0]
    if lens.note:
        other = f" (the file also holds side {pair[1][0].side})" if len(pair) > 1 else ""
        print(f"lensbench: {lens.note}{other}", file=sys.stderr)
    if args.wearer:
        return [(lens, load_wearer(args.wearer, lens.side))]
    return [(lens, told or assumed_wearer(lens))]


def completion(args: argparse.Namespace) -> "Completion":
    """What the options tell of a lens beside its surface file. Raises InputError."""
    from ..formats.lone_surface import Completion
    from ..optics.materials import Material

    for name, least, most in (
        ("thickness", 0.1, 50.0),
        ("diameter", 5.0, 150.0),
        ("power", -40.0, 40.0),
        ("index", 1.2, 2.5),
    ):
        value = getattr(args, name)
        if value is not None and not least <= value <= most:
            raise InputError(f"--{name}: {value:g} is not from {least:g} to {most:g}")
    for name in ("front_radius", "back_radius"):
        value = getattr(args, name)
        if value is not None and not abs(value) >= 5:
            raise InputError(
                f"--{name.replace('_', '-')}: {value:g} mm is no radius of a lens; it is 5 or more, or inf"
            )
    if args.index and args.material:
        raise InputError("--index and --material both give the index: say one of them")
    material = Material(f"n = {args.index:g}", args.index, args.index, 40.0, 1.3) if args.index else None
    radii = args.front_radius, args.back_radius
    return Completion(reading(args), material, args.thickness, *radii, args.diameter, args.power or 0.0)


def reading(args: argparse.Namespace) -> "Reading":
    """How the options say that points lie. Raises InputError."""
    from ..formats.orientation import named
    from ..formats.surface_data import Reading

    order = named(args.orientation) if args.orientation else None
    face = {"front": "F", "back": "B", None: ""}[args.face]
    return Reading(
        face=face,
        first_point=order and order.first_point,
        rows=order and order.rows,
        z_towards=args.z_towards,
        flip_z=args.flip_z,
    )


def kind_of(path: Path, *allowed: str) -> str:
    """The extension of an output file, in lower case. Raises InputError when it is not allowed."""
    if path.suffix.lower() not in allowed:
        raise InputError(
            f"{path}: cannot write {path.suffix or 'a file without extension'}; name one of {', '.join(allowed)}"
        )
    return path.suffix.lower()


def write(path: Path, content: str | bytes) -> None:
    """Write a file and say its name."""
    from ..output import write_file

    write_file(path, content)
    print(path)


def write_picture(path: Path, picture: Any) -> None:
    """Write a picture and say its name."""
    from ..views.maps import save_picture

    save_picture(picture, path)
    print(path)


def deliver(
    args: argparse.Namespace, kind: str, numbers: Any, table: Callable[[], str], picture: Callable[[], Any]
) -> None:
    """Print the numbers as JSON if asked to; else write the file in the kind that its name says."""
    from ..output import to_json

    if args.json:
        print(to_json(numbers))
    elif kind == ".json":
        write(args.output, to_json(numbers))
    elif kind == ".csv":
        write(args.output, table())
    else:
        write_picture(args.output, picture())
