"""lensbench gui: the window."""

import argparse
from pathlib import Path
from typing import Any

from ..errors import InputError, LensBenchError
from .options import add_verb


def add_verbs(verbs: Any) -> None:
    """Add this group's verbs."""
    verb = add_verb(verbs, "gui", open_window, "the workbench in a window")
    verb.add_argument(
        "files", type=Path, nargs="*", metavar="FILE", help="lenses, wearers, scenes, a session (.lensbench.json)"
    )


def open_window(args: argparse.Namespace) -> None:
    """lensbench gui [FILES...]."""
    for path in args.files:
        if not path.exists():
            raise InputError(f"{path}: no such file")
    try:
        from ..gui.app import start
    except ModuleNotFoundError as error:
        raise LensBenchError(f'{error.name} is not installed: pip install "lensbench[gui]"') from None
    if start(args.files):
        raise LensBenchError("the window ended with an error")
