"""A grid of values over the picture, and the key of its colours."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pyqtgraph as pg
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QGraphicsRectItem, QHBoxLayout, QLabel, QSizePolicy, QWidget

from workbench.language import tr
from workbench.theme import shades
from workbench.views.colours import sigma_table, to_rgba
from workbench.views.plots.base import Plot, small_font, written
from workbench.views.scene.colours import table, ticks

_BAR = 14
"""Width of the bar in pixels."""


class ColourBar(QWidget):
    """Vertical colour bar with ticks."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._colours: NDArray[np.uint8] = np.zeros((0, 3), dtype=np.uint8)
        self._limits, self.title = (0.0, 1.0), ""
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self.setFixedWidth(64)

    def set_scale(self, colours: NDArray[np.uint8], limits: tuple[float, float], title: str) -> None:
        """Show the colours (K, 3), uint8, of values from the lower to the upper of `limits`, under a title."""
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


MapName = Literal["viridis", "plasma", "deviation", "sigma"]


class HeatMap(Plot):
    """Map of values of cells that cover the picture evenly, with the colour bar beside; NaN is left blank."""

    def __init__(self, parent: QWidget | None = None) -> None:
        self._values = np.zeros((0, 0))
        self._size, self._limits = (1, 1), (0.0, 1.0)
        self._label, self._unit, self._colour_map = "", "", "viridis"
        self.bar, self._heading = ColourBar(), QLabel()  # before the rest, which begins by clearing them
        super().__init__(parent, least_height=200)
        self._heading.setObjectName("muted")
        self._heading.setAlignment(Qt.AlignmentFlag.AlignRight)
        self._column.insertWidget(0, self._heading)
        row = QHBoxLayout()
        row.setSpacing(4)
        self._column.removeWidget(self._field)
        row.addWidget(self._field, 1)
        row.addWidget(self.bar)
        self._column.addLayout(row, 1)
        self.bar.hide()

    def set_map(
        self,
        values: ArrayLike,
        *,
        size: tuple[int, int],
        label: str,
        unit: str,
        colour_map: MapName = "viridis",
    ) -> None:
        """Show values (rows, columns) over a picture of `size` (width, height) in px; row 0 is at the top."""
        self._values = np.asarray(values, dtype=np.float64)
        finite = self._values[np.isfinite(self._values)]
        if self._values.ndim != 2 or not finite.size:
            self.clear(self._empty.message)
            return
        low, high = float(finite.min()), float(finite.max())
        self._limits = (low, high if high > low else low + max(abs(low), 1e-3))
        self._size, self._label, self._unit, self._colour_map = size, label, unit, colour_map
        self._redraw()

    def clear(self, message: str = "") -> None:
        self._values = np.zeros((0, 0))
        self.bar.hide()
        self._heading.clear()
        super().clear(message)

    def _has_data(self) -> bool:
        return self._values.size > 0

    def _draw(self) -> None:
        width, height = self._size
        s = shades()
        self._set_axis("bottom", "u", "px")
        self._set_axis("left", "v", "px")
        self._box.setAspectLocked(True)
        self._box.invertY(True)
        colours = sigma_table()[:, :3] if self._colour_map == "sigma" else table(self._colour_map)
        extent = QRectF(-0.5, -0.5, width, height)
        item = pg.ImageItem(self._painted(colours), axisOrder="row-major")
        item.setRect(extent)
        self._item.addItem(item, ignoreBounds=True)
        frame = QGraphicsRectItem(extent)
        frame.setPen(self._pen(s.line, 1))
        self._item.addItem(frame, ignoreBounds=True)
        self._box.setRange(extent, padding=0.02)
        title = f"{self._label} [{self._unit}]" if self._unit else self._label
        self._heading.setText(title)
        self.bar.set_scale(colours, self._limits, title)
        self.bar.show()

    def _painted(self, colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
        low, high = self._limits
        known = np.isfinite(self._values)
        scaled = np.clip((np.where(known, self._values, low) - low) / (high - low) * 255.999, 0, 255).astype(np.uint8)
        painted = np.full((*self._values.shape, 4), 255, dtype=np.uint8)
        painted[..., :3] = colours[scaled]
        painted[~known] = to_rgba(shades().window)
        return painted

    def _tip(self, x: float, y: float) -> str:
        rows, columns = self._values.shape
        column = int(np.floor((x + 0.5) / self._size[0] * columns))
        row = int(np.floor((y + 0.5) / self._size[1] * rows))
        if not (0 <= row < rows and 0 <= column < columns):
            return ""
        value = float(self._values[row, column])
        low, high = self._limits
        said = tr("no value") if np.isnan(value) else f"{written(value, (high - low) / 500)} {self._unit}"
        return f"u {x:.0f} px, v {y:.0f} px: {said}"
