"""Pages of a document below each other, as wide as there is room or as the eye wants them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QImage, QPixmap, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QLabel, QScrollArea, QVBoxLayout, QWidget

WIDEST_PX = 1000
NARROWEST_PX = 300


class PageScroll(QScrollArea):
    """Shows pages; Ctrl and the wheel make them larger or smaller."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._pages: list[QPixmap] = []
        self._labels: list[QLabel] = []
        self._zoom = 1.0
        inside = QWidget()
        self._column = QVBoxLayout(inside)
        self._column.setSpacing(14)
        self._column.setAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
        self.setWidget(inside)
        self.setWidgetResizable(True)
        self._message = QLabel()
        self._message.setObjectName("muted")
        self._message.setWordWrap(True)
        self._message.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._message.setMinimumHeight(240)
        self._column.addWidget(self._message)
        self.setAccessibleName(self.tr("Pages of the report"))

    def set_pages(self, pages: Sequence[NDArray[np.uint8]]) -> None:
        """Show pages (h, w, 3); the place looked at stays."""
        place = self.verticalScrollBar().value()
        self._pages = [_pixmap(page) for page in pages]
        while len(self._labels) > len(self._pages):
            label = self._labels.pop()
            self._column.removeWidget(label)
            label.deleteLater()
        while len(self._labels) < len(self._pages):
            label = QLabel()
            label.setStyleSheet("border: 1px solid palette(mid);")
            label.setAccessibleName(self.tr("Page {0}").format(len(self._labels) + 1))
            self._column.addWidget(label, 0, Qt.AlignmentFlag.AlignHCenter)
            self._labels.append(label)
        self._message.setVisible(not self._pages)
        self._fit()
        self.verticalScrollBar().setValue(place)

    def set_message(self, text: str) -> None:
        """What is said where there are no pages."""
        self._message.setText(text)

    def count(self) -> int:
        """How many pages are shown."""
        return len(self._pages)

    def zoom(self, factor: float) -> None:
        """Make the pages larger or smaller."""
        self._zoom = min(max(self._zoom * factor, 0.5), 2.5)
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.zoom(1.1 if event.angleDelta().y() > 0 else 1 / 1.1)
            event.accept()
        else:
            super().wheelEvent(event)

    def event(self, event: QEvent) -> Any:
        if event.type() == QEvent.Type.DevicePixelRatioChange:
            self._fit()
        return super().event(event)

    def _fit(self) -> None:
        ratio = self.devicePixelRatioF()
        room = self.viewport().width() - 40
        width = max(NARROWEST_PX, min(room, WIDEST_PX) * self._zoom)
        for label, page in zip(self._labels, self._pages, strict=True):
            shown = page.scaledToWidth(round(width * ratio), Qt.TransformationMode.SmoothTransformation)
            shown.setDevicePixelRatio(ratio)
            label.setPixmap(shown)


def _pixmap(page: NDArray[np.uint8]) -> QPixmap:
    page = np.ascontiguousarray(page)
    height, width, _ = page.shape
    return QPixmap.fromImage(QImage(page.data, width, height, 3 * width, QImage.Format.Format_RGB888))
