"""What is told of a study: its facts, and its tables."""

from __future__ import annotations

import math

import numpy as np

from core.messages import Message, decimals_of, label, plain
from core.report.facts.fact import Fact, Grade, Reader
from core.report.facts.of_budget import EFFECTIVE, freedom_fact
from core.report.facts.of_repeats import LEAST_DIGITS, repeat_facts
from core.report.facts.of_verdict import decision, verdict_fact
from core.report.facts.table import Column, FactTable, Uncertain
from core.report.wording import ENGLISH, Words
from core.states import SPREAD, VERDICT
from core.wings.studies.kinds.acceptance import AcceptanceCheck
from core.wings.studies.kinds.budget import UncertaintyBudget
from core.wings.studies.kinds.capability import LIMIT as CAPABILITY
from core.wings.studies.kinds.capability import Index
from core.wings.studies.kinds.grr import ENOUGH_CATEGORIES, GOOD, POOLED_ABOVE, USABLE, Component, GrrStudy
from core.wings.studies.kinds.repeats import THICKNESS, RepeatStudy
from core.wings.studies.kinds.series import SeriesStudy
from core.wings.studies.kinds.study import KINDS, Study, kind_of
from core.wings.studies.kinds.type1 import LIMIT, RESOLUTION_SHARE, Type1Study

SOURCES = {
    "gauge R&R": label("gauge R&R"), "repeatability": label("repeatability"), "error": label("repeatability"),
    "reproducibility": label("reproducibility"), "operators": label("operators"), "interaction": label("interaction"),
    "parts": label("parts"), "total": label("total"),
}  # fmt: skip
"""Of variation, by the names that `core.wings.studies.kinds.grr` gives them."""
MEAN_OF_ALL, SPREAD_OF_ALL = label("Mean of all values"), label("Standard deviation of all values (over n − 1)")
_OF_INDICES = {
    "Cp": label("Width of the tolerance over 6 σ within a short time"),
    "Cpk": label("Room from the mean to the nearer limit over 3 σ within a short time"),
    "Pp": label("Width of the tolerance over 6 s of all values"),
    "Ppk": label("Room from the mean to the nearer limit over 3 s of all values"),
}
"""What the indices of a process are."""


def study_title(study: Study, words: Words = ENGLISH) -> str:
    """Write the title of a study: 'Gauge R&R', 'Series: thickness'."""
    kind, name = words(KINDS[kind_of(study)]), name_of(study)
    return words("{name}: {value}", name=kind, value=name) if name else kind


def name_of(study: Study) -> str:
    """Return the name of what a study of repeats or a series measured, as "thickness"; "" for other kinds of study."""
    if not isinstance(study, (RepeatStudy, SeriesStudy)):
        return ""
    return label("thickness") if study.name == THICKNESS else study.name


def study_facts(study: Study) -> tuple[Fact, ...]:
    """Make the facts (name, value, unit) on a study, its verdict first."""
    match study:
        case RepeatStudy():
            facts = _of_repeats(study)
        case Type1Study():
            facts = _of_type1(study)
        case GrrStudy():
            facts = _of_grr(study)
        case SeriesStudy():
            facts = _of_series(study)
        case AcceptanceCheck():
            facts = []
    return (verdict_fact(study.verdict), *facts)


def study_tables(study: Study) -> tuple[FactTable, ...]:
    """Make the tables of a study, the most important first; () for a type-1 study."""
    match study:
        case RepeatStudy():
            return (_contributions(study.budget),)
        case GrrStudy():
            return _components(study), _anova(study)
        case SeriesStudy():
            return _points(study), *_control_limits(study)
        case AcceptanceCheck():
            return (_quantities(study),)
        case Type1Study():
            return ()


def digits_of(study: Type1Study | SeriesStudy) -> int:
    """Compute how many decimals a study's values are shown with: one more than their standard deviation."""
    return max(decimals_of(study.s) + 1, LEAST_DIGITS)


def _of_repeats(study: RepeatStudy) -> list[Fact]:
    budget, unit = study.budget, study.unit
    digits = max(decimals_of(budget.U), decimals_of(study.statistics.std_mm), LEAST_DIGITS)
    about = Message("study.tip_of_mean", "Expanded uncertainty that covers {coverage:.2%}", coverage=budget.coverage)
    facts = [
        *repeat_facts(study.statistics, unit, study.nominal, digits),
        Fact(label("U of the mean"), budget.U, unit, digits, about),
        Fact(label("k of the mean"), budget.k, digits=2, tip=label("Coverage factor of U"), level=Reader.AUDITOR),
        freedom_fact(EFFECTIVE, budget.dof, Reader.METROLOGIST),
    ]
    if study.run is not None:
        about_run = label("A steady measurement seldom leaves the control limits (individual values, ISO 7870-2)")
        facts += [
            Fact(label("lower control limit"), study.run.lower, unit, digits, about_run, Reader.AUDITOR),
            Fact(label("upper control limit"), study.run.upper, unit, digits, about_run, Reader.AUDITOR),
        ]
    if study.zones is not None and study.nominal is not None:
        rule = label("The limits are drawn in by it on both sides (ISO 14253-1)")
        facts += _limits(study.nominal + study.zones.lower, study.nominal + study.zones.upper, unit)
        facts.append(Fact(label("guard band"), study.zones.guard_band, unit, digits, rule, Reader.AUDITOR))
    return facts


def _of_type1(study: Type1Study) -> list[Fact]:
    unit, digits = study.unit, digits_of(study)
    asked = Message(
        "study.tip_capable", "(0.1 T − |bias|) / (3 s); capable if Cg and Cgk are {limit:g} or more", limit=LIMIT
    )
    smallest = Message("study.tip_smallest", "Smallest tolerance for which Cgk reaches {limit:g}", limit=LIMIT)
    facts = [
        Fact("Cg", study.cg, digits=2, tip="0.2 T / (6 s)", interval=study.cg_interval),
        Fact("Cgk", study.cgk, digits=2, tip=asked),
        Fact(
            label("bias"), study.bias, unit, digits, label("Mean less the reference value"), Reader.AUDITOR,
            interval=study.bias_interval, signed=True,
        ),
        Fact(SPREAD, study.s, unit, digits, SPREAD_OF_ALL, Reader.AUDITOR),
        Fact(label("repeats"), study.n, level=Reader.AUDITOR),
        Fact(label("mean"), study.mean, unit, digits, MEAN_OF_ALL, Reader.AUDITOR),
        Fact(label("reference value"), study.reference, unit, level=Reader.AUDITOR),
        _tolerance(study.tolerance, unit),
        Fact(label("smallest T"), study.smallest_tolerance, unit, digits, smallest, Reader.AUDITOR),
    ]  # fmt: skip
    if study.resolution is not None and study.resolution_share is not None:
        most = Message("study.tip_resolution", "At most {share:.0%} of T suffice", share=RESOLUTION_SHARE)
        grade: Grade = "good" if study.resolution_suffices else "bad"
        facts += [
            Fact(label("resolution"), study.resolution, unit, level=Reader.AUDITOR),
            Fact(
                label("resolution of T"), 100 * study.resolution_share, "%", 1, most, Reader.AUDITOR, grade=grade
            ),
        ]  # fmt: skip
    probable = label("t-test: how probable a bias as large is without any")
    return [
        *facts,
        Fact("t", study.t, digits=2, tip=label("Statistic of the t-test of the bias"), level=Reader.METROLOGIST),
        Fact(label("p of the bias"), study.p, tip=probable, level=Reader.METROLOGIST, significant=2),
    ]


def _of_grr(study: GrrStudy) -> list[Fact]:
    of_all, (parts, operators, repeats) = study.component("gauge R&R"), study.values.shape
    facts = []
    if of_all.of_tolerance is not None and study.tolerance_interval is not None:
        judged = Message(
            "study.tip_grr_of_tolerance",
            "6 σ of gauge R&R over T; up to {good:.0%} is acceptable, above {usable:.0%} is not",
            good=GOOD, usable=USABLE,
        )  # fmt: skip
        facts.append(_share(label("%GRR of T"), of_all.of_tolerance, study.tolerance_interval, judged))
    judged = Message(
        "study.tip_grr_of_total",
        "σ of gauge R&R over that of the whole scatter; up to {good:.0%} is acceptable, above {usable:.0%} is not",
        good=GOOD, usable=USABLE,
    )  # fmt: skip
    deciding = Reader.AUDITOR if facts else Reader.TECHNICIAN
    facts.append(_share(label("%GRR of the total"), of_all.of_total, study.grr_interval, judged, deciding))
    wanted = Message(
        "study.tip_categories", "How many groups of parts it can tell apart; {least} or more are wanted",
        least=ENOUGH_CATEGORIES,
    )  # fmt: skip
    few = study.categories is not None and study.categories < ENOUGH_CATEGORIES
    whole = math.inf if study.categories is None else study.categories
    facts += [
        Fact(label("categories (ndc)"), whole, tip=wanted, grade="warn" if few else ""),
        Fact(label("parts"), parts, level=Reader.AUDITOR),
        Fact(label("operators"), operators, level=Reader.AUDITOR),
        Fact(label("repeats"), repeats, tip=label("Of each part by each operator"), level=Reader.AUDITOR),
    ]
    if study.tolerance is not None:
        facts.append(_tolerance(study.tolerance, study.unit))
    before = label("√2 σ of the parts over σ of gauge R&R, before it is cut off to a whole number")
    facts.append(
        Fact(
            label("categories, not cut off"), study.ndc, digits=2, tip=before, level=Reader.METROLOGIST,
            interval=study.ndc_interval,
        )
    )  # fmt: skip
    interaction = next((row for row in study.anova if row.source == "interaction"), None)
    if interaction is not None and interaction.p is not None:
        pooled = Message(
            "study.tip_pooled", "Above {limit:g} the interaction is pooled with the repeatability", limit=POOLED_ABOVE
        )
        p = Fact(label("p of the interaction"), interaction.p, tip=pooled, level=Reader.METROLOGIST, significant=3)
        facts.append(p)
    return facts


def _of_series(study: SeriesStudy) -> list[Fact]:
    unit, digits = study.unit, digits_of(study)
    facts = [_index(name, index) for name, index in study.indices.items()]
    level = Reader.AUDITOR if facts else Reader.TECHNICIAN
    facts += [
        Fact(label("mean"), study.mean, unit, digits, MEAN_OF_ALL, level),
        Fact(SPREAD, study.s, unit, digits, SPREAD_OF_ALL, level),
        Fact(label("parts"), study.n, level=Reader.AUDITOR),
        *_limits(study.lower, study.upper, unit),
    ]
    if study.size > 1:
        facts.append(Fact(label("subgroup"), study.size, tip=label("Parts a subgroup"), level=Reader.AUDITOR))
    if study.share_of_u is not None:
        about = label("What the measurement makes up of s², by its stated uncertainty")
        facts += [
            Fact(name, 100 * share, "%", 1, about, Reader.AUDITOR)
            for name, share in zip(
                (label("measurement in s², surely"), label("measurement in s², at most")), study.share_of_u, strict=True
            )
        ]
    return facts


def _index(name: str, index: Index) -> Fact:
    about: str | Message = _OF_INDICES[name]
    if name not in ("Cpk", "Ppk"):
        return Fact(name, index.value, digits=2, tip=about, level=Reader.AUDITOR, interval=index.interval)
    asked = Message("study.tip_index", "{what}; capable: surely {limit:g} or more", what=about, limit=CAPABILITY)
    return Fact(name, index.value, digits=2, tip=asked, interval=index.interval)


def _limits(lower: float, upper: float, unit: str) -> list[Fact]:
    """Those of the characteristic that there are."""
    ends = (label("lower limit"), lower), (label("upper limit"), upper)
    return [Fact(name, end, unit, level=Reader.AUDITOR) for name, end in ends if math.isfinite(end)]


def _tolerance(width: float, unit: str) -> Fact:
    return Fact(
        label("tolerance T"), width, unit, tip=label("Full width: upper less lower limit"), level=Reader.AUDITOR
    )


def _share(
    name: str, share: float, interval: tuple[float, float], tip: Message, level: Reader = Reader.TECHNICIAN
) -> Fact:
    low, high = interval
    return Fact(name, 100 * share, "%", 1, tip, level, interval=(100 * low, 100 * high))


def _contributions(budget: UncertaintyBudget) -> FactTable:
    """What U of the mean rests on, the largest first."""
    rows = sorted(budget.rows, key=lambda row: -row.u_mm)
    columns = (
        Column(label("contribution to U of the mean")),
        Column("u", budget.unit, max(decimals_of(budget.u), LEAST_DIGITS), label("Standard uncertainty (k = 1)")),
        Column(label("share of u²"), "%", 1, label("Share of the whole variance")),
    )
    cells = tuple((row.words, row.u_mm, 100 * budget.share(row)) for row in rows)
    return FactTable(columns, cells, level=Reader.AUDITOR)


def _components(study: GrrStudy) -> FactTable:
    unit, digits = study.unit, max(decimals_of(study.component("gauge R&R").sigma) + 1, LEAST_DIGITS)
    columns = [
        Column(label("source of variation")),
        Column("σ", unit, digits, label("Standard deviation")),
        Column(label("σ at least"), unit, digits, label("95 % confidence interval"), Reader.METROLOGIST),
        Column(label("σ at most"), unit, digits, label("95 % confidence interval"), Reader.METROLOGIST),
        Column(label("share of σ²"), "%", 1, label("Share of the whole variance")),
        Column(label("of the total"), "%", 1, label("σ over that of the whole scatter")),
    ]
    if study.tolerance is not None:
        columns.append(Column(label("of T"), "%", 1, label("6 σ over the tolerance T")))
    rows = tuple(_component(one)[: len(columns)] for one in study.components)
    return FactTable(tuple(columns), rows)


def _component(one: Component) -> tuple[str | float | None, ...]:
    low, high = (math.sqrt(end) for end in one.variance_interval)
    of_tolerance = None if one.of_tolerance is None else 100 * one.of_tolerance
    return SOURCES[one.source], one.sigma, low, high, 100 * one.contribution, 100 * one.of_total, of_tolerance


def _anova(study: GrrStudy) -> FactTable:
    columns = (
        Column(label("source of variation")),
        Column("SS", significant=6, tip=label("Sum of squares")),
        Column("ν", tip=label("Degrees of freedom")),
        Column("MS", significant=4, tip=label("Mean square")),
        Column("F", significant=3),
        Column("p", significant=3),
    )
    rows = tuple(
        (SOURCES[row.source], row.ss, row.dof, None if math.isnan(row.ms) else row.ms, row.f, row.p)
        for row in study.pooled_anova or study.anova
    )
    return FactTable(columns, rows, label("ANOVA"), Reader.METROLOGIST)


def _points(study: SeriesStudy) -> FactTable:
    """The points of the chart in their order, with the rules that each of them breaks."""
    charts, digits = study.charts, digits_of(study)
    points = study.values if charts is None else charts.location.points
    names = study.labels if charts is None else tuple(study.label_of(place) for place in range(len(points)))
    broken: dict[int, list[str]] = {}
    for one in () if charts is None else charts.location.breaks:
        broken.setdefault(one.place, []).append(str(one.rule))
    columns = (
        Column(label("part") if study.size == 1 else label("subgroup")),
        Column(label("value") if study.size == 1 else "X̄", study.unit, digits),
        Column(label("rule broken"), tip=label("Of Western Electric's four rules")),
    )
    rows = tuple(
        (plain(name), float(value), plain(", ".join(broken[place])) if place in broken else None)
        for place, (name, value) in enumerate(zip(names, np.asarray(points), strict=True))
    )
    return FactTable(columns, rows, level=Reader.METROLOGIST)


def _control_limits(study: SeriesStudy) -> tuple[FactTable, ...]:
    """Those of both charts; nothing where there are too few points for any."""
    if study.charts is None:
        return ()
    digits = digits_of(study)
    columns = (
        Column(label("control chart")),
        Column(label("mean"), study.unit, digits),
        Column(label("lower control limit"), study.unit, digits),
        Column(label("upper control limit"), study.unit, digits),
    )
    charts = zip(chart_names(study), (study.charts.location, study.charts.spread), strict=True)
    rows = tuple((name, chart.centre, chart.lower, chart.upper) for name, chart in charts)
    return (FactTable(columns, rows, label("control chart"), Reader.AUDITOR),)


def chart_names(study: SeriesStudy) -> tuple[str, str]:
    """Return the names of the points of a series' two control charts: "X̄", "s", or "value", "moving range"."""
    return (label("value"), label("moving range")) if study.size == 1 else (label("X̄"), label("s"))


def _quantities(study: AcceptanceCheck) -> FactTable:
    columns = (
        Column(label("quantity")),
        Column(label("positions")),
        Column(label("largest error"), "mm", signed=True),
        Column(label("at"), tip=label("Position of the largest error")),
        Column(label("limit"), "mm"),
        Column(VERDICT),
    )
    rows = tuple(
        (
            one.title, one.positions, Uncertain(one.largest_error, one.k * one.worst.u),
            plain(one.worst.position), one.limit, decision(one.verdict) or None,
        )
        for one in study.quantities
    )  # fmt: skip
    return FactTable(columns, rows)
