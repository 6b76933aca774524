"""One page of a document."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import QWidget

from workbench.language import tr
from workbench.theme import shades

DIM = 0.45
"""Opacity of a page that is no longer what it should say."""


class PageSheet(QWidget):
    """One page. Drawn quickly until `sharpen` has scaled it well."""

    def __init__(self, page: NDArray[np.uint8], number: int) -> None:
        super().__init__()
        self._page = np.ascontiguousarray(page)
        height, width, _ = self._page.shape
        self._image = QImage(self._page.data, width, height, 3 * width, QImage.Format.Format_RGB888)
        self._sharp: QPixmap | None = None
        self._dim = False
        self.setAccessibleName(tr("Page {number}", number=number))

    @property
    def is_sharp(self) -> bool:
        """Whether the page is scaled well at its present size."""
        return self._sharp is not None and self._sharp.size() == self._wanted()

    def sharpen(self) -> None:
        """Scale the page well: some ten milliseconds."""
        wanted, ratio = self._wanted(), self.devicePixelRatioF()
        mode = Qt.TransformationMode.SmoothTransformation
        self._sharp = QPixmap.fromImage(self._image.scaled(wanted, Qt.AspectRatioMode.IgnoreAspectRatio, mode))
        self._sharp.setDevicePixelRatio(ratio)
        self.update()

    def set_width(self, width: int) -> None:
        """Be so wide, in the page's proportions."""
        size = QSize(width, round(width * self._image.height() / self._image.width()))
        if size != self.size():
            self.setFixedSize(size)

    def set_dim(self, dim: bool) -> None:
        """Whether the page is no longer what it should say."""
        if dim != self._dim:
            self._dim = dim
            self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setClipRect(event.rect())
        if self._dim:
            painter.setOpacity(DIM)
        if self._sharp is not None and self.is_sharp:
            painter.drawPixmap(0, 0, self._sharp)
        else:
            painter.drawImage(self.rect(), self._image)
        painter.setOpacity(1.0)
        painter.setPen(QColor(shades().line))
        painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()

    def _wanted(self) -> QSize:
        return self.size() * self.devicePixelRatioF()
