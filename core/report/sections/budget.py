"""The uncertainty budget of a characteristic (GUM): one row an input, u_c, ν_eff, k and U."""

from __future__ import annotations

from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Table, TableStyle

from core.inspect.characteristic import Characteristic
from core.report.facts.fact import Fact, heading
from core.report.facts.of_budget import INPUT, budget_facts, input_cells
from core.report.layout.blocks import ShareBar, plain_table, ruled_table
from core.report.layout.style import MUTED, TEXT_WIDTH, ReportLook, color

WIDTHS = [size * mm for size in (18, 19, 20, 17, 19, 11, 20)]
"""Value, distribution, u of input, sensitivity, contribution, degrees of freedom, share; the rest is the source's."""

DISTRIBUTION = 1
"""The cell that is no number."""

SHARE = 6
"""The last cell."""

IN_HEAD = (4, SHARE)
"""Cells whose unit is that of all rows and stands in the head: contribution and share."""

BAR = 9 * mm
"""Length of the bar of a whole share."""


def budget_table(look: ReportLook, one: Characteristic) -> Table:
    """Make the table of an uncertainty budget: its sources, their combination, and the result."""
    words, facts, cells = look.words, budget_facts(one), input_cells(one)
    sources, last = facts[: len(cells)], facts[len(cells) :]
    names = [fact.column(words) if place in IN_HEAD else fact.title(words) for place, fact in enumerate(cells[0])]
    styles = ["head" if place == DISTRIBUTION else "head_number" for place in range(len(names))]
    head = [
        look.fixed_text(INPUT, "head"),
        *(look.text(name, style) for name, style in zip(names, styles, strict=True)),
    ]
    rows: list[list[Flowable]] = [head]
    for source, row in zip(sources, cells, strict=True):
        shown = (_cell(look, place, fact) for place, fact in enumerate(row))
        rows.append([look.text(source.heading(words), "small"), *shown])
    for place, fact in enumerate(last):
        strong = "_strong" if place == len(last) - 1 else ""
        name = heading(fact.column(words) if strong else fact.title(words))
        blanks = [look.text("", "small") for _ in range(4)]
        rows.append(
            [
                look.text(name, f"small{strong}"), *blanks, look.text(fact.parts(words)[0], f"number{strong}"),
                look.text(""), look.text(""),
            ]
        )  # fmt: skip
    table = ruled_table(rows, [TEXT_WIDTH - sum(WIDTHS), *WIDTHS])
    line = -len(last) - 1
    spans = [("SPAN", (0, row), (4, row)) for row in range(-len(last), 0)]
    table.setStyle(TableStyle([("LINEBELOW", (0, line), (-1, line), 0.6, color(MUTED)), *spans]))
    return table


def _cell(look: ReportLook, place: int, fact: Fact) -> Flowable:
    if fact.value is None:
        return look.text("", "number")
    shown = fact.parts(look.words)[0] if place in IN_HEAD else fact.text(look.words)
    if place != SHARE or not isinstance(fact.value, float):
        return look.text(shown, "small" if place == DISTRIBUTION else "number")
    cells = [[ShareBar(look, fact.value / 100, BAR), look.text(shown, "number")]]
    table = plain_table(cells, [BAR, WIDTHS[-1] - BAR])
    sides = ("LEFTPADDING", "RIGHTPADDING", "TOPPADDING", "BOTTOMPADDING")
    table.setStyle(TableStyle([(side, (0, 0), (-1, -1), 0) for side in sides]))
    return table
