"""Gauges and hints for work in progress."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QHideEvent, QPainter, QPaintEvent, QPolygonF
from PySide6.QtWidgets import QFrame, QLabel, QSizePolicy, QWidget

from workbench.language import tr
from workbench.theme import shades
from workbench.views.colours import Level
from workbench.views.common import IconLabel, dress, grade_words
from workbench.views.layouts import in_row
from workbench.views.plots.base import tinted

STAYS_MS = 1000
"""Shortest time a hint stays."""

_BAR = 8
"""Height of the bar in pixels."""
_NEEDLE = 5
"""Half the width of the needle's tip in pixels."""


class Meter(QWidget):
    """Horizontal gauge: zones of good and bad, a needle, the value as text. The zone is named in words as well."""

    def __init__(
        self,
        title: str,
        zones: Sequence[tuple[float, Level]],
        *,
        minimum: float = 0.0,
        logarithmic: bool = False,
        names: Mapping[Level, str] | None = None,
        parent: QWidget | None = None,
    ) -> None:
        """`zones` are (upper end, level), rising; the last upper end is the end of the scale. `names`: of the zones.

        Raises
        ------
        ValueError
            If the zones do not rise from the minimum, or a logarithmic scale does not begin above 0.
        """
        super().__init__(parent)
        ends = [minimum, *(end for end, _ in zones)]
        if not zones or any(b <= a for a, b in pairwise(ends)) or (logarithmic and minimum <= 0):
            raise ValueError(f"no scale: {minimum}, {zones}")
        self._title, self._zones, self._minimum, self._logarithmic = title, tuple(zones), minimum, logarithmic
        self._names = grade_words() if names is None else names
        self._value: float | None = None
        self._text = ""
        self.setAccessibleName(title)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def set_value(self, value: float | None, text: str = "") -> None:
        """Move the needle to a value and show `text`, the value with its unit; None or NaN hides the needle."""
        if value is not None and math.isnan(value):
            value = None
        if (value, text) != (self._value, self._text):
            self._value, self._text = value, text
            self.setAccessibleDescription(self.value_text)
            self.update()

    @property
    def level(self) -> Level:
        """Level, as "good", of the zone that the needle is in."""
        if self._value is None:
            return ""
        return next((level for end, level in self._zones if self._value <= end), self._zones[-1][1])

    @property
    def value_text(self) -> str:
        """Text of the value and the name of the zone it is in."""
        return " · ".join(part for part in (self._text, self._names.get(self.level, "")) if part) or "–"

    def share(self, value: float) -> float:
        """Compute the place of a value on the scale, from 0 at its lower end to 1 at its upper end."""
        low, high = self._minimum, self._zones[-1][0]
        value = min(max(value, low), high)
        if self._logarithmic:
            return math.log(value / low) / math.log(high / low)
        return (value - low) / (high - low)

    def sizeHint(self) -> QSize:
        return QSize(220, self.fontMetrics().height() + _BAR + _NEEDLE + 10)

    def minimumSizeHint(self) -> QSize:
        return QSize(140, self.sizeHint().height())

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.PaletteChange, QEvent.Type.FontChange):
            self.updateGeometry()
            self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter, s = QPainter(self), shades()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        line = self.fontMetrics().height()
        words = QRectF(0, 1, self.width(), line + 1)
        painter.setPen(QColor(s.muted))
        painter.drawText(words, int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter), self._title)
        level = self.level
        painter.setPen(QColor(getattr(s, level) if level else s.text))
        painter.drawText(words, int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter), self.value_text)
        bar = QRectF(_NEEDLE, line + 5, self.width() - 2 * _NEEDLE, _BAR)
        self._draw_zones(painter, bar)
        if self._value is not None:
            x = bar.left() + self.share(self._value) * bar.width()
            top, bottom = bar.top() - 2, bar.bottom() + 3
            painter.setPen(QColor(s.panel))
            painter.setBrush(QColor(s.text))
            painter.drawRect(QRectF(x - 1.5, top, 3, _BAR + 4))
            tip = [QPointF(x, bottom - 3), QPointF(x - _NEEDLE, bottom + 4), QPointF(x + _NEEDLE, bottom + 4)]
            painter.drawPolygon(QPolygonF(tip))
        painter.end()

    def _draw_zones(self, painter: QPainter, bar: QRectF) -> None:
        s, start, current = shades(), self._minimum, self.level
        painter.setPen(Qt.PenStyle.NoPen)
        for end, level in self._zones:
            left, right = (bar.left() + self.share(x) * bar.width() for x in (start, end))
            painter.setBrush(tinted(getattr(s, level) if level else s.muted, 220 if level == current else 90))
            painter.drawRect(QRectF(left, bar.top(), right - left - (1 if end < self._zones[-1][0] else 0), _BAR))
            start = end


class Steady(QObject):
    """Filter that changes a shown value at most once a second, so nothing flickers; the last one comes then."""

    shown = Signal(object)
    """What is to be said from now on."""

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.now: Any = None
        """What is said; None before there is anything."""
        self._wanted: Any = None
        self._since = -math.inf
        self._clock = QTimer(self)
        self._clock.setSingleShot(True)
        self._clock.timeout.connect(self._show)

    def show(self, said: Any, *, at_once: bool = False) -> None:
        """Show a value now if `at_once` or the last one was shown for a second, else when that second is over."""
        self._wanted = said
        if said == self.now:
            self._clock.stop()
            return
        left = STAYS_MS - 1000 * (time.monotonic() - self._since)
        if left <= 0 or at_once:
            self._clock.stop()
            self._show()
        elif not self._clock.isActive():
            self._clock.start(math.ceil(left))

    def wait_no_longer(self) -> None:
        """Drop the value that waits to be shown, as the widget is hidden."""
        self._clock.stop()

    def _show(self) -> None:
        if self._wanted != self.now:
            self.now, self._since = self._wanted, time.monotonic()
            self.shown.emit(self.now)


class HintBar(QFrame):
    """Bar with a hint on what to do now. A sentence stays for at least a second, so nothing flickers; an empty list
    stays calm too.
    """

    def __init__(self, idle: str = "", parent: QWidget | None = None) -> None:
        """`idle` is shown, muted, while there is no hint."""
        super().__init__(parent)
        self._idle = idle
        self._sign, self._label = IconLabel(18), QLabel()
        self._label.setWordWrap(True)
        self._label.setAccessibleName(tr("Hint"))
        row = in_row(on=self, margins=(10, 6, 10, 6), spacing=8)
        row.addWidget(self._sign, 0, Qt.AlignmentFlag.AlignTop)
        row.addWidget(self._label, 1)
        self._steady = Steady(self)
        self._steady.shown.connect(self._dress)
        self._dress()

    def set_hints(self, hints: Sequence[str]) -> None:
        """Set the hints on what to do now, the most important one first."""
        self._steady.show(tuple(hints), at_once=not self._steady.now)

    @property
    def text(self) -> str:
        """Hint that is shown; "" if none is."""
        return self._label.text()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._dress()

    def hideEvent(self, event: QHideEvent) -> None:
        self._steady.wait_no_longer()
        super().hideEvent(event)

    def _dress(self, *_: object) -> None:
        s, shown = shades(), self._steady.now or ()
        self._label.setText("   ".join(shown) or self._idle)
        dress(self._label, "" if shown else f"color: {s.muted};")
        colour = "accent" if shown else "muted"
        symbol = "mdi6.lightbulb-on-outline" if shown else "mdi6.lightbulb-outline"
        self._sign.show_icon(symbol, colour)
        dress(self, f"HintBar {{ background: {s.panel}; border: 1px solid {s.line}; border-radius: 5px; }}")
