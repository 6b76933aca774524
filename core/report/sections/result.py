"""The result on page one: the box with the verdict, the bar of the tolerance, and the table of all characteristics."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Spacer, Table, TableStyle

from core.inspect.characteristic import Characteristic
from core.inspect.conformity import WORST_FIRST, Verdict
from core.messages import plural_message
from core.report.content import ReportContent
from core.report.facts.fact import Reader, for_reader
from core.report.facts.of_features import HEADS, characteristic_cells, characteristic_facts
from core.report.layout.blocks import heads, plain_table, ruled_table, texts_by_name
from core.report.layout.control_frame import ControlFrameMark
from core.report.layout.paragraph import Paragraph
from core.report.layout.style import (
    BOLD,
    HAIRLINE,
    INK,
    MUTED,
    SANS,
    TEXT_WIDTH,
    TINT,
    ReportLook,
    color,
    draw_words,
    markup,
    words_width,
)
from core.report.tolerance_scale import ToleranceScale
from core.report.wording import (
    SIGNS,
    decision_sentence,
    grouped,
    headed_name,
    points_counted,
    shown_name,
    unbroken,
    uncertainty_sentence,
    value_parts,
    verdict_title,
)

PADDING = 5 * mm  # of the box, inside
BADGE = 46 * mm  # width of the verdict's mark

SHOWN_FIRST = (*WORST_FIRST, Verdict.NONE)


def result_box(look: ReportLook, content: ReportContent, width: float) -> Table:
    """Make the box with the verdict: on the one result, on several together, or on the cloud if there is no result."""
    inner, found = width - 2 * PADDING, content.characteristics
    verdict = content.results.verdict
    if len(found) == 1 and found[0].verdict == verdict:
        rows = _one(look, found[0], inner)
    else:
        rows = _several(look, content, inner) if found or verdict else _cloud(look, content, inner)
    style = TableStyle(
        [
            ("FONTNAME", (0, 0), (-1, -1), SANS),
            ("BACKGROUND", (0, 0), (-1, -1), color(TINT)),
            ("LINEBEFORE", (0, 0), (0, -1), 2.2, look.accent_color),
            ("LEFTPADDING", (0, 0), (-1, -1), PADDING),
            ("RIGHTPADDING", (0, 0), (-1, -1), PADDING),
            ("TOPPADDING", (0, 0), (-1, -1), 3.5 * mm),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 3.5 * mm),
        ]
    )
    if content.all_notes:
        notes = look.words(plural_message("report.remarks", "{n:,} remark", "{n:,} remarks", n=len(content.all_notes)))
        said = look.words("{remarks} under “Notes and warnings” further on.", remarks=notes)
        rows.append(look.link(said, "notes", "caption"))
    return Table([[rows]], colWidths=[width], style=style, hAlign="LEFT")


def _facts(look: ReportLook, facts: dict[str, str], width: float) -> list[Flowable]:
    if not facts:
        return []
    cells = [[look.text(label, "label"), look.text(value, "fact")] for label, value in facts.items()]
    table = plain_table([cells], [width / len(cells)] * len(cells))
    table.setStyle(
        TableStyle([("LINEABOVE", (0, 0), (-1, 0), 0.5, color(HAIRLINE)), ("TOPPADDING", (0, 0), (-1, -1), 5)])
    )
    return [table]


def _one(look: ReportLook, one: Characteristic, width: float) -> list[Flowable]:
    words = look.words
    headline = [look.text(headed_name(one, words), "label"), _value(look, one)]
    parts: list[Flowable] = [*_headed(look, headline, one.verdict, width), Spacer(0, 2.5 * mm)]
    parts += _facts(look, texts_by_name(look, characteristic_facts(one)[1:-1]), width)  # value and verdict stand above
    if scale := ToleranceScale.of(one):
        parts += [Spacer(0, 1 * mm), ToleranceBar(look, scale, width)]
    reason, meaning = decision_sentence(one, words), uncertainty_sentence(one.k, one.U, words)
    captions = [look.text(said, "caption") for said in (_rule(look, one), meaning)]
    return [*parts, Spacer(0, 1.5 * mm), look.text(reason), *captions]


def _rule(look: ReportLook, one: Characteristic) -> str:
    """The rule by which it is decided, or that none is applied."""
    if one.limits is None:
        return look.words("Decision rule: none, for no limits are stated.")
    return look.words("Decision rule: ISO 14253-1, a deviation must stay within its tolerance even when enlarged by U.")


def _value(look: ReportLook, one: Characteristic) -> Paragraph:
    """'50.012 mm ± 0.024 mm', large, and k."""
    value, coverage = value_parts(one, look.words)
    said = f'{look.markup(value)} <font name="{SANS}" size="11">{markup(unbroken(coverage))}</font>'
    return Paragraph(said, look.style("result"))


def _headed(look: ReportLook, headline: list[Flowable], verdict: Verdict, width: float) -> list[Flowable]:
    """A headline with the verdict beside it, if there is one."""
    if not verdict:
        return headline
    head = plain_table([[headline, VerdictMark(look, verdict, BADGE)]], [width - BADGE, BADGE])
    head.setStyle(TableStyle([("VALIGN", (1, 0), (1, 0), "MIDDLE")]))
    return [head]


def _several(look: ReportLook, content: ReportContent, width: float) -> list[Flowable]:
    """The verdict on the part, the worst characteristic, and how many of which verdict there are."""
    words, found = look.words, content.results.worst_first
    counts = {verdict: sum(one.verdict == verdict for one in found) for verdict in SHOWN_FIRST}
    verdict = content.results.verdict
    results = plural_message("report.characteristics", "{n:,} characteristic", "{n:,} characteristics", n=len(found))
    headline: list[Flowable] = [look.fixed_text("Result", "label"), look.text(words(results), "result")]
    if found and found[0].verdict:
        title = words("{name}: the worst of {all}", name=headed_name(found[0], words), all=words(results))
        headline = [look.text(title, "label"), _value(look, found[0])]
    facts = {verdict_title(verdict, words): grouped(number) for verdict, number in counts.items() if number}
    said = words(
        "The verdict on the part is the worst of those on its characteristics. Each is stated with U = k·u below; by "
        "ISO 14253-1 a deviation must stay within its tolerance even when it is enlarged by U."
    )
    return [
        *_headed(look, headline, verdict, width),
        Spacer(0, 2.5 * mm),
        *_facts(look, facts, width),
        Spacer(0, 2 * mm),
        look.text(said),
    ]


def _cloud(look: ReportLook, content: ReportContent, width: float) -> list[Flowable]:
    parts: list[Flowable] = [
        look.fixed_text("Point cloud", "label"),
        look.text(look.words(points_counted(len(content.cloud))), "result"),
    ]
    _points, *rest = for_reader(content.scan_facts, Reader.TECHNICIAN)
    facts = texts_by_name(look, rest)
    sentence = look.fixed_text(
        "No pair of parallel faces was evaluated, so there is no thickness and no verdict: this report is of the cloud."
    )
    return [*parts, Spacer(0, 2.5 * mm), *_facts(look, facts, width), Spacer(0, 2 * mm), sentence]


WIDTHS = [size * mm for size in (15.5, 27, 19.5, 16.5, 8, 18.5, 32.5)]
"""Nominal, permitted deviations, measured, U, k, deviation, verdict; the name has the rest."""
DECIDED = {verdict: "small" if verdict is Verdict.NONE else "small_strong" for verdict in Verdict}
"""How a verdict is written: where there is none, it is not made much of."""


def result_table(look: ReportLook, content: ReportContent, budgets: Collection[int]) -> Table:
    """Make the table of all characteristics; those numbered in `budgets` link to their uncertainty budgets."""
    keys = [budget_key(number) if number in budgets else "" for number in range(len(content.characteristics))]
    return characteristics_table(look, content, content.characteristics, keys)


def characteristics_table(
    look: ReportLook, content: ReportContent, shown: Sequence[Characteristic], keys: Sequence[str] = ()
) -> Table:
    """Make the table of the characteristics `shown`, each name a link to its key in `keys` unless that is ""."""
    head = heads(look, "Characteristic", *HEADS, numbers=range(1, 7))
    rows: list[list[Flowable | list[Flowable]]] = [[*head]]
    rows += [_row(look, content, one, key) for one, key in zip(shown, keys or [""] * len(shown), strict=True)]
    table = ruled_table(rows, [TEXT_WIDTH - sum(WIDTHS), *WIDTHS])
    table.setStyle(TableStyle([("LEFTPADDING", (7, 0), (7, -1), 5)]))
    return table


def budget_key(number: int) -> str:
    """Return the link key of the uncertainty budget of characteristic `number`."""
    return f"budget-{number}"


def _row(look: ReportLook, content: ReportContent, one: Characteristic, key: str) -> list[Flowable | list[Flowable]]:
    words = look.words
    *numbers, _ = characteristic_cells(one, words)
    name = shown_name(one, words)
    title = look.link(name, key, "small_strong") if key else look.text(name, "small_strong")
    below: list[Flowable] = [look.text(words.known(one.rule), "rule")] if one.rule else []
    if letter := content.datums.get(content.features.get(one.name, "")):
        below.insert(0, look.fixed_text("Datum {letter}", "rule", letter=letter))
    if frame := content.control_frames.get(one.name):
        below.insert(0, ControlFrameMark(look, frame))
    decided = f"{SIGNS[one.verdict]} {verdict_title(one.verdict, words)}"
    return [
        [title, *below],
        *(look.text(number, "number_strong" if place == 2 else "number") for place, number in enumerate(numbers)),
        look.text(decided, DECIDED[one.verdict]),
    ]


class VerdictMark(Flowable):  # type: ignore[misc]
    """Verdict as word and form: filled with ✓, dark with ✗, outlined with ?."""

    def __init__(self, look: ReportLook, verdict: Verdict, width: float) -> None:
        super().__init__()
        self.look, self.verdict, self.width, self.height = look, verdict, width, 10 * mm

    def draw(self) -> None:
        """Paint the mark (called by reportlab)."""
        tone = {Verdict.CONFORMING: self.look.accent, Verdict.NONE: MUTED}.get(self.verdict, INK)
        filled = self.verdict in (Verdict.CONFORMING, Verdict.NOT_CONFORMING)
        words = f"{SIGNS[self.verdict]}  {verdict_title(self.verdict, self.look.words)}"
        size = min(10.5, 10.5 * (self.width - 6) / words_width(words, BOLD, 10.5))
        canvas = self.canv
        canvas.setStrokeColor(color(tone))
        canvas.setFillColor(color(tone if filled else "#FFFFFF"))
        canvas.setLineWidth(0.9)
        canvas.roundRect(0, 0, self.width, self.height, 1.2 * mm, stroke=1, fill=1)
        canvas.setFillColor(color("#FFFFFF" if filled else tone))
        draw_words(canvas, (self.width / 2, self.height / 2 - 3.8), words, BOLD, size, share=0.5)


class ToleranceBar(Flowable):  # type: ignore[misc]
    """Bar with the place of a result in its tolerance, to scale."""

    def __init__(self, look: ReportLook, scale: ToleranceScale, width: float) -> None:
        super().__init__()
        self.look, self.scale, self.width, self.height = look, scale, width, 15 * mm

    def x(self, value: float) -> float:
        """Compute the horizontal place of a deviation on the bar, in points."""
        return self.width * self.scale.share(value)

    def draw(self) -> None:
        """Paint the bar (called by reportlab)."""
        canvas, axis, scale = self.canv, 6.6 * mm, self.scale
        low, high = self.x(scale.lower), self.x(scale.upper)
        canvas.setFillColor(color("#D5E2E7"))
        canvas.rect(low, axis - 2.4 * mm, high - low, 4.8 * mm, stroke=0, fill=1)
        canvas.setStrokeColor(color(MUTED))
        canvas.setLineWidth(0.5)
        canvas.line(0, axis, self.width, axis)
        canvas.setLineWidth(1.0)
        for place in map(self.x, scale.limits):
            canvas.line(place, axis - 2.4 * mm, place, axis + 2.4 * mm)
        self._words(low, high, axis)
        canvas.setStrokeColor(self.look.accent_color)
        canvas.setFillColor(self.look.accent_color)
        left, right, middle = (self.x(scale.deviation + offset) for offset in (-scale.U, scale.U, 0.0))
        canvas.setLineWidth(1.8)
        canvas.line(left, axis, right, axis)
        canvas.setLineWidth(1.2)
        for place in (left, right):
            canvas.line(place, axis - 1.1 * mm, place, axis + 1.1 * mm)
        canvas.circle(middle, axis, 1.0 * mm, stroke=0, fill=1)

    def _words(self, low: float, high: float, axis: float) -> None:
        canvas, words, scale = self.canv, self.look.words, self.scale
        canvas.setFillColor(color(MUTED))
        below, above = axis - 2.4 * mm - 7.5, axis + 2.4 * mm + 2.5
        lean = min(8.0, (high - low) / 2 - 2)  # the two never meet, however narrow the zone is drawn
        for place, limit, share in ((low + lean, scale.lower, 1.0), (high - lean, scale.upper, 0.0)):
            if np.isfinite(limit):
                draw_words(canvas, (place, below), scale.limit_text(limit, words), SANS, 6.5, share)
        if high - low > 45 * mm and len(scale.limits) == 2:
            canvas.setStrokeColor(color(MUTED))
            canvas.setLineWidth(0.5)
            canvas.line(self.x(0), axis - 2.4 * mm, self.x(0), axis + 2.4 * mm)
            draw_words(canvas, (self.x(0), below), words("nominal"), SANS, 6.5, share=0.5)
        canvas.setFillColor(self.look.accent_color)
        said = scale.deviation_text(words)
        half = words_width(said, SANS, 6.5) / 2
        middle = float(np.clip(self.x(scale.deviation), half, self.width - half))
        draw_words(canvas, (middle, above), said, SANS, 6.5, share=0.5)
