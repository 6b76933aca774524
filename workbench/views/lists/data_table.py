"""A table of texts with units in its headers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, Qt, Signal
from PySide6.QtGui import QGuiApplication, QKeyEvent, QKeySequence
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QMenu, QTableView, QWidget

from core.files.csv_text import harmless
from core.messages import unparted
from workbench.language import tr
from workbench.views.layouts import in_column

_NUMBER_SIGNS = set("0123456789.,+-−–±×e%° \u00a0")
_Index = QModelIndex | QPersistentModelIndex
_NONE = QModelIndex()

Header = tuple[str, str] | tuple[str, str, str]
"""Title and unit of a column, "" for none, and perhaps a tip that says what a short title means."""


LEAST_PX = 70
"""Width of a column that gives way to the others: its title and a beginning of what is in it are seen."""


class _Texts(QAbstractTableModel):
    """Rows of texts with titles and tips; a column of numbers stands right."""

    titles: tuple[str, ...] = ()
    title_tips: tuple[str, ...] = ()
    rows: tuple[Sequence[str], ...] = ()
    _tips: Sequence[str] | None = None
    _right: tuple[bool, ...] = ()

    def set_titles(self, titles: Sequence[str], tips: Sequence[str]) -> None:
        self.beginResetModel()
        self.titles, self.title_tips, self.rows, self._tips, self._right = tuple(titles), tuple(tips), (), None, ()
        self.endResetModel()

    def set_rows(self, rows: Sequence[Sequence[str]], tips: Sequence[str] | None) -> None:
        """Rows that stay keep their places, so that what is chosen stays chosen."""
        before, now = len(self.rows), len(rows)
        if now > before:
            self.beginInsertRows(_NONE, before, now - 1)
        elif now < before:
            self.beginRemoveRows(_NONE, now, before - 1)
        self.rows, self._tips = tuple(tuple(map(unparted, row)) for row in rows), tips
        columns = range(len(self.titles))
        self._right = tuple(_are_numbers([row[i] for row in rows if row[i]]) for i in columns)
        if now > before:
            self.endInsertRows()
        elif now < before:
            self.endRemoveRows()
        if now:
            self.dataChanged.emit(self.index(0, 0), self.index(now - 1, len(self.titles) - 1))
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, len(self.titles) - 1)

    @property
    def ends_with_numbers(self) -> bool:
        """Whether the last column stands right."""
        return bool(self._right) and self._right[-1]

    def rowCount(self, parent: _Index = _NONE) -> int:
        return 0 if parent.isValid() else len(self.rows)

    def columnCount(self, parent: _Index = _NONE) -> int:
        return 0 if parent.isValid() else len(self.titles)

    def data(self, index: _Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        match role:
            case Qt.ItemDataRole.DisplayRole:
                return self.rows[index.row()][index.column()]
            case Qt.ItemDataRole.ToolTipRole if self._tips is not None:
                return self._tips[index.row()]
            case Qt.ItemDataRole.TextAlignmentRole:
                return self._placed(index.column())
        return None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation is Qt.Orientation.Horizontal and role == Qt.ItemDataRole.DisplayRole:
            return self.titles[section]
        if orientation is Qt.Orientation.Horizontal and role == Qt.ItemDataRole.ToolTipRole:
            return self.title_tips[section]
        if orientation is Qt.Orientation.Horizontal and role == Qt.ItemDataRole.TextAlignmentRole and self.rows:
            return self._placed(section)
        return None

    def _placed(self, column: int) -> Qt.AlignmentFlag:
        side = Qt.AlignmentFlag.AlignRight if self._right[column] else Qt.AlignmentFlag.AlignLeft
        return side | Qt.AlignmentFlag.AlignVCenter


class CopyingTable(QTableView):
    """Table that asks its owner when something is to be copied."""

    copy_wanted = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.matches(QKeySequence.StandardKey.Copy):
            self.copy_wanted.emit()
        else:
            super().keyPressEvent(event)


class DataTable(QWidget):
    """Table of rows of texts; numbers are aligned to the right. Ctrl+C copies what is chosen, tabs between columns,
    headers first.
    """

    current_row_changed = Signal(int)
    """The row gone to, −1 for none."""

    row_activated = Signal(int)
    """Enter or a double click."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._model, self.table, self._shrinking = _Texts(self), CopyingTable(), False
        self.table.setModel(self._model)
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.table.setAlternatingRowColors(True)
        self.table.setShowGrid(False)
        self.table.setTabKeyNavigation(False)
        self.table.setWordWrap(False)
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 9)
        self.table.horizontalHeader().setHighlightSections(False)
        self.table.horizontalHeader().setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.table.horizontalHeader().setStretchLastSection(True)
        self.table.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.table.customContextMenuRequested.connect(self._menu)
        self.table.copy_wanted.connect(self._copy)
        self.table.selectionModel().currentRowChanged.connect(self._moved)
        self.table.activated.connect(self._activated)
        self.setFocusProxy(self.table)
        in_column(self.table, on=self)

    def let_shrink(self, column: int) -> None:
        """Give the column `column` the width that the others leave; texts that are cut are in tooltips."""
        self._shrinking, header = True, self.table.horizontalHeader()
        header.setStretchLastSection(False)
        header.setMinimumSectionSize(LEAST_PX)
        header.setSectionResizeMode(column, QHeaderView.ResizeMode.Stretch)

    def show_rows(self, most: int) -> None:
        """Set the table's height for all present rows, or for at most `most` of them."""
        table = self.table
        rows = min(self._model.rowCount(), most) * table.verticalHeader().defaultSectionSize()
        table.setMinimumHeight(table.horizontalHeader().sizeHint().height() + rows + 2 * table.frameWidth())

    def whole_width(self) -> int:
        """Return the width in px at which no column is cut, the scroll bar included."""
        table, header = self.table, self.table.horizontalHeader()
        columns = range(len(self._model.titles))
        wanted = sum(max(table.sizeHintForColumn(one), header.sectionSizeHint(one)) for one in columns)
        return wanted + 2 * table.frameWidth() + table.verticalScrollBar().sizeHint().width()

    def set_headers(self, headers: Sequence[Header]) -> None:
        """Set the columns with their headers; all rows are removed."""
        titles = [f"{title} [{unit}]" if unit else title for title, unit, *_ in headers]
        self._model.set_titles(titles, [tip[0] if tip else "" for _, _, *tip in headers])

    def set_rows(self, rows: Sequence[Sequence[str]], tips: Sequence[str] | None = None) -> None:
        """Set the rows, a text for each column, and a tooltip for each row; selection and scrolling are kept.

        Raises
        ------
        ValueError
            If a row has not as many texts as there are columns.
        """
        columns = len(self._model.titles)
        if wrong := next((row for row in rows if len(row) != columns), None):
            raise ValueError(f"{columns} columns, but a row of {len(wrong)}")
        self._model.set_rows(rows, tips)
        if not self._shrinking:  # numbers at the far end of a wide table would stand alone
            self.table.horizontalHeader().setStretchLastSection(not self._model.ends_with_numbers)

    def rows(self) -> tuple[tuple[str, ...], ...]:
        """Return the texts of all rows."""
        return tuple(tuple(row) for row in self._model.rows)

    def current_row(self) -> int:
        """Return the index of the current row; −1 if there is none."""
        return self.table.currentIndex().row()

    def set_current_row(self, row: int) -> None:
        """Make the row with this index the current one; −1 for none."""
        self.table.setCurrentIndex(self._model.index(row, 0))

    def copied(self) -> str:
        """Return what Ctrl+C copies: headers, then the selected rows, or all rows, separated by tabs.

        No text is a formula.
        """
        chosen = sorted({index.row() for index in self.table.selectedIndexes()}) or range(len(self._model.rows))
        lines = (self._model.titles, *(self._model.rows[row] for row in chosen))
        return "\n".join("\t".join(cell if _is_number(cell) else harmless(cell) for cell in line) for line in lines)

    def _copy(self) -> None:
        QGuiApplication.clipboard().setText(self.copied())

    def _menu(self) -> None:
        menu = QMenu(self)
        menu.addAction(tr("Copy"), QKeySequence(QKeySequence.StandardKey.Copy), self._copy)
        menu.exec(self.cursor().pos())
        menu.deleteLater()

    def _moved(self, now: _Index, before: _Index) -> None:
        if now.row() != before.row():
            self.current_row_changed.emit(now.row())

    def _activated(self, index: _Index) -> None:
        self.row_activated.emit(index.row())


def _are_numbers(texts: Sequence[str]) -> bool:
    return bool(texts) and all(map(_is_number, texts))


def _is_number(text: str) -> bool:
    """Whether a text is a number, perhaps with an uncertainty: it stands right then."""
    return any(c.isdigit() for c in text) and set(text) <= _NUMBER_SIGNS
