"""Text of files as programs of all ages write it: UTF-8 and UTF-16 with or without byte order mark, else Latin-1."""

import codecs
import math
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats

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
    return text


def decoded(data: bytes) -> str | None:
    """The text of bytes, its line ends made \\n, or None where they are no text: control characters, odd UTF-16."""
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
    text = text.rstrip("\x1a\0").replace("\r\n", "\n").replace("\r", "\n")
    return None if "\ufffd" in text or any(chr(code) in text for code in _NO_TEXT) else text


MOST_SAG = 1000.0
MOST_SIDE = 4000
MOST_POINTS = 4_000_000
UNKNOWN = ("?", "")


def number(place: str, text: str) -> float:
    """The finite number that a field holds. Raises InputError naming the place."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isfinite(value) and "_" not in text:
        return value
    raise InputError(f"{place}: {shown(text)} is not a number{_hint(text)}")


def whole(place: str, text: str, least: int, most: int) -> int:
    """The whole number from least to most that a field holds. Raises InputError naming the place."""
    value = number(place, text)
    if value != int(value) or not least <= value <= most:
        raise InputError(f"{place}: {shown(text)} is not a whole number from {least} to {most}")
    return int(value)


def sags(place: str, fields: Sequence[str], first: int = 1) -> Floats:
    """Sags of a line in mm; NaN where a field is empty or "?". Raises InputError naming the place and the value's number."""
    try:
        values = np.array(fields, dtype=float)
        plain = bool(np.all(np.abs(values) <= MOST_SAG)) and not any("_" in f for f in fields)
    except ValueError:
        plain = False
    return values if plain else np.array([_sag(f"{place}, value {k}", f) for k, f in enumerate(fields, start=first)])


def _sag(place: str, text: str) -> float:
    if text.strip() in UNKNOWN:
        return math.nan
    value = number(place, text.strip())
    if abs(value) > MOST_SAG:
        raise InputError(f"{place}: {shown(text)} is not a sag in mm")
    return value


def digit_of(fields: Sequence[str], sample: int = 400) -> float:
    """The step of the last digit written, over a sample of the fields: 1e-6 for six decimals."""
    taken = fields[:: max(1, len(fields) // sample)]
    return float(10.0 ** -max((_decimals(f) for f in taken), default=0))


def _decimals(text: str) -> int:
    mantissa, _, exponent = text.strip().lower().partition("e")
    shift = int(exponent) if exponent.lstrip("+-").isdecimal() and len(exponent) < 6 else 0
    return min(max(0, len(mantissa.partition(".")[2]) - shift), 20)


def shown(text: str) -> str:
    """A field as a message shows it: quoted, not longer than 24 characters."""
    text = text.strip()
    return repr(text if len(text) <= 24 else text[:21] + "...")


def _hint(text: str) -> str:
    if text.count(",") == 1 and text.replace(",", "").replace("-", "").isdigit():
        return "; write a decimal point, not a comma"
    return (
        "; a missing value is written ?" if text.strip().lower() in ("nan", "inf", "-inf", "none", "null", "na") else ""
    )


def side_in_name(path: Path) -> str:
    """The side that a file's name says at its start or end: R_job.xyz, jobL.txt, lens_R.hmf, right.csv; "" if it says none."""
    stem = path.stem
    found = re.search(r"(?:^|[_\-. ])(R|L|right|left)$|^(R|L|right|left)[_\-. ]", stem, re.IGNORECASE)
    found = found or re.fullmatch(r"(R|L)?\d+(R|L)?", stem)
    word = next((g for g in found.groups() if g), "") if found else ""
    return word[:1].upper()
