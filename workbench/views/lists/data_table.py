"""A table of texts with units in its headers."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QGuiApplication, QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QMenu,
    QTableWidget,
    QTableWidgetItem,
    QWidget,
)

from workbench.views.layouts import in_column

_NUMBER_SIGNS = set("0123456789.,+-−–±×e%° ")


class CopyingTable(QTableWidget):
    """A table that asks its owner when something is to be copied."""

    copy_wanted = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.matches(QKeySequence.StandardKey.Copy):
            self.copy_wanted.emit()
        else:
            super().keyPressEvent(event)


class DataTable(QWidget):
    """Rows of texts; numbers stand right. Ctrl+C copies what is chosen, tabs between columns, headers first."""

    current_row_changed = Signal(int)
    """The row gone to, −1 for none."""

    row_activated = Signal(int)
    """Enter or a double click."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._titles: list[str] = []
        self.table = CopyingTable()
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.table.setAlternatingRowColors(True)
        self.table.setShowGrid(False)
        self.table.setTabKeyNavigation(False)
        self.table.setWordWrap(False)
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 9)
        self.table.horizontalHeader().setHighlightSections(False)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.table.horizontalHeader().setStretchLastSection(True)
        self.table.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.table.customContextMenuRequested.connect(self._menu)
        self.table.copy_wanted.connect(self._copy)
        self.table.currentCellChanged.connect(self._moved)
        self.table.cellActivated.connect(lambda row, _: self.row_activated.emit(row))
        self.setFocusProxy(self.table)
        in_column(self.table, on=self)

    def set_headers(self, headers: Sequence[tuple[str, str]]) -> None:
        """(title, unit) of each column; rows shown before are gone."""
        self._titles = [f"{title} [{unit}]" if unit else title for title, unit in headers]
        self.table.clear()
        self.table.setRowCount(0)
        self.table.setColumnCount(len(headers))
        self.table.setHorizontalHeaderLabels(self._titles)

    def set_rows(self, rows: Sequence[Sequence[str]], tips: Sequence[str] | None = None) -> None:
        """Rows of texts, as many as there are columns; `tips` one a row. The chosen row and the scrolling are kept.

        Raises
        ------
        ValueError
            If a row has not as many texts as there are columns.
        """
        if wrong := next((row for row in rows if len(row) != len(self._titles)), None):
            raise ValueError(f"{len(self._titles)} columns, but a row of {len(wrong)}")
        kept, scrolled = self.table.currentRow(), self.table.verticalScrollBar().value()
        self.table.blockSignals(True)
        self.table.setRowCount(len(rows))
        numeric = [all(_is_number(row[i]) for row in rows if row[i]) for i in range(len(self._titles))] if rows else []
        for place, row in enumerate(rows):
            for i, (text, right) in enumerate(zip(row, numeric, strict=True)):
                item = QTableWidgetItem(text)
                item.setTextAlignment(_placed(right))
                if tips is not None:
                    item.setToolTip(tips[place])
                self.table.setItem(place, i, item)
        for i, right in enumerate(numeric):
            header = self.table.horizontalHeaderItem(i)
            assert header is not None
            header.setTextAlignment(_placed(right))
        self.table.blockSignals(False)
        self.table.setCurrentCell(min(kept, len(rows) - 1), 0)
        self.table.verticalScrollBar().setValue(scrolled)

    def current_row(self) -> int:
        """The row gone to, −1 for none."""
        return self.table.currentRow()

    def set_current_row(self, row: int) -> None:
        """Go to a row."""
        self.table.setCurrentCell(row, 0)

    def copied(self) -> str:
        """What Ctrl+C copies: the chosen rows, or all if none is chosen, with the headers."""
        chosen = sorted({index.row() for index in self.table.selectedIndexes()}) or range(self.table.rowCount())
        columns = range(self.table.columnCount())
        model = self.table.model()
        lines = [self._titles, *([str(model.index(row, column).data()) for column in columns] for row in chosen)]
        return "\n".join("\t".join(line) for line in lines)

    def _copy(self) -> None:
        QGuiApplication.clipboard().setText(self.copied())

    def _menu(self) -> None:
        menu = QMenu(self)
        menu.addAction(self.tr("Copy"), QKeySequence(QKeySequence.StandardKey.Copy), self._copy)
        menu.exec(self.cursor().pos())
        menu.deleteLater()

    def _moved(self, row: int, _column: int, before: int, _before_column: int) -> None:
        if row != before:
            self.current_row_changed.emit(row)


def _is_number(text: str) -> bool:
    """Whether a text is a number, perhaps with an uncertainty: it stands right then."""
    return any(c.isdigit() for c in text) and set(text) <= _NUMBER_SIGNS


def _placed(right: bool) -> Qt.AlignmentFlag:
    return (Qt.AlignmentFlag.AlignRight if right else Qt.AlignmentFlag.AlignLeft) | Qt.AlignmentFlag.AlignVCenter
