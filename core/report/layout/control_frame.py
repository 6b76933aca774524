"""A feature control frame as drawings have it: symbol, zone, datums, each in its box.

References
----------
ISO 7083:2021, Symbols for geometrical tolerancing, proportions and dimensions.
"""

from __future__ import annotations

from reportlab.lib.units import mm
from reportlab.platypus import Flowable

from core.inspect.plan.control_frame import ControlFrame
from core.report.layout.style import INK, SANS, ReportLook, color, draw_words, words_width

HEIGHT, SIZE, PADDING = 4.4 * mm, 6.5, 1.1 * mm
"""Of the frame in points, of its letters, and beside them."""


class ControlFrameMark(Flowable):  # type: ignore[misc]
    """One frame, to the left, with a little room above."""

    def __init__(self, look: ReportLook, frame: ControlFrame) -> None:
        super().__init__()
        self.symbol = frame.symbol
        self.cells = (f"{frame.round}{look.words.general(frame.zone_mm)}", *frame.datums)
        self.widths = [max(HEIGHT, words_width(cell, SANS, SIZE) + 2 * PADDING) for cell in self.cells]
        self.width, self.height = HEIGHT + sum(self.widths), HEIGHT + 0.8 * mm

    def draw(self) -> None:
        """Paint it (called by reportlab)."""
        canvas = self.canv
        canvas.setStrokeColor(color(INK))
        canvas.setFillColor(color(INK))
        canvas.setLineWidth(0.5)
        canvas.rect(0, 0, self.width, HEIGHT, stroke=1, fill=0)
        x = HEIGHT
        for cell, width in zip(self.cells, self.widths, strict=True):
            canvas.line(x, 0, x, HEIGHT)
            draw_words(canvas, (x + width / 2, HEIGHT / 2 - 0.36 * SIZE), cell, SANS, SIZE, share=0.5)
            x += width
        self._symbol()

    def _symbol(self) -> None:
        """In a square of side 1, each as ISO 7083 has it."""
        canvas = self.canv
        canvas.saveState()
        canvas.scale(HEIGHT, HEIGHT)
        canvas.setLineWidth(0.06)
        canvas.setLineCap(1)
        match self.symbol:
            case "flatness":
                self._lines((0.12, 0.28, 0.66, 0.28, 0.88, 0.72, 0.34, 0.72, 0.12, 0.28))
            case "cylindricity":
                canvas.circle(0.5, 0.5, 0.2)
                self._lines((0.12, 0.22, 0.4, 0.78), (0.6, 0.22, 0.88, 0.78))
            case "parallelism":
                self._lines((0.26, 0.2, 0.52, 0.8), (0.48, 0.2, 0.74, 0.8))
            case "perpendicularity":
                self._lines((0.18, 0.24, 0.82, 0.24), (0.5, 0.24, 0.5, 0.8))
            case "position":
                canvas.circle(0.5, 0.5, 0.24)
                self._lines((0.12, 0.5, 0.88, 0.5), (0.5, 0.12, 0.5, 0.88))
            case "profile of a surface":
                canvas.arc(0.16, 0.0, 0.84, 0.68, 0, 180)
                self._lines((0.16, 0.34, 0.84, 0.34))
        canvas.restoreState()

    def _lines(self, *lines: tuple[float, ...]) -> None:
        """Polylines x, y, x, y, …"""
        for line in lines:
            path = self.canv.beginPath()
            path.moveTo(*line[:2])
            for place in range(2, len(line), 2):
                path.lineTo(*line[place : place + 2])
            self.canv.drawPath(path)
