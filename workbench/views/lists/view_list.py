"""A list of views, poses or frames to look at, include and leave out: its rows, how one is drawn, and the table."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import (
    QAbstractTableModel,
    QEvent,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QPoint,
    QRect,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import (
    QColor,
    QFontMetrics,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPalette,
    QPixmap,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QWidget,
)

from workbench.language import tr
from workbench.theme import shades
from workbench.views.layouts import in_column

_Index = QModelIndex | QPersistentModelIndex

THUMBNAIL = QSize(56, 42)

VALUE_ROLE = int(Qt.ItemDataRole.UserRole)
"""The row itself."""


@dataclass(frozen=True, eq=False, slots=True)
class ListRow:
    """Row of a view, pose or frame.

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
    """Model of rows with two columns: the item, and its value. Sorted here; the order given comes back at column −1."""

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
        """Rows of the model, as they are sorted now."""
        return self._rows

    def set_headers(self, what: str, value: str) -> None:
        """Set the titles of the two columns."""
        self._headers = (what, value)
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, 1)

    def set_rows(self, rows: Sequence[ListRow]) -> None:
        """Replace all rows; rows with the same names in the same order only change their texts."""
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
        """Check or uncheck the box of the row with this index."""
        new = replace(self._rows[row], used=used)
        self._rows[row] = new
        self._given = tuple(new if given.name == new.name else given for given in self._given)
        self.dataChanged.emit(self.index(row, 0), self.index(row, 1))

    def row_of(self, name: str) -> int:
        """Return the index of the row called `name`; −1 if there is none."""
        return self._places.get(name, -1)

    def rowCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        return 0 if parent.isValid() else len(self._rows)

    def columnCount(self, parent: _Index = QModelIndex()) -> int:  # noqa: B008
        return 0 if parent.isValid() else 2

    def flags(self, index: _Index) -> Qt.ItemFlag:
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return flags | Qt.ItemFlag.ItemIsUserCheckable if index.column() == 0 else flags

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation == Qt.Orientation.Horizontal and role in (
            Qt.ItemDataRole.DisplayRole,
            Qt.ItemDataRole.ToolTipRole,
        ):
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


CHECK_WIDTH = 30
"""A click so near to the left edge means the check box."""

_NARROWEST, _WIDEST, _AROUND_HEADER = 104, 124, 18
"""Pixels of the values' column, which is as wide as its header within these bounds, and of what is beside that."""

_PAD, _BAR = 4, 4
"""Pixels: room beside a text, and height of the bar that shows a value."""


class RowDelegate(QStyledItemDelegate):
    """Delegate that draws check box, thumbnail, name, and below it why it was left out; the value over its bar."""

    thumbnail_missing = Signal(str)
    """Name of a row in sight whose thumbnail comes later."""

    def sizeHint(self, option: QStyleOptionViewItem, index: _Index) -> QSize:
        return QSize(140, row_height(option.fontMetrics))

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: _Index) -> None:
        self.initStyleOption(option, index)
        row: ListRow = index.data(VALUE_ROLE)
        style, s = option.widget.style(), shades()
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        ink = option.palette.color(QPalette.ColorRole.HighlightedText if chosen else QPalette.ColorRole.Text)
        faint = ink if chosen else QColor(s.muted)
        style.drawPrimitive(QStyle.PrimitiveElement.PE_PanelItemViewItem, option, painter, option.widget)
        painter.save()
        if index.column() == 0:
            left = self._draw_check(painter, option, style)
            left = self._draw_thumbnail(painter, option.rect, left, index)
            area = QRect(left, option.rect.top(), option.rect.right() - left - _PAD, option.rect.height())
            second = row.reason if row.reason else ""
            self._draw_lines(painter, area, (index.data(), ink if row.used else faint), (second, faint))
        else:
            self._draw_value(painter, option.rect, row, ink if row.used else faint, chosen)
        painter.restore()

    def _draw_check(self, painter: QPainter, option: QStyleOptionViewItem, style: QStyle) -> int:
        side = style.pixelMetric(QStyle.PixelMetric.PM_IndicatorWidth, option, option.widget)
        box = QStyleOptionViewItem(option)
        middle = option.rect.top() + (option.rect.height() - side) // 2
        box.rect = QRect(QPoint(option.rect.left() + 6, middle), QSize(side, side))
        box.state &= ~QStyle.StateFlag.State_HasFocus
        checked = option.checkState == Qt.CheckState.Checked
        box.state |= QStyle.StateFlag.State_On if checked else QStyle.StateFlag.State_Off
        style.drawPrimitive(QStyle.PrimitiveElement.PE_IndicatorItemViewItemCheck, box, painter, option.widget)
        return option.rect.left() + 6 + side + 8

    def _draw_thumbnail(self, painter: QPainter, cell: QRect, left: int, index: _Index) -> int:
        pixmap: QPixmap | None = index.data(Qt.ItemDataRole.DecorationRole)
        if pixmap is None:
            return self._keep_free(painter, cell, left, index)
        size = QSize(pixmap.size()).scaled(THUMBNAIL, Qt.AspectRatioMode.KeepAspectRatio)
        place = QRect(QPoint(left, cell.top() + (cell.height() - size.height()) // 2), size)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.setOpacity(1.0 if index.data(VALUE_ROLE).used else 0.45)
        painter.drawPixmap(place, pixmap)
        painter.setOpacity(1.0)
        return left + THUMBNAIL.width() + 8

    def _keep_free(self, painter: QPainter, cell: QRect, left: int, index: _Index) -> int:
        """The place of a thumbnail that comes later, if it does."""
        model = self.parent()
        if not isinstance(model, RowsModel) or not model.later:
            return left
        place = QRect(QPoint(left, cell.top() + (cell.height() - THUMBNAIL.height()) // 2), THUMBNAIL)
        painter.fillRect(place, QColor(shades().line))
        self.thumbnail_missing.emit(index.data(VALUE_ROLE).name)
        return left + THUMBNAIL.width() + 8

    def _draw_lines(
        self, painter: QPainter, area: QRect, first: tuple[str, QColor], second: tuple[str, QColor]
    ) -> None:
        metrics = painter.fontMetrics()
        lines = [line for line in (first, second) if line[0]]
        top = area.top() + (area.height() - len(lines) * metrics.height()) // 2
        for text, colour in lines:
            painter.setPen(colour)
            elided = metrics.elidedText(text, Qt.TextElideMode.ElideRight, area.width())
            line = QRect(area.left(), top, area.width(), metrics.height())
            painter.drawText(line, int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter), elided)
            top += metrics.height()

    def _draw_value(self, painter: QPainter, cell: QRect, row: ListRow, ink: QColor, chosen: bool) -> None:
        metrics, s = painter.fontMetrics(), shades()
        area = cell.adjusted(_PAD, 0, -8, 0)
        top = area.top() + (area.height() - metrics.height() - _BAR - 2) // 2
        painter.setPen(ink)
        line = QRect(area.left(), top, area.width(), metrics.height())
        painter.drawText(line, int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter), row.text)
        model = self.parent()
        largest = model.largest if isinstance(model, RowsModel) else 0.0
        if row.value is None or not largest > 0 or not row.value >= 0:
            return
        rail = QRect(area.left(), top + metrics.height() + 2, area.width(), _BAR)
        length = max(1, round(area.width() * min(row.value / largest, 1.0)))
        painter.fillRect(rail, QColor(s.line))
        colour = ink if chosen else QColor(s.accent if row.used else s.muted)
        painter.fillRect(QRect(rail.right() + 1 - length, rail.top(), length, _BAR), colour)


def row_height(metrics: QFontMetrics) -> int:
    """Return the height of a row in px: two lines of text or a thumbnail, whichever is higher."""
    return max(2 * metrics.height() + 2 * _PAD, THUMBNAIL.height() + 6)


class CheckingTable(QTableView):
    """Table that emits clicks on check boxes, which leave the selection alone.

    Its current row stays in sight in a lower table, until it is scrolled away.
    """

    toggle_wanted = Signal()
    check_clicked = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self._follows = False
        self.verticalScrollBar().valueChanged.connect(self._scrolled)

    def currentChanged(self, current: _Index, previous: _Index) -> None:
        super().currentChanged(current, previous)
        self._follows = True

    def resizeEvent(self, event: QResizeEvent) -> None:
        follows = self._follows  # a lower table is scrolled by Qt, too
        super().resizeEvent(event)
        self._follows = follows
        if follows:
            self.scrollTo(self.currentIndex())

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

    def _scrolled(self) -> None:
        self._follows = self.viewport().rect().intersects(self.visualRect(self.currentIndex()))

    def _check_at(self, event: QMouseEvent) -> int:
        index = self.indexAt(event.position().toPoint())
        left = event.button() == Qt.MouseButton.LeftButton and event.position().x() <= CHECK_WIDTH
        return index.row() if left and index.isValid() and index.column() == 0 else -1


class ViewList(QWidget):
    """List of rows with a check box each; Space checks or unchecks all chosen rows. Headers sort, a third click as
    given.
    """

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
        self.set_headers(tr("View"), tr("Error"))
        self.setFocusProxy(self.table)
        in_column(self.table, on=self)

    def set_headers(self, what: str, value: str) -> None:
        """Set the titles of the two columns: the items, and the value with its unit."""
        self.model.set_headers(what, value)
        self.table.setAccessibleName(what)
        header = self.table.horizontalHeader()
        header.ensurePolished()
        needed = header.fontMetrics().horizontalAdvance(value) + _AROUND_HEADER
        header.resizeSection(1, min(max(needed, _NARROWEST), _WIDEST))

    def set_rows(self, rows: Sequence[ListRow]) -> None:
        """Show these rows; selection, current row and scrolling are kept."""
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
        """Return all rows of the list."""
        return tuple(self.model.rows)

    def current(self) -> str:
        """Return the name of the current row; "" if there is none."""
        index = self.table.currentIndex()
        return self.model.rows[index.row()].name if index.isValid() else ""

    def set_current(self, name: str) -> None:
        """Make the row called `name` the current one, without emitting; an unknown name changes nothing."""
        place = self.model.row_of(name)
        if place >= 0 and name != self.current():
            self._told = name
            self.table.setCurrentIndex(self.model.index(place, 0))

    def chosen(self) -> tuple[str, ...]:
        """Return the names of the rows that are selected."""
        return tuple(self.model.rows[index.row()].name for index in self.table.selectionModel().selectedRows())

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
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
        header.setTextElideMode(Qt.TextElideMode.ElideRight)  # else Qt cuts what is right-aligned at its beginning
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
