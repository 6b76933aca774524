"""Layers over a picture: points, lines, arrows, grid cells, regions and words, each drawn by a few calls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pyqtgraph.Qt import internals
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QImage, QPainter, QPen, QPixmap, QPolygonF, QTransform
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from workbench.views.colours import EXCLUDED, ColourLike, KeySign, Symbol, sigma_table, to_colour, to_rgba
from workbench.views.image.symbols import RIM, symbol_pixmap

GROUND, TEXT = QColor(12, 16, 20, 175), QColor("#F4F6F8")
"""Of plates over the picture, and of the words on them: readable on any grey."""

_NEAR_PX = 40.0
"""A label farther than this from the widget it should be within is left where it is."""


def draw_label(
    painter: QPainter, at: QPointF, text: str, colour: QColor = TEXT, *, within: QWidget | None = None
) -> None:
    """Draw a text on a dark plate about the screen place `at`; the painter must have no transform.

    With `within` a label that would lie partly outside that widget is moved inside; one farther away is left there.
    """
    font = QFont(painter.font())
    font.setPixelSize(12)
    painter.setFont(font)
    bounds = QFontMetricsF(font).boundingRect(QRectF(0, 0, 1000, 1000), int(Qt.AlignmentFlag.AlignLeft), text)
    plate = QRectF(0, 0, bounds.width() + 8, bounds.height() + 2)
    plate.moveCenter(at)
    if within is not None:
        inside = QRectF(within.rect()).adjusted(2, 2, -2, -2)
        if inside.adjusted(-_NEAR_PX, -_NEAR_PX, _NEAR_PX, _NEAR_PX).contains(at):
            plate.moveLeft(min(max(plate.left(), inside.left()), inside.right() - plate.width()))
            plate.moveTop(min(max(plate.top(), inside.top()), inside.bottom() - plate.height()))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(GROUND)
    painter.drawRoundedRect(plate, 3, 3)
    painter.setPen(colour)
    painter.drawText(plate, int(Qt.AlignmentFlag.AlignCenter), text)


Points = NDArray[np.float64]

_EVERYWHERE = QRectF(-1e6, -1e6, 2e6, 2e6)
"""Pixels that no layer leaves: asking each for its bounds would take longer than drawing it."""

_POINT_REACH_PX = 8.0
"""A point is meant by a click no farther away."""


class Layer(QGraphicsItem):
    """Layer of a picture. Its points are full-resolution pixels; symbols and widths are screen pixels.

    `title` stands in the legend beside `key`.
    """

    def __init__(self, title: str = "") -> None:
        super().__init__()
        self.title = title
        self.setAcceptedMouseButtons(Qt.MouseButton.NoButton)

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        """Sign and colour that stand for this layer in the legend."""
        return "line", EXCLUDED

    def point_at(self, u: float, v: float, pixel: float) -> int | None:
        """Find the index of the layer's point at (u, v); None if none is there. `pixel` is a screen pixel's width."""
        return None

    def tip(self, index: int) -> str:
        """Return the tooltip of the layer's point number `index`; "" if it has none."""
        return ""

    def boundingRect(self) -> QRectF:
        return _EVERYWHERE


class PointsLayer(Layer):
    """Layer of symbols at points."""

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
        return nearest if distance[nearest] <= max(_POINT_REACH_PX, self._size / 2 + 2) * pixel else None

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
    """Convert points to an array (N, 2); an empty sequence gives (0, 2)."""
    return np.asarray(uv, dtype=np.float64).reshape(-1, 2)


def on_screen(transform: QTransform, uv: Points) -> Points:
    """Transform points (N, 2) of the picture to points (N, 2) of the screen."""
    turn = np.array([[transform.m11(), transform.m12()], [transform.m21(), transform.m22()]])
    mapped: Points = uv @ turn + [transform.dx(), transform.dy()]
    return mapped


def cosmetic(rgba: tuple[int, int, int, int], width: float, widget: QWidget | None) -> QPen:
    """Make a pen whose width on the screen does not depend on the zoom."""
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


_VALUE_COLOURS = 16
"""Shades of a line that is coloured by values: changing the pen is what takes the time."""


class LinesLayer(Layer):
    """Layer of polylines: in one colour, in one each, or coloured by a value at each point."""

    def __init__(
        self,
        lines: Sequence[ArrayLike],
        colours: Sequence[ColourLike],
        values: Sequence[ArrayLike] | None,
        limits: tuple[float, float],
        width: float,
        labels: Sequence[str] | None,
        title: str,
    ) -> None:
        super().__init__(title)
        points = [as_points(line) for line in lines]
        self._width, self._colours = width, list(colours)
        self._sign: KeySign = "line" if values is None else "scale"
        self._batches = _coloured(points, self._colours) if values is None else _valued(points, values, limits)
        self._labels = []
        for line, text, colour in zip(points, labels or [""] * len(points), self._colours, strict=True):
            known = line[np.isfinite(line).all(axis=1)]
            if text and len(known):
                self._labels.append((QPointF(*known[0]), text, to_colour(colour)))

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        return self._sign, self._colours[0] if self._colours else EXCLUDED

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for rgba, lines in self._batches:
            painter.setPen(cosmetic(rgba, self._width, widget))
            painter.drawLines(*lines.drawargs())
        if self._labels:
            transform = painter.worldTransform()
            painter.resetTransform()
            for start, text, colour in self._labels:
                draw_label(painter, transform.map(start) + QPointF(0, -12), text, colour, within=widget)


class VectorsLayer(Layer):
    """Layer of arrows."""

    def __init__(self, uv: ArrayLike, d_uv: ArrayLike, factor: float, colour: ColourLike, title: str) -> None:
        super().__init__(title)
        self._colour = colour
        start, along = as_points(uv), as_points(d_uv) * factor
        tip = start + along
        side = np.column_stack([-along[:, 1], along[:, 0]])
        barbs = [tip - 0.28 * along + turn * 0.14 * side for turn in (-1, 1)]
        self._lines = _primitive(np.vstack([np.hstack([start, tip]), *(np.hstack([tip, barb]) for barb in barbs)]))

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        return "line", self._colour

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(cosmetic(to_rgba(self._colour), 1.4, widget))
        painter.drawLines(*self._lines.drawargs())


def _coloured(lines: Sequence[Points], colours: Sequence[ColourLike]) -> list[tuple[tuple[int, int, int, int], Any]]:
    grouped: dict[tuple[int, int, int, int], list[Points]] = {}
    for line, colour in zip(lines, colours, strict=True):
        grouped.setdefault(to_rgba(colour), []).append(line)
    return [(rgba, _primitive(_segments(group)[0])) for rgba, group in grouped.items()]


def _valued(
    lines: Sequence[Points], values: Sequence[ArrayLike], limits: tuple[float, float]
) -> list[tuple[tuple[int, int, int, int], Any]]:
    """Pieces of line in a few colours: drawing one colour is fast, changing it is not."""
    segments, owner = _segments(lines)
    all_values = (
        np.concatenate([np.asarray(v, dtype=np.float64).reshape(-1) for v in values]) if values else np.zeros(0)
    )
    low, high = limits
    with np.errstate(invalid="ignore"):
        mean = 0.5 * (all_values[owner] + all_values[owner + 1])
        step = np.floor((mean - low) * (_VALUE_COLOURS / (high - low)))
        known = np.isfinite(mean) & (mean <= high)
    step = np.where(known, np.clip(step, 0, _VALUE_COLOURS - 1), _VALUE_COLOURS).astype(np.intp)
    table = sigma_table()
    shades = [table[round((k + 0.5) * 255 / _VALUE_COLOURS)] for k in range(_VALUE_COLOURS)]
    palette = [(int(r), int(g), int(b), 255) for r, g, b, _ in shades] + [to_rgba(EXCLUDED)]
    return [(palette[k], _primitive(segments[step == k])) for k in np.unique(step)]


def _segments(lines: Sequence[Points]) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """The pieces (M, 4) between neighbouring points of each line, and the number of the point each starts at."""
    if not lines:
        return np.zeros((0, 4)), np.zeros(0, dtype=np.intp)
    points = np.concatenate(lines)
    last = np.cumsum([len(line) for line in lines]) - 1
    starts = np.ones(len(points), dtype=bool)
    starts[last[last >= 0]] = False
    owner = np.flatnonzero(starts)
    segments = np.hstack([points[owner], points[owner + 1]])
    finite = np.isfinite(segments).all(axis=1)
    return segments[finite], owner[finite]


def _primitive(segments: NDArray[np.float64]) -> Any:
    """Pieces of line as Qt draws them at one go."""
    segments = segments[np.isfinite(segments).all(axis=1)]
    lines = internals.PrimitiveArray(QLineF, 4)
    lines.resize(len(segments))
    lines.ndarray()[:] = segments
    return lines


Grip = int | Literal["whole"]
"""What is dragged of a region: the corner of this number, or all of it."""

_GRIP_REACH_PX = 9.0
"""A corner or the middle is taken hold of from no farther away: twice its half width."""

_HANDLE_PX = 4.5
"""Half the width of a handle: large enough to aim at, small enough to see the edge below it."""

_TINT = 70
"""Opacity of a tinted cell, of 255: the picture is read through it."""

_NARROWEST_PX = 12
"""Cells narrower than this are shown without the lines between them, which would hide the picture."""


class CellsLayer(Layer):
    """Layer of cells of a grid over the whole picture, tinted where True."""

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
        if abs(painter.worldTransform().m11()) * extent.width() < _NARROWEST_PX * columns:
            return  # a grid so fine would hide the picture
        painter.setPen(cosmetic((*to_rgba(self._colour)[:3], 45), 1.0, widget))
        for x in np.linspace(extent.left(), extent.right(), columns + 1):
            painter.drawLine(QPointF(x, extent.top()), QPointF(x, extent.bottom()))
        for y in np.linspace(extent.top(), extent.bottom(), rows + 1):
            painter.drawLine(QPointF(extent.left(), y), QPointF(extent.right(), y))


class PolygonLayer(Layer):
    """Layer of a closed region; with handles at its corners and in its middle when it can be edited.

    One with a `label`, which stands below it, is dashed: it is offered.
    """

    def __init__(self, uv: ArrayLike, colour: ColourLike, editable: bool, title: str, label: str = "") -> None:
        super().__init__(title)
        self.uv = as_points(uv).copy()
        self.editable = editable
        self._colour, self._label = colour, label

    @property
    def key(self) -> tuple[KeySign, ColourLike]:
        return "line", self._colour

    @property
    def middle(self) -> QPointF:
        """Mean of the region's corners, where the handle that drags the whole region is."""
        return QPointF(*self.uv.mean(axis=0)) if len(self.uv) else QPointF()

    def grip_at(self, u: float, v: float, pixel: float) -> Grip | None:
        """Find the part of the region that can be dragged at (u, v), a corner or the whole; None if none."""
        if not self.editable or not len(self.uv):
            return None
        distance = np.hypot(self.uv[:, 0] - u, self.uv[:, 1] - v)
        nearest = int(np.argmin(distance))
        if distance[nearest] <= _GRIP_REACH_PX * pixel:
            return nearest
        middle = self.middle
        return "whole" if np.hypot(middle.x() - u, middle.y() - v) <= _GRIP_REACH_PX * pixel else None

    def drag(self, grip: Grip, du: float, dv: float) -> None:
        """Move one corner, or the whole region, by (du, dv) picture pixels."""
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
        painter.setPen(QPen(colour, 1.6, Qt.PenStyle.DashLine if self._label else Qt.PenStyle.SolidLine))
        painter.drawPolygon(outline)
        if self._label:
            box = outline.boundingRect()
            below = QPointF(box.center().x(), box.bottom() + 12)
            draw_label(painter, below, self._label, colour, within=widget)
        if self.editable:
            painter.setPen(QPen(RIM, 1.0))
            painter.setBrush(colour)
            for corner in outline.toList():
                painter.drawRect(
                    QRectF(corner.x() - _HANDLE_PX, corner.y() - _HANDLE_PX, 2 * _HANDLE_PX, 2 * _HANDLE_PX)
                )
            painter.drawEllipse(transform.map(self.middle), _HANDLE_PX, _HANDLE_PX)
