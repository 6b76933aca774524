"""Style sheets that depend on the theme, and the frame of what has the focus."""

from __future__ import annotations

from PySide6.QtGui import QColor, QPainter
from PySide6.QtWidgets import QWidget

from workbench.theme import shades


def dress(widget: QWidget, sheet: str) -> None:
    """Set a style sheet unless it is set: setting one tells the widget of a changed palette, where it is set again."""
    if widget.styleSheet() != sheet:
        widget.setStyleSheet(sheet)


def draw_focus(widget: QWidget) -> None:
    """Frame a widget that has the focus; to be called while it is painted. It leaves a margin of a pixel for it."""
    if widget.hasFocus():
        painter = QPainter(widget)
        painter.setPen(QColor(shades().accent))
        painter.drawRect(widget.rect().adjusted(0, 0, -1, -1))
        painter.end()
