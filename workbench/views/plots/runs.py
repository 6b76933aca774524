"""Repeats of a measurement, and how values are spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pyqtgraph as pg
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget

from core.messages import decimals_of
from workbench.language import named, number, tr
from workbench.theme import shades
from workbench.views.plots.base import Plot, tinted, written

_DASH = Qt.PenStyle.DashLine
_MOST_BINS = 60
"""Bars of a histogram at most."""
_LEAST_HEIGHT = 200
"""Pixels: less cuts the title of the vertical axis."""
_WORDS = 128
"""Screen pixels at the right of a run chart for what its lines mean."""


@dataclass(frozen=True, eq=False, slots=True)
class _Runs:
    values: NDArray[np.float64]
    U: NDArray[np.float64]
    labels: tuple[str, ...]
    mean: float | None
    nominal: float | None
    tolerance: float | None
    k: float


class _ReferenceLine(NamedTuple):
    value: float
    text: str
    colour: str
    style: Qt.PenStyle
    words_below: bool


class RunChart(Plot):
    """Chart of repeats of one measurement in order, each with its expanded uncertainty, and reference lines."""

    def __init__(self, parent: QWidget | None = None) -> None:
        self._runs: _Runs | None = None
        self._words_shown: list[tuple[pg.TextItem, float]] = []
        self._reach = (0.0, 1.0)
        super().__init__(parent, least_height=_LEAST_HEIGHT)

    def set_runs(
        self,
        values: ArrayLike,
        U: ArrayLike,
        *,
        labels: Sequence[str] | None = None,
        mean: float | None = None,
        nominal: float | None = None,
        tolerance: float | None = None,
        k: float = 2.0,
    ) -> None:
        """Show repeats `values` (N,) with ±`U` (N,) in mm in order, and lines for mean, nominal and tolerance."""
        measured = np.asarray(values, dtype=np.float64).reshape(-1)
        names = tuple(labels) if labels is not None else tuple(str(i) for i in range(1, len(measured) + 1))
        if not len(measured):
            self.clear(self._empty.message)
            return
        spread = np.asarray(U, dtype=np.float64).reshape(-1)
        self._runs = _Runs(measured, spread, names, mean, nominal, tolerance, k)
        self._redraw()

    def clear(self, message: str = "") -> None:
        self._runs = None
        super().clear(message)

    def _prepare(self) -> None:
        self._box.sigResized.connect(self._place_words)

    def _has_data(self) -> bool:
        return self._runs is not None

    def _draw(self) -> None:
        runs, s = self._runs, shades()
        assert runs is not None
        count = len(runs.values)
        self._set_axis("bottom", tr("scan"))
        self._set_axis("left", tr("thickness, U (k = {k:g})", k=runs.k), "mm")
        every = max(1, count // 12)
        self._item.getAxis("bottom").setTicks([[(i + 1, str(i + 1)) for i in range(0, count, every)]])
        at = np.arange(1, count + 1)
        lines = self._reference_lines(runs)
        reach = [*(runs.values - np.nan_to_num(runs.U)), *(runs.values + np.nan_to_num(runs.U))]
        reach += [line.value for line in lines]
        low, high = min(reach), max(reach)
        self._words_shown, self._reach = [], (low, high)
        for line in lines:
            self._item.addItem(pg.InfiniteLine(line.value, angle=0, pen=self._pen(line.colour, 1.2, line.style)))
            text = f"{line.text} {written(line.value, (high - low) / 200)} mm"
            words = self._words(text, line.colour, (1, 0 if line.words_below else 1))
            words.setZValue(-1)  # their ground would hide half the width of the line
            self._words_shown.append((words, line.value))
            self._item.addItem(words, ignoreBounds=True)
        self._place_words()
        bars = pg.ErrorBarItem(x=at, y=runs.values, height=2 * runs.U, beam=0.18, pen=self._pen(s.accent, 1.3))
        self._item.addItem(bars)
        self._item.addItem(pg.ScatterPlotItem(at, runs.values, size=8, pen=None, brush=s.accent))

    def _place_words(self) -> None:
        """Leave room for what the lines mean: at the right, above and below, whatever the size."""
        if self._runs is None:
            return
        low, high = self._reach
        line = self.fontMetrics().height() + 12  # words have margins, Chinese ones are higher
        margin = max(0.12, line / max(self._box.height() - 2 * line, line)) * (high - low) or 0.01
        self._box.setYRange(low - margin, high + margin, padding=0)
        width = self._box.width()
        end = (len(self._runs.values) + 0.6) * (1 + _WORDS / max(width - _WORDS, _WORDS))
        self._box.setXRange(0.4, end, padding=0)
        for words, y in self._words_shown:
            words.setPos(end, y)

    def _reference_lines(self, runs: _Runs) -> list[_ReferenceLine]:
        s = shades()
        lines: list[_ReferenceLine] = []
        if runs.nominal is not None and runs.tolerance is not None:
            lines.append(_ReferenceLine(runs.nominal + runs.tolerance, tr("upper limit"), s.bad, _DASH, False))
            lines.append(_ReferenceLine(runs.nominal - runs.tolerance, tr("lower limit"), s.bad, _DASH, True))
        if runs.nominal is not None:
            below = runs.mean is not None and runs.nominal <= runs.mean
            lines.append(_ReferenceLine(runs.nominal, tr("nominal"), s.muted, Qt.PenStyle.SolidLine, below))
        if runs.mean is not None:
            below = runs.nominal is not None and runs.mean < runs.nominal
            lines.append(_ReferenceLine(runs.mean, tr("mean"), s.text, Qt.PenStyle.DotLine, below))
        return lines

    def _tip(self, x: float, y: float) -> str:
        runs, place = self._runs, round(x) - 1
        if runs is None or not 0 <= place < len(runs.values):
            return ""
        decimals = decimals_of(float(runs.U[place]))
        value, U = (number(float(part[place]), f".{decimals}f") for part in (runs.values, runs.U))
        return named(runs.labels[place], f"{value} ± {U} mm (k = {number(runs.k, 'g')})")


class Histogram(Plot):
    """Histogram of values, with limits."""

    def __init__(self, parent: QWidget | None = None) -> None:
        self._values = np.zeros(0)
        self._limits: tuple[tuple[float, str], ...] = ()
        self._label, self._unit = "", ""
        self._bins: int | None = None
        super().__init__(parent)

    def set_values(
        self,
        values: ArrayLike,
        *,
        label: str,
        unit: str,
        bins: int | None = None,
        limits: Sequence[tuple[float, str]] = (),
    ) -> None:
        """Show the histogram of the finite values (N,); `limits` are (value, text) of vertical lines."""
        all_values = np.asarray(values, dtype=np.float64).reshape(-1)
        self._values = all_values[np.isfinite(all_values)]
        self._label, self._unit, self._bins, self._limits = label, unit, bins, tuple(limits)
        if not len(self._values):
            self.clear(self._empty.message)
        self._redraw()

    def clear(self, message: str = "") -> None:
        self._values = np.zeros(0)
        super().clear(message)

    def _has_data(self) -> bool:
        return len(self._values) > 0

    def _draw(self) -> None:
        s = shades()
        bins = self._bins or min(_MOST_BINS, max(8, round(2 * len(self._values) ** (1 / 3))))
        counts, edges = np.histogram(self._values, bins=bins)
        self._set_axis("bottom", self._label, self._unit)
        self._set_axis("left", tr("count"))
        middles, width = 0.5 * (edges[1:] + edges[:-1]), float(edges[1] - edges[0])
        self._counts, self._edges = counts, edges
        pen = self._pen(s.panel, 1)
        self._item.addItem(
            pg.BarGraphItem(x=middles, height=counts, width=width, brush=pg.mkBrush(tinted(s.accent, 220)), pen=pen)
        )
        reach = [edges[0], edges[-1], *(value for value, _ in self._limits)]
        top = 1.15 * float(counts.max())
        self._box.setRange(xRange=(min(reach), max(reach)), yRange=(0, top), padding=0.02)
        for value, text in self._limits:
            self._item.addItem(pg.InfiniteLine(value, angle=90, pen=self._pen(s.bad, 1.2, _DASH)))
            right = value > 0.5 * (min(reach) + max(reach))
            words = self._words(text, s.bad, (1 if right else 0, 0))
            words.setPos(value, top)
            self._item.addItem(words, ignoreBounds=True)

    def _tip(self, x: float, y: float) -> str:
        place = int(np.searchsorted(self._edges, x)) - 1
        if not 0 <= place < len(self._counts):
            return ""
        step = float(self._edges[1] - self._edges[0]) / 10
        low, high = (written(float(edge), step) for edge in self._edges[place : place + 2])
        return tr(
            "{low} to {high} {unit}: {count}", low=low, high=high, unit=self._unit, count=int(self._counts[place])
        )
