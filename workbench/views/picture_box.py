"""The coordinates of a picture on the screen: zoom about the cursor, drag to pan, and what the mouse means."""

from __future__ import annotations

from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtWidgets import QGraphicsSceneWheelEvent

ZOOM_STEP = 1.25
_MARGIN = 0.01
_LARGEST_PIXEL = 80.0
_SMALLEST_SHARE = 0.15


class PictureBox(pg.ViewBox):  # type: ignore[misc]
    """A view box with square pixels and v downwards. It says where the mouse is and does; who listens decides.

    Places are (u, v) in full-resolution pixels.
    """

    clicked = Signal(QPointF, object)
    """Place and button."""

    double_clicked = Signal(QPointF)

    dragged = Signal(QPointF, QPointF, str)
    """Place, movement since the last, and "start", "on" or "end"; only while `claim_drag` said yes."""

    hovered = Signal(object)
    """Place, or None when the mouse has left."""

    zoomed = Signal()
    """The user has zoomed or panned."""

    def __init__(self) -> None:
        super().__init__(lockAspect=True, invertY=True, enableMenu=False, defaultPadding=0.0)
        self.disableAutoRange()
        self.setFlag(self.GraphicsItemFlag.ItemIsFocusable, False)
        self.claim_drag: Any = lambda _place: False
        self._claimed = False
        self.extent = QRectF()
        """What the picture covers; zooming and panning do not lose it."""

    @property
    def pixel(self) -> float:
        """How many picture pixels one screen pixel is wide."""
        width = self.width()
        return float(self.viewRect().width() / width) if width > 0 else 1.0

    def fit(self) -> None:
        """Show all of it."""
        if not self.extent.isEmpty():
            self.setRange(self.extent, padding=_MARGIN)

    def show_at_zoom(self, screen_pixels: float, centre: QPointF | None = None) -> None:
        """Make a picture pixel this many screen pixels wide, with a place (or the middle) kept in the middle."""
        middle = self.viewRect().center() if centre is None else centre
        width, height = self.width() / screen_pixels, self.height() / screen_pixels
        self.setRange(QRectF(middle.x() - width / 2, middle.y() - height / 2, width, height), padding=0)

    def zoom_by(self, factor: float, about: QPointF | None = None) -> None:
        """Enlarge, a place (or the middle) staying where it is."""
        if self.extent.isEmpty() or self.width() <= 0:
            return
        zoom = 1.0 / self.pixel
        whole = min(self.width() / self.extent.width(), self.height() / self.extent.height())
        wanted = min(max(zoom * factor, _SMALLEST_SHARE * whole), max(_LARGEST_PIXEL, whole))
        self.scaleBy((zoom / wanted, zoom / wanted), about or self.viewRect().center())
        self.zoomed.emit()

    def pan_by(self, right: float, down: float) -> None:
        """Move the view by screen pixels."""
        self._move(right * self.pixel, down * self.pixel)

    def wheelEvent(self, event: QGraphicsSceneWheelEvent, axis: int | None = None) -> None:
        self.zoom_by(ZOOM_STEP ** (event.delta() / 120.0), self.mapSceneToView(event.scenePos()))
        event.accept()

    def mouseClickEvent(self, event: Any) -> None:
        event.accept()
        place = self.mapSceneToView(event.scenePos())
        if event.double() and event.button() == Qt.MouseButton.LeftButton:
            self.double_clicked.emit(place)
        else:
            self.clicked.emit(place, event.button())

    def mouseDragEvent(self, event: Any, axis: int | None = None) -> None:
        event.accept()
        place, last = self.mapSceneToView(event.scenePos()), self.mapSceneToView(event.lastScenePos())
        if event.isStart():
            start = self.mapSceneToView(event.buttonDownScenePos())
            self._claimed = event.button() == Qt.MouseButton.LeftButton and bool(self.claim_drag(start))
            if self._claimed:
                self.dragged.emit(start, QPointF(0, 0), "start")
                last = start
        if self._claimed:
            self.dragged.emit(place, place - last, "end" if event.isFinish() else "on")
        elif event.button() in (Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton):
            self._move(last.x() - place.x(), last.y() - place.y())

    def hoverEvent(self, event: Any) -> None:
        self.hovered.emit(None if event.isExit() else self.mapSceneToView(event.scenePos()))

    def _move(self, du: float, dv: float) -> None:
        """Move the view; its middle stays on the picture."""
        middle, extent = self.viewRect().center(), self.extent
        u = min(max(middle.x() + du, extent.left()), extent.right())
        v = min(max(middle.y() + dv, extent.top()), extent.bottom())
        self.translateBy(x=u - middle.x(), y=v - middle.y())
        self.zoomed.emit()
