"""The company's own words, and the lines to sign on."""

from __future__ import annotations

from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Spacer, TableStyle

from core.report.content import ReportContent
from core.report.layout import section
from core.report.look import Look
from core.report.style import MUTED, TEXT_WIDTH, color
from core.report.tables import plain_table

A_ROW = 3
"""Signatures beside each other."""

ROOM = 14 * mm
"""Above a line, for the hand."""


def signatures(look: Look, content: ReportContent) -> list[Flowable]:
    """A line for everyone who signs: those of the template, or else the operator."""
    names = content.template.signatures or (content.operator,)
    own = [look.text(content.template.text, "small")] if content.template.text else []
    lines: list[Flowable] = []
    for start in range(0, len(names), A_ROW):
        row = names[start : start + A_ROW]
        cells = [[look.text(name, "small_strong"), look.say("Date, signature", "label")] for name in row]
        columns: list[list[Flowable]] = []
        for cell in cells:
            columns += [cell, []]
        width, gap = (TEXT_WIDTH - (A_ROW - 1) * 8 * mm) / A_ROW, 8 * mm
        table = plain_table([columns[:-1]], ([width, gap] * len(row))[:-1])
        above = [("LINEABOVE", (2 * place, 0), (2 * place, 0), 0.5, color(MUTED)) for place in range(len(row))]
        table.setStyle(TableStyle(above))
        lines += [Spacer(0, ROOM), table]
    return [section(look, "signatures", "Signatures", [*own, *lines])]
