"""The command line: verbs parse, call and print. Exit codes: 0 ok, 2 bad usage or bad input, 1 failure."""

import argparse
import sys
from collections.abc import Sequence

from .. import __version__
from ..errors import LensBenchError
from . import conoid, files, gallery, gui, machine, maps, pair, report, verify, view


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
    for group in (gui, report, maps, conoid, pair, view, gallery, files, verify, machine):
        group.add_verbs(verbs)
    return top
