"""What a list or tree shows: texts, tips and marks of its rows by their numbers."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QAbstractItemModel, QModelIndex, Qt
from PySide6.QtWidgets import QAbstractItemView


def place(view: QAbstractItemView, row: int, column: int = 0, below: int | None = None) -> QModelIndex:
    """Index of a row, or of the one so far below it."""
    model: QAbstractItemModel = view.model()
    return model.index(row, column) if below is None else model.index(below, column, model.index(row, 0))


def shown(
    view: QAbstractItemView,
    row: int,
    column: int = 0,
    below: int | None = None,
    role: int = Qt.ItemDataRole.DisplayRole,
) -> Any:
    """What is shown there: a text, or what another role says."""
    return place(view, row, column, below).data(role)


def tip(view: QAbstractItemView, row: int, column: int = 0, below: int | None = None) -> str:
    """Of a row, or of the one so far below it."""
    return str(shown(view, row, column, below, Qt.ItemDataRole.ToolTipRole))


def icon_of(view: QAbstractItemView, row: int, column: int = 0, below: int | None = None) -> Any:
    """Its icon; None without one."""
    return shown(view, row, column, below, Qt.ItemDataRole.DecorationRole)
