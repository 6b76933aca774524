"""Style sheets that depend on the theme."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget


def dress(widget: QWidget, sheet: str) -> None:
    """Set a style sheet unless it is set: setting one tells the widget of a changed palette, where it is set again."""
    if widget.styleSheet() != sheet:
        widget.setStyleSheet(sheet)
