"""What a widget shows, as a picture for elsewhere."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QFileDialog, QWidget


def copy_picture(widget: QWidget) -> None:
    """Put what it shows on the clipboard."""
    QGuiApplication.clipboard().setPixmap(widget.grab())


def save_picture(widget: QWidget, title: str, name: str) -> None:
    """Ask for a file and write what it shows; `title` is the question's, `name` the file's at first."""
    kinds = QCoreApplication.translate("Grabbed", "Picture (*.png)")
    path, _ = QFileDialog.getSaveFileName(widget, title, name, kinds)
    if path:
        widget.grab().save(path)
