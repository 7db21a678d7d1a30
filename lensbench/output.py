"""Files are written under a temporary name and renamed, so that nothing is ever half-written."""

import json
import math
import os
import tempfile
from pathlib import Path
from typing import Any

from .errors import InputError

UMASK = os.umask(0o077)
os.umask(UMASK)


def require_folder(folder: Path) -> None:
    """Raise InputError now if files could not be written into the folder later."""
    there = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not there.is_dir() or not os.access(there, os.W_OK):
        raise InputError(f"{folder}: cannot be written: {there} is not a folder that you may write to")


def write_file(path: Path, content: bytes | str) -> None:
    """Write the file whole or not at all. Raises InputError when its folder cannot be written."""
    data = content.encode() if isinstance(content, str) else content
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(name, 0o666 & ~UMASK)
        os.replace(name, path)
    except BaseException as error:
        os.unlink(name)
        if isinstance(error, OSError):
            raise InputError(f"{path}: cannot be written: {error.strerror}") from None
        raise


def to_json(value: Any, ascii_only: bool = False) -> str:
    """JSON text of dataclasses' dicts, arrays and numbers: 7 significant digits, null for NaN, "inf" for infinity."""
    return json.dumps(_plain(value), ensure_ascii=ascii_only, allow_nan=False)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, float):
        if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        return None if math.isnan(value) else float(f"{value:.7g}")
    return value
