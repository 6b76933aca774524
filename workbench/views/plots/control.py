"""A control chart: values in the order of time, and the limits they are to stay within."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyqtgraph as pg
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget

from workbench.theme import shades
from workbench.views.plots.base import Plot

_HEIGHT = 140
"""Pixels: it stands in a card at the side."""


@dataclass(frozen=True, eq=False, slots=True)
class _Chart:
    values: NDArray[np.float64]
    good: NDArray[np.bool_]
    tips: tuple[str, ...]
    limits: tuple[float, float, float]
    axes: tuple[str, str]
    unit: str


class ControlPlot(Plot):
    """Plot of one point a value, a cross where it is not good; dashed the limits, dotted their middle."""

    def __init__(self, parent: QWidget | None = None) -> None:
        self._chart: _Chart | None = None
        super().__init__(parent, least_height=_HEIGHT)
        self.setFixedHeight(_HEIGHT)

    def set_values(
        self,
        values: ArrayLike,
        good: ArrayLike,
        tips: Sequence[str],
        limits: tuple[float, float, float],
        *,
        axes: tuple[str, str],
        unit: str = "mm",
    ) -> None:
        """Show values (N,) in `unit` in time order, flags `good` (N,), a tooltip each, and the limits.

        `limits` are lower, centre and upper; `axes` what stands at the left and below.
        """
        shown = np.asarray(values, dtype=np.float64), np.asarray(good, dtype=np.bool_)
        self._chart = _Chart(*shown, tuple(tips), limits, axes, unit)
        self._redraw()

    def clear(self, message: str = "") -> None:
        self._chart = None
        super().clear(message)

    def _has_data(self) -> bool:
        return self._chart is not None

    def _draw(self) -> None:
        chart, s = self._chart, shades()
        assert chart is not None
        self._set_axis("left", chart.axes[0], chart.unit)
        self._set_axis("bottom", chart.axes[1])
        count = len(chart.values)
        every = max(1, count // 8)
        self._item.getAxis("bottom").setTicks([[(n, str(n)) for n in range(1, count + 1, every)]])
        lower, centre, upper = chart.limits
        for y, style in ((lower, Qt.PenStyle.DashLine), (centre, Qt.PenStyle.DotLine), (upper, Qt.PenStyle.DashLine)):
            colour = s.muted if y == centre else s.bad
            self._item.addItem(pg.InfiniteLine(y, angle=0, pen=self._pen(colour, 1.2, style)))
        at = np.arange(1, count + 1)
        self._item.addItem(pg.PlotCurveItem(at, chart.values, pen=self._pen(s.line, 1), connect="finite"))
        known = np.isfinite(chart.values)
        for which, symbol, colour in ((known & chart.good, "o", s.accent), (known & ~chart.good, "x", s.bad)):
            self._item.addItem(
                pg.ScatterPlotItem(at[which], chart.values[which], size=8, symbol=symbol, pen=None, brush=colour)
            )
        reach = [lower, upper, *chart.values[known]]
        margin = 0.1 * (max(reach) - min(reach)) or 0.01
        self._box.setRange(xRange=(0.5, count + 0.5), yRange=(min(reach) - margin, max(reach) + margin), padding=0)

    def _tip(self, x: float, y: float) -> str:
        chart, place = self._chart, round(x) - 1
        return chart.tips[place] if chart is not None and 0 <= place < len(chart.tips) else ""
