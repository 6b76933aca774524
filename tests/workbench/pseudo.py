"""Texts of a window that are told past the catalogues: in the pseudo-language each other one has its accents."""

from __future__ import annotations

import re
from collections.abc import Iterator

from PySide6.QtCore import QAbstractItemModel, QAbstractListModel, QModelIndex, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QComboBox,
    QGroupBox,
    QLabel,
    QLineEdit,
    QMenu,
    QTabBar,
    QWidget,
)

FOREIGN = (
    "Trisect",
    "English", "Deutsch",  # languages, by their own names
    "Letter", "Tabloid",  # sizes of paper
    "GRR",  # the symbol of a quantity
    "Ctrl", "Shift",  # keys, as Qt names them
)  # fmt: skip
"""What is called the same in every language. Names in the project are added, and paths and pictures are passed over."""


def texts_of(widget: QWidget) -> Iterator[str]:
    """What a widget itself tells: its text, its tip, its items."""
    yield widget.toolTip()
    yield widget.windowTitle()
    if isinstance(widget, QLabel | QAbstractButton):
        yield widget.text()
    if isinstance(widget, QGroupBox):
        yield widget.title()
    if isinstance(widget, QLineEdit):
        yield widget.placeholderText()
    if isinstance(widget, QTabBar):
        for tab in range(widget.count()):
            yield widget.tabText(tab)
            yield widget.tabToolTip(tab)
    if isinstance(widget, QComboBox):
        yield from (widget.itemText(item) for item in range(widget.count()))
    if isinstance(widget, QAbstractItemView) and widget.model() is not None:
        yield from items_of(widget.model())
    yield from (text for action in widget.actions() for text in said_by(action))


def said_by(action: QAction) -> tuple[str, str, str]:
    return action.text(), action.toolTip(), action.statusTip()


def items_of(model: QAbstractItemModel) -> Iterator[str]:
    """Heads and cells of a list or table."""
    root = QModelIndex()
    for column in range(1 if isinstance(model, QAbstractListModel) else model.columnCount(root)):
        yield str(model.headerData(column, Qt.Orientation.Horizontal) or "")
        for row in range(model.rowCount(root)):
            index = model.index(row, column, root)
            for role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
                yield str(model.data(index, role) or "")


def english(text: str) -> list[str]:
    """Words of a text that are in no catalogue; the pseudo-language gives every word of three letters an accent."""
    plain = re.sub(r"<[^<>]*>|&\w+;|/\S+|\b\w+\.(png|toml|pdf)\b", " ", text.replace("\N{ZERO WIDTH SPACE}", ""))
    return re.findall(r"\b[A-Za-z]{3,}\b", plain)


def is_never_shown(widget: QWidget) -> bool:
    """Whether it is pyqtgraph's own menu of a plot, or in it: no plot opens it."""
    parent: QWidget | None = widget
    while parent is not None and not (isinstance(parent, QMenu) and parent.title() == "Plot Options"):
        parent = parent.parentWidget()
    return parent is not None


def told_past_the_catalogues(window: QWidget, foreign: re.Pattern[str]) -> dict[str, str]:
    """Every such text of a window, and what tells it."""
    found = {}
    for widget in [window, *window.findChildren(QWidget)]:
        for text in () if is_never_shown(widget) else texts_of(widget):
            if english(foreign.sub(" ", text)):
                found[text] = f"{type(widget).__name__} {widget.objectName()}".strip()
    return found
