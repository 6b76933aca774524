"""The result of a measurement as rows of plain values: what every table and text format for others is written from.

Lengths in mm, angles in degrees: each row says its unit. A side without a limit has None there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from core.files.atomic import write_text
from core.files.csv_text import csv_text
from core.inspect.characteristic import Characteristic
from core.inspect.uncertainty.coverage import effective_dof
from core.messages import Message
from core.report.content import ReportContent
from core.report.facts.fact import Fact
from core.report.wording import Words

Row = Mapping[str, Any]

RESULT_COLUMNS = (
    "name",
    "kind",
    "unit",
    "nominal",
    "lower_limit",
    "upper_limit",
    "value",
    "deviation",
    "u",
    "k",
    "U",
    "verdict",
    "rule",
)
FRAME_COLUMNS = ("name", "used", "reason", "points", "sigma_mm", "stripes", "fan_crossings", "sweep_crossings")

FACT_COLUMNS = ("of", "name", "value", "u", "U", "low", "high", "unit", "level")
"""Of what is told of results besides the characteristics. `u` is a standard, `U` an expanded uncertainty; `low` and
`high` are the ends of a 95 % interval."""


def fact_row(of: str, fact: Fact, words: Words) -> dict[str, Any]:
    """Make the row, by FACT_COLUMNS, of one fact (named value) of the result `of`, in the language of `words`."""
    low, high = (None, None) if fact.interval is None else map(finite, fact.interval)
    value = finite(fact.value) if isinstance(fact.value, float) else fact.value
    return {
        "of": of,
        "name": words.known(fact.label),
        "value": words(value) if isinstance(value, (str, Message)) else value,
        "u": fact.sd,
        "U": fact.U,
        "low": low,
        "high": high,
        "unit": fact.unit,
        "level": int(fact.level),
    }


def facts_of_studies(content: ReportContent, words: Words) -> list[tuple[str, Fact]]:
    """List all facts (named values) of a report's studies, table values included, each with its study's name."""
    return [
        (study.title(words), fact)
        for study in content.studies
        for fact in (*study.facts, *(fact for table in study.tables for fact in table.facts(words)))
    ]


def facts_of_steps(content: ReportContent) -> list[tuple[str, Fact]]:
    """List all facts (named values) of the steps a report's result rests on, each with the name of its step."""
    return [(of, fact) for of, facts in content.facts.items() for fact in facts]


def unit_of(one: Characteristic) -> tuple[str, float]:
    """Return the unit in which a characteristic is exported, and the factor from its own unit to that."""
    return ("deg", math.degrees(1.0)) if one.quantity == "angle" else ("mm", 1.0)


def result_row(one: Characteristic) -> dict[str, Any]:
    """Make the row, by RESULT_COLUMNS, of one characteristic."""
    unit, factor = unit_of(one)
    limits = one.limits
    return {
        "name": one.name,
        "kind": one.kind,
        "unit": unit,
        "nominal": None if limits is None else factor * limits.nominal,
        "lower_limit": None if limits is None else finite(factor * (limits.nominal + limits.lower)),
        "upper_limit": None if limits is None else finite(factor * (limits.nominal + limits.upper)),
        "value": finite(factor * one.value),
        "deviation": None if one.deviation is None else finite(factor * one.deviation),
        "u": finite(factor * one.u),
        "k": one.k,
        "U": finite(factor * one.U),
        "verdict": one.verdict or "none",
        "rule": str(one.rule or ""),
    }


def budget_rows(one: Characteristic) -> list[dict[str, Any]]:
    """Make the rows of one characteristic's uncertainty budget; `share` is that of the variance, 0 to 1."""
    unit, factor = unit_of(one)
    variance = sum(row.u_mm**2 for row in one.budget)
    return [
        {
            "characteristic": one.name,
            "source": str(row.words),
            "value": row.value,
            "input_unit": row.unit,
            "distribution": row.distribution,
            "standard_uncertainty": row.point_mm,
            "sensitivity": None if row.sensitivity is None else factor * row.sensitivity,
            "contribution": factor * row.u_mm,
            "unit": unit,
            "dof": finite(row.dof),
            "share": row.u_mm**2 / variance if variance else 0.0,
        }
        for row in one.budget
    ]


def degrees_of_freedom(one: Characteristic) -> float | None:
    """Compute the effective degrees of freedom of a characteristic's u; None if infinitely many or without a budget."""
    return finite(effective_dof(one.budget)) if one.budget else None


def frame_rows(content: ReportContent) -> list[dict[str, Any]]:
    """Make a row, by FRAME_COLUMNS, for each frame of the recording."""
    return [
        {name: plain(getattr(frame, name)) for name in FRAME_COLUMNS} | {"reason": str(frame.reason or "")}
        for frame in content.frames
    ]


def setting_rows(content: ReportContent) -> list[tuple[str, str]]:
    """List name and value of what a report's result rests on: circumstances, settings, calibrations, hashes."""
    known = {
        "report": content.report_id,
        "verdict": content.results.verdict or "none",
        "measured at": content.timestamp.isoformat(timespec="seconds"),
        "part": content.part,
        "serial number": content.serial,
        "customer": content.customer,
        "laboratory": content.laboratory or content.template.name,
        "operator": content.operator,
        "air temperature, °C": _said(content.air_celsius),
        "part temperature, °C": _said(content.part_celsius),
        "software": f"Trisect {content.version}",
        "method": content.method,
        "SHA-256 of the settings": content.settings_digest,
        "SHA-256 over all inputs": content.inputs_digest,
        "rig": content.rig_id,
    }
    for mark in content.calibrations:
        known[f"{mark.of} calibration"] = mark.id
        known[f"{mark.of} calibration, made at"] = "" if mark.made_at is None else mark.made_at.isoformat()
        known[f"{mark.of} calibration, SHA-256"] = mark.sha256
    rows = [(name, value) for name, value in known.items() if value]
    return [
        *rows,
        *((name, str(value)) for name, value in content.settings.items()),
        *((f"rig: {name}", value) for name, value in content.rig.items()),
    ]


def finite(value: float) -> float | None:
    """Return `value` if it is a finite number, else None."""
    return float(value) if math.isfinite(value) else None


def plain(value: Any) -> Any:
    """Convert a value to what JSON can hold: NaN and infinity, also within lists and tables, become None."""
    return finite(value) if isinstance(value, float) else value


def one_line(text: str) -> str:
    """Remove line ends and control characters from a text, for file formats with a line for each field."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def as_table(columns: Sequence[str], rows: Sequence[Row]) -> list[list[Any]]:
    """Make a table of cells: a head line with the names of the `columns`, then each row in their order."""
    return [list(columns), *([row[name] for name in columns] for row in rows)]


def _said(value: float | None) -> str:
    return "" if value is None else f"{value:g}"


def write_result_csv(path: Path, content: ReportContent) -> None:
    """Write a report's characteristics as CSV, a line each, cells of unknown values empty; InputError if that fails.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    rows = [result_row(one) for one in content.characteristics]
    write_text(path, csv_text(as_table(RESULT_COLUMNS, rows)))
