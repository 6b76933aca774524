"""The rows of a list of views: what they hold, and in which order they stand."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, QSize, Qt
from PySide6.QtGui import QImage, QPixmap

THUMBNAIL = QSize(56, 42)

VALUE_ROLE = int(Qt.ItemDataRole.UserRole)
"""The row itself."""

_Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True, eq=False, slots=True)
class ListRow:
    """A view, pose or frame.

    `text` is its value with the unit; by `value` it is sorted and its bar is long. `reason` says why it is not used.
    `thumbnail` is (rows, columns) or (rows, columns, 3) of uint8. `title` is shown instead of `name` if given.
    """

    name: str
    value: float | None = None
    text: str = ""
    used: bool = True
    reason: str = ""
    thumbnail: NDArray[np.uint8] | None = None
    title: str = ""


class RowsModel(QAbstractTableModel):
    """Rows with two columns: what it is, and its value. Sorted here; the order given comes back at column −1."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._given: tuple[ListRow, ...] = ()
        self._rows: list[ListRow] = []
        self._places: dict[str, int] = {}
        self._headers = ("", "")
        self._sorted_by, self._order = -1, Qt.SortOrder.AscendingOrder
        self._pixmaps: dict[str, tuple[object, QPixmap]] = {}
        self.later = False
        """Whether thumbnails come later, when a row is in sight: their place is kept free."""
        self.largest = 0.0

    @property
    def rows(self) -> Sequence[ListRow]:
        """The rows as they stand."""
        return self._rows

    def set_headers(self, what: str, value: str) -> None:
        """Name both columns."""
        self._headers = (what, value)
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, 1)

    def set_rows(self, rows: Sequence[ListRow]) -> None:
        """Replace all rows; if they are the same ones in the same order, only what they say changes."""
        before = [row.name for row in self._rows]
        self._given = tuple(rows)
        self.largest = max((row.value for row in rows if row.value is not None and np.isfinite(row.value)), default=0.0)
        self._pixmaps = {row.name: self._pixmaps[row.name] for row in rows if row.name in self._pixmaps}
        ordered = self._in_order()
        if [row.name for row in ordered] == before:
            self._rows = ordered
            if ordered:
                self.dataChanged.emit(self.index(0, 0), self.index(len(ordered) - 1, 1))
        else:
            self.beginResetModel()
            self._rows = ordered
            self.endResetModel()

    def set_used(self, row: int, used: bool) -> None:
        """Check or uncheck a row."""
        new = replace(self._rows[row], used=used)
        self._rows[row] = new
        self._given = tuple(new if given.name == new.name else given for given in self._given)
        self.dataChanged.emit(self.index(row, 0), self.index(row, 1))

    def row_of(self, name: str) -> int:
        """Where a row stands, −1 if it is not there."""
        return self._places.get(name, -1)

    def rowCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        return 0 if parent.isValid() else len(self._rows)

    def columnCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        return 0 if parent.isValid() else 2

    def flags(self, index: _Index) -> Qt.ItemFlag:
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return flags | Qt.ItemFlag.ItemIsUserCheckable if index.column() == 0 else flags

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation == Qt.Orientation.Horizontal and role == Qt.ItemDataRole.DisplayRole:
            return self._headers[section]
        if orientation == Qt.Orientation.Horizontal and role == Qt.ItemDataRole.TextAlignmentRole:
            across = Qt.AlignmentFlag.AlignRight if section == 1 else Qt.AlignmentFlag.AlignLeft
            return across | Qt.AlignmentFlag.AlignVCenter
        return None

    def data(self, index: _Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        row, first = self._rows[index.row()], index.column() == 0
        if role == VALUE_ROLE:
            return row
        if role == Qt.ItemDataRole.DisplayRole:
            return (row.title or row.name) if first else row.text
        if role == Qt.ItemDataRole.CheckStateRole and first:
            return Qt.CheckState.Checked if row.used else Qt.CheckState.Unchecked
        if role == Qt.ItemDataRole.ToolTipRole:
            return "\n".join(part for part in (row.title or row.name, row.text, row.reason) if part)
        if role == Qt.ItemDataRole.DecorationRole and first:
            return self._pixmap(row)
        return None

    def sort(self, column: int, order: Qt.SortOrder = Qt.SortOrder.AscendingOrder) -> None:
        self._sorted_by, self._order = column, order
        self.layoutAboutToBeChanged.emit()
        before = self.persistentIndexList()
        names = [self._rows[index.row()].name for index in before]
        self._rows = self._in_order()
        after = [self.index(self.row_of(name), index.column()) for name, index in zip(names, before, strict=True)]
        self.changePersistentIndexList(before, after)
        self.layoutChanged.emit()

    def _in_order(self) -> list[ListRow]:
        """The rows given as they are to stand; from now on `row_of` tells these places."""
        rows = list(self._given)
        downwards = self._order == Qt.SortOrder.DescendingOrder
        if self._sorted_by == 0:
            rows.sort(key=lambda row: _natural(row.title or row.name), reverse=downwards)
        elif self._sorted_by == 1:
            known = [row for row in rows if row.value is not None and np.isfinite(row.value)]
            known_names = {row.name for row in known}
            known.sort(key=lambda row: row.value or 0.0, reverse=downwards)
            rows = known + [row for row in rows if row.name not in known_names]
        self._places = {row.name: place for place, row in enumerate(rows)}
        return rows

    def _pixmap(self, row: ListRow) -> QPixmap | None:
        if row.thumbnail is None:
            return None
        kept = self._pixmaps.get(row.name)
        if kept is None or kept[0] is not row.thumbnail:
            kept = (row.thumbnail, _thumbnail(row.thumbnail))
            self._pixmaps[row.name] = kept
        return kept[1]


def _thumbnail(picture: NDArray[np.uint8]) -> QPixmap:
    picture = np.ascontiguousarray(picture)
    rows, columns = picture.shape[:2]
    colour = picture.ndim == 3
    form = QImage.Format.Format_RGB888 if colour else QImage.Format.Format_Grayscale8
    image = QImage(picture.data, columns, rows, picture.strides[0], form)
    # twice as fine as shown, for fine screens
    fine = THUMBNAIL * 2
    scaled = image.scaled(fine, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation)
    return QPixmap.fromImage(scaled.copy())


def _natural(text: str) -> list[tuple[int, int, str]]:
    """view2 before view10."""
    parts = re.split(r"(\d+)", text.lower())
    return [(1, int(part), "") if part.isdigit() else (0, 0, part) for part in parts]
