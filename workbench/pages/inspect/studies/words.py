"""Studies in words and numbers: their kinds, figures and tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from workbench.language import number, text_of, tr
from workbench.pages.inspect import words as inspect_words
from workbench.pages.words import wording
from workbench.views.colours import Level
from workbench.views.lists.value_rows import ValueRow

if TYPE_CHECKING:
    from core.study.acceptance import AcceptanceCheck
    from core.study.grr import GrrStudy

LEVELS: dict[str, Level] = {
    "acceptable": "good",
    "acceptable with reservations": "warn",
    "not acceptable": "bad",
    "conforming": "good",
    "not proven": "warn",
    "not conforming": "bad",
}
Table = tuple[list[tuple[str, str]], list[Sequence[str]]]
"""Headers (title, unit) and rows of texts."""


def kind_title(kind: str) -> str:
    """What a kind of study is called."""
    return {
        "repeats": tr("Repeats"),
        "type1": tr("Type-1 study"),
        "grr": tr("Gauge R&R"),
        "acceptance": tr("Acceptance check"),
    }[kind]


def rows(kind: str, study: Any) -> list[ValueRow]:
    """The figures of a study."""
    made: Mapping[str, Callable[[Any], list[ValueRow]]] = {
        "type1": inspect_words.type1_rows,
        "grr": _grr_rows,
        "acceptance": _acceptance_rows,
    }
    return made[kind](study) if kind in made else []


def table(kind: str, study: Any) -> Table:
    """The table of a study; without headers where it has none."""
    made: Mapping[str, Callable[[Any], Table]] = {"grr": _components, "acceptance": _quantities}
    return made[kind](study) if kind in made else ([], [])


def verdict_row(verdict: str) -> ValueRow:
    """What was decided."""
    words = {
        "": tr("no limit stated"),
        "acceptable": tr("acceptable"),
        "acceptable with reservations": tr("with reservations"),
        "not acceptable": tr("not acceptable"),
        "conforming": tr("conforming"),
        "not proven": tr("not proven"),
        "not conforming": tr("not conforming"),
    }
    return tr("Decision"), words[verdict], "", LEVELS.get(verdict, "")


def _grr_rows(study: GrrStudy) -> list[ValueRow]:
    of_total, of_tolerance = study.component("gauge R&R").of_total, study.component("gauge R&R").of_tolerance
    said: list[ValueRow] = [verdict_row(study.verdict)]
    if of_tolerance is not None and study.tolerance is not None:
        tip = tr(
            "6 s of gauge R&R over T = {tolerance:g} mm; up to 10 % is good, above 30 % is not acceptable",
            tolerance=study.tolerance,
        )
        said.append((tr("%GRR of T"), _percent(of_tolerance), tip, ""))
    low, high = (_percent(end) for end in study.grr_interval)
    tip = tr("s of gauge R&R over the whole scatter; 95 % interval {low} to {high}", low=low, high=high)
    said.append((tr("%GRR of the total"), _percent(of_total), tip, ""))
    categories = "∞" if study.categories is None else str(study.categories)
    tip = tr("Number of distinct categories: how many groups of parts it can tell apart; 5 or more are wanted")
    said.append((tr("ndc"), categories, tip, "" if study.categories is None or study.categories >= 5 else "warn"))
    interaction = next((row for row in study.anova if row.source == "interaction"), None)
    if interaction is not None and interaction.p is not None:
        pooled = tr("pooled") if study.pooled else tr("kept")
        tip = tr("p = {p:.2g}: pooled with the error above 0.05", p=interaction.p)
        said.append((tr("Interaction"), pooled, tip, ""))
    return said


def _components(study: GrrStudy) -> Table:
    names = {
        "gauge R&R": tr("gauge R&R"),
        "repeatability": tr("repeatability"),
        "reproducibility": tr("reproducibility"),
        "operators": tr("  operators"),
        "interaction": tr("  interaction"),
        "parts": tr("parts"),
        "total": tr("total"),
    }
    with_tolerance = study.tolerance is not None
    headers = [(tr("Source"), ""), (tr("s"), study.unit), (tr("% of s²"), ""), (tr("% of total"), "")]
    headers += [(tr("% of T"), "")] if with_tolerance else []
    body: list[Sequence[str]] = []
    for one in study.components:
        shares = [one.contribution, one.of_total] + ([one.of_tolerance or 0.0] if with_tolerance else [])
        said = names.get(one.source, one.source)
        body.append([said, wording().fixed(one.sigma, 5), *(wording().fixed(100 * share, 1) for share in shares)])
    return headers, body


def _acceptance_rows(study: AcceptanceCheck) -> list[ValueRow]:
    return [verdict_row(study.verdict)]


def _quantities(study: AcceptanceCheck) -> Table:
    headers = [
        (tr("Quantity"), ""),
        (tr("Positions"), ""),
        (tr("Largest error"), "mm"),
        (tr("At"), ""),
        (tr("Limit"), "mm"),
        (tr("Decision"), ""),
    ]
    body: list[Sequence[str]] = [
        [
            text_of(one.title),
            str(len(one.readings)),
            wording().fixed(one.largest_error, 4, signed=True),
            one.worst.position,
            "" if one.limit is None else number(one.limit, "g"),
            verdict_row(one.verdict)[1] if one.verdict else "",
        ]
        for one in study.quantities
    ]
    return headers, body


def _percent(share: float) -> str:
    return f"{wording().fixed(100 * share, 1)} %" if math.isfinite(share) else "–"
