"""A form of numbers, each typed or dragged; every change is an edit of the document."""

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QFormLayout, QHBoxLayout, QSlider, QWidget

from ..session import Workbench
from .document import Document
from .fields import Field


class NumberBox(QDoubleSpinBox):
    """A spin box that leaves Space to the window: no number holds one."""

    def event(self, event: QEvent) -> bool:
        if event.type() == QEvent.Type.ShortcutOverride and event.key() == Qt.Key.Key_Space:
            self.interpretText()
            event.ignore()
            return True
        return super().event(event)


class NumberRow(QWidget):
    """A spin box with its unit, and a slider beside it. moved(value): by the user; let_go(): the drag is over."""

    moved = Signal(float)
    let_go = Signal()

    def __init__(self, field: Field) -> None:
        super().__init__()
        self.field = field
        self.box = NumberBox(decimals=field.decimals, minimum=field.low, maximum=field.high, singleStep=field.step)
        self.box.setSuffix(f" {field.unit}")
        self.box.setKeyboardTracking(False)
        self.box.setAccessibleName(field.name)
        self.box.setToolTip(f"{field.name}: {field.low:g} to {field.high:g} {field.unit}")
        self.box.setMinimumWidth(96)
        self.box.valueChanged.connect(self._typed)
        row = QHBoxLayout(self, spacing=6)
        row.setContentsMargins(0, 0, 0, 0)
        self.slider = QSlider(Qt.Orientation.Horizontal, maximum=round((field.high - field.low) / field.step))
        self.slider.setVisible(field.slider)
        self.slider.setAccessibleName(f"{field.name}, slider")
        self.slider.valueChanged.connect(self._dragged)
        self.slider.sliderReleased.connect(self.let_go)
        row.addWidget(self.slider, 1)
        row.addWidget(self.box, 0 if field.slider else 1)

    def show_value(self, value: float) -> None:
        """Show a value that came from elsewhere; while the user drags or types, his own stays."""
        for widget, shown in ((self.box, value), (self.slider, round((value - self.field.low) / self.field.step))):
            if not (widget is self.slider and self.slider.isSliderDown()):
                widget.blockSignals(True)
                widget.setValue(shown)
                widget.blockSignals(False)

    def _typed(self, value: float) -> None:
        self.moved.emit(value)
        self.let_go.emit()

    def _dragged(self, step: int) -> None:
        self.moved.emit(self.field.low + step * self.field.step)


class Form(QWidget):
    """The fields of one group."""

    def __init__(self, document: Document, fields: tuple[Field, ...]) -> None:
        super().__init__()
        self.document = document
        layout = QFormLayout(self, labelAlignment=Qt.AlignmentFlag.AlignRight, verticalSpacing=4)
        layout.setContentsMargins(6, 4, 6, 8)
        layout.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.ExpandingFieldsGrow)
        self.rows = {field.name: NumberRow(field) for field in fields}
        for name, row in self.rows.items():
            layout.addRow(name, row)
            row.moved.connect(lambda value, row=row: self._write(row.field, value))
            row.let_go.connect(document.rest)
        document.changed.connect(self.show_bench)
        self.show_bench(None, document.workbench)

    def show_bench(self, _old: Workbench | None, new: Workbench) -> None:
        """Show what the workbench holds."""
        for row in self.rows.values():
            row.show_value(row.field.read(new))

    def _write(self, field: Field, value: float) -> None:
        try:
            self.document.edit(field.name, lambda bench: field.write(bench, value), row=field.name)
        finally:
            self.show_bench(None, self.document.workbench)
