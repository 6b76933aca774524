"""A widget that shows one picture of the scene."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QImage, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QWidget


class PictureWidget(QWidget):
    """Shows one picture, stretched to its size until a new one comes."""

    def __init__(self, parent: QWidget, draw_now: Callable[[], None]) -> None:
        super().__init__(parent)
        self._draw_now = draw_now
        self._pixels: NDArray[np.uint8] = np.zeros((1, 1, 3), dtype=np.uint8)

    @property
    def pixels(self) -> NDArray[np.uint8]:
        """What is shown, (h, w, 3)."""
        return self._pixels

    @property
    def device_size(self) -> tuple[int, int]:
        """Width and height in device pixels."""
        ratio = self.devicePixelRatioF()
        return max(1, round(self.width() * ratio)), max(1, round(self.height() * ratio))

    def show_pixels(self, pixels: NDArray[np.uint8]) -> None:
        """Show (h, w, 3) uint8."""
        self._pixels = np.ascontiguousarray(pixels)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        height, width = self._pixels.shape[:2]
        image = QImage(self._pixels.data, width, height, 3 * width, QImage.Format.Format_RGB888)
        painter = QPainter(self)
        painter.drawImage(self.rect(), image)
        painter.end()

    def resizeEvent(self, event: QResizeEvent) -> None:
        self._draw_now()


def image_pixels(image: QImage) -> NDArray[np.uint8]:
    """A copy of a picture as (h, w, 3)."""
    rgb = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(rgb.constBits(), dtype=np.uint8)[: rgb.bytesPerLine() * rgb.height()]
    return rows.reshape(rgb.height(), rgb.bytesPerLine())[:, : 3 * rgb.width()].reshape(rgb.height(), -1, 3).copy()


def pixels_image(pixels: NDArray[np.uint8]) -> QImage:
    """A picture from (h, w, 3)."""
    height, width = pixels.shape[:2]
    return QImage(np.ascontiguousarray(pixels).tobytes(), width, height, 3 * width, QImage.Format.Format_RGB888).copy()
