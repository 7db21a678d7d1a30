"""Light and dark: Fusion with a palette of our own, because bare X11 has no theme of its own."""

from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QApplication

_DARK = {
    QPalette.ColorRole.Window: "#262a2e",
    QPalette.ColorRole.WindowText: "#e6e9ec",
    QPalette.ColorRole.Base: "#1e2225",
    QPalette.ColorRole.AlternateBase: "#2a2f33",
    QPalette.ColorRole.Text: "#e6e9ec",
    QPalette.ColorRole.Button: "#33383d",
    QPalette.ColorRole.ButtonText: "#e6e9ec",
    QPalette.ColorRole.ToolTipBase: "#33383d",
    QPalette.ColorRole.ToolTipText: "#e6e9ec",
    QPalette.ColorRole.PlaceholderText: "#8d969e",
    QPalette.ColorRole.Highlight: "#2a7fb8",
    QPalette.ColorRole.HighlightedText: "#ffffff",
}
_LIGHT = {
    QPalette.ColorRole.Window: "#f1f3f5",
    QPalette.ColorRole.WindowText: "#1d2733",
    QPalette.ColorRole.Base: "#ffffff",
    QPalette.ColorRole.AlternateBase: "#f4f6f8",
    QPalette.ColorRole.Text: "#1d2733",
    QPalette.ColorRole.Button: "#e7eaed",
    QPalette.ColorRole.ButtonText: "#1d2733",
    QPalette.ColorRole.ToolTipBase: "#fffde7",
    QPalette.ColorRole.ToolTipText: "#1d2733",
    QPalette.ColorRole.PlaceholderText: "#7a858f",
    QPalette.ColorRole.Highlight: "#0b5d7a",
    QPalette.ColorRole.HighlightedText: "#ffffff",
}


def set_theme(dark: bool) -> None:
    """Dress the application. Pictures keep their white ground in both: colours of maps are to be compared."""
    application = QApplication.instance()
    assert isinstance(application, QApplication)
    palette = QPalette()
    for role, colour in (_DARK if dark else _LIGHT).items():
        palette.setColor(role, QColor(colour))
    for role in (QPalette.ColorRole.Text, QPalette.ColorRole.WindowText, QPalette.ColorRole.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, role, QColor("#8d969e"))
    application.setStyle("Fusion")
    application.setPalette(palette)
