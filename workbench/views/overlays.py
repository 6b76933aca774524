"""Layers over a picture: one graphics item each, however many points it has. Layers of points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pyqtgraph.Qt import internals
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter, QPen, QPixmap, QTransform
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from workbench.views.colours import EXCLUDED, ColourLike, KeySign, Symbol, to_colour, to_rgba
from workbench.views.symbols import symbol_pixmap

Points = NDArray[np.float64]

_EVERYWHERE = QRectF(-1e6, -1e6, 2e6, 2e6)
_REACH = 8.0


class Layer(QGraphicsItem):
    """One layer. Its points are full-resolution pixels; symbols and widths are screen pixels.

    `title` stands in the legend beside `key`.
    """

    def __init__(self, title: str = "") -> None:
        super().__init__()
        self.title = title
        self.setAcceptedMouseButtons(Qt.MouseButton.NoButton)

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        """How the legend shows it."""
        return "line", EXCLUDED

    def point_at(self, u: float, v: float, pixel: float) -> int | None:
        """The index of the point at (u, v), None where there is none; a screen pixel is `pixel` wide there."""
        return None

    def tip(self, index: int) -> str:
        """What hovering over a point says."""
        return ""

    def boundingRect(self) -> QRectF:
        return _EVERYWHERE


class PointsLayer(Layer):
    """Symbols at points."""

    def __init__(
        self,
        uv: ArrayLike,
        colour: ColourLike | ArrayLike,
        symbol: Symbol,
        size: float,
        tips: Sequence[str] | None,
        title: str,
    ) -> None:
        super().__init__(title)
        self.uv = as_points(uv)
        self._symbol, self._size, self._tips = symbol, size, tips
        self._groups = _by_colour(colour, len(self.uv))
        self._fragments = internals.PrimitiveArray(QPainter.PixmapFragment, 10)

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        return self._symbol, self._groups[0][0] if self._groups else EXCLUDED

    def point_at(self, u: float, v: float, pixel: float) -> int | None:
        if not len(self.uv):
            return None
        distance = np.hypot(self.uv[:, 0] - u, self.uv[:, 1] - v)
        distance[~np.isfinite(distance)] = np.inf
        nearest = int(np.argmin(distance))
        return nearest if distance[nearest] <= max(_REACH, self._size / 2 + 2) * pixel else None

    def tip(self, index: int) -> str:
        return self._tips[index] if self._tips is not None and index < len(self._tips) else ""

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        ratio = widget.devicePixelRatioF() if widget is not None else 1.0
        spots = on_screen(painter.worldTransform(), self.uv)
        painter.resetTransform()
        for rgba, chosen in self._groups:
            pixmap = symbol_pixmap(self._symbol, rgba, self._size, ratio)
            self._stamp(painter, spots[chosen], pixmap, ratio)

    def _stamp(self, painter: QPainter, spots: Points, pixmap: QPixmap, ratio: float) -> None:
        spots = spots[np.abs(spots).max(axis=1, initial=0.0) < 1e5]  # NaN compares false
        if not len(spots):
            return
        self._fragments.resize(len(spots))
        rows = self._fragments.ndarray()
        rows[:, :2] = spots
        rows[:, 2:] = [0, 0, pixmap.width(), pixmap.height(), 1 / ratio, 1 / ratio, 0, 1]
        draw: Any = painter.drawPixmapFragments  # PySide's stub does not know of the array
        draw(*self._fragments.drawargs(), pixmap)


def as_points(uv: ArrayLike) -> Points:
    """(N, 2) of whatever is given; nothing gives (0, 2)."""
    return np.asarray(uv, dtype=np.float64).reshape(-1, 2)


def on_screen(transform: QTransform, uv: Points) -> Points:
    """Points of the picture as points of the screen, (N, 2)."""
    turn = np.array([[transform.m11(), transform.m12()], [transform.m21(), transform.m22()]])
    mapped: Points = uv @ turn + [transform.dx(), transform.dy()]
    return mapped


def cosmetic(rgba: tuple[int, int, int, int], width: float, widget: QWidget | None) -> QPen:
    """A pen as wide on the screen whatever the zoom. Qt counts its width in the screen's own pixels."""
    pen = QPen(to_colour(rgba), width * (1.0 if widget is None else widget.devicePixelRatioF()))
    pen.setCosmetic(True)
    return pen


def _by_colour(
    colour: ColourLike | ArrayLike, count: int
) -> list[tuple[tuple[int, int, int, int], NDArray[np.intp] | slice]]:
    """Which points have which colour: one for all, or (N, 3 or 4) of them."""
    if isinstance(colour, np.ndarray | list):
        table = np.asarray(colour, dtype=np.uint8).reshape(count, -1)
        if table.shape[1] == 3:
            table = np.column_stack([table, np.full(count, 255, dtype=np.uint8)])
        packed = np.ascontiguousarray(table).view(np.uint32).reshape(count)
        distinct, which = np.unique(packed, return_inverse=True)
        colours = distinct.view(np.uint8).reshape(-1, 4)
        return [
            ((int(r), int(g), int(b), int(a)), np.flatnonzero(which == i)) for i, (r, g, b, a) in enumerate(colours)
        ]
    return [(to_rgba(colour), slice(None))]  # type: ignore[arg-type]
