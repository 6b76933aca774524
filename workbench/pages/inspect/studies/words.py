"""Studies in words and numbers: their kinds, figures and tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from core.messages import capital
from core.model.arrays import Array
from core.states import DECISIONS, VERDICT
from core.study.series_chart import RULE_WORDS, Chart
from workbench.language import joined, named, number, text_of, tr
from workbench.pages.inspect import words as inspect_words
from workbench.pages.words import wording
from workbench.views.colours import Level
from workbench.views.lists.data_table import Header
from workbench.views.lists.value_rows import ValueRow

if TYPE_CHECKING:
    from core.study.acceptance import AcceptanceCheck
    from core.study.grr import GrrStudy
    from core.study.series import SeriesStudy

LEVELS: dict[str, Level] = {
    "capable": "good",
    "not capable": "bad",
    "acceptable": "good",
    "acceptable with reservations": "warn",
    "not acceptable": "bad",
    "conforming": "good",
    "not proven": "warn",
    "not conforming": "bad",
}
Table = tuple[list[Header], list[Sequence[str]]]
"""Headers and rows of texts."""


def kind_title(kind: str) -> str:
    """What a kind of study is called."""
    return {
        "repeats": tr("Repeats"),
        "type1": tr("Type-1 study"),
        "grr": tr("Gauge R&R"),
        "acceptance": tr("Acceptance check"),
        "series": tr("Series"),
    }[kind]


def rows(kind: str, study: Any) -> list[ValueRow]:
    """The figures of a study."""
    made: Mapping[str, Callable[[Any], list[ValueRow]]] = {
        "type1": inspect_words.type1_rows,
        "grr": _grr_rows,
        "acceptance": _acceptance_rows,
        "series": _series_rows,
    }
    return made[kind](study) if kind in made else []


def table(kind: str, study: Any) -> Table:
    """The table of a study; without headers where it has none."""
    made: Mapping[str, Callable[[Any], Table]] = {"grr": _components, "acceptance": _quantities, "series": _values}
    return made[kind](study) if kind in made else ([], [])


@dataclass(frozen=True, eq=False, slots=True)
class ShownChart:
    """A control chart as it is drawn: values (k,), NaN for none, whether each is good, its tip; the lines; the axes."""

    values: Array
    good: NDArray[np.bool_]
    tips: tuple[str, ...]
    limits: tuple[float, float, float]
    axes: tuple[str, str]


def charts(kind: str, study: Any) -> tuple[ShownChart, ...]:
    """The control charts of a study: two of a series with limits, else none."""
    if kind != "series" or study.charts is None:
        return ()
    single = study.size == 1
    titles = (tr("value"), tr("moving range")) if single else (tr("X̄"), tr("s"))
    both = (study.charts.location, study.label_of), (study.charts.spread, study.label_of_spread)
    return tuple(
        _shown(chart, study.points, label_of, (title, tr("part") if single else tr("subgroup")), study.unit)
        for (chart, label_of), title in zip(both, titles, strict=True)
    )


def _shown(chart: Chart, count: int, label_of: Callable[[int], str], axes: tuple[str, str], unit: str) -> ShownChart:
    """A chart `count` points wide: a moving range stands at its second value, and the first value has none."""
    missing = count - len(chart.points)
    tips = [""] * missing
    for place, value in enumerate(chart.points):
        said = named(label_of(place), f"{wording().fixed(float(value), 4)} {unit}")
        rules = [RULE_WORDS[one.rule - 1] for one in chart.breaks if one.place == place]
        tips.append("\n".join([said, *map(tr, rules)]))
    good = np.array([place - missing not in chart.breaking for place in range(count)])
    values = np.concatenate([np.full(missing, np.nan), chart.points])
    return ShownChart(values, good, tuple(tips), (chart.lower, chart.centre, chart.upper), axes)


def verdict_row(verdict: str) -> ValueRow:
    """What was decided."""
    return (
        capital(tr(VERDICT)),
        tr(DECISIONS[verdict]) if verdict else tr("no limit stated"),
        "",
        LEVELS.get(verdict, ""),
    )


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
    headers: list[Header] = [
        (tr("Source"), ""),
        (tr("s"), study.unit, tr("Standard deviation")),
        (tr("% of s²"), "", tr("Share of the whole variance")),
        (tr("% of total"), "", tr("s over that of the whole scatter")),
    ]
    headers += [(tr("% of T"), "", tr("6 s over the tolerance T"))] if with_tolerance else []
    body: list[Sequence[str]] = []
    for one in study.components:
        shares = [one.contribution, one.of_total] + ([one.of_tolerance or 0.0] if with_tolerance else [])
        said = names.get(one.source, one.source)
        body.append([said, wording().fixed(one.sigma, 5), *(wording().fixed(100 * share, 1) for share in shares)])
    return headers, body


def _acceptance_rows(study: AcceptanceCheck) -> list[ValueRow]:
    return [verdict_row(study.verdict)]


def _quantities(study: AcceptanceCheck) -> Table:
    headers: list[Header] = [
        (tr("Quantity"), ""),
        (tr("Positions"), ""),
        (tr("Largest error"), "mm"),
        (tr("At"), ""),
        (tr("Limit"), "mm"),
        (capital(tr(VERDICT)), ""),
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


def _series_rows(study: SeriesStudy) -> list[ValueRow]:
    about = {
        "Cp": tr("Width of the tolerance over 6 σ within a short time"),
        "Cpk": tr("Room from the mean to the nearer limit over 3 σ within a short time; capable: surely 1.33 or more"),
        "Pp": tr("Width of the tolerance over 6 s of all values"),
        "Ppk": tr("Room from the mean to the nearer limit over 3 s of all values; capable: surely 1.33 or more"),
    }
    said: list[ValueRow] = [verdict_row(study.verdict)]
    for name, index in study.indices.items():
        value, low, high = (wording().fixed(one, 2) for one in (index.value, *index.interval))
        shown = tr("{value} ({low} to {high})", value=value, low=low, high=high)
        said.append((name, shown, tr("{meaning}; in brackets its 95 % interval", meaning=about[name]), ""))
    for title, of_all in ((tr("Mean"), study.mean), (tr("s"), study.s)):
        said.append((title, f"{wording().fixed(of_all, 4)} {study.unit}", tr("Of all values"), ""))
    if study.share_of_u is not None:
        low, high = (_percent(share) for share in study.share_of_u)
        tip = tr("Part of s² that the measurement surely makes up, and at most, by its stated uncertainty")
        said.append((tr("Measurement in s²"), tr("{low} to {high}", low=low, high=high), tip, ""))
    return said


def _values(study: SeriesStudy) -> Table:
    """Points of the chart in their order, with the rules each of them breaks."""
    charts = study.charts
    broken: dict[int, list[str]] = {}
    for one in () if charts is None else charts.location.breaks:
        broken.setdefault(one.place, []).append(str(one.rule))
    points = study.values if charts is None else charts.location.points
    called = study.labels if charts is None else [study.label_of(place) for place in range(len(points))]
    headers: list[Header] = [
        (tr("Part"), ""),
        (tr("Value") if study.size == 1 else tr("X̄"), study.unit),
        (tr("Rule broken"), ""),
    ]
    body: list[Sequence[str]] = [
        [name, wording().fixed(float(value), 4), joined(broken.get(place, ()))]
        for place, (name, value) in enumerate(zip(called, points, strict=True))
    ]
    return headers, body


def _percent(share: float) -> str:
    return f"{wording().fixed(100 * share, 1)} %" if math.isfinite(share) else "–"
