"""Residuals of the corners of one or all views: where they are, and how they scatter."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import QRectF, QSignalBlocker
from PySide6.QtWidgets import QGraphicsEllipseItem, QGraphicsRectItem, QLabel, QWidget

from workbench.language import tr
from workbench.theme import shades
from workbench.views.common import Choice
from workbench.views.layouts import in_row
from workbench.views.plots.base import Plot, written
from workbench.views.scene.colours import nice_step

FACTORS = (5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000)
"""How many times longer than true the vectors can be drawn."""
_SHARE = 0.05
"""Share of the picture's width that a long vector (90 % are shorter) gets where the factor is chosen by itself."""


class ResidualPlot(Plot):
    """Residual vectors over the frame of the picture, enlarged, with an arrow of known length; or as a scatter.

    Points that were left out are drawn in red, as crosses in the scatter.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        self._uv = self._residuals = np.zeros((0, 2))
        self._counted: NDArray[np.bool_] = np.zeros(0, dtype=bool)
        self._size = (1, 1)
        self._rms: float | None = None
        super().__init__(parent, least_height=170)
        self.kind = Choice()
        self.kind.addItems([tr("On the picture"), tr("Scatter")])
        self.kind.setToolTip(tr("Where the residuals are, or how they scatter"))
        self.factor = Choice()
        self.factor.addItem(tr("automatic"), 0)
        for factor in FACTORS:
            self.factor.addItem(f"× {factor}", factor)
        self.factor.setToolTip(tr("How much the residuals are enlarged"))
        self._enlarged = QLabel()
        self._enlarged.setObjectName("muted")
        row = in_row(self.kind, self.factor, (self._enlarged, 1))
        self._column.insertLayout(0, row)
        self.kind.currentIndexChanged.connect(self._redraw)
        self.factor.currentIndexChanged.connect(self._redraw)

    def set_residuals(
        self,
        uv: ArrayLike,
        residuals: ArrayLike,
        *,
        size: tuple[int, int],
        rms: float | None = None,
        counted: ArrayLike | None = None,
    ) -> None:
        """Show residuals (N, 2) in px at places `uv` (N, 2) of a picture of `size` (width, height) in px.

        `rms` is the radius of the circle in the scatter; `counted` (N,) is False for points left out.
        """
        self._uv = np.asarray(uv, dtype=np.float64).reshape(-1, 2)
        self._residuals = np.asarray(residuals, dtype=np.float64).reshape(-1, 2)
        chosen = np.ones(len(self._uv), dtype=np.bool_)
        if counted is not None:
            chosen &= np.asarray(counted, dtype=np.bool_)
        finite = np.flatnonzero(np.isfinite(self._residuals).all(axis=1))
        self._uv, self._residuals, self._counted = self._uv[finite], self._residuals[finite], chosen[finite]
        self._size, self._rms = size, rms
        if not len(self._uv):
            self.clear(self._empty.message)
        self._redraw()

    def clear(self, message: str = "") -> None:
        self._uv = self._residuals = np.zeros((0, 2))
        super().clear(message)

    @property
    def factor_used(self) -> int:
        """Factor by which the residuals are drawn enlarged."""
        if chosen := int(self.factor.currentData()):
            return chosen
        typical = float(np.percentile(np.hypot(*self._residuals.T), 90)) if len(self._residuals) else 0.0
        wanted = _SHARE * self._size[0] / typical if typical > 0 else FACTORS[0]
        return next((factor for factor in reversed(FACTORS) if factor <= wanted), FACTORS[0])

    def _has_data(self) -> bool:
        return len(self._uv) > 0

    def _draw(self) -> None:
        scatter = self.kind.currentIndex() == 1
        self.factor.setEnabled(not scatter)
        self._box.setAspectLocked(True)
        self._box.invertY(True)
        self._enlarged.setText("" if scatter else tr("enlarged × {factor}", factor=self.factor_used))
        if scatter:
            self._draw_scatter()
        else:
            self._draw_field()

    def _draw_field(self) -> None:
        s, factor = shades(), self.factor_used
        width, height = self._size
        self._set_axis("bottom", "u", "px")
        self._set_axis("left", "v", "px")
        frame = QGraphicsRectItem(QRectF(-0.5, -0.5, width, height))
        frame.setPen(self._pen(s.line, 1))
        self._item.addItem(frame, ignoreBounds=True)
        for which, colour in ((self._counted, s.accent), (~self._counted, s.bad)):
            start, along = self._uv[which], factor * self._residuals[which]
            self._add_arrows(start, along, colour)
        length = nice_step(_SHARE * width / factor)
        self._add_arrows(np.array([[0.0, 1.07 * height]]), np.array([[length * factor, 0.0]]), s.text)
        words = self._words(f"{written(length, length)} px", s.text, (0, 0.5))
        words.setPos(length * factor + 0.015 * width, 1.07 * height)
        self._item.addItem(words, ignoreBounds=True)
        self._box.setRange(QRectF(-0.5, -0.5, width, 1.13 * height), padding=0.03)

    def _add_arrows(self, start: NDArray[np.float64], along: NDArray[np.float64], colour: str) -> None:
        tip, side = start + along, np.column_stack([-along[:, 1], along[:, 0]])
        barbs = [tip - 0.28 * along + turn * 0.14 * side for turn in (-1, 1)]
        ends = np.stack([start, tip, tip, barbs[0], tip, barbs[1]], axis=1).reshape(-1, 2)
        pen = self._pen(colour, 1.3)
        self._item.addItem(pg.PlotCurveItem(ends[:, 0], ends[:, 1], connect="pairs", pen=pen), ignoreBounds=True)

    def _draw_scatter(self) -> None:
        s = shades()
        self._set_axis("bottom", tr("residual in u"), "px")
        self._set_axis("left", tr("residual in v"), "px")
        for which, symbol, colour in ((self._counted, "o", s.accent), (~self._counted, "x", s.bad)):
            dots = self._residuals[which]
            size = 5 if symbol == "o" else 9
            marks = pg.ScatterPlotItem(dots[:, 0], dots[:, 1], symbol=symbol, size=size, pen=None, brush=colour)
            self._item.addItem(marks)
        reach = 1.1 * max(float(np.abs(self._residuals).max()), self._rms or 0.0, 1e-9)
        for ends in (([-reach, reach], [0, 0]), ([0, 0], [-reach, reach])):
            self._item.addItem(pg.PlotCurveItem(*ends, pen=self._pen(s.line, 1)), ignoreBounds=True)
        if self._rms is not None:
            circle = QGraphicsEllipseItem(QRectF(-self._rms, -self._rms, 2 * self._rms, 2 * self._rms))
            circle.setPen(self._pen(s.text, 1.5))
            self._item.addItem(circle, ignoreBounds=True)
            words = self._words(f"RMS {written(self._rms, reach / 100)} px", s.text, (0, 0))
            words.setPos(-reach, -reach)
            self._item.addItem(words, ignoreBounds=True)
        self._box.setRange(QRectF(-reach, -reach, 2 * reach, 2 * reach), padding=0.02)

    def set_kind(self, scatter: bool) -> None:
        """Show the residuals as a scatter plot, or, with False, as arrows over the picture."""
        with QSignalBlocker(self.kind):
            self.kind.setCurrentIndex(int(scatter))
        self._redraw()
