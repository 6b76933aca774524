"""What `trisect study` does: read, judge, say it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import cast

import typer

from core.cli import study_output
from core.cli.measuring import Shown
from core.errors import InputError
from core.files.study_file import Study, study_values, write_study
from core.files.study_input import read_crossed, read_readings, read_repeats
from core.pipeline.acceptance_step import Artefact, read_positions
from core.progress import Progress
from core.study.acceptance import AcceptanceCheck, Quantity, acceptance_check
from core.study.grr import ACCEPTABLE, GrrStudy, grr_study
from core.study.repeats import RepeatStudy, repeat_study
from core.study.repeats_budget import from_budgets, from_stated
from core.study.type1 import CAPABLE, Type1Study, type1_study

GOOD = ("", "conforming", CAPABLE, ACCEPTABLE)
"""Verdicts that leave with exit code 0."""
ARTEFACTS = ("sphere", "bar", "plane")


def finish(study: Study, out: Path | None, *, as_json: bool) -> None:
    """Write study.json if asked to, say what was found, and leave with the verdict's exit code."""
    files = {} if out is None else {"study": write_study(out, study)}
    Shown(study_output.rows(study), study_values(study), study.notes, files).show(as_json=as_json)
    raise typer.Exit(0 if study.verdict in GOOD else 1)


def repeats(
    files: Sequence[Path], name: str, nominal: float | None, tolerance: float | None, u: float | None, guard: float
) -> RepeatStudy:
    """Repeats of a table or of folders."""
    _finite(nominal, "--nominal")
    _not_negative(u, "--u")
    _not_negative(guard, "--guard")
    found = read_repeats(files, name)
    asked = found.limits
    if nominal is None and asked is not None:
        nominal = asked.nominal
    limits = _both_sides(tolerance)
    if limits is None and asked is not None and nominal == asked.nominal:
        limits = asked.lower, asked.upper
    if limits is not None and nominal is None:
        raise InputError("a tolerance needs a nominal value", where="--tolerance", todo="give --nominal as well")
    if len(found.values) == 1 and u is None and found.u is None:
        raise InputError(
            "one value alone, with no stated uncertainty, is no study", where=files[0], todo="measure again"
        )
    if u is None and found.budgets:
        budget = from_budgets(found.values, found.budgets, unit=found.unit)
    else:
        budget = from_stated(found.values, found.u if u is None else u, unit=found.unit)
    return repeat_study(
        found.values, budget, complete=u is not None or found.u is not None, name=name, labels=found.labels, U=found.U,
        nominal=nominal, limits=limits, r=guard, unit=found.unit,
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
            "a type-1 study needs the calibrated value of the part and the tolerance it is measured against",
            where="--nominal, --tolerance",
            todo="give both",
        )
    if len(found.values) < 2:
        raise InputError("one value alone is no study", where=files[0], todo="measure the part again")
    if resolution is not None and not (resolution > 0 and math.isfinite(resolution)):
        raise InputError(f"{resolution:g} is no resolution", where="--resolution", todo="give a value above 0")
    return type1_study(found.values, nominal, limits[1] - limits[0], resolution=resolution, unit=found.unit)


def grr(file: Path, name: str, tolerance: float | None) -> GrrStudy:
    """A gauge R&R study of a table."""
    limits = _both_sides(tolerance)
    found = read_crossed(file, name)
    if found.values.max() == found.values.min():
        raise InputError("all values are the same", where=file, todo="measure parts that differ")
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
            raise InputError(f"{limit:g} mm is no limit", where=f"--{name}", todo="give a length above 0")
    _not_negative(u, "--u")
    if len(files) == 1 and not files[0].is_dir():
        return acceptance_check(read_readings(files[0]), given)
    if artefact not in ARTEFACTS:
        raise InputError(f'"{artefact}" is no artefact', where="--artefact", todo=f"choose {', '.join(ARTEFACTS)}")
    if artefact != "plane" and not _is_length(nominal):
        raise InputError(f"the {artefact} has no calibrated value", where="--nominal", todo="give it in mm, above 0")
    if artefact == "bar" and not _is_length(diameter):
        raise InputError("the spheres of the bar have no diameter", where="--diameter", todo="give it in mm, above 0")
    readings = read_positions(
        files,
        cast(Artefact, artefact),
        calibrated_mm=nominal or 0.0,
        u_mm=u,
        diameter_mm=diameter or 0.0,
        progress=progress,
    )
    return acceptance_check(readings, given)


def _is_length(value: float | None) -> bool:
    return value is not None and value > 0 and math.isfinite(value)


def _both_sides(tolerance: float | None) -> tuple[float, float] | None:
    """Deviations permitted, or None; InputError if it is no tolerance."""
    if tolerance is None:
        return None
    if not (tolerance > 0 and math.isfinite(tolerance)):
        raise InputError(f"{tolerance:g} is no tolerance", where="--tolerance", todo="give a value above 0")
    return -tolerance, tolerance


def _finite(value: float | None, where: str) -> None:
    if value is not None and not math.isfinite(value):
        raise InputError(f"{value:g} is not a finite number", where=where)


def _not_negative(value: float | None, where: str) -> None:
    if value is not None and not (value >= 0 and math.isfinite(value)):
        raise InputError(f"{value:g} is not a finite number of 0 or more", where=where)
