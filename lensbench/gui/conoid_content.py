"""The conoid of the probed gaze: how light from the pupil spreads along it, its focal lines and circle of least confusion."""

from functools import partial
from typing import Any

import numpy as np

from ..layers import ConoidLayer, Probe
from ..optics.conoid import GazeConoids
from ..optics.conventions import Status
from ..optics.gaze import angles_from_direction
from ..session import Pane, Workbench
from ..views.conoid import draw_conoid, fitting_factor, look_at_conoid
from .scene_source import answer_with_scene
from .space_content import SpaceContent


class ConoidContent(SpaceContent):
    """The conoid in space along the probed gaze, at first straight ahead; the camera follows until the user turns it."""

    def __init__(self) -> None:
        super().__init__()
        self.bar.hide()
        self.gaze = 0.0, 0.0  # azimuth, elevation, rad
        self.found: GazeConoids | None = None
        self._turned = False
        self.camera_moved.connect(self._keep_camera)

    def question(self, bench: Workbench, pane: Pane) -> Any:
        lens = bench.lens_of(pane)
        wearer = bench.worn_by(lens)
        layer = ConoidLayer(*self.gaze, bench.distance, bench.accommodation)
        scene = bench.scene if bench.distance == "scene" else ""
        return (lens, wearer, layer, scene), partial(answer_with_scene, lens, wearer, layer, scene)

    def show_answer(self, answer: GazeConoids, bench: Workbench, pane: Pane) -> None:
        self.found = answer if answer.status == Status.OK else None
        if self.found is None:
            self.stage.show_nothing("No ray passes the lens along this gaze")
            return

        def put(plotter: Any) -> None:
            factor = fitting_factor(answer)
            lens = bench.lens_of(pane)
            words = draw_conoid(plotter, lens, bench.worn_by(lens), answer, factor)
            self.stage.words = [*words, (answer.pupil, f"×{factor:g} across the ray")]
            if not self._turned:
                look_at_conoid(plotter, answer)

        self.stage.draw(put)

    def look_first(self, plotter: Any) -> None:
        self._turned = False
        if self.found is not None:
            look_at_conoid(plotter, self.found)

    def show_probe(self, probe: Probe | None) -> None:
        """Ask for the conoid of another gaze."""
        if probe is None or not np.isfinite(probe.direction).all():
            return
        gaze = tuple(float(angle) for angle in angles_from_direction(probe.direction))
        if gaze != self.gaze:
            self.gaze = gaze
            self.wants_edit.emit("", None, "probe")

    def _keep_camera(self) -> None:
        self._turned = True
