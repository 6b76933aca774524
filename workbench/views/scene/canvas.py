"""The part of the 3D view that shows the scene: whatever draws it below, the overlay with labels and tools above."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QHideEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QShowEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from workbench.views.scene_view_overlay import Look, paint_sentence, text_plate
from workbench.views.scene_view_tools import Navigate


class Overlay(QWidget):
    """Paints over the scene and takes all mouse and key events."""

    cancelled = Signal()

    def __init__(self, parent: QWidget, tool: Navigate, paint: Callable[[QPainter], None]) -> None:
        super().__init__(parent)
        self._tool, self._paint = tool, paint
        self._message: str | None = None
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)

    @property
    def tool(self) -> Navigate:
        """What the mouse does."""
        return self._tool

    def show_message(self, message: str | None) -> None:
        """Show a sentence on an empty ground instead of the scene; None shows the scene."""
        self._message = message
        self.update()

    def set_tool(self, tool: Navigate) -> None:
        """Let the mouse do something else."""
        self._tool = tool
        self.setCursor(tool.cursor)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        look = Look.of(self.palette())
        if self._message is not None:
            painter.fillRect(self.rect(), look.ground)
            paint_sentence(painter, QRectF(self.rect()), self._message, look)
        else:
            self._paint(painter)
            self._tool.paint(painter, look)
            if self._tool.hint:
                text_plate(painter, QPointF(self.width() / 2, 18), self._tool.hint, look)
        if self.hasFocus():
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(look.accent)
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        self._tool.press(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        self._tool.move(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        self._tool.release(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self._tool.double_click(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        self._tool.wheel(event)
        event.accept()

    def focusInEvent(self, event: QFocusEvent) -> None:
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and type(self._tool) is not Navigate:
            self.cancelled.emit()
        elif not self._tool.key(event):
            super().keyPressEvent(event)


class Canvas(QWidget):
    """Keeps what draws the scene and the overlay as large as itself."""

    shown = Signal()
    hidden = Signal()
    resized = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setMinimumSize(120, 90)
        self._layers: list[QWidget] = []

    def put_below(self, widget: QWidget) -> None:
        """Add what draws the scene."""
        self._layers.insert(0, widget)
        widget.setGeometry(self.rect())
        widget.lower()
        widget.show()

    def put_above(self, widget: QWidget) -> None:
        """Add the overlay."""
        self._layers.append(widget)
        widget.setGeometry(self.rect())
        widget.raise_()
        widget.show()

    def take(self, widget: QWidget) -> None:
        """Let go of a layer, if it is one."""
        if widget in self._layers:
            self._layers.remove(widget)

    def resizeEvent(self, event: QResizeEvent) -> None:
        for widget in self._layers:
            widget.setGeometry(self.rect())
        self.resized.emit()

    def showEvent(self, event: QShowEvent) -> None:
        self.shown.emit()

    def hideEvent(self, event: QHideEvent) -> None:
        self.hidden.emit()
