"""The key of a colour map: which colour is which value."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from workbench.theme import shades
from workbench.views.plots.base import small_font
from workbench.views.scene.colours import ticks

_BAR = 14
"""Width of the bar in pixels."""


class ColourBar(QWidget):
    """A vertical bar with ticks."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._colours: NDArray[np.uint8] = np.zeros((0, 3), dtype=np.uint8)
        self._limits, self.title = (0.0, 1.0), ""
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self.setFixedWidth(64)

    def set_scale(self, colours: NDArray[np.uint8], limits: tuple[float, float], title: str) -> None:
        """Colours (K, 3) from low to high, their limits, and what they mean."""
        self._colours, self._limits, self.title = colours, limits, title
        self.setToolTip(title)
        self.setAccessibleName(title)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        if not len(self._colours):
            return
        painter, s = QPainter(self), shades()
        painter.setFont(small_font())
        line = painter.fontMetrics().height()
        bar = QRectF(4, line / 2 + 2, _BAR, self.height() - 2 * line - 24)
        pixels = np.ascontiguousarray(np.column_stack([self._colours[::-1, :3], np.full(len(self._colours), 255)]))
        pixels = pixels.astype(np.uint8)
        painter.drawImage(bar, QImage(pixels.data, 1, len(pixels), 4, QImage.Format.Format_RGBA8888))
        painter.setPen(s.line)
        painter.drawRect(bar)
        painter.setPen(s.muted)
        low, high = self._limits
        for value, text in zip(*ticks(low, high, max(2, int(bar.height() / (2.2 * line)))), strict=True):
            y = bar.bottom() - bar.height() * (value - low) / (high - low)
            painter.drawLine(round(bar.right()), round(y), round(bar.right()) + 3, round(y))
            place = QRectF(bar.right() + 7, y - line / 2, self.width(), line)
            painter.drawText(place, int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter), text)
        painter.end()
