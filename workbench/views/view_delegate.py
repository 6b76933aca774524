"""How a row of a list of views is drawn."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPalette, QPixmap
from PySide6.QtWidgets import QStyle, QStyledItemDelegate, QStyleOptionViewItem

from workbench.theme import shades
from workbench.views.view_rows import THUMBNAIL, VALUE_ROLE, ListRow, RowsModel

CHECK_WIDTH = 30
"""A click so near to the left edge means the check box."""

_PAD, _BAR = 4, 4
_Index = QModelIndex | QPersistentModelIndex


class RowDelegate(QStyledItemDelegate):
    """Check box, thumbnail, name, and below it why it was left out; the value over its bar."""

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
    """Two lines of text, or a thumbnail."""
    return max(2 * metrics.height() + 2 * _PAD, THUMBNAIL.height() + 6)
