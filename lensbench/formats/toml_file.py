"""TOML files checked by pydantic models, with one clear sentence for the first thing that is wrong."""

import difflib
import tomllib
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ..errors import InputError
from .text import read_text


class Table(BaseModel):
    """A TOML table: finite numbers only (no text or truth value for one), and no key that it does not know."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        for key in data if isinstance(data, dict) else ():
            if key not in cls.model_fields:
                near = difflib.get_close_matches(key, cls.model_fields, n=1, cutoff=0.5)
                hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(cls.model_fields)}"
                raise ValueError(f"unknown key {key!r}; {hint}")
        return data


Pair = Annotated[tuple[float, float], Field(strict=False)]
T = TypeVar("T", bound=Table)


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a TOML file. Raises InputError with the line of a syntax error."""
    try:
        return tomllib.loads(read_text(path))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}") from None


def validated(path: Path, data: dict[str, Any], model: type[T]) -> T:
    """The file's tables as a model; the first error becomes an InputError that names file and key."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(_place(first["loc"], data, first["type"] == "missing"))
        more = f" (and {error.error_count() - 1} more)" if error.error_count() > 1 else ""
        raise InputError(f"{path}: {where + ': ' if where else ''}{_sentence(first)}{more}") from None


def _place(loc: tuple[str | int, ...], data: Any, missing: bool) -> list[str]:
    """The keys that lead to an error; pydantic's names of variants, which are no keys of the file, are left out."""
    kept = []
    for part in loc:
        if isinstance(data, dict) and part not in data and not (missing and part == loc[-1]):
            continue
        kept.append(str(part))
        data = data.get(part) if isinstance(data, dict) else data[part] if isinstance(part, int) else None
    return kept


def _sentence(error: Any) -> str:
    kind, message = error["type"], str(error["msg"]).removeprefix("Value error, ")
    if kind == "missing":
        return "this key is missing"
    if kind == "value_error":
        return message
    if kind == "union_tag_not_found":
        near = difflib.get_close_matches("type", error["input"], n=1) if isinstance(error["input"], dict) else []
        return f"the key 'type' is missing{f'; is {near[0]!r} meant for it?' if near else ''}"
    if kind == "union_tag_invalid":
        return f"type: {error['ctx']['tag']!r} is not known; there are {error['ctx']['expected_tags']}"
    if kind in ("model_type", "model_attributes_type"):
        message = "must be a table"
    shown = repr(error["input"])
    return f"{message[0].lower()}{message[1:]}, not {shown if len(shown) <= 40 else shown[:37] + '...'}"
