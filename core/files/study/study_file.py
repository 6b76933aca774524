"""study.json: what a study was made of and what it found, with every number a report needs."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeAlias

from core import __version__
from core.files.atomic import make_folder, write_text
from core.files.json_text import to_json
from core.inspect.conformity import Zones
from core.inspect.results import Contribution
from core.study.acceptance import AcceptanceCheck, CheckedQuantity
from core.study.budget import UncertaintyBudget
from core.study.grr import AnovaRow, Component, GrrStudy
from core.study.repeats import RepeatStudy
from core.study.type1 import Type1Study

Study: TypeAlias = RepeatStudy | Type1Study | GrrStudy | AcceptanceCheck

SCHEMA = 1
NAME = "study.json"
STUDIES = "studies"
"""The folder of studies in a project."""


def write_study(folder: Path, study: Study) -> Path:
    """Write study.json into `folder`, made if need be; InputError if it cannot be written."""
    path = make_folder(folder) / NAME
    write_text(path, to_json({"schema": SCHEMA, **study_values(study), "version": __version__}))
    return path


def study_path(folder: Path, id_: str) -> Path:
    """Where the project in `folder` keeps the study called `id_`."""
    return folder / STUDIES / id_ / NAME


def study_values(study: Study) -> dict[str, Any]:
    """A study by the names of study.json; what is infinite or not known becomes null there."""
    match study:
        case RepeatStudy():
            values = {"kind": "repeats", **_repeats(study)}
        case Type1Study():
            values = {"kind": "type1", **_type1(study)}
        case GrrStudy():
            values = {"kind": "grr", **_grr(study)}
        case AcceptanceCheck():
            values = {"kind": "acceptance", "unit": "mm", "quantities": [_quantity(one) for one in study.quantities]}
    return {**values, "verdict": study.verdict, "notes": study.notes}


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
        "decision": None if study.zones is None else zones_values(study.zones),
    }


def budget_values(budget: UncertaintyBudget) -> dict[str, Any]:
    """A budget: its rows, and what they add up to."""
    return {
        "rows": [row_values(row) | {"share": budget.share(row)} for row in budget.rows],
        "value": budget.value,
        "u": budget.u,
        "dof": budget.dof,
        "coverage": budget.coverage,
        "k": budget.k,
        "U": budget.U,
        "unit": budget.unit,
        "correlation": budget.correlation,
    }


def row_values(row: Contribution) -> dict[str, Any]:
    """A row of a budget; `u_input` in `unit`, `contribution` in the result's."""
    return {
        "source": row.source,
        "value": row.value,
        "unit": row.unit,
        "distribution": row.distribution,
        "u_input": row.point_mm,
        "sensitivity": row.sensitivity,
        "contribution": row.u_mm,
        "dof": row.dof,
    }


def zones_values(zones: Zones) -> dict[str, Any]:
    """The rule of a decision, its guard band and its zones, all as deviations."""
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
    }


def _grr(study: GrrStudy) -> dict[str, Any]:
    return {
        "unit": study.unit,
        "parts": study.parts,
        "operators": study.operators,
        "values": study.values,
        "tolerance_width": study.tolerance,
        "anova": [_anova(row) for row in study.anova],
        "anova_pooled": [_anova(row) for row in study.pooled_anova],
        "components": [_component(one) for one in study.components],
        "grr_of_total": {"value": study.component("gauge R&R").of_total, "interval": study.grr_interval},
        "grr_of_tolerance": {
            "value": study.component("gauge R&R").of_tolerance,
            "interval": study.tolerance_interval,
        },
        "ndc": {"value": study.ndc, "categories": study.categories, "interval": study.ndc_interval},
    }


def _anova(row: AnovaRow) -> dict[str, Any]:
    return {"source": row.source, "ss": row.ss, "dof": row.dof, "ms": row.ms, "f": row.f, "p": row.p}


def _component(one: Component) -> dict[str, Any]:
    return {
        "source": one.source,
        "variance": one.variance,
        "variance_interval": one.variance_interval,
        "sigma": one.sigma,
        "contribution": one.contribution,
        "of_total": one.of_total,
        "of_tolerance": one.of_tolerance,
    }


def _quantity(one: CheckedQuantity) -> dict[str, Any]:
    return {
        "quantity": one.quantity,
        "title": one.title,
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
                "error": reading.error,
                "verdict": one.verdict_of(reading),
            }
            for reading in one.readings
        ],
    }
