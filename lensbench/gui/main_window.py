"""The main window: tree and forms on the left, linked viewports in the middle, readings and log below."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QSettings, Qt
from PySide6.QtGui import QAction, QActionGroup, QCloseEvent, QDragEnterEvent, QDropEvent, QKeySequence
from PySide6.QtWidgets import (
    QDockWidget,
    QMainWindow,
    QMessageBox,
    QPlainTextEdit,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from .. import __version__
from ..errors import LensBenchError
from ..layers import Probe
from ..session import SPLITS, Pane, Workbench
from .asker import marks
from .document import Document
from .files import Files
from .lane import Lane, sentence
from .pictures import PictureActions
from .readings import Readings
from .reports import ReportRunner
from .space_content import SIDES, SpaceContent
from .table_panel import TablePanel
from .theme import set_theme
from .viewport import Viewport, grid


class MainWindow(QMainWindow):
    """Everything that is seen. Holds the document and the lane; panels only know these two."""

    def __init__(self, settings: QSettings | None = None) -> None:
        super().__init__()
        self.settings = settings or QSettings("LensBench", "LensBench")
        self.document, self.lane = Document(), Lane()
        self._flip_to: int | None = None
        self.viewports = [Viewport(self.document, self.lane, k) for k in range(max(SPLITS))]
        self.files = Files(self)
        self.readings = Readings(self, self.document, self.lane)
        self.pictures = PictureActions(self)
        self.reports = ReportRunner(self)
        self._central = QWidget()
        self._central_layout = QVBoxLayout(self._central)
        self._central_layout.setContentsMargins(3, 3, 3, 3)
        self.setCentralWidget(self._central)
        self._build_docks()
        self._build_menus()
        for viewport in self.viewports:
            viewport.pointed.connect(partial(self.readings.point_at, viewport.k))
            viewport.said.connect(self.say)
            viewport.acted.connect(self._act)
            viewport.turned.connect(self._link_cameras)
        self.lane.answered.connect(self._answered)
        self.readings.probed.connect(self._mark_probe)
        self.readings.said.connect(self.say)
        self.document.changed.connect(self.show_bench)
        self.document.history.connect(self._show_history)
        self.setAcceptDrops(True)
        self.resize(1500, 940)
        self._theme(bool(self.settings.value("dark", False, type=bool)))
        self.show_bench(None, self.document.workbench)

    # ---- building ----

    def _build_docks(self) -> None:
        self.table = TablePanel(self.document, self.attempt)
        self._dock("Table", self.table, Qt.DockWidgetArea.LeftDockWidgetArea)
        readings = self.readings
        self.log = QPlainTextEdit(readOnly=True, maximumBlockCount=500)
        tabs = QTabWidget()
        for title, widget in (
            ("Reference points", readings.points), ("Against the order", readings.tolerances), ("Log", self.log),
        ):  # fmt: skip
            tabs.addTab(widget, title)
        tabs.setCornerWidget(marks(readings.of_points, readings.of_tolerances))
        self._dock("Readings", tabs, Qt.DockWidgetArea.BottomDockWidgetArea)
        self._dock("Probe", readings.probe_panel, Qt.DockWidgetArea.BottomDockWidgetArea)
        docks = [self.findChild(QDockWidget, name) for name in ("Readings", "Probe")]
        self.resizeDocks(docks, [1000, 330], Qt.Orientation.Horizontal)
        self.resizeDocks(docks, [190, 190], Qt.Orientation.Vertical)
        self.resizeDocks([self.findChild(QDockWidget, "Table")], [390], Qt.Orientation.Horizontal)

    def _dock(self, title: str, widget: QWidget, area: Qt.DockWidgetArea) -> None:
        dock = QDockWidget(title, self)
        dock.setObjectName(title)
        dock.setWidget(widget)
        self.addDockWidget(area, dock)

    def _build_menus(self) -> None:
        file = self.menuBar().addMenu("&File")
        self._action(file, "&Open…", self.files.ask_open, QKeySequence.StandardKey.Open)
        file.addMenu(self.files.recent)
        self._action(file, "&Save session", self.files.ask_save, QKeySequence.StandardKey.Save)
        self._action(file, "Save session &as…", lambda: self.files.ask_save(anew=True), QKeySequence.StandardKey.SaveAs)
        file.addSeparator()
        self._action(file, "&Report…", self.reports.ask_report, "Ctrl+R")
        self._action(file, "&Compare…", self.reports.ask_comparison, "Ctrl+Shift+R")
        file.addSeparator()
        self._action(file, "&Quit", self.close, QKeySequence.StandardKey.Quit)
        edit = self.menuBar().addMenu("&Edit")
        self.undo = self._action(edit, "&Undo", self.document.undo, QKeySequence.StandardKey.Undo)
        self.redo = self._action(edit, "&Redo", self.document.redo, QKeySequence.StandardKey.Redo)
        self._action(edit, "&Take lens off the table", self._remove_lens, QKeySequence.StandardKey.Delete)
        view = self.menuBar().addMenu("&View")
        group = QActionGroup(self)
        self.splits = {}
        for split in SPLITS:
            action = self._action(
                view, f"{split} viewport{'s' * (split > 1)}", partial(self._split, split), f"Ctrl+{split}"
            )
            action.setCheckable(True)
            group.addAction(action)
            self.splits[split] = action
        view.addSeparator()
        self._action(view, "&Flip between two lenses", self.flip, "Space")
        self._action(view, "Difference of the two lenses", self._difference, "Ctrl+D")
        self._action(view, "Two lenses side by side", self._side_by_side, "Ctrl+Shift+D")
        camera = view.addMenu("&Camera")
        for k, side in enumerate(("", *SIDES), start=2):
            self._action(camera, f"From {side}" if side else "As at first", partial(self._look, side), f"F{k}")
        self._action(view, "&Stop computing", self.stop, "Esc")
        self._action(view, "&Compute what was stopped", self.again, "F8")
        self._action(view, "Full screen", self._full_screen, "F11")
        self.dark = self._action(view, "&Dark", lambda: self._theme(self.dark.isChecked()))
        self.dark.setCheckable(True)
        docks = view.addMenu("Panels")
        for dock in self.findChildren(QDockWidget):
            docks.addAction(dock.toggleViewAction())
        self._action(self.menuBar().addMenu("&Help"), "&About", self._about)
        self._show_history()

    def _action(self, menu: Any, text: str, run: Callable[[], Any], key: Any = None) -> QAction:
        action = menu.addAction(text, lambda *_: run())
        if key is not None:
            action.setShortcut(QKeySequence(key))
        return action

    # ---- showing ----

    def show_bench(self, old: Workbench | None, new: Workbench) -> None:
        """Show the workbench: layout, and to which lens one flips."""
        if old is None or old.split != new.split:
            self._lay_out(new.split)
        if old is not None and old.lens != new.lens and old.lens < len(new.lenses):
            self._flip_to = old.lens

    def _lay_out(self, split: int) -> None:
        for viewport in self.viewports:
            viewport.setParent(None)
        while (item := self._central_layout.takeAt(0)) is not None:
            if item.widget() is not None:
                item.widget().deleteLater()
        self._central_layout.addWidget(grid(self.viewports, split))
        for viewport in self.viewports[:split]:
            viewport.show_bench(None, self.document.workbench)
        self.splits[split].setChecked(True)

    @property
    def probe(self) -> Probe | None:
        """The gaze that is marked in every view."""
        return self.readings.probe

    def _mark_probe(self, probe: Probe | None) -> None:
        for viewport in self.viewports[: self.document.workbench.split]:
            viewport.show_probe(probe)

    def _answered(self, asker: str, _answer: Any) -> None:
        if asker.startswith("viewport"):
            self._mark_probe(self.probe)

    def say(self, sentence: str) -> None:
        """A line for the log and the status bar."""
        self.log.appendPlainText(sentence)
        self.statusBar().showMessage(sentence, 8000)

    def _show_history(self) -> None:
        document = self.document
        for action, name, word in ((self.undo, document.undo_name, "Undo"), (self.redo, document.redo_name, "Redo")):
            action.setText(f"{word} {name[:1].lower()}{name[1:]}" if name else word)
            action.setEnabled(bool(name))
        name = self.files.session.name if self.files.session else "unnamed session"
        self.setWindowTitle(f"{name}[*] – LensBench")
        self.setWindowModified(document.modified)

    # ---- doing ----

    def attempt(self, do: Callable[[], Any]) -> bool:
        """Do something; what is wrong is said, not raised."""
        try:
            do()
        except (LensBenchError, OSError) as error:
            self.say(sentence(error))
            return False
        return True

    def flip(self) -> None:
        """Make the lens active that was active before: A/B."""
        other = self._other_lens()
        if other is not None:
            self.document.edit("Flip between lenses", lambda bench: replace(bench, lens=other), "flip")

    def stop(self) -> None:
        """Compute nothing more of what was asked so far."""
        self.lane.stop()
        self.reports.cancel()
        self.say("stopped: what is marked so is older than the settings; a click on the mark or F8 computes it")

    def again(self) -> None:
        """Compute what was stopped."""
        for asker in (*(viewport.asker for viewport in self.viewports), *self.readings.askers):
            asker.again()

    def _split(self, split: int) -> None:
        self.document.edit("Number of viewports", lambda bench: replace(bench, split=split))

    def _difference(self) -> None:
        bench, other = self.document.workbench, self._other_lens()
        if other is None:
            return
        shown = next((k for k in range(bench.split) if bench.panes[k].kind == "map"), 0)
        self.document.edit(
            "Difference of two lenses", lambda b: b.with_pane(shown, kind="map", lens=b.lens, minus=other)
        )

    def _side_by_side(self) -> None:
        """The active lens, the other one, their difference, and the profiles of both."""
        other = self._other_lens()
        if other is None:
            return

        def make(bench: Workbench) -> Workbench:
            quantity = next((p.quantity for p in bench.panes if p.kind == "map"), "astigmatism")
            panes = (
                Pane("map", quantity, bench.lens),
                Pane("map", quantity, other),
                Pane("map", quantity, bench.lens, other),
            )
            return replace(bench, split=4, panes=(*panes, Pane("profile")))

        self.document.edit("Two lenses side by side", make)

    def _other_lens(self) -> int | None:
        """The lens that was active before, or the next one."""
        bench, other = self.document.workbench, self._flip_to
        if len(bench.lenses) < 2:
            self.say("this needs two lenses: open another one")
            return None
        return (
            (bench.lens + 1) % len(bench.lenses) if other in (None, bench.lens) or other >= len(bench.lenses) else other
        )

    def _remove_lens(self) -> None:
        k = self.table.tree.selected_lens()
        if k is not None:
            self.document.edit("Take lens off the table", lambda bench: bench.without_lens(k))

    def _act(self, verb: str, k: int) -> None:
        """What a viewport's menu asks for."""
        if verb == "alone":
            self._show_alone(k)
        elif verb == "full":
            self._show_alone(k)
            self._full_screen()
        else:
            self.attempt(lambda: self.pictures.act(verb, k))

    def _link_cameras(self, k: int) -> None:
        """All stages of one kind are seen from the same place."""
        source = self.viewports[k].content
        for viewport in self.viewports[: self.document.workbench.split]:
            if viewport.content is not source and type(viewport.content) is type(source):
                viewport.content.stage.look_like(source.stage)

    def _look(self, side: str) -> None:
        """Turn the cameras of all stages that are shown."""
        for viewport in self.viewports[: self.document.workbench.split]:
            if isinstance(viewport.content, SpaceContent):
                viewport.content.look(side)

    def _show_alone(self, k: int) -> None:
        """The k-th viewport alone, or all again."""

        def make(bench: Workbench) -> Workbench:
            if bench.split == 1:
                return replace(bench, split=4)
            panes = list(bench.panes)
            panes[0], panes[k] = panes[k], panes[0]
            return replace(bench, split=1, panes=tuple(panes))

        self.document.edit("Viewport alone", make)

    def _full_screen(self) -> None:
        self.setWindowState(self.windowState() ^ Qt.WindowState.WindowFullScreen)

    def _theme(self, dark: bool) -> None:
        set_theme(dark)
        self.dark.setChecked(dark)
        self.settings.setValue("dark", dark)

    def _about(self) -> None:
        QMessageBox.about(
            self, "LensBench", f"LensBench {__version__}\nWhat a spectacle lens does, and what its wearer sees."
        )

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if event.mimeData().hasUrls():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        self.files.open(paths)
        event.acceptProposedAction()

    def closeEvent(self, event: QCloseEvent) -> None:
        if not self._may_close():
            event.ignore()
            return
        self.reports.cancel()
        self.lane.close()
        for viewport in self.viewports:
            viewport.close_stage()
        event.accept()

    def _may_close(self) -> bool:
        """Whether nothing is lost: neither a picture that is not yet written nor edits that the user, asked, wants to keep."""
        if self.pictures.being_saved:
            self.say(f"{self.pictures.being_saved[0]} is still being written; Esc gives it up")
            return False
        if not self.document.modified:
            return True
        buttons = QMessageBox.StandardButton
        answer = QMessageBox.question(
            self, "LensBench", "Save the changes of this session?", buttons.Save | buttons.Discard | buttons.Cancel
        )
        return answer == buttons.Discard or (answer == buttons.Save and self.files.ask_save())
