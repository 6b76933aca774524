"""The box at the top of page one: the result, the verdict, and where the result lies in its tolerance."""

from __future__ import annotations

import numpy as np
from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Paragraph, Spacer, Table, TableStyle

from core.inspect.results import GaugeResult
from core.report.content import ReportContent
from core.report.style import ACCENT, BOLD, HAIRLINE, INK, MUTED, SANS, STYLES, TINT, color, markup, text
from core.report.tables import plain_table
from core.report.wording import (
    VERDICTS,
    count,
    decimals_of,
    fixed,
    grouped,
    thickness_line,
    uncertainty_sentence,
    verdict_sentence,
)

PADDING = 5 * mm
MARKS = {"conforming": ("✓", ACCENT, True), "not conforming": ("✗", INK, True), "not proven": ("?", INK, False)}
"""Sign and colour of each verdict, and whether its mark is filled."""


class VerdictMark(Flowable):  # type: ignore[misc]
    """The verdict as word and form: filled with ✓, dark with ✗, outlined with ?; never by colour alone."""

    def __init__(self, verdict: str, width: float) -> None:
        super().__init__()
        self.verdict, self.width, self.height = verdict, width, 10 * mm

    def draw(self) -> None:
        """Paint it (called by reportlab)."""
        sign, tone, filled = MARKS.get(self.verdict, ("–", MUTED, False))
        canvas, radius = self.canv, 1.2 * mm
        canvas.setStrokeColor(color(tone))
        canvas.setFillColor(color(tone if filled else "#FFFFFF"))
        canvas.setLineWidth(0.9)
        canvas.roundRect(0, 0, self.width, self.height, radius, stroke=1, fill=1)
        canvas.setFillColor(color("#FFFFFF" if filled else tone))
        canvas.setFont(BOLD, 10.5)
        canvas.drawCentredString(self.width / 2, self.height / 2 - 3.8, f"{sign}  {VERDICTS[self.verdict]}")


class ToleranceBar(Flowable):  # type: ignore[misc]
    """The deviation with its interval ±U against the zone of the tolerance, to scale."""

    def __init__(self, deviation: float, U: float, tolerance: float, decimals: int, width: float) -> None:
        super().__init__()
        self.deviation, self.U, self.tolerance, self.decimals = deviation, U, tolerance, decimals
        self.width, self.height = width, 15 * mm
        # what is drawn spans the tolerance and the whole interval, with room for the words at both ends
        self.half = 1.3 * max(tolerance, abs(deviation) + U, 1e-9)

    def x(self, value: float) -> float:
        """Place of a deviation (mm) on paper."""
        return self.width / 2 * (1 + value / self.half)

    def draw(self) -> None:
        """Paint it (called by reportlab)."""
        canvas, axis = self.canv, 6.6 * mm
        low, high = self.x(-self.tolerance), self.x(self.tolerance)
        canvas.setFillColor(color("#D5E2E7"))
        canvas.rect(low, axis - 2.4 * mm, high - low, 4.8 * mm, stroke=0, fill=1)
        canvas.setStrokeColor(color(MUTED))
        canvas.setLineWidth(0.5)
        canvas.line(0, axis, self.width, axis)
        canvas.setLineWidth(1.0)
        for place in (low, high):
            canvas.line(place, axis - 2.4 * mm, place, axis + 2.4 * mm)
        self._words(low, high, axis)
        canvas.setStrokeColor(color(ACCENT))
        canvas.setFillColor(color(ACCENT))
        left, right, middle = (self.x(self.deviation + offset) for offset in (-self.U, self.U, 0.0))
        canvas.setLineWidth(1.8)
        canvas.line(left, axis, right, axis)
        canvas.setLineWidth(1.2)
        for place in (left, right):
            canvas.line(place, axis - 1.1 * mm, place, axis + 1.1 * mm)
        canvas.circle(middle, axis, 1.0 * mm, stroke=0, fill=1)

    def _words(self, low: float, high: float, axis: float) -> None:
        canvas = self.canv
        canvas.setFont(SANS, 6.5)
        canvas.setFillColor(color(MUTED))
        below, above = axis - 2.4 * mm - 7.5, axis + 2.4 * mm + 2.5
        limit = f"{self.tolerance:g} mm"
        lean = min(8.0, (high - low) / 2 - 2)  # the two never meet, however narrow the zone is drawn
        canvas.drawRightString(low + lean, below, f"−{limit}")
        canvas.drawString(high - lean, below, f"+{limit}")
        if high - low > 45 * mm:
            canvas.setStrokeColor(color(MUTED))
            canvas.setLineWidth(0.5)
            canvas.line(self.x(0), axis - 2.4 * mm, self.x(0), axis + 2.4 * mm)
            canvas.drawCentredString(self.x(0), below, "nominal")
        canvas.setFillColor(color(ACCENT))
        words = f"deviation {fixed(self.deviation, self.decimals, signed=True)} mm ± {fixed(self.U, self.decimals)} mm"
        half = canvas.stringWidth(words, SANS, 6.5) / 2
        canvas.drawCentredString(float(np.clip(self.x(self.deviation), half, self.width - half)), above, words)


def result_box(content: ReportContent, width: float) -> Table:
    """The box: of the thickness, or of the cloud where there is no gauge."""
    inner = width - 2 * PADDING
    rows = _thickness(content.gauge, inner) if content.gauge else _cloud(content, inner)
    style = TableStyle(
        [
            ("FONTNAME", (0, 0), (-1, -1), SANS),
            ("BACKGROUND", (0, 0), (-1, -1), color(TINT)),
            ("LINEBEFORE", (0, 0), (0, -1), 2.2, color(ACCENT)),
            ("LEFTPADDING", (0, 0), (-1, -1), PADDING),
            ("RIGHTPADDING", (0, 0), (-1, -1), PADDING),
            ("TOPPADDING", (0, 0), (-1, -1), 3.5 * mm),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 3.5 * mm),
        ]
    )
    if content.all_notes:
        notes = count(len(content.all_notes), "remark")
        rows.append(text(f"{notes} under “Notes and warnings” further on.", "caption"))
    return Table([[rows]], colWidths=[width], style=style, hAlign="LEFT")


def _facts(facts: dict[str, str], width: float) -> Table:
    cells = [[text(label, "label"), text(value, "fact")] for label, value in facts.items()]
    table = plain_table([cells], [width / len(cells)] * len(cells))
    table.setStyle(
        TableStyle([("LINEABOVE", (0, 0), (-1, 0), 0.5, color(HAIRLINE)), ("TOPPADDING", (0, 0), (-1, -1), 5)])
    )
    return table


def _thickness(gauge: GaugeResult, width: float) -> list[Flowable]:
    value, _, factor = thickness_line(gauge).partition(" (")
    factor = factor.replace(" ", "\u00a0")
    words = f'{markup(value)} <font name="{SANS}" size="11">({markup(factor)}</font>'
    headline = [text("Thickness", "label"), Paragraph(words, STYLES["result"])]
    parts: list[Flowable] = []
    if gauge.verdict:
        badge = 42 * mm
        head = plain_table([[headline, VerdictMark(gauge.verdict, badge)]], [width - badge, badge])
        head.setStyle(TableStyle([("VALIGN", (1, 0), (1, 0), "MIDDLE")]))
        parts += [head, Spacer(0, 2.5 * mm)]
    else:
        parts += [*headline, Spacer(0, 2.5 * mm)]
    decimals = max(decimals_of(gauge.U_mm), 0)
    facts = {}
    if gauge.nominal_mm is not None and gauge.deviation_mm is not None:
        facts["Nominal value"] = f"{gauge.nominal_mm:g} mm"
        facts["Deviation from nominal"] = f"{fixed(gauge.deviation_mm, decimals, signed=True)} mm"
    if gauge.tolerance_mm is not None:
        facts["Tolerance"] = f"±{gauge.tolerance_mm:g} mm"
    facts["Expanded uncertainty U"] = f"{fixed(gauge.U_mm, decimals_of(gauge.U_mm))} mm"
    parts.append(_facts(facts, width))
    if (
        gauge.deviation_mm is not None
        and gauge.tolerance_mm is not None
        and np.isfinite(gauge.deviation_mm + gauge.U_mm)
    ):
        parts += [Spacer(0, 1 * mm), ToleranceBar(gauge.deviation_mm, gauge.U_mm, gauge.tolerance_mm, decimals, width)]
    parts += [Spacer(0, 1.5 * mm), text(verdict_sentence(gauge)), text(uncertainty_sentence(gauge), "caption")]
    return parts


def _cloud(content: ReportContent, width: float) -> list[Flowable]:
    cloud = content.cloud
    parts: list[Flowable] = [text("Point cloud", "label"), text(count(len(cloud), "point"), "result")]
    facts = {"Triangles of the mesh": grouped(len(content.mesh.triangles))}
    known = cloud.sigma[np.isfinite(cloud.sigma)]
    if len(known):
        middle, most = np.quantile(known, [0.5, 0.95])
        decimals = decimals_of(float(middle))
        facts["σ of depth, median"] = f"{fixed(float(middle), decimals)} mm"
        facts["σ of depth, 95 % below"] = f"{fixed(float(most), decimals)} mm"
    if len(cloud):
        size = np.ptp(cloud.points, axis=0)
        facts["Extent x, y, z"] = (
            " × ".join(fixed(float(value), 0 if size.max() >= 10 else 2) for value in size) + " mm"
        )
    sentence = (
        "No pair of parallel faces was evaluated, so there is no thickness and no verdict: this report is of the cloud."
    )
    return [*parts, Spacer(0, 2.5 * mm), _facts(facts, width), Spacer(0, 2 * mm), text(sentence)]
