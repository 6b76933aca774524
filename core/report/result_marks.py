"""Marks that carry a result: the decision as word and form, and the deviation drawn into its tolerance."""

from __future__ import annotations

import numpy as np
from reportlab.lib.units import mm
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.platypus import Flowable

from core.inspect.characteristic import Characteristic
from core.report.look import Look
from core.report.style import BOLD, INK, MUTED, SANS, color
from core.report.wording import VERDICTS, decimals_of, shown_unit

SIGNS = {"conforming": "✓", "not conforming": "✗", "not proven": "?", "": "–"}
"""Of each decision: it is never told by colour alone."""


class VerdictMark(Flowable):  # type: ignore[misc]
    """The decision as word and form: filled with ✓, dark with ✗, outlined with ?."""

    def __init__(self, look: Look, verdict: str, width: float) -> None:
        super().__init__()
        self.look, self.verdict, self.width, self.height = look, verdict, width, 10 * mm

    def draw(self) -> None:
        """Paint it (called by reportlab)."""
        tone = {"conforming": self.look.accent, "": MUTED}.get(self.verdict, INK)
        filled = self.verdict in ("conforming", "not conforming")
        words = f"{SIGNS[self.verdict]}  {self.look.words(VERDICTS[self.verdict])}"
        size = min(10.5, 10.5 * (self.width - 6) / stringWidth(words, BOLD, 10.5))
        canvas = self.canv
        canvas.setStrokeColor(color(tone))
        canvas.setFillColor(color(tone if filled else "#FFFFFF"))
        canvas.setLineWidth(0.9)
        canvas.roundRect(0, 0, self.width, self.height, 1.2 * mm, stroke=1, fill=1)
        canvas.setFillColor(color("#FFFFFF" if filled else tone))
        canvas.setFont(BOLD, size)
        canvas.drawCentredString(self.width / 2, self.height / 2 - 3.8, words)


class ToleranceBar(Flowable):  # type: ignore[misc]
    """The deviation with its interval ±U against the zone of the tolerance, to scale; open where there is no limit."""

    def __init__(self, look: Look, one: Characteristic, width: float) -> None:
        super().__init__()
        unit, factor = shown_unit(one)
        limits = one.limits
        if limits is None:
            raise ValueError("there is no tolerance to draw")
        self.look, self.unit = look, unit
        self.deviation, self.U = factor * (one.deviation or 0.0), factor * one.U
        self.lower, self.upper = factor * limits.lower, factor * limits.upper
        self.decimals = max(decimals_of(self.U), 0)
        self.width, self.height = width, 15 * mm
        # what is drawn spans the limits and the whole interval, with room for the words at both ends
        known = [abs(limit) for limit in (self.lower, self.upper) if np.isfinite(limit)]
        self.half = 1.3 * max(*known, abs(self.deviation) + self.U, 1e-9) if known else 1.0

    def x(self, value: float) -> float:
        """Place of a deviation on paper."""
        return float(np.clip(self.width / 2 * (1 + value / self.half), 0, self.width))

    def draw(self) -> None:
        """Paint it (called by reportlab)."""
        canvas, axis = self.canv, 6.6 * mm
        low, high = self.x(self.lower), self.x(self.upper)
        canvas.setFillColor(color("#D5E2E7"))
        canvas.rect(low, axis - 2.4 * mm, high - low, 4.8 * mm, stroke=0, fill=1)
        canvas.setStrokeColor(color(MUTED))
        canvas.setLineWidth(0.5)
        canvas.line(0, axis, self.width, axis)
        canvas.setLineWidth(1.0)
        for place, limit in ((low, self.lower), (high, self.upper)):
            if np.isfinite(limit):
                canvas.line(place, axis - 2.4 * mm, place, axis + 2.4 * mm)
        self._words(low, high, axis)
        canvas.setStrokeColor(self.look.accent_color)
        canvas.setFillColor(self.look.accent_color)
        left, right, middle = (self.x(self.deviation + offset) for offset in (-self.U, self.U, 0.0))
        canvas.setLineWidth(1.8)
        canvas.line(left, axis, right, axis)
        canvas.setLineWidth(1.2)
        for place in (left, right):
            canvas.line(place, axis - 1.1 * mm, place, axis + 1.1 * mm)
        canvas.circle(middle, axis, 1.0 * mm, stroke=0, fill=1)

    def _words(self, low: float, high: float, axis: float) -> None:
        canvas, words = self.canv, self.look.words
        canvas.setFont(SANS, 6.5)
        canvas.setFillColor(color(MUTED))
        below, above = axis - 2.4 * mm - 7.5, axis + 2.4 * mm + 2.5
        lean = min(8.0, (high - low) / 2 - 2)  # the two never meet, however narrow the zone is drawn
        for place, limit, draw in (
            (low + lean, self.lower, canvas.drawRightString),
            (high - lean, self.upper, canvas.drawString),
        ):
            if np.isfinite(limit):
                draw(place, below, words.numeral(f"{limit:+g}") + f" {self.unit}")
        if high - low > 45 * mm and np.isfinite(self.lower + self.upper):
            canvas.setStrokeColor(color(MUTED))
            canvas.setLineWidth(0.5)
            canvas.line(self.x(0), axis - 2.4 * mm, self.x(0), axis + 2.4 * mm)
            canvas.drawCentredString(self.x(0), below, words("nominal"))
        canvas.setFillColor(self.look.accent_color)
        said = words(
            "deviation {deviation} ± {U}",
            deviation=f"{words.fixed(self.deviation, self.decimals, signed=True)} {self.unit}",
            U=f"{words.fixed(self.U, self.decimals)} {self.unit}",
        )
        half = canvas.stringWidth(said, SANS, 6.5) / 2
        canvas.drawCentredString(float(np.clip(self.x(self.deviation), half, self.width - half)), above, said)
