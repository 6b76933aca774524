"""Studies as rows for people."""

from __future__ import annotations

import math

from core.cli.output import Rows
from core.files.study_file import Study
from core.report.wording import count, decimals_of, fixed
from core.study.acceptance import AcceptanceCheck, CheckedQuantity
from core.study.budget import UncertaintyBudget
from core.study.grr import AnovaRow, Component, GrrStudy
from core.study.repeats import RepeatStudy
from core.study.type1 import LIMIT, Type1Study


def rows(study: Study) -> Rows:
    """What a study found, and its verdict."""
    match study:
        case RepeatStudy():
            found = _repeats(study)
        case Type1Study():
            found = _type1(study)
        case GrrStudy():
            found = _grr(study)
        case AcceptanceCheck():
            found = [row for one in study.quantities for row in _quantity(one)]
    return [*found, ("verdict", study.verdict or "none: no limit was given")]


def _repeats(study: RepeatStudy) -> Rows:
    found, unit = study.statistics, study.unit
    digits = max(decimals_of(study.budget.U), decimals_of(found.std_mm), 3)

    def shown(value: float | None, *, signed: bool = False) -> str:
        return "unknown" if value is None else f"{fixed(value, digits, signed=signed)} {unit}"

    lines = [
        (study.name, f"{count(found.n, 'scan')}, mean {shown(found.mean_mm)}"),
        ("STD (n − 1)", shown(found.std_mm)),
    ]
    if study.nominal is not None:
        lines += [
            ("nominal", f"{study.nominal:g} {unit}"),
            ("mean error", shown(found.error_mm, signed=True)),
            ("RMSE", shown(found.rmse_mm)),
            ("largest error", shown(found.largest_error_mm)),
        ]
    if study.run is not None:
        lines.append(("run chart", f"{shown(study.run.lower)} to {shown(study.run.upper)} (individual values)"))
    lines += [("U of the mean", _expanded(study.budget, digits)), ("from", _sources(study.budget, digits))]
    if study.zones is not None:
        limits = f"{fixed(study.zones.lower, 3, signed=True)} to {fixed(study.zones.upper, 3, signed=True)} {unit}"
        lines.append(("rule", f"ISO 14253-1, deviation {limits}, guard band {shown(study.zones.guard_band)}"))
    return lines


def _expanded(budget: UncertaintyBudget, digits: int) -> str:
    dof = "∞" if math.isinf(budget.dof) else f"{budget.dof:.1f}"
    return f"{fixed(budget.U, digits)} {budget.unit} (k = {budget.k:.2f}, ν_eff = {dof}, {budget.coverage:.2%})"


def _sources(budget: UncertaintyBudget, digits: int) -> str:
    largest = sorted(budget.rows, key=lambda row: -row.u_mm)
    return ", ".join(
        f"{row.source} {fixed(row.u_mm, digits)} {budget.unit}" for row in largest if row.u_mm >= 0.1 * budget.u > 0
    )


def _type1(study: Type1Study) -> Rows:
    digits, unit = max(decimals_of(study.s) + 1, 3), study.unit

    def shown(value: float, *, signed: bool = False) -> str:
        return f"{fixed(value, digits, signed=signed)} {unit}"

    low, high = (fixed(value, digits, signed=True) for value in study.bias_interval)
    lines = [
        ("repeats", f"{study.n}, mean {shown(study.mean)}, s {shown(study.s)}"),
        ("reference", f"{study.reference:g} {unit}, T = {study.tolerance:g} {unit}"),
        ("bias", f"{shown(study.bias, signed=True)} (95 %: {low} to {high}), t = {study.t:.2f}, p = {study.p:.2g}"),
        ("Cg", f"{_index(study.cg)} (95 %: {_index(study.cg_interval[0])} to {_index(study.cg_interval[1])})"),
        ("Cgk", f"{_index(study.cgk)}; both must be {LIMIT} or more"),
        ("smallest T", f"{shown(study.smallest_tolerance)} for which they would be"),
    ]
    if study.resolution_share is not None:
        judged = "suffices" if study.resolution_suffices else "does not suffice: 5 % at most"
        lines.append(("resolution", f"{study.resolution:g} {unit}, {study.resolution_share:.1%} of T: {judged}"))
    return lines


def _index(value: float) -> str:
    return "∞" if math.isinf(value) and value > 0 else fixed(value, 2)


def _grr(study: GrrStudy) -> Rows:
    p, o, r = study.values.shape
    lines = [("measured", f"{count(p, 'part')} × {count(o, 'operator')} × {count(r, 'repeat')}")]
    lines += [(f"ANOVA {row.source}", _anova(row)) for row in (study.pooled_anova or study.anova)]
    lines += [(one.source, _component(one, study.unit)) for one in study.components]
    low, high = study.grr_interval
    gauge = study.component("gauge R&R")
    lines.append(("%GRR of total", f"{gauge.of_total:.1%} (95 %: {low:.1%} to {high:.1%})"))
    if study.tolerance_interval is not None and gauge.of_tolerance is not None:
        low, high = study.tolerance_interval
        said = f"{gauge.of_tolerance:.1%} (95 %: {low:.1%} to {high:.1%}), T = {study.tolerance:g} {study.unit}"
        lines.append(("%GRR of T", said))
    low, high = study.ndc_interval
    lines.append(("ndc", f"{study.categories or '∞'} ({_index(study.ndc)}; 95 %: {_index(low)} to {_index(high)})"))
    return lines


def _anova(row: AnovaRow) -> str:
    tested = "" if row.f is None or row.p is None else f", F {row.f:.3g}, p {row.p:.3g}"
    return f"SS {row.ss:.6g}, ν {row.dof}" + ("" if math.isnan(row.ms) else f", MS {row.ms:.4g}") + tested


def _component(one: Component, unit: str) -> str:
    of_tolerance = "" if one.of_tolerance is None else f", {one.of_tolerance:.1%} of T"
    low, high = (math.sqrt(value) for value in one.variance_interval)
    return f"σ {one.sigma:.4g} {unit} (95 %: {low:.3g} to {high:.3g}), {one.of_total:.1%} of total{of_tolerance}"


def _quantity(one: CheckedQuantity) -> Rows:
    limit = "no limit" if one.limit is None else f"limit {one.limit:g} mm"
    positions = count(len({reading.position for reading in one.readings}), "position")
    said = f"{fixed(one.largest_error, 4, signed=True)} mm at {one.worst.position}, {positions}, {limit}"
    return [(one.title, said + (f": {one.verdict}" if one.verdict else ""))]
