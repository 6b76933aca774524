"""Curves over one axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyqtgraph as pg
from numpy.typing import ArrayLike, NDArray
from PySide6.QtWidgets import QWidget

from workbench.theme import shades
from workbench.views.colours import FAN, ColourLike, to_colour
from workbench.views.plots.base import Plot


@dataclass(frozen=True, eq=False, slots=True)
class _Curve:
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    colour: ColourLike
    title: str
    points: bool


LEGEND_LEFT, LEGEND_RIGHT = (8, 6), (-8, 6)
"""How far in pixels the legend is from the upper corner in which fewer points are; negative: from the right."""


class LineChart(Plot):
    """Chart of curves over one axis."""

    def __init__(self, parent: QWidget | None = None) -> None:
        self._curves: dict[str, _Curve] = {}
        self._names = ("", "", "", "")
        self._from_zero = False
        super().__init__(parent)

    def set_axes(self, x_label: str, x_unit: str, y_label: str, y_unit: str, *, from_zero: bool = False) -> None:
        """Set the names and units of both axes; `from_zero`: the upward axis begins at zero if no value is below."""
        self._names, self._from_zero = (x_label, x_unit, y_label, y_unit), from_zero
        self._redraw()

    def set_curve(
        self, name: str, x: ArrayLike, y: ArrayLike, *, colour: ColourLike = "", title: str = "", points: bool = False
    ) -> None:
        """Set the curve called `name`, x and y (N,); NaN leaves a gap. `title` is its text in the legend."""
        across, up = (np.asarray(values, dtype=np.float64).reshape(-1) for values in (x, y))
        self._curves[name] = _Curve(across, up, colour, title, points)
        self._redraw()

    def clear(self, message: str = "") -> None:
        self._curves = {}
        super().clear(message)

    def _prepare(self) -> None:
        self._legend = self._item.addLegend(offset=LEGEND_RIGHT, labelTextSize="11px", verSpacing=-4)

    def _has_data(self) -> bool:
        return any(len(curve.x) for curve in self._curves.values())

    def _draw(self) -> None:
        s = shades()
        self._set_axis("bottom", *self._names[:2])
        self._set_axis("left", *self._names[2:])
        self._legend.clear()
        self._legend.setLabelTextColor(s.text)
        colours = (s.accent, *FAN[1:], s.good)
        for number, curve in enumerate(self._curves.values()):
            colour = to_colour(curve.colour or colours[number % len(colours)])
            item = pg.PlotDataItem(
                curve.x,
                curve.y,
                pen=None if curve.points else self._pen(colour, 1.8),
                symbol="o" if curve.points else None,
                symbolSize=6,
                symbolPen=None,
                symbolBrush=colour,
                connect="finite",
            )
            self._item.addItem(item)
            if curve.title:
                self._legend.addItem(item, curve.title)
        self._legend.setVisible(any(curve.title for curve in self._curves.values()))
        self._set_range()

    def _set_range(self) -> None:
        x = np.concatenate([curve.x for curve in self._curves.values()])
        y = np.concatenate([curve.y for curve in self._curves.values()])
        x, y = x[np.isfinite(x)], y[np.isfinite(y)]
        if len(x) and len(y):
            margin = 0.08 * float(y.max() - y.min()) or 0.05 * abs(float(y.max())) or 1.0
            across = (float(x.min()), float(x.max()))
            lowest = 0.0 if self._from_zero else float(y.min()) - margin
            titles = sum(bool(curve.title) for curve in self._curves.values())
            above = margin * (1 + titles)  # the legend stands in no curve
            self._place_legend(float(np.mean(across)), float(np.mean((y.min(), y.max()))))
            self._box.setRange(xRange=across, yRange=(lowest, float(y.max()) + above), padding=0.01)

    def _place_legend(self, middle: float, half_up: float) -> None:
        """In the upper corner that has fewer of the points in the upper half."""
        across = np.concatenate([curve.x[curve.y >= half_up] for curve in self._curves.values()])  # no gap is there
        at_left = np.count_nonzero(across < middle) < np.count_nonzero(across > middle)
        self._legend.setOffset(LEGEND_LEFT if at_left else LEGEND_RIGHT)
