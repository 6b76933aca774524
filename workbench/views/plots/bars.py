"""One bar a view, and a threshold that can be dragged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QPaintEvent
from PySide6.QtWidgets import QWidget

from workbench.language import named, tr
from workbench.theme import shades
from workbench.views.common import draw_focus
from workbench.views.plots.base import Plot, tinted, written

_HEADROOM = 1.3
"""Height of the plot over its highest bar: room for the line that is dragged and its words."""
_NUDGE = 0.01
"""Share of the plot's height by which an arrow key moves the line."""

AMBER = "#E0A52C"
"""Above the threshold."""


@dataclass(frozen=True, slots=True)
class Bar:
    """Bar of one view or pose; `value` None where there is none. `tip` is added to name and value on hover."""

    name: str
    value: float | None
    used: bool = True
    tip: str = ""


class BarsWithThreshold(Plot):
    """Plot of one bar a view: filled when used, hollow when left out, amber above the threshold.

    The threshold is dragged by the mouse, or moved by the Up and Down keys; Left and Right go from bar to bar.
    """

    threshold_changed = Signal(float)
    """The threshold was let go."""

    threshold_moving = Signal(float)
    """The threshold is being dragged."""

    bar_clicked = Signal(str)
    """Name of the bar clicked, or gone to by key."""

    def __init__(self, parent: QWidget | None = None) -> None:
        self._bars: tuple[Bar, ...] = ()
        self._label, self._unit, self._current = "", "", ""
        self._threshold: float | None = None
        self._line: Any = None
        self._height = 1.0
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(tr("Errors as bars: Left and Right go along, Up and Down move the threshold"))
        self._column.setContentsMargins(1, 1, 1, 1)

    def set_bars(self, bars: Sequence[Bar], *, label: str, unit: str, threshold: float | None = None) -> None:
        """Show a bar for each view, with a line at `threshold` that can be dragged; None: no line."""
        self._bars, self._label, self._unit = tuple(bars), label, unit
        self._threshold = threshold
        if not self._bars:
            self.clear(self._empty.message)
            return
        self._redraw()

    def set_current(self, name: str) -> None:
        """Mark the bar called `name`; an unknown name marks none."""
        if name != self._current:
            self._current = name
            self._redraw()

    @property
    def threshold(self) -> float | None:
        """Value of the threshold in the bars' unit; None without a line."""
        return self._threshold

    def clear(self, message: str = "") -> None:
        self._bars, self._line = (), None
        super().clear(message)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        key = Qt.Key(event.key())
        if key in (Qt.Key.Key_Up, Qt.Key.Key_Down) and self._line is not None:
            step = _NUDGE * self._height * (1 if key == Qt.Key.Key_Up else -1)
            self._line.setValue(min(max((self._threshold or 0.0) + step, 0.0), self._height))
            self._let_go()
        elif key in (Qt.Key.Key_Left, Qt.Key.Key_Right) and self._bars:
            names = [bar.name for bar in self._bars]
            place = names.index(self._current) if self._current in names else -1
            place = min(max(place + (1 if key == Qt.Key.Key_Right else -1), 0), len(names) - 1)
            self.set_current(names[place])
            self.bar_clicked.emit(names[place])
        else:
            super().keyPressEvent(event)

    def focusInEvent(self, event: QFocusEvent) -> None:
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        draw_focus(self)

    def _prepare(self) -> None:
        self._item.scene().sigMouseClicked.connect(self._clicked)

    def _has_data(self) -> bool:
        return bool(self._bars)

    def _draw(self) -> None:
        self._set_axis("left", self._label, self._unit)
        self._hide_ticks()
        known = [bar.value for bar in self._bars if bar.value is not None]
        self._height = _HEADROOM * max([*known, self._threshold or 0.0], default=1.0) or 1.0
        self._box.setRange(xRange=(-0.7, len(self._bars) - 0.3), yRange=(0, self._height), padding=0)
        self._graph = pg.BarGraphItem(x=[], height=[], width=0.7)
        self._item.addItem(self._graph)
        missing = [i for i, bar in enumerate(self._bars) if bar.value is None]
        if missing:
            y = [0.03 * self._height] * len(missing)
            self._item.addItem(pg.ScatterPlotItem(missing, y, symbol="x", size=7, pen=None, brush=shades().muted))
        self._colour_bars()
        self._line = None
        if self._threshold is not None:
            self._add_line(self._threshold)

    def _colour_bars(self) -> None:
        s = shades()
        brushes, pens = [], []
        for bar in self._bars:
            over = self._threshold is not None and bar.value is not None and bar.value > self._threshold
            colour = s.muted if not bar.used else AMBER if over else s.accent
            brushes.append(pg.mkBrush(tinted(colour, 235) if bar.used else None))
            pens.append(
                self._pen(s.text if bar.name == self._current else colour, 2 if bar.name == self._current else 1)
            )
        heights = [bar.value or 0.0 for bar in self._bars]
        self._graph.setOpts(x=range(len(self._bars)), height=heights, brushes=brushes, pens=pens)

    def _add_line(self, threshold: float) -> None:
        s = shades()
        self._line = pg.InfiniteLine(
            pos=threshold,
            angle=0,
            movable=True,
            bounds=(0, self._height),
            pen=self._pen(s.bad, 1.5, Qt.PenStyle.DashLine),
            hoverPen=self._pen(s.bad, 3),
            label="",
            labelOpts={"position": 0.98, "anchors": [(1, 1), (1, 1)], "color": s.bad, "fill": tinted(s.panel, 215)},
        )
        behind = self._line.label.GraphicsItemFlag.ItemStacksBehindParent
        self._line.label.setFlag(behind)  # its ground would hide half the width of the line
        self._line.setCursor(Qt.CursorShape.SplitVCursor)
        self._item.addItem(self._line)
        self._say_threshold()
        self._line.sigPositionChanged.connect(self._moving)
        self._line.sigPositionChangeFinished.connect(self._let_go)

    def _say_threshold(self) -> None:
        limit = f"{written(self._line.value(), self._height / 200)} {self._unit}"
        self._line.label.setText(tr("left out above {limit}", limit=limit))

    def _moving(self) -> None:
        self._threshold = float(self._line.value())
        self._say_threshold()
        self._colour_bars()
        self.threshold_moving.emit(self._threshold)

    def _let_go(self) -> None:
        self._threshold = float(self._line.value())
        self.threshold_changed.emit(self._threshold)

    def _bar_at(self, x: float) -> Bar | None:
        place = round(x)
        return self._bars[place] if 0 <= place < len(self._bars) and abs(x - place) <= 0.5 else None

    def _tip(self, x: float, y: float) -> str:
        bar = self._bar_at(x)
        if bar is None:
            return ""
        value = tr("no value") if bar.value is None else f"{written(bar.value, self._height / 400)} {self._unit}"
        return "\n".join(part for part in (named(bar.name, value), bar.tip) if part)

    def _clicked(self, event: Any) -> None:
        if event.button() != Qt.MouseButton.LeftButton or not self._bars:
            return
        place = self._box.mapSceneToView(event.scenePos())
        bar = self._bar_at(place.x())
        if bar is not None and 0 <= place.y() <= self._height:
            self.set_current(bar.name)
            self.bar_clicked.emit(bar.name)
