"""What `trisect study` does: read, judge, say it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import cast

import typer

from core.cli.language import spoken, told, tr
from core.cli.measuring import Shown, exit_code
from core.cli.output import Rows, words
from core.errors import InputError, WrongValue
from core.files.project.folder import results_in
from core.files.study.input import Repeats, read_crossed, read_readings, read_repeats
from core.files.study.study_file import Study, study_values, write_study
from core.messages import Message, plural_message
from core.pipeline.steps.acceptance_step import Artefact, read_positions
from core.progress import Progress
from core.report.wording import decimals_of, study_name
from core.states import DECISIONS, SPREAD, VERDICT
from core.study.acceptance import AcceptanceCheck, CheckedQuantity, Quantity, acceptance_check
from core.study.budget import UncertaintyBudget, from_budgets, from_stated
from core.study.capability import LIMIT as CAPABILITY
from core.study.grr import ACCEPTABLE, AnovaRow, Component, GrrStudy, grr_study
from core.study.repeats import RepeatStudy, Requirement, repeat_study
from core.study.series import SeriesStudy, StatedUncertainty, series_study, stated_uncertainty
from core.study.type1 import CAPABLE, LIMIT, Type1Study, type1_study

GOOD = ("conforming", CAPABLE, ACCEPTABLE)
"""Verdicts that leave with exit code 0."""
ARTEFACTS = ("sphere", "bar", "plane")


def finish(study: Study, out: Path | None, *, as_json: bool) -> None:
    """Write study.json if asked to, say what was found, and leave with the verdict's exit code."""
    files = {} if out is None else {"study": write_study(out, study)}
    Shown(study_rows(study), study_values(study), study.notes, files).show(as_json=as_json)
    raise typer.Exit(exit_code(study.verdict, GOOD))


def repeats(
    files: Sequence[Path], name: str, nominal: float | None, tolerance: float | None, u: float | None, guard: float
) -> RepeatStudy:
    """Repeats of a table or of folders."""
    _not_negative(u, "--u")
    _not_negative(guard, "--guard")
    found = read_repeats(files, name)
    nominal, limits = _asked(found, nominal, tolerance)
    if len(found.values) == 1 and u is None and found.u is None:
        raise InputError(
            Message("study.one_value_without_u", "one value alone, with no stated uncertainty, is no study"),
            where=files[0],
            todo=Message("advice.measure_again", "measure again"),
        )
    if u is None and found.budgets:
        budget = from_budgets(found.values, found.budgets, unit=found.unit)
    else:
        budget = from_stated(found.values, found.u if u is None else u, unit=found.unit)
    return repeat_study(
        found.values, budget, complete=u is not None or found.u is not None, name=name, labels=found.labels, U=found.U,
        asked=Requirement(nominal, limits, guard), doubted=found.doubted,
    )  # fmt: skip


def type1(
    files: Sequence[Path], name: str, nominal: float | None, tolerance: float | None, resolution: float | None
) -> Type1Study:
    """A type-1 study of a table or of folders."""
    _finite(nominal, "--nominal")
    limits = _both_sides(tolerance)
    found = read_repeats(files, name)
    if found.limits is not None:
        nominal = found.limits.nominal if nominal is None else nominal
        limits = limits or (found.limits.lower, found.limits.upper)
    if nominal is None or limits is None or not math.isfinite(limits[1] - limits[0]):
        raise InputError(
            Message(
                "study.type1_needs_reference",
                "a type-1 study needs the calibrated value of the part and the tolerance it is measured against",
            ),
            where="--nominal, --tolerance",
            todo=Message("advice.give_both", "give both"),
        )
    if len(found.values) < 2:
        raise InputError(
            Message("study.one_value", "one value alone is no study"),
            where=files[0],
            todo=Message("advice.measure_part_again", "measure the part again"),
        )
    if resolution is not None and not (resolution > 0 and math.isfinite(resolution)):
        raise InputError(
            Message("study.no_resolution", "{resolution:g} is no resolution", resolution=resolution),
            where="--resolution",
            todo=Message("advice.give_value_above_zero", "give a value above 0"),
        )
    return type1_study(found.values, nominal, limits[1] - limits[0], resolution=resolution, unit=found.unit)


def series(
    files: Sequence[Path], name: str, nominal: float | None, tolerance: float | None, u: float | None, size: int
) -> SeriesStudy:
    """A series of a table, or of folders of results or projects in the order given."""
    _not_negative(u, "--u")
    found = read_repeats([results_in(path) for path in files], name)
    nominal, limits = _asked(found, nominal, tolerance)
    lower, upper = (-math.inf, math.inf) if limits is None or nominal is None else (nominal + end for end in limits)
    stated = None
    if u is not None:
        stated = StatedUncertainty(0.0, u)
    elif found.u is not None:
        stated = stated_uncertainty(found.u, found.budgets)
    if len(found.values) < 2:
        raise InputError(
            Message("study.series_too_few", "a series needs two finite values or more"),
            where=files[0],
            todo=Message("advice.measure_more_parts", "measure more parts"),
        )
    try:
        return series_study(
            found.values, (lower, upper), size=size, stated=stated, name=name, labels=found.labels, unit=found.unit,
            doubted=found.doubted,
        )  # fmt: skip
    except WrongValue as error:
        raise InputError(error.what, where="--subgroup") from error


def grr(file: Path, name: str, tolerance: float | None) -> GrrStudy:
    """A gauge R&R study of a table."""
    limits = _both_sides(tolerance)
    found = read_crossed(file, name)
    if found.values.max() == found.values.min():
        raise InputError(
            Message("study.all_values_same", "all values are the same"),
            where=file,
            todo=Message("advice.measure_parts_differ", "measure parts that differ"),
        )
    return grr_study(
        found.values,
        parts=found.parts,
        operators=found.operators,
        tolerance=None if limits is None else limits[1] - limits[0],
        unit=found.unit,
    )


def acceptance(
    files: Sequence[Path],
    artefact: str,
    nominal: float | None,
    u: float,
    diameter: float | None,
    limits: Mapping[str, float | None],
    progress: Progress,
) -> AcceptanceCheck:
    """An acceptance check of a table, or of folders of results."""
    given = cast(dict[Quantity, float], {name: limit for name, limit in limits.items() if limit is not None})
    for name, limit in given.items():
        if not (limit > 0 and math.isfinite(limit)):
            raise InputError(
                Message("study.no_limit", "{limit:g} mm is no limit", limit=limit),
                where=f"--{name}",
                todo=Message("advice.give_length_above_zero", "give a length above 0"),
            )
    _not_negative(u, "--u")
    if len(files) == 1 and not files[0].is_dir():
        return acceptance_check(read_readings(files[0]), given)
    if artefact not in ARTEFACTS:
        raise InputError(
            Message("study.no_artefact", '"{artefact}" is no artefact', artefact=artefact),
            where="--artefact",
            todo=Message("advice.choose_artefact", "choose {artefacts}", artefacts=tuple(ARTEFACTS)),
        )
    if artefact != "plane" and not _is_length(nominal):
        raise InputError(
            Message("study.no_calibrated_value", "the {artefact} has no calibrated value", artefact=artefact),
            where="--nominal",
            todo=Message("advice.give_mm_above_zero", "give it in mm, above 0"),
        )
    if artefact == "bar" and not _is_length(diameter):
        raise InputError(
            Message("study.no_sphere_diameter", "the spheres of the bar have no diameter"),
            where="--diameter",
            todo=Message("advice.give_mm_above_zero", "give it in mm, above 0"),
        )
    readings = read_positions(
        files,
        cast(Artefact, artefact),
        calibrated_mm=nominal or 0.0,
        u_mm=u,
        diameter_mm=diameter or 0.0,
        progress=progress,
    )
    return acceptance_check(readings, given)


def _asked(
    found: Repeats, nominal: float | None, tolerance: float | None
) -> tuple[float | None, tuple[float, float] | None]:
    """Nominal value and deviations permitted: those given, else those that the results agree on."""
    _finite(nominal, "--nominal")
    asked = found.limits
    if nominal is None and asked is not None:
        nominal = asked.nominal
    limits = _both_sides(tolerance)
    if limits is None and asked is not None and nominal == asked.nominal:
        limits = asked.lower, asked.upper
    if limits is not None and nominal is None:
        raise InputError(
            Message("study.tolerance_without_nominal", "a tolerance needs a nominal value"),
            where="--tolerance",
            todo=Message("advice.give_nominal", "give --nominal as well"),
        )
    return nominal, limits


def _is_length(value: float | None) -> bool:
    return value is not None and value > 0 and math.isfinite(value)


def _both_sides(tolerance: float | None) -> tuple[float, float] | None:
    """Deviations permitted, or None; InputError if it is no tolerance."""
    if tolerance is None:
        return None
    if not (tolerance > 0 and math.isfinite(tolerance)):
        raise InputError(
            Message("study.no_tolerance", "{tolerance:g} is no tolerance", tolerance=tolerance),
            where="--tolerance",
            todo=Message("advice.give_value_above_zero", "give a value above 0"),
        )
    return -tolerance, tolerance


def _finite(value: float | None, where: str) -> None:
    if value is not None and not math.isfinite(value):
        raise InputError(Message("study.not_finite", "{value:g} is not a finite number", value=value), where=where)


def _not_negative(value: float | None, where: str) -> None:
    if value is not None and not (value >= 0 and math.isfinite(value)):
        raise InputError(
            Message("study.not_finite_or_negative", "{value:g} is not a finite number of 0 or more", value=value),
            where=where,
        )


def study_rows(study: Study) -> Rows:
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
        case SeriesStudy():
            found = _series(study)
    return [*found, (tr(VERDICT), tr(DECISIONS[study.verdict]) if study.verdict else tr("none: no limit was given"))]


def _repeats(study: RepeatStudy) -> Rows:
    found, unit = study.statistics, study.unit
    digits = max(decimals_of(study.budget.U), decimals_of(found.std_mm), 3)

    def shown(value: float | None, *, signed: bool = False) -> str:
        return tr("unknown") if value is None else f"{_fixed(value, digits, signed=signed)} {unit}"

    lines = [
        (
            study_name(study.name, words()),
            told(
                plural_message(
                    "cli.repeats",
                    "{n:,} scan, mean {mean}",
                    "{n:,} scans, mean {mean}",
                    n=found.n,
                    mean=shown(found.mean_mm),
                )
            ),
        ),
        (tr(SPREAD), shown(found.std_mm)),
    ]
    if study.nominal is not None:
        lines += [
            (tr("nominal"), tr("{value:g} {unit}", value=study.nominal, unit=unit)),
            (tr("mean error"), shown(found.error_mm, signed=True)),
            (tr("RMSE"), shown(found.rmse_mm)),
            (tr("largest error"), shown(found.largest_error_mm)),
        ]
    if study.run is not None:
        lower, upper = shown(study.run.lower), shown(study.run.upper)
        lines.append((tr("run chart"), tr("{lower} to {upper} (individual values)", lower=lower, upper=upper)))
    lines += [(tr("U of the mean"), _expanded(study.budget, digits)), (tr("from"), _sources(study.budget, digits))]
    if study.zones is not None:
        said = tr(
            "ISO 14253-1, deviation {lower} to {upper} {unit}, guard band {guard}",
            lower=_fixed(study.zones.lower, 3, signed=True),
            upper=_fixed(study.zones.upper, 3, signed=True),
            unit=unit,
            guard=shown(study.zones.guard_band),
        )
        lines.append((tr("rule"), said))
    return lines


def _expanded(budget: UncertaintyBudget, digits: int) -> str:
    dof = "∞" if math.isinf(budget.dof) else spoken().number(budget.dof, ".1f")
    U = f"{_fixed(budget.U, digits)} {budget.unit}"
    return tr("{U} (k = {k:.2f}, ν_eff = {dof}, {coverage:.2%})", U=U, k=budget.k, dof=dof, coverage=budget.coverage)


def _fixed(value: float, decimals: int, *, signed: bool = False) -> str:
    return words().fixed(value, decimals, signed=signed)


def _sources(budget: UncertaintyBudget, digits: int) -> str:
    largest = sorted(budget.rows, key=lambda row: -row.u_mm)
    return spoken().joined(
        [
            f"{told(row.source)} {_fixed(row.u_mm, digits)} {budget.unit}"
            for row in largest
            if row.u_mm >= 0.1 * budget.u > 0
        ]
    )


def _type1(study: Type1Study) -> Rows:
    digits, unit = max(decimals_of(study.s) + 1, 3), study.unit

    def shown(value: float, *, signed: bool = False) -> str:
        return f"{_fixed(value, digits, signed=signed)} {unit}"

    low, high = (_fixed(value, digits, signed=True) for value in study.bias_interval)
    lines = [
        (tr("repeats"), tr("{n}, mean {mean}, s {s}", n=study.n, mean=shown(study.mean), s=shown(study.s))),
        (
            tr("reference value"),
            tr(
                "{value:g} {unit}, T = {tolerance:g} {unit}",
                value=study.reference,
                unit=unit,
                tolerance=study.tolerance,
            ),
        ),
        (
            tr("bias"),
            tr(
                "{bias} (95 %: {low} to {high}), t = {t:.2f}, p = {p:.2g}",
                bias=shown(study.bias, signed=True),
                low=low,
                high=high,
                t=study.t,
                p=study.p,
            ),
        ),
        ("Cg", _with_interval(_index(study.cg), *map(_index, study.cg_interval))),
        ("Cgk", tr("{cgk}; both must be {limit} or more", cgk=_index(study.cgk), limit=LIMIT)),
        (tr("smallest T"), tr("{T} for which they would be", T=shown(study.smallest_tolerance))),
    ]
    if study.resolution_share is not None:
        judged = tr("suffices" if study.resolution_suffices else "does not suffice: 5 % at most")
        said = tr(
            "{value:g} {unit}, {share:.1%} of T: {judged}",
            value=study.resolution, unit=unit, share=study.resolution_share, judged=judged,
        )  # fmt: skip
        lines.append((tr("resolution"), said))
    return lines


def _series(study: SeriesStudy) -> Rows:
    digits, unit = max(decimals_of(study.s) + 1, 3), study.unit

    def shown(value: float) -> str:
        return tr("none") if math.isinf(value) else f"{_fixed(value, digits)} {unit}"

    lines = [
        (
            study_name(study.name, words()),
            tr("{n}, mean {mean}, s {s}", n=study.n, mean=shown(study.mean), s=shown(study.s)),
        ),
        (tr("limits"), tr("{lower} to {upper}", lower=shown(study.lower), upper=shown(study.upper))),
    ]
    if study.charts is not None:
        names = (tr("X̄ chart"), tr("s chart")) if study.size > 1 else (tr("single values"), tr("moving range"))
        for name, chart in zip(names, (study.charts.location, study.charts.spread), strict=True):
            lower, centre, upper = map(shown, (chart.lower, chart.centre, chart.upper))
            said = tr("centre {centre}, limits {lower} to {upper}", centre=centre, lower=lower, upper=upper)
            lines.append((name, said))
    for title, index in study.indices.items():
        lines.append((title, _with_interval(_index(index.value), *map(_index, index.interval))))
    if study.indices:
        lines.append((tr("asked"), tr("Cpk and Ppk surely {limit} or more", limit=CAPABILITY)))
    if study.share_of_u is not None:
        low, high = map(_share, study.share_of_u)
        lines.append((tr("measurement in s²"), tr("surely {low}, at most {high}", low=low, high=high)))
    return lines


def _index(value: float) -> str:
    return "∞" if math.isinf(value) and value > 0 else _fixed(value, 2)


def _with_interval(value: str, low: str, high: str) -> str:
    return tr("{value} (95 %: {low} to {high})", value=value, low=low, high=high)


def _share(value: float) -> str:
    return spoken().number(value, ".1%")


def _grr(study: GrrStudy) -> Rows:
    p, o, r = study.values.shape
    lines = [(tr("measured"), tr("parts {p} × operators {o} × repeats {r}", p=p, o=o, r=r))]
    lines += [(f"ANOVA {told(row.source)}", _anova(row)) for row in (study.pooled_anova or study.anova)]
    lines += [(told(one.source), _component(one, study.unit)) for one in study.components]
    low, high = study.grr_interval
    gauge = study.component("gauge R&R")
    lines.append((tr("%GRR of total"), _with_interval(*map(_share, (gauge.of_total, low, high)))))
    if study.tolerance_interval is not None and gauge.of_tolerance is not None:
        low, high = study.tolerance_interval
        said = _with_interval(*map(_share, (gauge.of_tolerance, low, high)))
        said = tr("{share}, T = {tolerance:g} {unit}", share=said, tolerance=study.tolerance, unit=study.unit)
        lines.append((tr("%GRR of T"), said))
    low, high = study.ndc_interval
    said = tr(
        "{n} ({ndc}; 95 %: {low} to {high})",
        n=str(study.categories or "∞"), ndc=_index(study.ndc), low=_index(low), high=_index(high),
    )  # fmt: skip
    lines.append(("ndc", said))
    return lines


def _anova(row: AnovaRow) -> str:
    number = spoken().number
    tested = "" if row.f is None or row.p is None else f", F {number(row.f, '.3g')}, p {number(row.p, '.3g')}"
    mean = "" if math.isnan(row.ms) else f", MS {number(row.ms, '.4g')}"
    return f"SS {number(row.ss, '.6g')}, ν {row.dof}{mean}{tested}"


def _component(one: Component, unit: str) -> str:
    of_tolerance = "" if one.of_tolerance is None else tr(", {share:.1%} of T", share=one.of_tolerance)
    low, high = (math.sqrt(value) for value in one.variance_interval)
    said = tr(
        "σ {sigma:.4g} {unit} (95 %: {low:.3g} to {high:.3g}), {share:.1%} of total",
        sigma=one.sigma, unit=unit, low=low, high=high, share=one.of_total,
    )  # fmt: skip
    return said + of_tolerance


def _quantity(one: CheckedQuantity) -> Rows:
    limit = tr("no limit") if one.limit is None else tr("limit {limit:g} mm", limit=one.limit)
    positions = plural_message(
        "cli.positions", "{n} position", "{n} positions", n=len({reading.position for reading in one.readings})
    )
    said = tr(
        "{error} mm at {position}, {positions}, {limit}",
        error=_fixed(one.largest_error, 4, signed=True), position=one.worst.position, positions=positions, limit=limit,
    )  # fmt: skip
    return [(told(one.title), said + (f": {tr(DECISIONS[one.verdict])}" if one.verdict else ""))]
