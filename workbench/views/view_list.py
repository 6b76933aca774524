"""A list of views, poses or frames to look at, include and leave out."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableView, QVBoxLayout, QWidget

from workbench.views.view_delegate import CHECK_WIDTH, RowDelegate, row_height
from workbench.views.view_rows import ListRow, RowsModel


class CheckingTable(QTableView):
    """A table that says when check boxes are meant; clicking one leaves the selection alone."""

    toggle_wanted = Signal()
    check_clicked = Signal(int)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        row = self._check_at(event)
        if row >= 0:
            self.check_clicked.emit(row)
        else:
            super().mousePressEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        row = self._check_at(event)
        if row >= 0:
            self.check_clicked.emit(row)
        else:
            super().mouseDoubleClickEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Space, Qt.Key.Key_Select):
            self.toggle_wanted.emit()
        else:
            super().keyPressEvent(event)

    def _check_at(self, event: QMouseEvent) -> int:
        index = self.indexAt(event.position().toPoint())
        left = event.button() == Qt.MouseButton.LeftButton and event.position().x() <= CHECK_WIDTH
        return index.row() if left and index.isValid() and index.column() == 0 else -1


class ViewList(QWidget):
    """Rows with a check box each; Space checks or unchecks all chosen rows. Headers sort, a third click as given."""

    toggled = Signal(str, bool)
    """Name and whether it is to be used; once for each row. Connect this or `toggled_together`, not both."""

    toggled_together = Signal(object, bool)
    """All names (tuple) that one click or key changed, and whether they are to be used: one edit to be undone."""

    current_changed = Signal(str)
    """Name of the row gone to, "" for none."""

    activated = Signal(str)
    """Name of the row double-clicked or entered."""

    thumbnail_wanted = Signal(str)
    """Name of a row that is in sight, and whose thumbnail comes later; told again and again until it is there."""

    def __init__(self, parent: QWidget | None = None, *, thumbnails_later: bool = False) -> None:
        super().__init__(parent)
        self.model = RowsModel(self)
        self.model.later = thumbnails_later
        self.table = CheckingTable()
        self.table.setModel(self.model)
        self._delegate = RowDelegate(self.model)
        self.table.setItemDelegate(self._delegate)
        self._delegate.thumbnail_missing.connect(self.thumbnail_wanted, Qt.ConnectionType.QueuedConnection)
        self._told = ""
        self._set_up_table()
        self.set_headers(self.tr("View"), self.tr("Error"))
        self.setFocusProxy(self.table)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.table)

    def set_headers(self, what: str, value: str) -> None:
        """Name both columns: what is listed, and the value with its unit."""
        self.model.set_headers(what, value)
        self.table.setAccessibleName(what)

    def set_rows(self, rows: Sequence[ListRow]) -> None:
        """Show rows. Which are chosen, which is current, and the scrolling are kept."""
        chosen, current = self.chosen(), self.current()
        scrolled = self.table.verticalScrollBar().value()
        before = [row.name for row in self.model.rows]
        selection = self.table.selectionModel()
        selection.blockSignals(True)
        self.model.set_rows(rows)
        if [row.name for row in self.model.rows] != before:
            self._restore(chosen, current)
            self.table.verticalScrollBar().setValue(scrolled)
        selection.blockSignals(False)
        self.table.viewport().update()
        self._tell_current()

    def rows(self) -> tuple[ListRow, ...]:
        """The rows as they stand."""
        return tuple(self.model.rows)

    def current(self) -> str:
        """Name of the current row, "" for none."""
        index = self.table.currentIndex()
        return self.model.rows[index.row()].name if index.isValid() else ""

    def set_current(self, name: str) -> None:
        """Go to a row without telling; a name that is not there changes nothing."""
        place = self.model.row_of(name)
        if place >= 0 and name != self.current():
            self._told = name
            self.table.setCurrentIndex(self.model.index(place, 0))

    def chosen(self) -> tuple[str, ...]:
        """Names of the selected rows."""
        return tuple(self.model.rows[index.row()].name for index in self.table.selectionModel().selectedRows())

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "table"):
            self.table.viewport().update()

    def _set_up_table(self) -> None:
        table = self.table
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        table.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        table.setShowGrid(False)
        table.setTabKeyNavigation(False)
        table.setWordWrap(False)
        table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        table.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        table.verticalHeader().hide()
        table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        table.verticalHeader().setDefaultSectionSize(row_height(self.fontMetrics()))
        header = table.horizontalHeader()
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.Fixed)
        header.resizeSection(1, 104)
        header.setHighlightSections(False)
        header.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        header.setSortIndicatorClearable(True)
        header.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        table.setSortingEnabled(True)
        table.toggle_wanted.connect(self._toggle_chosen)
        table.check_clicked.connect(self._clicked)
        table.doubleClicked.connect(lambda index: self.activated.emit(self.model.rows[index.row()].name))
        table.selectionModel().currentRowChanged.connect(lambda *_: self._tell_current())

    def _clicked(self, place: int) -> None:
        row = self.model.rows[place]
        self.table.setFocus(Qt.FocusReason.MouseFocusReason)
        self._toggle([row.name], not row.used)

    def _toggle_chosen(self) -> None:
        names = self.chosen() or ((self.current(),) if self.current() else ())
        if names:
            current = self.model.rows[max(self.model.row_of(self.current() or names[0]), 0)]
            self._toggle(names, not current.used)

    def _toggle(self, names: Sequence[str], used: bool) -> None:
        changed = [name for name in names if self.model.rows[self.model.row_of(name)].used != used]
        for name in changed:
            self.model.set_used(self.model.row_of(name), used)
        for name in changed:
            self.toggled.emit(name, used)
        if changed:
            self.toggled_together.emit(tuple(changed), used)

    def _restore(self, chosen: Sequence[str], current: str) -> None:
        selection = self.table.selectionModel()
        place = self.model.row_of(current)
        flags = selection.SelectionFlag
        if place >= 0:
            selection.setCurrentIndex(self.model.index(place, 0), flags.NoUpdate)
        for name in chosen:
            if (row := self.model.row_of(name)) >= 0:
                selection.select(self.model.index(row, 0), flags.Select | flags.Rows)

    def _tell_current(self) -> None:
        current = self.current()
        if current != self._told:
            self._told = current
            self.current_changed.emit(current)
