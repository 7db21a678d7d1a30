"""A viewport: a header that says and chooses what is shown, and the content, asked of the lane when what it shows changed."""

from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QMenu,
    QStackedLayout,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from ..layers import EYES, Probe
from ..optics.gaze import angles_from_direction
from ..quantities import QUANTITIES
from ..report.facts import misfit
from ..session import KINDS, Pane, Workbench
from .asker import Asker
from .conoid_content import ConoidContent
from .content import Content
from .document import Document
from .lane import Lane
from .map_content import MapContent
from .plot_content import DistortionContent, ProfileContent
from .space_content import EllipsesContent, LensContent, SpaceContent
from .view_content import ViewContent

CONTENTS: dict[str, type[Content]] = {
    "map": MapContent,
    "lens": LensContent,
    "profile": ProfileContent,
    "distortion": DistortionContent,
    "ellipses": EllipsesContent,
    "conoid": ConoidContent,
    "view": ViewContent,
}
EYE_NAMES = {
    "lens": "with the lens",
    "naked": "without the lens",
    "pinhole": "through a pinhole",
    "perfect": "perfect eye",
}


class Viewport(QFrame):
    """The k-th viewport. pointed(point, direction): see Content; said(sentence): for the log; acted(verb, k): from its menu;
    turned(k): the user moved its camera.
    """

    pointed = Signal(object, object)
    said = Signal(str)
    acted = Signal(str, int)
    turned = Signal(int)

    def __init__(self, document: Document, lane: Lane, k: int) -> None:
        super().__init__()
        self.document, self.lane, self.k = document, lane, k
        self.asker = Asker(self, lane, f"viewport {k + 1}")
        self.state = self.asker.mark
        self.content: Content | None = None
        self.answered = False
        self._own_actions: list[QAction] = []
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._build_header()
        self._empty = QLabel("Open a lens: File, Open… or drop its file here", alignment=Qt.AlignmentFlag.AlignCenter)
        self._stack = QStackedLayout()
        self._stack.addWidget(self._empty)
        layout = QVBoxLayout(self, spacing=0)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(self._header)
        layout.addLayout(self._stack, 1)
        self.asker.answered.connect(self._answered)
        self.asker.failed.connect(self.said)
        document.changed.connect(self.show_bench)

    def _build_header(self) -> None:
        self.kind, self.quantity, self.lens, self.eye = (QComboBox() for _ in range(4))
        for box, names in ((self.kind, KINDS), (self.eye, {eye: EYE_NAMES[eye] for eye in EYES})):
            for key, name in names.items():
                box.addItem(name, key)
        for key, quantity in QUANTITIES.items():
            self.quantity.addItem(quantity.label, key)
        self.misfit = QLabel("not as ordered", visible=False, margin=2)
        self.misfit.setStyleSheet("background: #fbe3b8; color: #5a3b00")
        self.menu = QToolButton(text="⋯", popupMode=QToolButton.ToolButtonPopupMode.InstantPopup, autoRaise=True)
        self.menu.setMenu(QMenu(self))
        self.menu.setToolTip("Colour scale, save, copy")
        for text, verb in (
            ("Colour scale…", "scale"), ("Keep this colour scale", "keep"), ("Copy colour scale to all", "share"),
            ("Copy picture", "copy"), ("Save picture…", "save"), ("Show alone / all", "alone"), ("Full screen", "full"),
        ):  # fmt: skip
            self.menu.menu().addAction(text, lambda verb=verb: self.acted.emit(verb, self.k))
        for name, box in (("Kind", self.kind), ("Quantity", self.quantity), ("Lens", self.lens), ("Eye", self.eye)):
            box.setAccessibleName(name)
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(6)
        self.menu.menu().aboutToShow.connect(self._offer_looks)
        self._header = QHBoxLayout(spacing=4)
        self._header.setContentsMargins(4, 3, 4, 3)
        for widget, share in (
            (self.kind, 2), (self.quantity, 3), (self.eye, 2), (self.lens, 3), (self.misfit, 0), (self.state, 0),
            (self.menu, 0),
        ):  # fmt: skip
            self._header.addWidget(widget, share)
        self.kind.activated.connect(lambda: self._choose(kind=self.kind.currentData()))
        self.quantity.activated.connect(
            lambda: self._choose(quantity=self.quantity.currentData(), low=None, high=None, step=None)
        )
        self.eye.activated.connect(lambda: self._choose(eye=self.eye.currentData()))
        self.lens.activated.connect(self._choose_lens)

    def _offer_looks(self) -> None:
        """What only a simulated view's menu has: where to look, and the split picture."""
        menu = self.menu.menu()
        for action in self._own_actions:
            menu.removeAction(action)
            action.deleteLater()
        self._own_actions = []
        seen = getattr(self.content, "seen", None)
        if seen is None:
            return
        pane = self.document.workbench.panes[self.k]
        for name in seen.scene.looks:
            target = np.array(seen.scene.looks[name].target) - seen.eye
            azimuth, elevation = (float(np.degrees(angle)) for angle in angles_from_direction(target))
            action = menu.addAction(f"Look {name}", partial(self._choose, azimuth=azimuth, elevation=elevation))
            self._own_actions.append(action)
        split = menu.addAction("Left half without the lens", lambda: self._choose(split=not pane.split))
        split.setCheckable(True)
        split.setChecked(pane.split)
        self._own_actions.append(split)

    # ---- choosing ----

    def _choose(self, **changes: Any) -> None:
        self.document.edit("What a viewport shows", lambda bench: bench.with_pane(self.k, **changes))

    def _choose_lens(self) -> None:
        lens, minus = self.lens.currentData()
        self._choose(lens=lens, minus=minus)

    def _fill_lenses(self, bench: Workbench, difference: bool) -> None:
        choices: list[tuple[str, tuple[int | None, int | None]]] = [("active lens", (None, None))]
        names = [entry.lens.name for entry in bench.lenses]
        choices += [(name, (k, None)) for k, name in enumerate(names)]
        if difference:
            choices += [(f"{a} − {b}", (i, j)) for i, a in enumerate(names) for j, b in enumerate(names) if i != j]
        self.lens.clear()
        for name, data in choices:
            self.lens.addItem(name, data)
        pane = bench.panes[self.k]
        self.lens.setCurrentIndex(
            next((n for n, (_, data) in enumerate(choices) if data == (pane.lens, pane.minus)), 0)
        )
        self.lens.setVisible(len(names) > 1)

    # ---- showing ----

    def show_bench(self, old: Workbench | None, new: Workbench) -> None:
        """Show what the workbench says; ask the lane if something that matters here has changed."""
        if self.k >= new.split:
            return
        pane = new.panes[self.k]
        if old is None or old.panes[self.k] is not pane or old.lenses is not new.lenses or self.content is None:
            self._show_choice(new)
        if self.content is None:
            return
        self._say_misfit(new)
        question = self.content.question(new, pane)
        self._stack.setCurrentWidget(self._empty if question is None else self.content)
        if question is None:
            self.asker.forget()
        else:
            self.asker.ask(*question, (self.content, new, pane))

    def _say_misfit(self, bench: Workbench) -> None:
        """Say so where a lens is shown for a wearer whom it was not ordered for: in the header, lest pictures change size."""
        pane = bench.panes[self.k]
        shown = [lens for lens in (bench.lens_of(pane), bench.lens_less(pane)) if lens is not None]
        sentences = [misfit(lens, bench.worn_by(lens)) for lens in shown]
        self.misfit.setToolTip(" ".join(filter(None, sentences)))
        self.misfit.setVisible(any(sentences))

    def show_probe(self, probe: Probe | None) -> None:
        """Mark a gaze."""
        if self.content is not None and self.answered:
            self.content.show_probe(probe)

    def close_stage(self) -> None:
        """Free what the content holds on the graphics card."""
        if self.content is not None:
            self.content.close_stage()

    def _show_choice(self, bench: Workbench) -> None:
        pane = bench.panes[self.k]
        if not isinstance(self.content, CONTENTS[pane.kind]):
            self._set_content(CONTENTS[pane.kind]())
        for box, value in ((self.kind, pane.kind), (self.quantity, pane.quantity), (self.eye, pane.eye)):
            box.setCurrentIndex(box.findData(value))
        self.quantity.setVisible(pane.kind in ("map", "lens"))
        self.eye.setVisible(pane.kind == "view")
        self._fill_lenses(bench, pane.kind == "map")

    def _set_content(self, content: Content) -> None:
        if self.content is not None:
            self.content.close_stage()
            self._stack.removeWidget(self.content)
            self.content.deleteLater()
        self.asker.forget()
        self.content, self.answered = content, False
        self._stack.addWidget(content)
        content.pointed.connect(self.pointed)
        content.wants_edit.connect(self._edit)
        content.haste = lambda: self.lane.haste
        if isinstance(content, SpaceContent):
            content.camera_moved.connect(lambda: self.turned.emit(self.k))

    def _edit(self, name: str, make: Any, row: str) -> None:
        """An edit from the content: a turn of head or eye; without a name it only asks anew (a probe) or ends a drag."""
        if name:
            own = {"k": self.k} if row == "eye" else {}
            self.document.edit(name, lambda bench: make(bench, **own), row)
        elif row:
            self.show_bench(None, self.document.workbench)
        else:
            self.document.rest()

    def _answered(self, found: Any, context: tuple[Content, Workbench, Pane]) -> None:
        content, bench, pane = context
        if content is not self.content:
            return
        try:
            content.show_answer(found, bench, pane)
            self.answered = True
        except Exception as error:
            self.asker.fail(str(error))


def grid(viewports: list[Viewport], split: int) -> QWidget:
    """The first viewports in one, two or four fields of equal size."""
    from PySide6.QtWidgets import QSplitter

    def row(shown: list[Viewport]) -> QSplitter:
        splitter = QSplitter(Qt.Orientation.Horizontal, childrenCollapsible=False)
        for viewport in shown:
            splitter.addWidget(viewport)
            viewport.show()
        splitter.setSizes([1000] * len(shown))
        return splitter

    if split < 4:
        return row(viewports[:split])
    column = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False)
    for pair in np.reshape(np.array(viewports, dtype=object), (2, 2)):
        column.addWidget(row(list(pair)))
    column.setSizes([1000, 1000])
    return column
