"""Short texts over a picture, readable on any ground."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter
from PySide6.QtWidgets import QWidget

GROUND = QColor(12, 16, 20, 175)
TEXT = QColor("#F4F6F8")
_NEAR = 40.0


def draw_label(
    painter: QPainter, at: QPointF, text: str, colour: QColor = TEXT, *, within: QWidget | None = None
) -> None:
    """Draw a text about a place of the screen, on a dark plate; `painter` has no transform.

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
        if inside.adjusted(-_NEAR, -_NEAR, _NEAR, _NEAR).contains(at):
            plate.moveLeft(min(max(plate.left(), inside.left()), inside.right() - plate.width()))
            plate.moveTop(min(max(plate.top(), inside.top()), inside.bottom() - plate.height()))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(GROUND)
    painter.drawRoundedRect(plate, 3, 3)
    painter.setPen(colour)
    painter.drawText(plate, int(Qt.AlignmentFlag.AlignCenter), text)
