"""The table of results: every characteristic with what is asked, what was measured, U, k and the decision."""

from __future__ import annotations

import math
from collections.abc import Collection

from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Table, TableStyle

from core.inspect.characteristic import Characteristic
from core.report.content import ReportContent
from core.report.look import Look
from core.report.result_marks import SIGNS
from core.report.style import TEXT_WIDTH
from core.report.tables import heads, ruled_table
from core.report.wording import VERDICTS, decimals_of, shown_name, shown_unit, tolerance_words

WIDTHS = [size * mm for size in (17, 27, 21, 16, 8, 18, 27)]
"""Nominal, permitted deviations, measured, U, k, deviation, decision; the name has the rest."""


def result_table(look: Look, content: ReportContent, budgets: Collection[int]) -> Table:
    """One row for each characteristic; the names of those whose numbers are in `budgets` lead to their budgets."""
    names = ("Characteristic", "nominal", "permitted", "measured", "U", "k", "deviation", "decision")
    rows: list[list[Flowable | list[Flowable]]] = [[*heads(look, *names, numbers=(1, 2, 3, 4, 5, 6))]]
    for number, one in enumerate(content.characteristics):
        rows.append(_row(look, one, budget_key(number) if number in budgets else ""))
    table = ruled_table(rows, [TEXT_WIDTH - sum(WIDTHS), *WIDTHS])
    table.setStyle(TableStyle([("LEFTPADDING", (7, 0), (7, -1), 5)]))
    return table


def budget_key(number: int) -> str:
    """What links call the budget of the characteristic of this number."""
    return f"budget-{number}"


def _row(look: Look, one: Characteristic, key: str) -> list[Flowable | list[Flowable]]:
    words, (unit, factor) = look.words, shown_unit(one)
    decimals = decimals_of(factor * one.U)
    limits = one.limits
    nominal = "" if limits is None else f"{words.general(factor * limits.nominal)}\u00a0{unit}"
    known = one.deviation is not None and math.isfinite(one.deviation)
    deviation = words.fixed(factor * (one.deviation or 0.0), decimals, signed=True) if known else ""
    name = shown_name(one, words)
    title = look.link(name, key, "small_strong") if key else look.text(name, "small_strong")
    rule: list[Flowable] = [look.text(words.known(one.rule), "rule")] if one.rule else []
    U = words.fixed(factor * one.U, decimals) if math.isfinite(one.U) else words("unknown")
    numbers = (
        nominal,
        tolerance_words(one, words),
        f"{words.fixed(factor * one.value, decimals)}\u00a0{unit}" if math.isfinite(one.value) else words("unknown"),
        U,
        words.general(one.k),
        deviation,
    )
    decision = f"{SIGNS[one.verdict]} {words(VERDICTS[one.verdict])}"
    return [
        [title, *rule],
        *(look.text(number, "number_strong" if place == 2 else "number") for place, number in enumerate(numbers)),
        look.text(decision, "small_strong"),
    ]
