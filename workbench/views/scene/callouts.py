"""Callouts: plates of words beside the surface, each with a line to its place on it. Drawn by Qt over the scene.

A plate that nobody moved stands where it covers least of the others, of their places and of what else is written over
the scene; one that was moved stays so many pixels from its place, wherever that is on the screen.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPen

from core.model.arrays import Array
from workbench.theme import icon, shades
from workbench.views.scene.contents import Callout
from workbench.views.scene.overlay import OverlayColours, small_font

DIRECTIONS = np.array([[1, -1], [-1, -1], [1, 0], [-1, 0], [1, 1], [-1, 1], [0, -1], [0, 1]], float)
"""Where a plate may stand beside its place, the first that is free is taken: to the upper right, as a flag."""

STEPS_PX = (22.0, 48.0, 80.0, 120.0, 170.0)
"""So far from its place is the plate's near side."""

DOT_PX = 3.0
"""Radius of the dot at the place."""

CLEAR_PX, MIDDLE_WEIGHT = 40.0, 0.1
"""The middle of the part, so many pixels round all places, is kept in sight, but rather covered than another plate."""

MOST_WIDE_PX = 190.0
"""A longer name ends with dots."""

ICON_PX, INSET_PX = 13.0, 5.0
"""Side of the sign before the value, and what is free inside a plate's edge."""


def plate_sizes(callouts: Sequence[Callout], font: QFont) -> Array:
    """Compute width and height (N, 2) of the callouts' text plates, in logical pixels."""
    metrics = QFontMetricsF(small_font(font))
    sizes = [
        (
            max(
                min(metrics.horizontalAdvance(one.title), MOST_WIDE_PX),
                _value_left(one) + metrics.horizontalAdvance(one.value),
            )
            + 2 * INSET_PX,
            2 * metrics.height() + INSET_PX,
        )
        for one in callouts
    ]
    rounded: Array = np.ceil(np.array(sizes, float).reshape(-1, 2))
    return rounded


def lay_out(
    places: Array, sizes: Array, moved: Sequence[tuple[float, float] | None], room: QRectF, kept: Sequence[QRectF]
) -> list[QRectF]:
    """Choose the rectangles of callouts' plates within `room`, so that their lines to `places` do not cross.

    Parameters
    ----------
    places, sizes
        (N, 2) on the screen, and (N, 2) widths and heights.
    moved
        How far from its place each was moved, None if it was not.
    room, kept
        No plate is outside of `room`, and none on what is `kept` free where there is other room.
    """
    low, high = np.array([room.left(), room.top()]), np.array([room.right(), room.bottom()])
    avoided = [(place - 2 * DOT_PX, place + 2 * DOT_PX) for place in places]
    avoided += [(np.array([one.left(), one.top()]), np.array([one.right(), one.bottom()])) for one in kept]
    middle = [(places.min(axis=0) - CLEAR_PX, places.max(axis=0) + CLEAR_PX)] if len(places) else []
    boxes: dict[int, tuple[Array, Array]] = {}
    for k in sorted(range(len(places)), key=lambda k: moved[k] is None):
        half, offset = sizes[k] / 2, moved[k]
        if offset is not None:
            middles = places[k] + np.array([offset])
        else:
            middles = np.vstack([places[k] + DIRECTIONS * (half + step) for step in STEPS_PX])
        middles = np.clip(middles, low + half, np.maximum(high - half, low + half))
        ends = np.array([*middle, *boxes.values(), *avoided]).reshape(-1, 2, 2)
        covered = _overlaps(np.stack([middles - half, middles + half], axis=1), ends)
        covered[:, : len(middle)] *= MIDDLE_WEIGHT
        best = middles[np.argmin(covered.sum(axis=1))]
        boxes[k] = best - half, best + half
    laid = np.array([boxes[k] for k in range(len(places))]).reshape(-1, 2, 2)
    laid = _uncrossed(places, laid, [offset is None for offset in moved], np.array(avoided).reshape(-1, 2, 2), room)
    return [QRectF(QPointF(*low), QPointF(*high)) for low, high in laid]


def _uncrossed(places: Array, boxes: Array, free: Sequence[bool], avoided: Array, room: QRectF) -> Array:
    """Two free plates whose lines cross exchange places, if then fewer lines cross and no more is covered.

    Corners (N, 2, 2) of the plates and (M, 2, 2) of what they avoid.
    """
    crossed, covered = _crossed(places, boxes), _covered(boxes, avoided)
    for _ in range(len(places)):
        for a, b in np.argwhere(np.triu(crossed)):
            if not (free[a] and free[b]):
                continue
            tried = _exchanged(boxes, a, b, places.mean(axis=0), room)
            left, covers = _crossed(places, tried), _covered(tried, avoided)
            if left.sum() < crossed.sum() and covers <= covered + 1:
                boxes, crossed, covered = tried, left, covers
                break
        else:
            break
    return boxes


def _exchanged(boxes: Array, a: int, b: int, middle: Array, room: QRectF) -> Array:
    """Two plates in each other's places, with the side towards `middle` where the other's was."""
    tried, halves, middles = boxes.copy(), np.diff(boxes, axis=1)[:, 0] / 2, boxes.mean(axis=1)
    low, high = np.array([room.left(), room.top()]), np.array([room.right(), room.bottom()])
    for one, other in ((a, b), (b, a)):
        away = middles[other] - middle
        outwards = np.sign(away) * (np.abs(away) > halves[other])
        at = middles[other] + outwards * (halves[one] - halves[other])
        at = np.clip(at, low + halves[one], np.maximum(high - halves[one], low + halves[one]))
        tried[one] = at - halves[one], at + halves[one]
    return tried


def _crossed(places: Array, boxes: Array) -> NDArray[np.bool_]:
    """Whose lines cross: (N, N) of bool."""
    ends = np.clip(places, boxes[:, 0], boxes[:, 1])
    along = ends - places

    def side(points: Array) -> Array:
        """Of which line (row) which of the points (column) lies: its sign."""
        to = points[None] - places[:, None]
        signs: Array = np.sign(along[:, None, 0] * to[..., 1] - along[:, None, 1] * to[..., 0])
        return signs

    parted = side(places) * side(ends) < 0
    crossed: NDArray[np.bool_] = parted & parted.T
    return crossed


def _covered(boxes: Array, avoided: Array) -> float:
    """Square pixels of plates on each other and on what they avoid."""
    covered = _overlaps(boxes, np.concatenate([boxes, avoided]))
    np.fill_diagonal(covered, 0)
    return float(covered.sum())


def _overlaps(boxes: Array, others: Array) -> Array:
    """Square pixels (N, M) that boxes, by their corners (N, 2, 2), share with others (M, 2, 2)."""
    sides = np.minimum(boxes[:, None, 1], others[None, :, 1]) - np.maximum(boxes[:, None, 0], others[None, :, 0])
    shared: Array = np.maximum(sides, 0).prod(axis=2)
    return shared


def _line_end(at: QPointF, plate: QRectF) -> QPointF:
    """Where the line from a place meets its plate."""
    return QPointF(min(max(at.x(), plate.left()), plate.right()), min(max(at.y(), plate.top()), plate.bottom()))


def paint_callouts(
    painter: QPainter, shown: Sequence[tuple[Callout, QPointF, QRectF]], colours: OverlayColours
) -> None:
    """Paint callouts, each as text plate, line, and place on the screen; all lines are below all plates."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for _, at, plate in shown:
        for pen in (QPen(colours.ground, 3.5), QPen(colours.text, 1.2)):
            painter.setPen(pen)
            painter.drawLine(at, _line_end(at, plate))
        painter.setPen(QPen(colours.text, 1.4))
        painter.setBrush(colours.ground)
        painter.drawEllipse(at, DOT_PX, DOT_PX)
    painter.setFont(small_font(painter.font()))
    for callout, _, plate in shown:
        _paint_plate(painter, callout, plate, colours)


def _paint_plate(painter: QPainter, callout: Callout, plate: QRectF, colours: OverlayColours) -> None:
    symbol, colour = callout.sign or ("", "muted")
    muted = QColor(shades().muted)
    ground = QColor(colours.ground)
    ground.setAlpha(238)
    edge = QPen(QColor(getattr(shades(), colour)), 1.2)
    if callout.outdated:
        edge.setStyle(Qt.PenStyle.DashLine)
    painter.setPen(edge)
    painter.setBrush(ground)
    painter.drawRoundedRect(plate, 4, 4)
    metrics = QFontMetricsF(painter.font())
    inside = plate.adjusted(INSET_PX, INSET_PX / 2, -INSET_PX, -INSET_PX / 2)
    rows = [
        QRectF(inside.left(), inside.top() + k * metrics.height(), inside.width(), metrics.height()) for k in (0, 1)
    ]
    # Chinese comes from another font, whose feet reach further down than this one's height.
    side = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter) | int(Qt.TextFlag.TextDontClip)
    painter.setPen(colours.text)
    title = metrics.elidedText(callout.title, Qt.TextElideMode.ElideMiddle, rows[0].width() + 1)
    painter.drawText(rows[0], side, title)
    if symbol:
        sign = QRectF(rows[1].left(), rows[1].center().y() - ICON_PX / 2, ICON_PX, ICON_PX)
        icon(symbol, colour=colour).paint(painter, sign.toRect())
    painter.setPen(muted if callout.outdated else colours.text)
    painter.drawText(rows[1].adjusted(_value_left(callout), 0, 1, 0), side, callout.value)


def _value_left(callout: Callout) -> float:
    return ICON_PX + 4 if callout.sign is not None else 0.0
