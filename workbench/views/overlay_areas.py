"""Layers of areas and texts over a picture: grid cells, regions, words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from workbench.views.colours import ColourLike, KeySign, to_colour, to_rgba
from workbench.views.labels import draw_label
from workbench.views.overlays import Layer, as_points, cosmetic
from workbench.views.symbols import RIM

Grip = int | Literal["whole"]
"""What is dragged of a region: the corner of this number, or all of it."""

_REACH = 9.0
_HANDLE = 4.5
_TINT = 70
_NARROWEST = 12
"""Cells narrower than so many screen pixels are shown without the lines between them."""


class CellsLayer(Layer):
    """Cells of a grid over the whole picture, tinted where True."""

    def __init__(self, grid: ArrayLike, colour: ColourLike, extent: Callable[[], QRectF], title: str) -> None:
        super().__init__(title)
        self._colour, self._extent = colour, extent
        cells = np.atleast_2d(np.asarray(grid, dtype=bool))
        tint = to_colour(colour)
        tint = QColor(tint.red(), tint.green(), tint.blue(), _TINT if tint.alpha() == 255 else tint.alpha())
        pixels = np.where(cells, np.uint32(tint.rgba()), np.uint32(0)).astype(np.uint32)
        rows, columns = cells.shape
        self._image = QImage(pixels.data, columns, rows, 4 * columns, QImage.Format.Format_ARGB32).copy()

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        return "s", self._colour

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        extent = self._extent()
        if extent.isEmpty() or self._image.isNull():
            return
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, False)
        painter.drawImage(extent, self._image)
        columns, rows = self._image.width(), self._image.height()
        if abs(painter.worldTransform().m11()) * extent.width() < _NARROWEST * columns:
            return  # a grid so fine would hide the picture
        painter.setPen(cosmetic((*to_rgba(self._colour)[:3], 45), 1.0, widget))
        for x in np.linspace(extent.left(), extent.right(), columns + 1):
            painter.drawLine(QPointF(x, extent.top()), QPointF(x, extent.bottom()))
        for y in np.linspace(extent.top(), extent.bottom(), rows + 1):
            painter.drawLine(QPointF(extent.left(), y), QPointF(extent.right(), y))


class TextLayer(Layer):
    """Words at places."""

    def __init__(self, texts: Sequence[tuple[float, float, str]], colour: ColourLike) -> None:
        super().__init__()
        self._texts, self._colour = [(QPointF(u, v), text) for u, v, text in texts], to_colour(colour)

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        transform = painter.worldTransform()
        painter.resetTransform()
        for place, text in self._texts:
            draw_label(painter, transform.map(place), text, self._colour)


class PolygonLayer(Layer):
    """A closed region; with handles at its corners and in its middle when it can be edited."""

    def __init__(self, uv: ArrayLike, colour: ColourLike, editable: bool, title: str) -> None:
        super().__init__(title)
        self.uv = as_points(uv).copy()
        self.editable = editable
        self._colour = colour

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        return "line", self._colour

    @property
    def middle(self) -> QPointF:
        """Where the whole is taken hold of: the mean of the corners."""
        return QPointF(*self.uv.mean(axis=0)) if len(self.uv) else QPointF()

    def grip_at(self, u: float, v: float, pixel: float) -> Grip | None:
        """What of the region can be dragged from (u, v), where a screen pixel is `pixel` wide."""
        if not self.editable or not len(self.uv):
            return None
        distance = np.hypot(self.uv[:, 0] - u, self.uv[:, 1] - v)
        nearest = int(np.argmin(distance))
        if distance[nearest] <= _REACH * pixel:
            return nearest
        middle = self.middle
        return "whole" if np.hypot(middle.x() - u, middle.y() - v) <= _REACH * pixel else None

    def drag(self, grip: Grip, du: float, dv: float) -> None:
        """Move a corner or the whole."""
        chosen = slice(None) if grip == "whole" else grip
        self.uv[chosen] += (du, dv)
        self.update()

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        if not len(self.uv):
            return
        transform = painter.worldTransform()
        painter.resetTransform()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        outline = transform.map(QPolygonF([QPointF(u, v) for u, v in self.uv]))
        colour = to_colour(self._colour)
        painter.setBrush(QColor(colour.red(), colour.green(), colour.blue(), 45))
        painter.setPen(QPen(RIM, 3.2))
        painter.drawPolygon(outline)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(colour, 1.6))
        painter.drawPolygon(outline)
        if self.editable:
            painter.setPen(QPen(RIM, 1.0))
            painter.setBrush(colour)
            for corner in outline.toList():
                painter.drawRect(QRectF(corner.x() - _HANDLE, corner.y() - _HANDLE, 2 * _HANDLE, 2 * _HANDLE))
            painter.drawEllipse(transform.map(self.middle), _HANDLE, _HANDLE)
