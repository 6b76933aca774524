"""Symbols of points as small pixmaps with a dark rim: on the picture, in the legend, in menus."""

from __future__ import annotations

from functools import lru_cache

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen, QPixmap

from workbench.views.colours import Symbol

RIM = QColor(0, 0, 0, 170)
"""Round everything drawn on a picture, so that it is seen on bright and dark."""

_STROKE = 1.6
"""Width of a symbol's lines in screen pixels."""


@lru_cache(maxsize=512)
def symbol_pixmap(symbol: Symbol, rgba: tuple[int, int, int, int], size: float, ratio: float) -> QPixmap:
    """Draw a point symbol, `size` screen pixels wide, as a pixmap with the device pixel ratio `ratio`."""
    side = round((size + 5) * ratio)
    pixmap = QPixmap(side, side)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.translate(side / 2, side / 2)
    painter.scale(ratio, ratio)
    draw_symbol(painter, symbol, QColor(*rgba), size)
    painter.end()
    return pixmap


def draw_symbol(painter: QPainter, symbol: Symbol, colour: QColor, size: float) -> None:
    """Draw a point symbol, `size` wide, about the painter's origin."""
    shape = _shape(symbol, size / 2)
    filled = symbol == "."
    rim = QColor(RIM)
    rim.setAlpha(rim.alpha() * colour.alpha() // 255)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(_pen(rim, 2.0 if filled else _STROKE + 1.8))
    painter.drawPath(shape)
    painter.setPen(Qt.PenStyle.NoPen if filled else _pen(colour, _STROKE))
    if filled:
        painter.setBrush(colour)
    painter.drawPath(shape)


def _pen(colour: QColor, width: float) -> QPen:
    pen = QPen(colour, width)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    return pen


def _shape(symbol: Symbol, r: float) -> QPainterPath:
    path = QPainterPath()
    if symbol in "o.":
        path.addEllipse(QPointF(0, 0), r, r)
    elif symbol == "s":
        path.addRect(QRectF(-0.85 * r, -0.85 * r, 1.7 * r, 1.7 * r))
    elif symbol == "t":
        _closed(path, [(0, -r), (0.95 * r, 0.75 * r), (-0.95 * r, 0.75 * r)])
    elif symbol == "d":
        _closed(path, [(0, -r), (r, 0), (0, r), (-r, 0)])
    else:
        d = 0.8 * r
        strokes = [((-d, -d), (d, d)), ((-d, d), (d, -d))] if symbol == "x" else [((-r, 0), (r, 0)), ((0, -r), (0, r))]
        for start, end in strokes:
            path.moveTo(*start)
            path.lineTo(*end)
    return path


def _closed(path: QPainterPath, corners: list[tuple[float, float]]) -> None:
    path.moveTo(*corners[0])
    for corner in corners[1:]:
        path.lineTo(*corner)
    path.closeSubpath()
