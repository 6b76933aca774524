"""Where a result lies in its tolerance, to be read from where the part is handled."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QLineF, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.report.tolerance_scale import ToleranceScale
from core.report.wording import Words
from workbench.language import chosen
from workbench.theme import shades
from workbench.views.common import dress
from workbench.views.plots.base import tinted

_ZONE_PX, _DOT_PX, _GAP_PX = 44, 12, 8
"""Height of the zone, radius of the value's dot, and what is left free above and below the zone."""


class ToleranceBar(QWidget):
    """Scale of the deviation with its interval ±U against the tolerance zone, as on page one of the report."""

    def __init__(self, text_px: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._scale: ToleranceScale | None = None
        self._colour = "text"
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        dress(self, f"font-size: {text_px}px;")

    def set_scale(self, scale: ToleranceScale | None, colour: str) -> None:
        """Show a result on its tolerance scale in a colour of the theme; None, no tolerance, shows nothing."""
        self._scale, self._colour = scale, colour
        self.setAccessibleName("" if scale is None else scale.deviation_text(Words(chosen())))
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(320, 2 * (self.fontMetrics().height() + _GAP_PX) + _ZONE_PX)

    def minimumSizeHint(self) -> QSize:
        return QSize(200, self.sizeHint().height())

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.PaletteChange, QEvent.Type.FontChange):
            self.updateGeometry()
            self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        scale = self._scale
        if scale is None:
            return
        painter, s, line = QPainter(self), shades(), self.fontMetrics().height()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        top, width = line + _GAP_PX, self.width() - 1
        bottom, axis = top + _ZONE_PX, top + _ZONE_PX / 2
        low, high = (scale.share(limit) * width for limit in (scale.lower, scale.upper))
        painter.fillRect(QRectF(low, top, high - low, _ZONE_PX), tinted(s.accent, 60))
        painter.setPen(QPen(QColor(s.muted), 1))
        painter.drawLine(QLineF(0, axis, width, axis))
        painter.setPen(QPen(QColor(s.text), 2))
        for limit in scale.limits:
            place = scale.share(limit) * width
            painter.drawLine(QLineF(place, top, place, bottom))
        colour = QColor(getattr(s, self._colour))
        left, right, middle = (scale.share(scale.deviation + offset) * width for offset in (-scale.U, scale.U, 0.0))
        painter.setPen(QPen(colour, 4))
        painter.drawLine(QLineF(left, axis, right, axis))
        for place in (left, right):
            painter.drawLine(QLineF(place, axis - _DOT_PX, place, axis + _DOT_PX))
        painter.setBrush(colour)
        painter.drawEllipse(QPointF(middle, axis), _DOT_PX, _DOT_PX)
        painter.setPen(QColor(s.text))
        self._words(painter, scale, middle, 0)
        self._limits(painter, scale, bottom + _GAP_PX)
        painter.end()

    def _words(self, painter: QPainter, scale: ToleranceScale, middle: float, top: float) -> None:
        """The deviation, above its dot as far as there is room."""
        said = scale.deviation_text(Words(chosen()))
        wide = self.fontMetrics().horizontalAdvance(said) + 2
        left = min(max(middle - wide / 2, 0.0), self.width() - wide)
        painter.drawText(QRectF(left, top, wide, self.fontMetrics().height()), int(Qt.AlignmentFlag.AlignCenter), said)

    def _limits(self, painter: QPainter, scale: ToleranceScale, top: float) -> None:
        """Each limit below its line; the two lean away from each other, and so never meet."""
        for limit in scale.limits:
            said, place = scale.limit_text(limit, Words(chosen())), scale.share(limit) * self.width()
            wide = self.fontMetrics().horizontalAdvance(said) + 2
            left = place - wide if limit == scale.lower else place
            left = min(max(left, 0.0), self.width() - wide)
            area = QRectF(left, top, wide, self.fontMetrics().height())
            painter.drawText(area, int(Qt.AlignmentFlag.AlignCenter), said)
