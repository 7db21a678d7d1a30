"""Text of files as programs of all ages write it: UTF-8 and UTF-16 with or without byte order mark, else Latin-1."""

import codecs
from pathlib import Path

from ..errors import InputError

_MARKS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))
_NO_TEXT = frozenset(range(32)) - frozenset(b"\t\n\v\f\r\x1a")


def read_bytes(path: Path, most: int = -1) -> bytes:
    """The first bytes of a file, or all of them. Raises InputError."""
    try:
        with path.open("rb") as file:
            return file.read(most)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None


def read_text(path: Path) -> str:
    """The text of a file, its line ends made \\n. Raises InputError where the file is no text."""
    data = read_bytes(path)
    text = decoded(data)
    if text is None:
        byte = next((k for k, b in enumerate(data) if b in _NO_TEXT), 0)
        raise InputError(f"{path}: byte {byte + 1} is not text (UTF-8, UTF-16 or Latin-1)")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def decoded(data: bytes) -> str | None:
    """The text of bytes, or None where they are no text: control characters, odd UTF-16."""
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return _plain(data[len(mark) :].decode(encoding, errors="replace"))
    if len(data) >= 2 and 0 in data[:64]:
        return _plain(data.decode("utf-16-le" if data[1] == 0 else "utf-16-be", errors="replace"))
    try:
        return _plain(data.decode("utf-8"))
    except UnicodeDecodeError as error:
        cut_off = error.end == len(data) and error.reason == "unexpected end of data"
        return _plain(data.decode("utf-8", errors="ignore") if cut_off else data.decode("latin-1"))


def _plain(text: str) -> str | None:
    """The text without a closing Ctrl-Z; None if it holds characters that no text has."""
    text = text.rstrip("\x1a\0")
    return None if "\ufffd" in text or any(chr(code) in text for code in _NO_TEXT) else text
