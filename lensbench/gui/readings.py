"""What the panels read of the active lens, and of the gaze that is probed: asked anew whenever it depends on what changed."""

import math
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from PySide6.QtCore import QObject, Signal

from ..layers import PointsLayer, Probe, ProbeLayer, VerificationLayer
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..quantities import QUANTITIES
from ..session import Pane, Workbench
from .asker import Asker, marks
from .document import Document
from .lane import Lane
from .readings_panel import PointsTable, ProbePanel, Reading, TolerancePanel
from .scene_source import answer_with_scene


class Place(NamedTuple):
    """Where the user points: in the k-th viewport at a lens point (x, y) mm, or along a gaze (3,); the other is None."""

    k: int
    point: tuple[float, float] | None
    direction: tuple[float, ...] | None


class Readings(QObject):
    """Fills the panels. probed(probe): of the gaze to be marked in every view; None: of none. said(sentence): for the log."""

    probed = Signal(object)
    said = Signal(str)

    def __init__(self, parent: QObject, document: Document, lane: Lane) -> None:
        super().__init__(parent)
        self.document = document
        self.points, self.tolerances, self.probe_panel = PointsTable(), TolerancePanel(), ProbePanel()
        self.of_points, self.of_tolerances = Asker(self, lane, "points"), Asker(self, lane, "tolerances")
        self.of_probe = Asker(self, lane, "probe", first=True)
        self.probe_panel.layout().insertWidget(0, marks(self.of_probe))
        self.probe: Probe | None = None
        self._at: Place | None = None
        self.of_points.answered.connect(lambda found, _: self.points.show_readings(found))
        self.of_tolerances.answered.connect(lambda found, _: self.tolerances.show_verification(found))
        self.of_probe.answered.connect(lambda found, _: self._show_probe(found))
        for asker in self.askers:
            asker.failed.connect(self.said)
        document.changed.connect(self.show_bench)

    @property
    def askers(self) -> tuple[Asker, Asker, Asker]:
        """All who ask for readings."""
        return self.of_points, self.of_tolerances, self.of_probe

    def show_bench(self, _old: Workbench | None, new: Workbench) -> None:
        """Read what the workbench holds, or clear the panels."""
        lens = new.active_lens
        if lens is None:
            for asker in (self.of_points, self.of_tolerances):
                asker.forget()
            self.points.show_readings(())
            self.tolerances.show_verification(None)
        else:
            wearer = new.worn_by(lens)
            for asker, layer in ((self.of_points, PointsLayer()), (self.of_tolerances, VerificationLayer())):
                asker.ask((lens, wearer), partial(answer_with_scene, lens, wearer, layer, ""))
        self._read_probe(new)

    def point_at(self, k: int, point: Any, direction: Any) -> None:
        """Read along the gaze through a lens point, or in a direction, of what the k-th viewport shows."""
        self._at = Place(k, point, direction)
        self._read_probe(self.document.workbench)

    def _read_probe(self, bench: Workbench) -> None:
        pane = bench.panes[self._at.k] if self._at is not None else None
        lens = bench.lens_of(pane) if pane is not None else None
        if self._at is None or pane is None or lens is None:
            self._at = None
            self.of_probe.forget()
            self._show_probe(None)
            return
        layer = _layer(bench, pane, self._at)
        scene = bench.scene if layer.distance == "scene" else ""
        less = bench.lens_less(pane) if layer.quantity else None
        worn = [(each, bench.worn_by(each)) for each in (lens, less) if each is not None]
        self.of_probe.ask((*worn, layer, scene), partial(_read, worn, layer, scene))

    def _show_probe(self, reading: Reading | None) -> None:
        self.probe = None if reading is None else reading.probe
        self.probe_panel.show_reading(reading)
        self.probed.emit(self.probe)


def _layer(bench: Workbench, pane: Pane, at: Place) -> ProbeLayer:
    """What is read: on a map its quantity too, for the object of the map; elsewhere for what the gaze meets in the scene."""
    if at.point is not None:
        quantity = pane.quantity if pane.kind in ("map", "lens") else ""
        return ProbeLayer(at.point, None, bench.distance, bench.accommodation, quantity=quantity)
    head = (math.radians(angle) for angle in (bench.head_turn, bench.head_tilt))
    return ProbeLayer(None, at.direction, "scene", bench.accommodation, *head)


def _read(worn: list[tuple[Lens, Wearer]], layer: ProbeLayer, scene: str) -> Reading:
    """The reading of the first worn lens; of a map's quantity its value less that of the second, if there is one."""
    (lens, wearer), *less = worn
    probe = answer_with_scene(lens, wearer, layer, scene)
    if not layer.quantity:
        return Reading(lens, wearer, probe)
    quantity = QUANTITIES[layer.quantity]
    label, value = quantity.label, probe.value
    for other, by in less:
        within = replace(lens, outline=other.outline)
        at_others = answer_with_scene(within, wearer, layer, scene).value
        value = at_others - answer_with_scene(other, by, layer, scene).value
        label = f"{label}, less that of {other.name}"
    return Reading(lens, wearer, probe, label, quantity.unit, value)
