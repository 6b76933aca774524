"""The picture on the screen: its pixels as a graphics item, and the box that zooms and pans it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QGraphicsItem, QGraphicsSceneWheelEvent, QStyleOptionGraphicsItem, QWidget

from core.image.display import halved

_SIXTEEN_BIT_WHITES = (1023, 4095, 16383, 65535)
"""Grey levels that are white with 10, 12, 14 and 16 bits: what cameras put into 16."""


class PictureItem(QGraphicsItem):
    """Picture drawn with the centre of its first full-resolution pixel at (0, 0).

    Pixels are sharp squares when enlarged and averaged when reduced.
    """

    def __init__(self) -> None:
        super().__init__()
        self.picture: NDArray[Any] | None = None
        self.scale_factor = 1.0
        self.gain, self.gamma = 1.0, 1.0
        self._grey: NDArray[np.uint8] = np.zeros((0, 0), dtype=np.uint8)
        self._shown: list[NDArray[np.uint8]] = []

    @property
    def rect(self) -> QRectF:
        """Rectangle that the picture covers, in full-resolution pixels."""
        if self.picture is None:
            return QRectF()
        rows, columns = self.picture.shape[:2]
        return QRectF(-0.5, -0.5, columns * self.scale_factor, rows * self.scale_factor)

    def set_picture(self, picture: NDArray[Any] | None, scale: float, levels: tuple[float, float] | None) -> None:
        """Show an array as the picture; None shows none. `scale`: full-resolution pixels per array pixel.

        Raises
        ------
        ValueError
            If it is no picture by its shape.
        """
        if picture is not None and (not picture.size or (picture.ndim != 2 and picture.shape[2:] != (3,))):
            raise ValueError(f"an array of shape {picture.shape} is no picture")
        before = self.rect
        self.picture, self.scale_factor = picture, scale
        if self.rect != before:
            self.prepareGeometryChange()
        if picture is not None:
            self._grey = np.ascontiguousarray(_eight_bit(picture, levels))
            self._render()

    def set_tone(self, gain: float, gamma: float) -> None:
        """Set how grey levels are shown: grey · gain, then to the power 1/gamma."""
        if (gain, gamma) != (self.gain, self.gamma):
            self.gain, self.gamma = gain, gamma
            if self.picture is not None:
                self._render()

    def value_at(self, u: float, v: float) -> str:
        """Return the value of the picture's pixel at (u, v) as text; "" outside."""
        if self.picture is None:
            return ""
        column, row = (int(np.floor((x + 0.5) / self.scale_factor)) for x in (u, v))
        rows, columns = self.picture.shape[:2]
        if not (0 <= column < columns and 0 <= row < rows):
            return ""
        value = self.picture[row, column]
        if value.ndim:
            return " ".join(str(int(part)) for part in value)
        return f"{value:.3g}" if value.dtype.kind == "f" else str(int(value))

    def image(self) -> QImage:
        """Return the picture with its tone, in full size."""
        return _wrapped(self._shown[0]).convertToFormat(QImage.Format.Format_RGB32) if self._shown else QImage()

    def boundingRect(self) -> QRectF:
        return self.rect

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        if self.picture is None:
            return
        device = widget.devicePixelRatioF() if widget is not None else 1.0
        on_screen = abs(painter.worldTransform().m11()) * self.scale_factor * device
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, on_screen < 1.0)
        painter.drawImage(self.rect, self._fitting(on_screen))

    def _fitting(self, on_screen: float) -> QImage:
        """The picture, halved as often as it can be without losing what the screen can show."""
        halvings = 0
        while on_screen <= 0.5 and min(self._shown[halvings].shape[:2]) > 8:
            if halvings + 1 == len(self._shown):
                self._shown.append(halved(self._shown[halvings]))
            halvings, on_screen = halvings + 1, on_screen * 2
        return _wrapped(self._shown[halvings])

    def _render(self) -> None:
        """Brighten; the picture stays one byte a pixel and colour, which is quick for tens of millions of pixels."""
        if (self.gain, self.gamma) == (1.0, 1.0):
            self._shown = [self._grey]
        else:
            shown = np.clip(np.arange(256) / 255.0 * self.gain, 0.0, 1.0) ** (1.0 / self.gamma) * 255.0
            self._shown = [np.take(np.round(shown).astype(np.uint8), self._grey)]
        self.update()


def _wrapped(pixels: NDArray[np.uint8]) -> QImage:
    """The pixels as an image that does not copy them."""
    rows, columns = pixels.shape[:2]
    if pixels.ndim == 3:
        return QImage(pixels.data, columns, rows, 3 * columns, QImage.Format.Format_RGB888)
    return QImage(pixels.data, columns, rows, columns, QImage.Format.Format_Grayscale8)


def _eight_bit(picture: NDArray[Any], levels: tuple[float, float] | None) -> NDArray[np.uint8]:
    """Values between the levels as 0 … 255."""
    if picture.dtype == np.uint8 and levels is None:
        return picture
    if picture.dtype == np.bool_:
        return picture.astype(np.uint8) * np.uint8(255)
    low, high = _levels(picture) if levels is None else levels
    width = high - low if high > low else 1.0
    if picture.dtype in (np.uint8, np.uint16):
        values = np.arange(np.iinfo(picture.dtype).max + 1)
        table = np.clip((values - low) * (255.0 / width), 0, 255).astype(np.uint8)
        looked_up: NDArray[np.uint8] = np.take(table, picture)
        return looked_up
    scaled = np.clip((picture - low) * (255.0 / width), 0, 255)
    return np.nan_to_num(scaled, nan=0.0, copy=False).astype(np.uint8)


def _levels(picture: NDArray[Any]) -> tuple[float, float]:
    """Black and white where none are given: a camera's 10, 12, 14 or 16 bits, or what a float picture holds."""
    if picture.dtype == np.uint16:
        brightest = int(picture.max())
        return 0.0, float(next(white for white in _SIXTEEN_BIT_WHITES if brightest <= white))
    finite = picture[np.isfinite(picture)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)


ZOOM_STEP = 1.25
"""One notch of the wheel enlarges by this factor: three double it."""

_MARGIN = 0.01
"""Share of the picture left free round it, so that its edge is seen."""

_LARGEST_PIXEL = 80.0
"""Screen pixels that one of the picture is wide at most: a stripe then still crosses the view."""

_SMALLEST_SHARE = 0.15
"""Of the zoom that shows the whole picture: smaller, it would be lost in the view."""


class PictureBox(pg.ViewBox):  # type: ignore[misc]
    """View box with square pixels and v downwards. It says where the mouse is and does; who listens decides.

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
        """Width of one screen pixel in picture pixels."""
        width = self.width()
        return float(self.viewRect().width() / width) if width > 0 else 1.0

    def fit(self) -> None:
        """Zoom so that the whole picture is shown."""
        if not self.extent.isEmpty():
            self.setRange(self.extent, padding=_MARGIN)

    def show_at_zoom(self, screen_pixels: float, centre: QPointF | None = None) -> None:
        """Zoom so that a picture pixel is `screen_pixels` wide, with `centre` (None: the middle) in the middle."""
        middle = self.viewRect().center() if centre is None else centre
        width, height = self.width() / screen_pixels, self.height() / screen_pixels
        self.setRange(QRectF(middle.x() - width / 2, middle.y() - height / 2, width, height), padding=0)

    def zoom_by(self, factor: float, about: QPointF | None = None) -> None:
        """Enlarge by `factor` about the place `about`; None: about the middle."""
        if self.extent.isEmpty() or self.width() <= 0:
            return
        zoom = 1.0 / self.pixel
        whole = min(self.width() / self.extent.width(), self.height() / self.extent.height())
        wanted = min(max(zoom * factor, _SMALLEST_SHARE * whole), max(_LARGEST_PIXEL, whole))
        self.scaleBy((zoom / wanted, zoom / wanted), about or self.viewRect().center())
        self.zoomed.emit()

    def pan_by(self, right: float, down: float) -> None:
        """Move the view by screen pixels to the right and down."""
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
