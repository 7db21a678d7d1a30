"""The tree of what lies on the table: lenses, wearers, scenes. A click makes one the active one."""

from dataclasses import replace
from html import escape

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QTreeWidget, QTreeWidgetItem

from ..report.facts import prescription_text
from ..scenes.builtin import SCENES
from ..session import Workbench
from .document import Document

ROLE = Qt.ItemDataRole.UserRole


class TableTree(QTreeWidget):
    """Lenses, wearers and scenes; the active ones in bold."""

    def __init__(self, document: Document) -> None:
        super().__init__()
        self.document = document
        self.setHeaderHidden(True)
        self.setMinimumHeight(120)
        self.itemClicked.connect(self._clicked)
        document.changed.connect(self.show_bench)
        self.show_bench(None, document.workbench)

    def show_bench(self, old: Workbench | None, new: Workbench) -> None:
        """Show what lies on the table."""
        parts = ("lenses", "wearers", "scene", "lens", "wearer", "as_ordered")
        if old is not None and all(getattr(old, part) is getattr(new, part) for part in parts):
            return
        self.clear()
        scenes = list(dict.fromkeys([*SCENES, new.scene]))
        wearers = [
            (f"{wearer.name or 'unnamed'}: {_refraction(new, k)}", k == new.wearer)
            for k, wearer in enumerate(new.wearers)
        ]
        self._group(
            "Lenses", "lens", [(f"{e.lens.name} ({e.lens.side})", k == new.lens) for k, e in enumerate(new.lenses)]
        )
        self._group("Wearers", "wearer", wearers)
        self._group("Scenes", "scene", [(name, name == new.scene) for name in scenes])
        self.expandAll()

    def selected_lens(self) -> int | None:
        """Index of the lens that is selected in the tree."""
        item = self.currentItem()
        kind, value = (item.data(0, ROLE) or ("", None)) if item is not None else ("", None)
        return int(value) if kind == "lens" else None

    def _group(self, title: str, kind: str, entries: list[tuple[str, bool]]) -> None:
        top = QTreeWidgetItem(self, [title])
        top.setFlags(Qt.ItemFlag.ItemIsEnabled)
        for k, (text, active) in enumerate(entries):
            item = QTreeWidgetItem(top, [text])
            item.setToolTip(0, f"<p>{escape(text)}</p>")
            item.setData(0, ROLE, (kind, text if kind == "scene" else k))
            font = item.font(0)
            font.setBold(active)
            item.setFont(0, font)

    def _clicked(self, item: QTreeWidgetItem) -> None:
        kind, value = item.data(0, ROLE) or ("", None)
        if kind and getattr(self.document.workbench, kind) != value:
            self.document.edit(f"Another {kind}", lambda bench: replace(bench, **{kind: value}))


def _refraction(bench: Workbench, k: int) -> str:
    if k == bench.as_ordered:
        return "for each lens its own refraction"
    return f"{prescription_text(bench.wearers[k].eye.refraction)} D"
