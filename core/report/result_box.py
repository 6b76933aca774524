"""The box at the top of page one: the result, the decision, and where the result lies in its tolerance."""

from __future__ import annotations

import numpy as np
from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Paragraph, Spacer, Table, TableStyle

from core.inspect.characteristic import Characteristic
from core.report.content import ReportContent
from core.report.language import grouped
from core.report.look import Look
from core.report.result_marks import ToleranceBar, VerdictMark
from core.report.style import HAIRLINE, SANS, TINT, color, markup
from core.report.tables import plain_table
from core.report.wording import (
    VERDICTS,
    decimals_of,
    decision_sentence,
    shown_name,
    shown_unit,
    tolerance_words,
    uncertainty_sentence,
    value_line,
)

PADDING = 5 * mm
BADGE = 46 * mm

WORST_FIRST = ("not conforming", "not proven", "conforming", "")


def result_box(look: Look, content: ReportContent, width: float) -> Table:
    """The box: of the one result, of all of them together, or of the cloud where there is none."""
    inner, found = width - 2 * PADDING, content.characteristics
    if len(found) == 1:
        rows = _one(look, found[0], inner)
    else:
        rows = _several(look, content, inner) if found else _cloud(look, content, inner)
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
        notes = look.words.count(len(content.all_notes), "remark")
        said = look.words("{remarks} under “Notes and warnings” further on.", remarks=notes)
        rows.append(look.link(said, "notes", "caption"))
    return Table([[rows]], colWidths=[width], style=style, hAlign="LEFT")


def _facts(look: Look, facts: dict[str, str], width: float) -> Table:
    cells = [[look.text(label, "label"), look.text(value, "fact")] for label, value in facts.items()]
    table = plain_table([cells], [width / len(cells)] * len(cells))
    table.setStyle(
        TableStyle([("LINEABOVE", (0, 0), (-1, 0), 0.5, color(HAIRLINE)), ("TOPPADDING", (0, 0), (-1, -1), 5)])
    )
    return table


def _one(look: Look, one: Characteristic, width: float) -> list[Flowable]:
    words, (unit, factor) = look.words, shown_unit(one)
    value, _, rest = value_line(one, words).partition(" (")
    rest = rest.replace(" ", "\u00a0")
    said = f'{markup(value)} <font name="{SANS}" size="11">({markup(rest)}</font>'
    name = shown_name(one, words)
    headline = [look.text(name[:1].upper() + name[1:], "label"), Paragraph(said, look.style("result"))]
    parts: list[Flowable] = [*_headed(look, headline, one.verdict, width), Spacer(0, 2.5 * mm)]
    decimals = max(decimals_of(factor * one.U), 0)
    facts = {}
    if one.limits is not None and one.deviation is not None:
        facts[words("Nominal value")] = f"{words.general(factor * one.limits.nominal)} {unit}"
        deviation = words.fixed(factor * one.deviation, decimals, signed=True)
        facts[words("Deviation from nominal")] = f"{deviation} {unit}"
        facts[words("Tolerance")] = tolerance_words(one, words)
    facts[words("Expanded uncertainty U")] = f"{words.fixed(factor * one.U, decimals_of(factor * one.U))} {unit}"
    parts.append(_facts(look, facts, width))
    if one.limits is not None and np.isfinite((one.deviation or 0.0) + one.U):
        parts += [Spacer(0, 1 * mm), ToleranceBar(look, one, width)]
    reason, meaning = decision_sentence(one, words), uncertainty_sentence(one.k, one.U, words)
    return [*parts, Spacer(0, 1.5 * mm), look.text(reason), look.text(meaning, "caption")]


def _headed(look: Look, headline: list[Flowable], verdict: str, width: float) -> list[Flowable]:
    """A headline with the decision beside it, if there is one."""
    if not verdict:
        return headline
    head = plain_table([[headline, VerdictMark(look, verdict, BADGE)]], [width - BADGE, BADGE])
    head.setStyle(TableStyle([("VALIGN", (1, 0), (1, 0), "MIDDLE")]))
    return [head]


def _several(look: Look, content: ReportContent, width: float) -> list[Flowable]:
    """How many of which decision; the worst of them is that of the part."""
    words, found = look.words, content.characteristics
    counts = {verdict: sum(one.verdict == verdict for one in found) for verdict in WORST_FIRST}
    worst = next(verdict for verdict in WORST_FIRST if counts[verdict])
    headline: list[Flowable] = [
        look.say("Result", "label"),
        look.text(words.count(len(found), "characteristic"), "result"),
    ]
    facts = {words(VERDICTS[verdict]): grouped(number) for verdict, number in counts.items() if number}
    said = words(
        "The decision on the part is the worst of those on its characteristics. Each is stated with U = k·u below; by "
        "ISO 14253-1 a deviation must stay within its tolerance even when it is enlarged by U."
    )
    return [
        *_headed(look, headline, worst, width),
        Spacer(0, 2.5 * mm),
        _facts(look, facts, width),
        Spacer(0, 2 * mm),
        look.text(said),
    ]


def _cloud(look: Look, content: ReportContent, width: float) -> list[Flowable]:
    cloud, words = content.cloud, look.words
    parts: list[Flowable] = [look.say("Point cloud", "label"), look.text(words.count(len(cloud), "point"), "result")]
    facts = {words("Triangles of the mesh"): grouped(len(content.mesh.triangles))}
    known = cloud.sigma[np.isfinite(cloud.sigma)]
    if len(known):
        middle, most = np.quantile(known, [0.5, 0.95])
        decimals = decimals_of(float(middle))
        facts[words("σ of depth, median")] = f"{words.fixed(float(middle), decimals)} mm"
        facts[words("σ of depth, 95 % below")] = f"{words.fixed(float(most), decimals)} mm"
    if len(cloud):
        size = np.ptp(cloud.points, axis=0)
        digits = 0 if size.max() >= 10 else 2
        facts[words("Extent x, y, z")] = " × ".join(words.fixed(float(value), digits) for value in size) + " mm"
    sentence = look.say(
        "No pair of parallel faces was evaluated, so there is no thickness and no verdict: this report is of the cloud."
    )
    return [*parts, Spacer(0, 2.5 * mm), _facts(look, facts, width), Spacer(0, 2 * mm), sentence]
