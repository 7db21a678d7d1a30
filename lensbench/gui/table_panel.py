"""The left panel: what lies on the table, what is chosen by name, and the forms of numbers."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QFormLayout, QScrollArea, QToolBox, QVBoxLayout, QWidget

from ..optics.materials import MATERIALS
from ..report.facts import RULES
from ..session import Workbench
from .document import Document
from .fields import GROUPS, with_material
from .form import Form
from .table_tree import TableTree

DISTANCES = {
    "objects at the proximity below": float(np.inf),
    "objects of the scene": "scene",
    "the wearer's distances": "model",
}


class TablePanel(QWidget):
    """Tree, choices and forms. attempt: runs an edit and says what is wrong with it."""

    def __init__(self, document: Document, attempt: Callable[[Callable[[], Any]], bool]) -> None:
        super().__init__()
        self.document, self.attempt = document, attempt
        self.tree, self.forms = TableTree(document), QToolBox()
        for title, fields in GROUPS.items():
            area = QScrollArea(widgetResizable=True)
            area.setFrameShape(QScrollArea.Shape.NoFrame)
            area.setWidget(Form(document, fields))
            self.forms.addItem(area, title)
        self.material, self.distance, self.rule = QComboBox(), QComboBox(), QComboBox()
        choices = QFormLayout(labelAlignment=Qt.AlignmentFlag.AlignRight, verticalSpacing=3)
        for text, box, names, choose in (
            ("Material", self.material, {name: name for name in MATERIALS}, with_material),
            ("Maps show", self.distance, DISTANCES, lambda bench, value: replace(bench, distance=value)),
            (
                "Eye accommodates for",
                self.rule,
                {text: rule for rule, text in RULES.items()},
                lambda bench, value: replace(bench, accommodation=value),
            ),
        ):
            for name, value in names.items():
                box.addItem(name, value)
            box.activated.connect(lambda _, text=text, box=box, choose=choose: self._choose(text, box, choose))
            choices.addRow(text, box)
        layout = QVBoxLayout(self, spacing=4)
        layout.setContentsMargins(2, 2, 2, 2)
        layout.addWidget(self.tree, 2)
        layout.addLayout(choices)
        layout.addWidget(self.forms, 5)
        document.changed.connect(self.show_bench)
        self.show_bench(None, document.workbench)

    def show_bench(self, _old: Workbench | None, new: Workbench) -> None:
        """Show what is chosen."""
        self.distance.setCurrentIndex(
            max(0, self.distance.findData(new.distance)) if isinstance(new.distance, str) else 0
        )
        self.rule.setCurrentIndex(self.rule.findData(new.accommodation))
        lens = new.active_lens
        self.material.setEnabled(lens is not None)
        if lens is not None:
            self.material.setCurrentIndex(self.material.findText(lens.material.name))
            self.material.setPlaceholderText(lens.material.name)

    def _choose(self, name: str, box: QComboBox, choose: Callable[[Workbench, Any], Workbench]) -> None:
        value = box.currentData()
        self.attempt(lambda: self.document.edit(name, lambda bench: choose(bench, value)))
        self.show_bench(None, self.document.workbench)
