"""Rows of a list, each perhaps with rows below it, as a model: what stays keeps its place and stays chosen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Any

from PySide6.QtCore import QAbstractItemModel, QModelIndex, QObject, QPersistentModelIndex, QPoint, Qt, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QTreeView, QWidget

_Index = QModelIndex | QPersistentModelIndex
_NONE = QModelIndex()
_TOP = 0
"""What an index carries that has no row above it; others carry the number of that row."""


@dataclass(frozen=True, slots=True)
class Cell:
    """Cell of a row in one column.

    `ticked` is None where there is nothing to tick, `edited` the text that can be edited in its place, None where none
    can; `more` is shown by delegates.
    """

    text: str
    tip: str = ""
    icon: QIcon | None = None
    right: bool = False
    ticked: bool | None = None
    edited: str | None = None
    more: Mapping[int, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class TreeRow:
    """Row; one of the same `key` is the same row, whatever its texts."""

    key: str
    cells: tuple[Cell, ...]
    below: tuple[TreeRow, ...] = ()


class TreeModel(QAbstractItemModel):
    """Model of rows for a list or a tree, with or without titles."""

    ticked = Signal(str, bool)
    """Key of a row whose box was clicked, and whether it is to be ticked."""
    edited = Signal(str, str)
    """Key of a row whose text was edited in its place, and what it is to be."""

    def __init__(self, parent: QObject, titles: Sequence[str] = ("",)) -> None:
        super().__init__(parent)
        self._titles = tuple(titles)
        self._rows: list[TreeRow] = []
        self._numbers: list[int] = []
        """Of each row its own for as long as it is there: an index of a row below knows by it which one is above."""
        self._next = count(_TOP + 1)

    def set_rows(self, rows: Sequence[TreeRow]) -> None:
        """Set the rows: rows with a known key are updated in place, others are added or removed."""
        before, now = [row.key for row in self._rows], [row.key for row in rows]
        first = _alike(before, now)
        last = _alike(before[first:][::-1], now[first:][::-1])
        if gone := len(before) - first - last:
            self.beginRemoveRows(_NONE, first, first + gone - 1)
            del self._rows[first : first + gone], self._numbers[first : first + gone]
            self.endRemoveRows()
        if come := len(now) - first - last:
            self.beginInsertRows(_NONE, first, first + come - 1)
            self._rows[first:first] = rows[first : first + come]
            self._numbers[first:first] = [next(self._next) for _ in range(come)]
            self.endInsertRows()
        for number, row in enumerate(rows):
            self._say(number, row)

    def _say(self, number: int, row: TreeRow) -> None:
        above, before, now = self.index(number, 0), len(self._rows[number].below), len(row.below)
        if now < before:
            self.beginRemoveRows(above, now, before - 1)
        elif now > before:
            self.beginInsertRows(above, before, now - 1)
        self._rows[number] = row
        if now < before:
            self.endRemoveRows()
        elif now > before:
            self.endInsertRows()
        last = len(self._titles) - 1
        self.dataChanged.emit(above, self.index(number, last))
        if now:
            self.dataChanged.emit(self.index(0, 0, above), self.index(now - 1, last, above))

    def key(self, index: _Index) -> str:
        """Return the key of the top-level row that an index belongs to; "" for an invalid index."""
        if not index.isValid():
            return ""
        above = index.parent()
        return self._rows[above.row() if above.isValid() else index.row()].key

    def index_of(self, key: str) -> QModelIndex:
        """Return the index of the row with this key; an invalid index if there is none."""
        return next((self.index(number, 0) for number, row in enumerate(self._rows) if row.key == key), QModelIndex())

    # ---- what Qt asks

    def index(self, row: int, column: int, parent: _Index = _NONE) -> QModelIndex:
        if not self.hasIndex(row, column, parent):
            return QModelIndex()
        return self.createIndex(row, column, self._numbers[parent.row()] if parent.isValid() else _TOP)

    def parent(self, index: _Index) -> QModelIndex:  # type: ignore[override]  # QObject has another one of this name
        if not index.isValid() or index.internalId() == _TOP:
            return QModelIndex()
        return self.createIndex(self._numbers.index(index.internalId()), 0, _TOP)

    def rowCount(self, parent: _Index = _NONE) -> int:
        if not parent.isValid():
            return len(self._rows)
        return len(self._rows[parent.row()].below) if parent.internalId() == _TOP and parent.column() == 0 else 0

    def columnCount(self, parent: _Index = _NONE) -> int:
        return len(self._titles)

    def flags(self, index: _Index) -> Qt.ItemFlag:
        flags = super().flags(index)
        if not index.isValid():
            return flags
        cell = self._cell(index)
        if cell.ticked is not None:
            flags |= Qt.ItemFlag.ItemIsUserCheckable
        return flags | Qt.ItemFlag.ItemIsEditable if cell.edited is not None else flags

    def data(self, index: _Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        cell = self._cell(index)
        match role:
            case Qt.ItemDataRole.DisplayRole:
                return cell.text
            case Qt.ItemDataRole.EditRole:
                return cell.edited
            case Qt.ItemDataRole.ToolTipRole:
                return cell.tip
            case Qt.ItemDataRole.DecorationRole:
                return cell.icon
            case Qt.ItemDataRole.TextAlignmentRole if cell.right:
                return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
            case Qt.ItemDataRole.CheckStateRole if cell.ticked is not None:
                return Qt.CheckState.Checked if cell.ticked else Qt.CheckState.Unchecked
        return cell.more.get(role)

    def setData(self, index: _Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Emit that the user wants a tick or a text changed; shown once `set_rows` brings it."""
        if role == Qt.ItemDataRole.EditRole:
            self.edited.emit(self.key(index), str(value))
            return True
        if role != Qt.ItemDataRole.CheckStateRole:
            return False
        self.ticked.emit(self.key(index), Qt.CheckState(value) == Qt.CheckState.Checked)
        return True

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation is Qt.Orientation.Horizontal and role == Qt.ItemDataRole.DisplayRole:
            return self._titles[section]
        return None

    def _cell(self, index: _Index) -> Cell:
        above = index.parent()
        row = self._rows[above.row()].below[index.row()] if above.isValid() else self._rows[index.row()]
        return row.cells[index.column()]


class TreeList(QTreeView):
    """List of such rows, those below others unfolded."""

    chosen = Signal(str)
    """Key of the row that someone went to, "" for none; not where the rows themselves changed."""
    ticked = Signal(str, bool)
    """As of the model."""
    edited = Signal(str, str)
    """As of the model; comes once the editor is gone, so that rows may come and go."""

    def __init__(self, titles: Sequence[str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._rows, self._showing = TreeModel(self, titles), False
        self.setModel(self._rows)
        self._rows.rowsInserted.connect(self.expandAll)
        self._rows.ticked.connect(self.ticked)
        self._rows.edited.connect(self.edited, Qt.ConnectionType.QueuedConnection)
        self.selectionModel().currentChanged.connect(self._gone_to)

    def key_at(self, at: QPoint) -> str:
        """Return the key of the row under a point of the viewport; "" if there is none."""
        return self._rows.key(self.indexAt(at))

    def set_rows(self, rows: Sequence[TreeRow]) -> None:
        """Show these rows; the rows below them are unfolded."""
        self._showing = True
        self._rows.set_rows(rows)
        self._showing = False

    def choose(self, key: str) -> None:
        """Select the row with this key and no other; "" or an unknown key selects none."""
        self._showing = True
        if self._rows.key(self.currentIndex()) != key:
            self.setCurrentIndex(self._rows.index_of(key))
        self._showing = False

    def _gone_to(self, index: QModelIndex) -> None:
        if not self._showing:
            self.chosen.emit(self._rows.key(index))


def _alike(before: Sequence[str], now: Sequence[str]) -> int:
    """How many keys from the first on are the same."""
    together = min(len(before), len(now))
    return next((place for place in range(together) if before[place] != now[place]), together)
