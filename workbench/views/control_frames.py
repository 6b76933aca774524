"""Feature control frames and datum letters as drawings have them, in lists and forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QIcon, QIconEngine, QPainter, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import QApplication, QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from core.inspect.plan.control_frame import STROKES
from core.inspect.plan.feature_kind import ToleranceSymbol
from workbench.theme import shades

FRAMES_ROLE = Qt.ItemDataRole.UserRole + 1
"""Frames that an item of a list shows in place of its icon."""
SHORT_ROLE = Qt.ItemDataRole.UserRole + 2
"""Words that an item of a list shows where there is no room for all; its tip is to tell these."""
HEIGHT, GAP, PADDING = 16, 5, 3
"""Of a frame, between two, and beside its letters, in logical pixels."""
LETTERS = 0.8
"""Of the height are the letters' line."""


@dataclass(frozen=True, slots=True)
class Frame:
    """Feature control frame, a row of boxes: a symbol, unless it is a datum's letter alone, and texts."""

    symbol: ToleranceSymbol | None
    cells: tuple[str, ...]

    def __str__(self) -> str:
        return " | ".join(self.cells)


class FramesIcon(QIconEngine):
    """Icon of frames beside each other, of their own size, in the colours of the theme in use."""

    def __init__(self, frames: Sequence[Frame]) -> None:
        super().__init__()
        self._frames = tuple(frames)
        self._font = QFont(QApplication.font())
        self._font.setPixelSize(round(LETTERS * HEIGHT))
        metrics = QFontMetricsF(self._font)
        self._widths = [
            [float(HEIGHT)] * (one.symbol is not None)
            + [max(float(HEIGHT), metrics.horizontalAdvance(cell) + 2 * PADDING) for cell in one.cells]
            for one in self._frames
        ]

    @property
    def size(self) -> QSize:
        """Size of the icon with all frames, in logical pixels."""
        width = sum(map(sum, self._widths)) + GAP * (len(self._frames) - 1)
        return QSize(round(width) + 1, HEIGHT + 1)

    def paint(self, painter: QPainter, rect: QRect, mode: QIcon.Mode, state: QIcon.State) -> None:
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        ink = QColor(shades().on_accent if mode == QIcon.Mode.Selected else shades().text)
        painter.setPen(QPen(ink, 1.0))
        painter.setFont(self._font)
        share = min(1.0, rect.width() / self.size.width(), rect.height() / self.size.height())
        painter.translate(rect.x() + 0.5, rect.y() + 0.5 + max(0.0, (rect.height() - share * self.size.height()) / 2))
        painter.scale(share, share)
        x = 0.0
        for frame, widths in zip(self._frames, self._widths, strict=True):
            texts = iter(frame.cells)
            for number, width in enumerate(widths):
                box = QRectF(x, 0.0, width, HEIGHT)
                painter.drawRect(box)
                if frame.symbol is not None and number == 0:
                    self._draw_symbol(painter, frame.symbol, box)
                else:
                    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, next(texts))
                x += width
            x += GAP
        painter.restore()

    def pixmap(self, size: QSize, mode: QIcon.Mode, state: QIcon.State) -> QPixmap:
        drawn = QPixmap(size)
        drawn.fill(Qt.GlobalColor.transparent)
        painter = QPainter(drawn)
        self.paint(painter, QRect(0, 0, size.width(), size.height()), mode, state)
        painter.end()
        return drawn

    @staticmethod
    def _draw_symbol(painter: QPainter, symbol: ToleranceSymbol, box: QRectF) -> None:
        side = box.height()
        for line in STROKES[symbol]:
            painter.drawPolyline([QPointF(box.x() + side * x, side * (1 - y)) for x, y in line])


class FramesMark(QWidget):
    """Frames in a form; of constant height."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.frames: tuple[Frame, ...] = ()
        self.setFixedHeight(HEIGHT + 2)

    def show_frames(self, frames: Sequence[Frame]) -> None:
        """Show these feature control frames and datum letters side by side."""
        if tuple(frames) == self.frames:
            return
        self.frames = tuple(frames)
        self.setAccessibleName("; ".join(map(str, frames)))
        self.setFixedWidth(FramesIcon(frames).size.width() if frames else 0)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        FramesIcon(self.frames).paint(painter, self.rect(), QIcon.Mode.Normal, QIcon.State.Off)
        painter.end()


class FramesDelegate(QStyledItemDelegate):
    """Delegate that shows an item's frames in place of its icon, and its shorter words where there is no room."""

    def initStyleOption(self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex) -> None:
        super().initStyleOption(option, index)
        frames = index.data(FRAMES_ROLE)
        if frames:
            engine = FramesIcon(frames)
            option.features |= QStyleOptionViewItem.ViewItemFeature.HasDecoration
            option.decorationSize = engine.size
            option.icon = QIcon(engine)
        short = index.data(SHORT_ROLE)
        if short and option.fontMetrics.horizontalAdvance(option.text) > _room(option):
            option.text = short


def _room(option: QStyleOptionViewItem) -> int:
    """For the words of an item, in logical pixels."""
    style = option.widget.style()
    margin = style.pixelMetric(QStyle.PixelMetric.PM_FocusFrameHMargin, option, option.widget) + 1
    words = style.subElementRect(QStyle.SubElement.SE_ItemViewItemText, option, option.widget)
    return words.width() - 2 * margin
