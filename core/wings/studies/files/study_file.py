"""study.json: what a study was made of and what it found, with every number a report needs."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from core import __version__
from core.files.atomic import make_folder, write_text
from core.files.complaints import checked, fitting
from core.files.json_text import to_json
from core.files.project.folder import STUDY
from core.files.reading import read_json
from core.files.tables import BudgetRow, Finite, ResultFile, kept
from core.findings.proof import doubts_named
from core.inspect.conformity import Zones
from core.inspect.results import Contribution
from core.messages import Command, Message
from core.wings.studies.kinds.acceptance import AcceptanceCheck, CheckedQuantity, Quantity, Reading, acceptance_check
from core.wings.studies.kinds.budget import UncertaintyBudget, add_up
from core.wings.studies.kinds.doubted import Doubted, DoubtedResult
from core.wings.studies.kinds.grr import GrrStudy, grr_study
from core.wings.studies.kinds.repeats import RepeatStudy, Requirement, repeat_study
from core.wings.studies.kinds.series import SeriesStudy, StatedUncertainty, series_study
from core.wings.studies.kinds.series_chart import Chart
from core.wings.studies.kinds.study import Study, kind_of
from core.wings.studies.kinds.type1 import Type1Study, type1_study

SCHEMA = 1
"""Version of the file's layout."""


def write_study(folder: Path, study: Study) -> Path:
    """Write study.json into `folder`, which is made if missing, and return its path; InputError if that fails."""
    path = make_folder(folder) / STUDY
    write_text(path, to_json({"schema": SCHEMA, **study_values(study), "version": __version__}))
    return path


def study_values(study: Study) -> dict[str, Any]:
    """Convert a study to the values of study.json; infinite and unknown numbers become null."""
    match study:
        case RepeatStudy():
            values = _repeats(study)
        case Type1Study():
            values = _type1(study)
        case GrrStudy():
            values = _grr(study)
        case AcceptanceCheck():
            values = {"unit": "mm", "quantities": [_quantity(one) for one in study.quantities]}
        case SeriesStudy():
            values = _series(study)
    return {"kind": kind_of(study), **values, "verdict": study.verdict, "notes": [kept(note) for note in study.notes]}


def _repeats(study: RepeatStudy) -> dict[str, Any]:
    found, run = study.statistics, study.run
    return {
        "characteristic": study.name,
        "unit": study.unit,
        "scans": [
            {"scan": label, "value": value, "U": U}
            for label, value, U in zip(study.labels, study.values.tolist(), study.U.tolist(), strict=True)
        ],
        "nominal": study.nominal,
        "n": found.n,
        "mean": found.mean_mm,
        "error": found.error_mm,
        "rmse": found.rmse_mm,
        "std": found.std_mm,
        "largest_error": found.largest_error_mm,
        "run_chart": None if run is None else {"lower": run.lower, "upper": run.upper, "outside": run.outside},
        "histogram": {"edges": study.histogram.edges, "counts": study.histogram.counts},
        "budget_of_mean": budget_values(study.budget),
        "budget_is_complete": study.complete,
        **_doubted(study.doubted),
        "decision": None if study.zones is None else zones_values(study.zones),
    }


def _doubted(doubted: Doubted) -> dict[str, Any]:
    """Labels of the results that prove nothing, and the facts by which each does not."""
    doubts = {one.label: [doubt.fact for doubt in one.doubts] for one in doubted}
    return {"doubted": list(doubts), "doubts": doubts}


def budget_values(budget: UncertaintyBudget) -> dict[str, Any]:
    """Convert an uncertainty budget to values for study.json: its rows, and u, ν_eff, k and U."""
    return {
        "rows": [row_values(row) | {"share": budget.share(row)} for row in budget.rows],
        "value": budget.value,
        "u": budget.u,
        "dof": budget.dof,
        "coverage": budget.coverage,
        "k": budget.k,
        "U": budget.U,
        "unit": budget.unit,
        "correlation": None,  # the rows are independent
    }


def row_values(row: Contribution) -> dict[str, Any]:
    """Convert a row of an uncertainty budget to values for study.json; `contribution` is in the result's unit."""
    return {
        "source": kept(row.words),
        "value": row.value,
        "unit": row.unit,
        "distribution": row.distribution,
        "u_input": row.point_mm,
        "sensitivity": row.sensitivity,
        "contribution": row.u_mm,
        "dof": row.dof,
    }


def zones_values(zones: Zones) -> dict[str, Any]:
    """Convert the zones of a decision by ISO 14253-1 to values for study.json, as deviations from nominal."""
    return {
        "rule": "ISO 14253-1",
        "lower": zones.lower,
        "upper": zones.upper,
        "U": zones.U,
        "r": zones.r,
        "guard_band": zones.guard_band,
        "conformance": zones.conformance,
        "nonconformance_outside": zones.nonconformance,
        "uncertainty": zones.uncertainty,
    }


def _type1(study: Type1Study) -> dict[str, Any]:
    return {
        "unit": study.unit,
        "values": study.values,
        "n": study.n,
        "reference": study.reference,
        "tolerance_width": study.tolerance,
        "mean": study.mean,
        "s": study.s,
        "bias": study.bias,
        "bias_interval": study.bias_interval,
        "t": study.t,
        "p": study.p,
        "bias_is_significant": study.bias_is_significant,
        "cg": study.cg,
        "cg_interval": study.cg_interval,
        "cgk": study.cgk,
        "smallest_tolerance_width": study.smallest_tolerance,
        "resolution": study.resolution,
        "resolution_share": study.resolution_share,
        "resolution_suffices": study.resolution_suffices,
        **_doubted(study.doubted),
    }


def _grr(study: GrrStudy) -> dict[str, Any]:
    return {
        "unit": study.unit,
        "parts": study.parts,
        "operators": study.operators,
        "values": study.values,
        "tolerance_width": study.tolerance,
        "anova": [asdict(row) for row in study.anova],
        "anova_pooled": [asdict(row) for row in study.pooled_anova],
        "components": [asdict(one) | {"sigma": one.sigma} for one in study.components],
        "grr_of_total": {"value": study.component("gauge R&R").of_total, "interval": study.grr_interval},
        "grr_of_tolerance": {
            "value": study.component("gauge R&R").of_tolerance,
            "interval": study.tolerance_interval,
        },
        **_doubted(study.doubted),
        "ndc": {"value": study.ndc, "categories": study.categories, "interval": study.ndc_interval},
    }


def _quantity(one: CheckedQuantity) -> dict[str, Any]:
    return {
        "quantity": one.quantity,
        "title": kept(one.title),
        "limit": one.limit,
        "k": one.k,
        "largest_error": one.largest_error,
        "worst_position": one.worst.position,
        "enough_positions": one.enough_positions,
        "verdict": one.verdict,
        "readings": [
            {
                "position": reading.position,
                "measured": reading.measured,
                "calibrated": reading.calibrated,
                "u": reading.u,
                "doubts": [doubt.fact for doubt in reading.doubts],
                "error": reading.error,
                "verdict": one.verdict_of(reading),
            }
            for reading in one.readings
        ],
    }


def _series(study: SeriesStudy) -> dict[str, Any]:
    charts, stated = study.charts, study.stated
    return {
        "characteristic": study.name,
        "unit": study.unit,
        "parts": [
            {"part": label, "value": value} for label, value in zip(study.labels, study.values.tolist(), strict=True)
        ],
        "subgroup_size": study.size,
        "lower_limit": study.lower,
        "upper_limit": study.upper,
        "u": None if stated is None else {"own": stated.own, "whole": stated.whole},
        "share_of_u": study.share_of_u,
        **_doubted(study.doubted),
        "n": study.n,
        "mean": study.mean,
        "s": study.s,
        "sigma_within": None if charts is None else charts.sigma,
        "sigma_within_dof": None if charts is None else charts.dof,
        "chart": None if charts is None else _chart(charts.location),
        "spread_chart": None if charts is None else _chart(charts.spread),
        "indices": {name: asdict(index) for name, index in study.indices.items()},
    }


def _chart(chart: Chart) -> dict[str, Any]:
    return {
        "points": chart.points,
        "centre": chart.centre,
        "lower": chart.lower,
        "upper": chart.upper,
        "breaks": [asdict(one) for one in chart.breaks],
    }


_TODO = Message(
    "advice.make_study_again", "make the study again{command}", command=Command("trisect study … --out DIR")
)


class _OfResults(ResultFile):
    """A study of results, of which some may prove nothing; an earlier version does not say why."""

    doubted: list[str] = Field(default_factory=list)
    doubts: dict[str, list[str]] = Field(default_factory=dict)

    @property
    def doubted_results(self) -> Doubted:
        """Each with its doubts."""
        return tuple(
            DoubtedResult(label, doubts_named(self.doubts.get(label, ()), complete=False)) for label in self.doubted
        )


class _Row(BudgetRow):
    point_mm: Finite | None = Field(None, validation_alias="u_input")
    contribution: Finite

    def row(self) -> Contribution:
        return self.contributing(self.contribution)


class _Budget(ResultFile):
    rows: list[_Row]
    coverage: Finite
    value: Finite | None = None
    unit: str = "mm"

    def budget(self) -> UncertaintyBudget:
        return add_up([one.row() for one in self.rows], value=self.value, coverage=self.coverage, unit=self.unit)


class _Scan(ResultFile):
    scan: str
    value: Finite
    U: Finite | None = None


class _Decision(ResultFile):
    lower: Finite | None = None
    upper: Finite | None = None
    r: Finite


class _Repeats(_OfResults):
    kind: Literal["repeats"]
    characteristic: str
    unit: str
    scans: list[_Scan]
    nominal: Finite | None = None
    budget_of_mean: _Budget
    budget_is_complete: bool
    decision: _Decision | None = None

    def study(self) -> RepeatStudy:
        asked, limits = self.decision, None
        if asked is not None:
            limits = (
                -math.inf if asked.lower is None else asked.lower,
                math.inf if asked.upper is None else asked.upper,
            )
        return repeat_study(
            [one.value for one in self.scans],
            self.budget_of_mean.budget(),
            complete=self.budget_is_complete,
            name=self.characteristic,
            labels=[one.scan for one in self.scans],
            U=[math.nan if one.U is None else one.U for one in self.scans],
            asked=Requirement(self.nominal, limits, 1.0 if asked is None else asked.r),
            doubted=self.doubted_results,
        )


class _Type1(_OfResults):
    kind: Literal["type1"]
    unit: str
    values: list[Finite]
    reference: Finite
    tolerance_width: Finite
    resolution: Finite | None = None

    def study(self) -> Type1Study:
        return type1_study(
            self.values, self.reference, self.tolerance_width, self.doubted_results, resolution=self.resolution,
            unit=self.unit,
        )  # fmt: skip


class _Grr(_OfResults):
    kind: Literal["grr"]
    unit: str
    parts: list[str]
    operators: list[str]
    values: list[list[list[Finite]]]
    tolerance_width: Finite | None = None

    def study(self) -> GrrStudy:
        return grr_study(
            np.array(self.values),
            parts=self.parts,
            operators=self.operators,
            tolerance=self.tolerance_width,
            unit=self.unit,
            doubted=self.doubted_results,
        )


class _Reading(ResultFile):
    position: str
    measured: Finite
    calibrated: Finite
    u: Finite
    doubts: list[str] = Field(default_factory=list)


class _Quantity(ResultFile):
    quantity: Quantity
    limit: Finite | None = None
    k: Finite
    readings: list[_Reading]


class _Acceptance(ResultFile):
    kind: Literal["acceptance"]
    quantities: list[_Quantity]

    def study(self) -> AcceptanceCheck:
        readings = [
            Reading(
                one.quantity, row.position, row.measured, row.calibrated, row.u, doubts_named(row.doubts, complete=True)
            )
            for one in self.quantities
            for row in one.readings
        ]
        limits = {one.quantity: one.limit for one in self.quantities if one.limit is not None}
        return acceptance_check(readings, limits, k=self.quantities[0].k if self.quantities else 2.0)


class _Part(ResultFile):
    part: str
    value: Finite


class _StatedU(ResultFile):
    own: Finite = Field(ge=0)
    whole: Finite = Field(ge=0)


class _Series(_OfResults):
    kind: Literal["series"]
    characteristic: str
    unit: str
    parts: list[_Part]
    subgroup_size: int
    lower_limit: Finite | None = None
    upper_limit: Finite | None = None
    u: _StatedU | None = None

    def study(self) -> SeriesStudy:
        limits = (
            -math.inf if self.lower_limit is None else self.lower_limit,
            math.inf if self.upper_limit is None else self.upper_limit,
        )
        return series_study(
            [one.value for one in self.parts],
            limits,
            size=self.subgroup_size,
            stated=None if self.u is None else StatedUncertainty(self.u.own, self.u.whole),
            name=self.characteristic,
            labels=[one.part for one in self.parts],
            unit=self.unit,
            doubted=self.doubted_results,
        )


_StudyFile: Any = Annotated[_Repeats | _Type1 | _Grr | _Acceptance | _Series, Field(discriminator="kind")]


def read_study(path: Path) -> Study:
    """Read a study from the study.json at `path`.

    Raises
    ------
    InputError
        If it is missing, damaged, or no study can be made of what it holds.
    """
    tables = read_json(path, todo=_TODO)
    file: _Repeats | _Type1 | _Grr | _Acceptance = checked(_StudyFile, tables, path)
    with fitting(path, todo=_TODO):
        return file.study()
