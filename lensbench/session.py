"""What lies on the table of the workbench, and the session file that keeps it: format "lensbench-session/1" (JSON).

A lens is kept as the file it came from and what was edited since, a wearer as in a wearer file. In the file: distances in
mm, powers in D, angles in degrees, paths relative to the file.
"""

import json
import os
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from .errors import InputError
from .formats import Contents, lenses_in, read_file
from .formats.lens_file import OrderTable, material_named
from .formats.text import read_text
from .formats.toml_file import Table, validated
from .formats.wearer_file import WearerTable, build_wearer, wearer_table
from .layers import EYES
from .optics.eye import Wearer
from .optics.lens import Lens, Order
from .optics.ordered import wearer_as_ordered, wearer_for
from .output import to_json, write_file
from .quantities import QUANTITIES

FORMAT = "lensbench-session/1"
SPLITS = (1, 2, 4)
PLAIN = (
    "scene",
    "lens",
    "wearer",
    "as_ordered",
    "split",
    "accommodation",
    "head_turn",
    "head_tilt",
)  # kept as they are
KINDS = {
    "map": "Map",
    "lens": "Lens in space",
    "profile": "Power profile",
    "distortion": "Distortion grid",
    "ellipses": "Ellipses of confusion",
    "conoid": "Conoid of the probed gaze",
    "view": "Simulated view",
}


@dataclass(frozen=True, slots=True)
class Edits:
    """What was changed of a lens since it was read; None: as in its file. centre_thickness: mm."""

    centre_thickness: float | None = None
    material: str | None = None
    ordered: Order | None = None


@dataclass(frozen=True, slots=True, eq=False)
class LensOnTable:
    """A lens as it was read from a file (side, material: as asked of it), and as it is now."""

    path: Path
    read: Lens
    lens: Lens
    side: str = ""
    material: str = ""
    edits: Edits = Edits()

    def edited(self, **changes: Any) -> "LensOnTable":
        """With other edits. Raises InputError for a material that is not known or a lens that would not hold together."""
        edits = replace(self.edits, **changes)
        lens = self.read
        if edits.material is not None:
            lens = replace(lens, material=material_named(edits.material))
        if edits.ordered is not None:
            lens = replace(lens, ordered=edits.ordered, verification_power=None)
        if edits.centre_thickness is not None:
            lens = replace(lens, centre_thickness=edits.centre_thickness)
            edge = lens.minimum_edge_thickness()
            if not edge.thickness > 0:
                raise InputError(
                    f"{lens.name}: with {edits.centre_thickness:g} mm at the centre the edge would be {edge.thickness:.2f} mm "
                    f"thick at x = {edge.x:.1f}, y = {edge.y:.1f} mm"
                )
        return replace(self, lens=lens, edits=edits)


@dataclass(frozen=True, slots=True)
class Pane:
    """What one viewport shows. kind: one of KINDS. quantity: of a map. lens: index, None for the active one; minus: index
    of the lens whose map is taken off. low, high, step: of the colour scale, None for what suits. Of a view: eye; azimuth,
    elevation: of the picture's centre, width: of the picture, degrees; split: left half as without the lens.
    """

    kind: str = "map"
    quantity: str = "mean_power"
    lens: int | None = None
    minus: int | None = None
    low: float | None = None
    high: float | None = None
    step: float | None = None
    eye: str = "lens"
    azimuth: float = 0.0
    elevation: float = -12.0
    width: float = 60.0
    split: bool = False


UNASKED = (Wearer(name="emmetrope"),)  # who looks while nothing tells of a wearer
PANES = (Pane("lens"), Pane("map", "astigmatism"), Pane("view"), Pane("profile"))


@dataclass(frozen=True, slots=True, eq=False)
class Workbench:
    """Everything on the table. lens, wearer: indices of the active ones. scene: a name or a file. split: viewports shown.

    as_ordered: index of the wearer who is, for each lens, of the refraction and accommodation for which it was ordered.
    distance: of objects from the front surface, mm, inf, or "scene" or "model" as in MapLayer. depths: of the ellipses, mm
    from the cornea.
    head_turn, head_tilt: degrees, as in ViewLayer.
    """

    lenses: tuple[LensOnTable, ...] = ()
    wearers: tuple[Wearer, ...] = UNASKED
    scene: str = "room"
    lens: int = 0
    wearer: int = 0
    as_ordered: int | None = None
    panes: tuple[Pane, ...] = PANES
    split: int = 4
    distance: float | str = float(np.inf)
    accommodation: str = "retina"
    depths: tuple[float, ...] = (300.0, 500.0, 800.0)
    head_turn: float = 0.0
    head_tilt: float = 0.0

    @property
    def active_lens(self) -> Lens | None:
        """The active lens, if there is any."""
        return self.lenses[self.lens].lens if self.lenses else None

    @property
    def active_wearer(self) -> Wearer:
        """The active wearer, as he wears the active lens."""
        return self.worn_by(self.active_lens)

    def worn_by(self, lens: Lens | None) -> Wearer:
        """The active wearer as he wears a lens."""
        wearer = self.wearers[self.wearer]
        if self.wearer != self.as_ordered or lens is None or lens.ordered is None:
            return wearer
        return wearer_for(wearer, lens.ordered)

    def with_active_wearer(self, wearer: Wearer, as_ordered: bool) -> "Workbench":
        """With another one in the place of the active wearer, who follows the lenses' orders if as_ordered and that one did."""
        wearers = (*self.wearers[: self.wearer], wearer, *self.wearers[self.wearer + 1 :])
        follows = None if self.as_ordered == self.wearer and not as_ordered else self.as_ordered
        return replace(self, wearers=wearers, as_ordered=follows)

    def lens_of(self, pane: Pane) -> Lens | None:
        """The lens that a pane shows, if there is any."""
        return (
            self.lenses[pane.lens].lens if pane.lens is not None and pane.lens < len(self.lenses) else self.active_lens
        )

    def lens_less(self, pane: Pane) -> Lens | None:
        """The lens whose map a pane takes off, if there is any."""
        return self.lenses[pane.minus].lens if pane.minus is not None and pane.minus < len(self.lenses) else None

    def with_lens(self, path: Path, side: str = "", material: str = "") -> "Workbench":
        """With the lens in a file added and active, as `with_lens_read`. Raises InputError."""
        return self.with_lens_read(*lens_read(read_file(path), side, material))

    def with_lens_read(self, added: LensOnTable, told: Wearer | None) -> "Workbench":
        """With a lens added and active, and the wearer of whom its file tells; while nobody was chosen, for each lens the one
        whom its order suggests.
        """
        bench = replace(self, lenses=(*self.lenses, added), lens=len(self.lenses))
        if told is not None:
            return bench.with_wearer(told)
        if self.wearers == UNASKED and added.lens.ordered is not None:
            return replace(bench, wearers=(wearer_as_ordered(added.lens.ordered, name="as ordered"),), as_ordered=0)
        return bench

    def with_wearer(self, wearer: Wearer) -> "Workbench":
        """With a wearer added and active; it takes the place of the emmetrope that nobody asked for."""
        wearers = (wearer,) if self.wearers == UNASKED else (*self.wearers, wearer)
        return replace(self, wearers=wearers, wearer=len(wearers) - 1)

    def without_lens(self, k: int) -> "Workbench":
        """With the k-th lens taken off the table; panes that showed it show the active lens."""

        def moved(index: int | None) -> int | None:
            return None if index is None or index == k else index - (index > k)

        panes = tuple(replace(pane, lens=moved(pane.lens), minus=moved(pane.minus)) for pane in self.panes)
        lenses = self.lenses[:k] + self.lenses[k + 1 :]
        return replace(self, lenses=lenses, lens=max(0, min(self.lens - (self.lens > k), len(lenses) - 1)), panes=panes)

    def with_pane(self, k: int, **changes: Any) -> "Workbench":
        """With the k-th pane changed."""
        pane = replace(self.panes[k], **changes)
        return replace(self, panes=(*self.panes[:k], pane, *self.panes[k + 1 :]))


def lens_read(contents: Contents, side: str = "", material: str = "") -> tuple[LensOnTable, Wearer | None]:
    """The lens in a file that was read, and the wearer that the file tells of. Raises InputError."""
    lens, told = lenses_in(contents, side, material)[0]
    return LensOnTable(contents.path, lens, lens, side, material), told


# ---- the session file ----


class LensEntry(Table):
    """file: relative to the session file, or absolute; side, material: as asked of it; the rest: edits."""

    file: str
    side: Literal["", "R", "L"] = ""
    as_material: str = ""
    centre_thickness: float | None = Field(None, gt=0, le=50)
    material: str | None = None
    ordered: OrderTable | None = None


class PaneTable(Table):
    """As in Pane."""

    kind: Literal[tuple(KINDS)]  # type: ignore[valid-type]
    quantity: Literal[tuple(QUANTITIES)]  # type: ignore[valid-type]
    lens: int | None = Field(None, ge=0)
    minus: int | None = Field(None, ge=0)
    low: float | None = None
    high: float | None = None
    step: float | None = Field(None, gt=0)
    eye: Literal[EYES] = "lens"  # type: ignore[valid-type]
    azimuth: float = Field(0.0, ge=-80, le=80)
    elevation: float = Field(0.0, ge=-80, le=80)
    width: float = Field(60.0, ge=5, le=120)
    split: bool = False

    @model_validator(mode="after")
    def _whole_scale(self) -> "PaneTable":
        if (self.low is None) != (self.high is None) or (self.low is not None and not self.low < self.high):  # type: ignore[operator]
            raise ValueError("a scale needs both limits, low below high, or neither")
        return self


class SessionTable(Table):
    """The whole file."""

    format: Literal["lensbench-session/1"]
    lenses: list[LensEntry]
    wearers: list[WearerTable] = Field(min_length=1)
    scene: str = "room"
    lens: int = Field(0, ge=0)
    wearer: int = Field(0, ge=0)
    as_ordered: int | None = Field(None, ge=0)
    panes: list[PaneTable] = Field(min_length=4, max_length=4)
    split: Literal[1, 2, 4] = 4
    distance: Annotated[float, Field(gt=0)] | Literal["inf", "scene", "model"] = "inf"
    accommodation: Literal["retina", "object", "paper"] = "retina"
    depths: list[Annotated[float, Field(gt=0)]] = Field(default=[300.0, 500.0, 800.0], min_length=1, max_length=9)
    head_turn: float = Field(0.0, ge=-60, le=60)
    head_tilt: float = Field(0.0, ge=-60, le=60)
    window: str = ""


def save_session(workbench: Workbench, path: Path, window: str = "") -> None:
    """Write the session file; window: the window's own state, as text. Raises InputError."""
    data = {
        "format": FORMAT,
        "lenses": [_lens_entry(entry, path.parent) for entry in workbench.lenses],
        "wearers": [wearer_table(wearer) for wearer in workbench.wearers],
        "panes": [_given(asdict(pane)) for pane in workbench.panes],
        "distance": "inf" if workbench.distance == np.inf else workbench.distance,
        "depths": list(workbench.depths),
        "window": window,
    }
    data |= {name: getattr(workbench, name) for name in PLAIN}
    write_file(path, to_json(data))


def _lens_entry(entry: LensOnTable, folder: Path) -> dict[str, Any]:
    file = entry.path.absolute()
    try:
        name = os.path.relpath(file, folder.absolute())
    except ValueError:  # another drive
        name = str(file)
    edits = asdict(entry.edits)
    return _given({"file": Path(name).as_posix(), "side": entry.side, "as_material": entry.material, **edits})


def _given(values: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value is not None}


def load_session(path: Path) -> tuple[Workbench, str]:
    """The workbench of a session file, its lenses read anew from their files; and the window's state. Raises InputError."""
    try:
        data = json.loads(read_text(path))
    except ValueError as error:
        raise InputError(f"{path}: not a session file: {error}") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise InputError(f"{path}: not a session file: it must hold format = {FORMAT!r}")
    table = validated(path, data, SessionTable)
    lenses = tuple(_lens_on_table(path, entry) for entry in table.lenses)
    wearers = tuple(build_wearer(path, wearer) for wearer in data["wearers"])
    for name, index, count in (
        ("lens", table.lens, max(1, len(lenses))),
        ("wearer", table.wearer, len(wearers)),
        ("as_ordered", table.as_ordered or 0, len(wearers)),
    ):
        if index >= count:
            what = name.replace("as_ordered", "wearer")
            raise InputError(f"{path}: {name}: there is no {what} {index}; the file holds {count}, counted from 0")
    panes = tuple(Pane(**pane.model_dump()) for pane in table.panes)
    for k, pane in enumerate(panes):
        if max(pane.lens or 0, pane.minus or 0) >= max(1, len(lenses)):
            raise InputError(f"{path}: panes.{k}: names a lens that the file does not hold")
    return Workbench(
        lenses=lenses,
        wearers=wearers,
        panes=panes,
        distance=np.inf if table.distance == "inf" else table.distance,
        depths=tuple(table.depths),
        **{name: getattr(table, name) for name in PLAIN},
    ), table.window


def _lens_on_table(path: Path, entry: LensEntry) -> LensOnTable:
    file = path.parent / entry.file
    on_table, _ = lens_read(read_file(file), entry.side, entry.as_material)
    ordered = None if entry.ordered is None else Order(**entry.ordered.model_dump())
    try:
        return on_table.edited(centre_thickness=entry.centre_thickness, material=entry.material, ordered=ordered)
    except InputError as error:
        raise InputError(f"{path}: {entry.file}: {error}") from None
