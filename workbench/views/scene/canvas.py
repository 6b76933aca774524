"""The part of the 3D view that shows the scene: its picture, what is written over it, and the tool in hand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QHideEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QShowEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from workbench.views.common import inner_edge
from workbench.views.scene.overlay import OverlayColours, paint_hint, paint_sentence
from workbench.views.scene.tools import Navigate


class Canvas(QWidget):
    """Widget with the picture drawn last, stretched until a new one comes; it passes mouse and keys to the tool.

    `paint` paints labels, colour bar and axes over the picture; `taken` tells how many pixels at the right the bar
    takes.
    """

    shown = Signal()
    hidden = Signal()
    resized = Signal()
    cancelled = Signal()
    """Esc was pressed while a tool other than turning the view was in hand."""

    def __init__(
        self, tool: Navigate, paint: Callable[[QPainter], None], taken: Callable[[], int], parent: QWidget
    ) -> None:
        super().__init__(parent)
        self.tool, self._paint, self._taken = tool, paint, taken
        self._message: str | None = None
        self._picture: QImage | None = None
        self.edges: QImage | None = None
        """Lines to be drawn over the picture, transparent elsewhere; None: none."""
        self.embedded = False
        """Whether an OpenGL widget below shows the scene; else the picture given is shown."""
        self.setMinimumSize(120, 90)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)

    @property
    def logical_size(self) -> tuple[int, int]:
        """Width and height of the canvas in logical pixels."""
        return max(self.width(), 2), max(self.height(), 2)

    @property
    def device_size(self) -> tuple[int, int]:
        """Width and height of the canvas in device pixels."""
        width, height = self.logical_size
        ratio = self.devicePixelRatioF()
        return round(width * ratio), round(height * ratio)

    def show_picture(self, pixels: NDArray[np.uint8]) -> None:
        """Show a picture (h, w, 3) of the scene."""
        self._picture = as_image(pixels)
        self.update()

    def show_message(self, message: str | None) -> None:
        """Show a sentence in place of the scene; None shows the scene."""
        self._message = message
        self.update()

    def set_tool(self, tool: Navigate) -> None:
        """Set the tool that gets mouse and keys, and paints over the scene."""
        self.tool = tool
        self.setCursor(tool.cursor)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        colours = OverlayColours.of(self.palette())
        if self._message is not None:
            painter.fillRect(self.rect(), colours.ground)
            paint_sentence(painter, QRectF(self.rect()), self._message, colours)
        else:
            if self._picture is not None and not self.embedded:
                painter.drawImage(self.rect(), self._picture)
            if self.edges is not None:
                painter.drawImage(self.rect(), self.edges)
            self._paint(painter)
            self.tool.paint(painter, colours)
            if self.tool.hint:
                paint_hint(painter, self.tool.hint, self.width() - self._taken(), colours)
        if self.hasFocus():
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(colours.accent)
            painter.drawRect(inner_edge(self))
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        self.tool.press(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        self.tool.move(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        self.tool.release(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self.tool.double_click(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        self.tool.wheel(event)
        event.accept()

    def focusInEvent(self, event: QFocusEvent) -> None:
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and type(self.tool) is not Navigate:
            self.cancelled.emit()
        elif not self.tool.key(event):
            super().keyPressEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        self.resized.emit()

    def showEvent(self, event: QShowEvent) -> None:
        self.shown.emit()

    def hideEvent(self, event: QHideEvent) -> None:
        self.hidden.emit()


def as_image(pixels: NDArray[np.uint8]) -> QImage:
    """Convert pixels (h, w, 3), uint8, to a QImage."""
    height, width = pixels.shape[:2]
    return QImage(np.ascontiguousarray(pixels).data, width, height, 3 * width, QImage.Format.Format_RGB888).copy()


def as_lines(opacity: NDArray[np.uint8]) -> QImage:
    """Make an image with dark lines of the given opacity (h, w), uint8, and transparent elsewhere."""
    height, width = opacity.shape
    dark = np.zeros((height, width, 4), dtype=np.uint8)
    dark[:, :, 3] = opacity
    return QImage(dark.data, width, height, 4 * width, QImage.Format.Format_RGBA8888).copy()


def as_pixels(image: QImage) -> NDArray[np.uint8]:
    """Convert a QImage to pixels (h, w, 3), uint8."""
    rgb = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(rgb.constBits(), dtype=np.uint8)[: rgb.bytesPerLine() * rgb.height()]
    return rows.reshape(rgb.height(), rgb.bytesPerLine())[:, : 3 * rgb.width()].reshape(rgb.height(), -1, 3).copy()
