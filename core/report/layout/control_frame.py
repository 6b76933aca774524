"""A feature control frame as drawings have it: symbol, zone, datums, each in its box."""

from __future__ import annotations

from reportlab.lib.units import mm
from reportlab.platypus import Flowable

from core.inspect.plan.control_frame import STROKES, ControlFrame
from core.report.layout.style import INK, SANS, ReportLook, color, draw_words, words_width

HEIGHT, SIZE, PADDING = 4.4 * mm, 6.5, 1.1 * mm
"""Of the frame in points, of its letters, and beside them."""


ROOM = 0.8 * mm
"""Above a frame, and below it."""


class ControlFrameMark(Flowable):  # type: ignore[misc]
    """Feature control frame, to the left, with a little room above and below."""

    def __init__(self, look: ReportLook, frame: ControlFrame) -> None:
        super().__init__()
        self.symbol = frame.symbol
        self.cells = (f"{frame.round}{look.words.general(frame.zone_mm)}", *frame.datums)
        self.widths = [max(HEIGHT, words_width(cell, SANS, SIZE) + 2 * PADDING) for cell in self.cells]
        self.width, self.height = HEIGHT + sum(self.widths), HEIGHT + 2 * ROOM

    def draw(self) -> None:
        """Paint the frame (called by reportlab)."""
        canvas = self.canv
        canvas.translate(0, ROOM)
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
        """In its square."""
        canvas = self.canv
        canvas.saveState()
        canvas.scale(HEIGHT, HEIGHT)
        canvas.setLineWidth(0.06)
        canvas.setLineCap(1)
        for (x, y), *others in STROKES[self.symbol]:
            path = canvas.beginPath()
            path.moveTo(x, y)
            for place in others:
                path.lineTo(*place)
            canvas.drawPath(path)
        canvas.restoreState()
