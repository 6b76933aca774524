"""What `trisect study` does: read, judge, say it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import cast

import typer

from core.cli.language import tr
from core.cli.measuring import Shown, exit_code
from core.cli.output import Rows, fact_rows, words
from core.errors import InputError, WrongValue
from core.files.project.folder import results_in
from core.messages import Message
from core.progress import Progress
from core.wings.studies.acceptance_step import Artefact, read_positions
from core.wings.studies.files.input import Repeats, read_crossed, read_readings, read_repeats
from core.wings.studies.files.study_file import study_values, write_study
from core.wings.studies.kinds.acceptance import AcceptanceCheck, Quantity, acceptance_check
from core.wings.studies.kinds.budget import from_budgets, from_stated
from core.wings.studies.kinds.grr import ACCEPTABLE, GrrStudy, grr_study
from core.wings.studies.kinds.repeats import RepeatStudy, Requirement, repeat_study
from core.wings.studies.kinds.series import SeriesStudy, StatedUncertainty, series_study, stated_uncertainty
from core.wings.studies.kinds.study import Study
from core.wings.studies.kinds.type1 import CAPABLE, Type1Study, type1_study
from core.wings.studies.study_facts import study_facts, study_tables, study_title

GOOD = ("conforming", CAPABLE, ACCEPTABLE)
"""Verdicts that leave with exit code 0."""
ARTEFACTS = ("sphere", "bar", "plane")


def finish(study: Study, out: Path | None, *, as_json: bool) -> None:
    """Write study.json to `out` unless None, print the study, and exit with the exit code of its verdict."""
    files = {} if out is None else {"study": write_study(out, study)}
    Shown(study_rows(study), study_values(study), study.notes, files).show(as_json=as_json)
    raise typer.Exit(exit_code(study.verdict, GOOD))


def repeats(
    files: Sequence[Path], name: str, nominal: float | None, tolerance: float | None, u: float | None, guard: float
) -> RepeatStudy:
    """Make a study of repeats from a table, or of the characteristic `name` in folders of results."""
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
    """Make a type-1 study from a table, or of the characteristic `name` in folders of results."""
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
    return type1_study(
        found.values, nominal, limits[1] - limits[0], found.doubted, resolution=resolution, unit=found.unit
    )


def series(
    files: Sequence[Path], name: str, nominal: float | None, tolerance: float | None, u: float | None, size: int
) -> SeriesStudy:
    """Make a study of a series from a table, or of the characteristic `name` in folders in the order of measuring."""
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
    """Make a gauge R&R study from a table; `name` is the characteristic to read where it lists folders of results."""
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
        doubted=found.doubted,
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
    """Make an acceptance check from a table, or from the clouds in folders of results, one for each position."""
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
    """Make the rows, label and value, of a study: its title, verdict, facts and tables."""
    return [(tr("study"), study_title(study, words())), *fact_rows(study_facts(study), study_tables(study))]
