"""What can be done with the picture in a viewport: its colour scale, copying and saving."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QBuffer, QByteArray, QIODevice
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QFileDialog, QFormLayout, QLineEdit

from ..errors import InputError
from ..output import write_file
from ..session import Pane, Workbench

if TYPE_CHECKING:
    from .main_window import MainWindow


class PictureActions:
    """The menu of a viewport, as far as it is about its picture."""

    def __init__(self, window: "MainWindow") -> None:
        self.window = window
        self._saving: dict[str, Path] = {}  # by the name of the asker
        window.lane.answered.connect(self._found)
        window.lane.failed.connect(self._failed)
        window.lane.stopped.connect(self._stopped)

    @property
    def being_saved(self) -> list[Path]:
        """Files whose content is still being computed."""
        return list(self._saving.values())

    def act(self, verb: str, k: int) -> None:
        """ "scale", "keep", "share", "copy" or "save". Raises InputError."""
        do = {"scale": self.ask_scale, "keep": self.keep_scale, "share": self.share_scale}
        (do | {"copy": self.copy, "save": self.ask_save})[verb](k)

    def ask_scale(self, k: int) -> None:
        """Ask for the limits and the step of a colour scale."""
        pane = self.window.document.workbench.panes[k]
        dialog = ScaleDialog(self.window, pane)
        if dialog.exec():
            self.set_scale(k, *dialog.values())

    def set_scale(self, k: int, low: float | None, high: float | None, step: float | None) -> None:
        """Set limits and step, None for what suits. Raises InputError for what makes no scale."""
        if (low is None) != (high is None) or (low is not None and high is not None and not low < high):
            raise InputError("a scale needs both limits, the lower one first, or neither")
        if step is not None and not step > 0:
            raise InputError("the step of a scale must be positive")
        self.window.document.edit("Colour scale", lambda bench: bench.with_pane(k, low=low, high=high, step=step))

    def keep_scale(self, k: int) -> None:
        """Let the limits stay as they are now, whatever the map becomes."""
        low, high = self._present_limits(k)
        self.window.document.edit("Keep colour scale", lambda bench: bench.with_pane(k, low=low, high=high))

    def share_scale(self, k: int) -> None:
        """Give all panes of the same quantity this pane's scale: its own limits, or those of all maps that it shows now."""

        def make(bench: Workbench) -> Workbench:
            source = bench.panes[k]
            low, high = (source.low, source.high) if source.low is not None else self._present_limits(k)
            panes = tuple(
                replace(p, low=low, high=high, step=source.step) if p.quantity == source.quantity else p
                for p in bench.panes
            )
            return replace(bench, panes=panes)

        self.window.document.edit("Colour scale of all", make)

    def _present_limits(self, k: int) -> tuple[float, float]:
        bands = getattr(self.window.viewports[k].content, "bands", None)
        if bands is None:
            raise InputError("this viewport has no colour scale")
        return float(bands.levels[0]), float(bands.levels[-1])

    def copy(self, k: int) -> None:
        """The picture to the clipboard."""
        QGuiApplication.clipboard().setImage(self._content(k).picture())
        self.window.say("picture copied")

    def ask_save(self, k: int) -> None:
        """Ask for a file and save the picture."""
        name, _ = QFileDialog.getSaveFileName(self.window, "Save picture", "", "Pictures (*.png *.svg *.exr)")
        if name:
            self.save(k, Path(name))

    def save(self, k: int, path: Path) -> None:
        """As it is seen (.png), as the report's figure (.svg), or a view with all its channels (.exr). Raises InputError."""
        content, kind = self._content(k), path.suffix.lower()
        if kind == ".svg":
            from ..views.maps import save_picture

            figure = content.figure()
            if figure is None:
                raise InputError(f"{path}: this view has no drawing in lines; save it as .png")
            save_picture(figure, path)
        elif kind == ".exr":
            self._save_exr(content, path)
            return
        elif kind == ".png":
            write_file(path, _png(content.picture()))
        else:
            raise InputError(f"{path}: a picture is saved as .png, a flat figure also as .svg, a view also as .exr")
        self.window.say(f"written: {path}")

    def _save_exr(self, content: Any, path: Path) -> None:
        """The optics of its pixels are traced, as all else, in the lane; the file is written when they are there."""
        light, seen = getattr(content, "light", lambda: None)(), getattr(content, "seen", None)
        if light is None or seen is None:
            raise InputError(f"{path}: only the simulated view is saved as .exr")
        from ..imaging.exr import exr_bytes

        asker = f"picture {path}"
        self._saving[asker] = path
        self.window.lane.ask(asker, partial(exr_bytes, light, seen), first=True)
        self.window.statusBar().showMessage(f"Saving {path.name}…")

    def _found(self, asker: str, content: Any) -> None:
        path = self._saving.pop(asker, None)
        if path is not None and self.window.attempt(partial(write_file, path, content)):
            self.window.say(f"written: {path}")

    def _failed(self, asker: str, sentence: str) -> None:
        path = self._saving.pop(asker, None)
        if path is not None:
            self.window.say(f"{path}: {sentence}")

    def _stopped(self) -> None:
        for path in self.being_saved:
            self.window.say(f"not written: {path}")
        self._saving.clear()

    def _content(self, k: int) -> Any:
        content = self.window.viewports[k].content
        if content is None:
            raise InputError("this viewport is empty")
        return content


def _png(image: Any) -> bytes:
    data = QByteArray()
    buffer = QBuffer(data)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    image.save(buffer, "PNG")
    return bytes(data.data())


class ScaleDialog(QDialog):
    """Limits and step of a colour scale; empty: what suits."""

    def __init__(self, parent: Any, pane: Pane) -> None:
        super().__init__(parent, windowTitle="Colour scale")
        layout = QFormLayout(self)
        self.lines = {}
        for name, value in (("From", pane.low), ("To", pane.high), ("Step", pane.step)):
            self.lines[name] = QLineEdit("" if value is None else f"{value:g}", placeholderText="automatic")
            layout.addRow(name, self.lines[name])
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout.addRow(buttons)

    def values(self) -> tuple[float | None, ...]:
        """What was written; None where nothing was. Raises InputError for what is no number."""
        try:
            return tuple(
                float(line.text().replace(",", ".")) if line.text().strip() else None for line in self.lines.values()
            )
        except ValueError:
            raise InputError("a colour scale takes numbers, or nothing for what suits") from None
