"""Tables of tolerances: format "lensbench-tolerances/1", those of the package and the user's own. D and degrees."""

from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field, field_validator

from ..errors import InputError
from ..optics.tolerances import Limits, Step, Tolerances
from .toml_file import Table, read_toml, validated

FOLDER = Path(__file__).parent / "tolerances"
DEFAULT = "ANSI Z80.1-2015"


class StepTable(Table):
    """Up to this size (D) of what is judged, and up to this power (D) of the lens: tolerance, and a share of the size."""

    up_to: float = Field(np.inf, gt=0)
    power_up_to: float = Field(np.inf, gt=0)
    tolerance: float = Field(0.0, ge=0, le=180)
    share: float = Field(0.0, ge=0, le=1)


class LimitsTable(Table):
    """Tolerances of one kind of lens: steps; prism in cm/m, or what a decentration in mm makes."""

    power: list[StepTable] = Field(min_length=1)
    cylinder: list[StepTable] = Field(min_length=1)
    axis: list[StepTable] = Field(min_length=1)
    addition: list[StepTable] = Field(min_length=1)
    prism: float = Field(ge=0, le=20)
    decentration: float = Field(0.0, ge=0, le=20)

    @field_validator("power", "cylinder", "axis", "addition")
    @classmethod
    def _covers_all(cls, steps: list[StepTable]) -> list[StepTable]:
        if steps[-1].up_to < np.inf or steps[-1].power_up_to < np.inf:
            raise ValueError("the last step must hold for all that is beyond: leave out its up_to and power_up_to")
        if any(not (step.tolerance or step.share) for step in steps):
            raise ValueError("each step needs a tolerance, or a share of the size")
        return steps

    def build(self) -> Limits:
        """The limits."""
        names = ("power", "cylinder", "axis", "addition")
        steps = {name: tuple(Step(**step.model_dump()) for step in getattr(self, name)) for name in names}
        return Limits(**steps, prism=self.prism, decentration=self.decentration)


class TolerancesTable(Table):
    """The whole file."""

    format: Literal["lensbench-tolerances/1"]
    edition: str = Field(min_length=1)
    source: str = Field(min_length=1)
    power: Literal["sphere", "highest meridian"]
    axis_from: float = Field(0.0, ge=0)
    single_vision: LimitsTable
    progressive: LimitsTable


def load_tolerances(named: str | Path = DEFAULT) -> Tolerances:
    """The table of an edition that the package holds, by its name, or of a file (.toml). Raises InputError."""
    for table in _built_in():
        if str(named).strip().lower() == table.edition.lower():
            return table
    path = Path(named)
    if path.suffix.lower() != ".toml":
        known = ", ".join(table.edition for table in _built_in())
        raise InputError(f"tolerances: {str(named)!r} is not known; there are {known}, or name a .toml file")
    return _read(path)


@cache
def _built_in() -> tuple[Tolerances, ...]:
    return tuple(_read(path) for path in sorted(FOLDER.glob("*.toml")))


def _read(path: Path) -> Tolerances:
    table = validated(path, read_toml(path), TolerancesTable)
    limits = table.single_vision.build(), table.progressive.build()
    return Tolerances(table.edition, table.source, table.power, table.axis_from, *limits)
