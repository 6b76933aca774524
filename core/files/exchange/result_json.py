"""The whole result as JSON, in the shape of resources/report/measurement.schema.json."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.files.atomic import write_text
from core.files.exchange.records import budget_rows, degrees_of_freedom, frame_rows, result_row
from core.files.json_text import to_json
from core.messages import as_json
from core.report.content import CalibrationMark, ReportContent

SCHEMA = "trisect-measurement"
SCHEMA_VERSION = 3
"""3: `verdict` stands where `decision` stood. 2: notes, rules, reasons and sources of uncertainty are messages with
code and values, no longer bare texts."""


def write_result_json(path: Path, content: ReportContent) -> None:
    """Write all facts of a report as JSON; InputError if it cannot be written."""
    write_text(path, to_json(result_tables(content)))


def result_tables(content: ReportContent) -> dict[str, Any]:
    """Make the tables of the JSON file of a report: lengths in mm, angles in degrees, temperatures in °C.

    null: not known, or no limit.
    """
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "report_id": content.report_id,
        "measured_at": content.timestamp.isoformat(timespec="seconds"),
        "software": {"name": "Trisect", "version": content.version},
        "item": {"part": content.part, "serial": content.serial},
        "laboratory": content.laboratory or content.template.name,
        "customer": content.customer,
        "operator": content.operator,
        "conditions": {"air_celsius": content.air_celsius, "part_celsius": content.part_celsius},
        "method": content.method,
        "rig": {"id": content.rig_id, "description": dict(content.rig)},
        "calibrations": [_mark(mark, content) for mark in content.calibrations],
        "settings": {name: str(value) for name, value in content.settings.items()},
        "settings_sha256": content.settings_digest,
        "inputs_sha256": content.inputs_digest,
        "inputs": dict(content.hashes),
        "verdict": content.results.verdict or "none",
        "characteristics": [
            {
                **result_row(one),
                "effective_dof": degrees_of_freedom(one),
                "rule": None if one.rule is None else as_json(one.rule),
                "notes": [as_json(note) for note in one.notes],
                "budget": [
                    {key: value for key, value in row.items() if key != "characteristic"}
                    | {"source": as_json(cause.words)}
                    for row, cause in zip(budget_rows(one), one.budget, strict=True)
                ],
            }
            for one in content.characteristics
        ],
        "frames": [
            row | {"reason": None if frame.reason is None else as_json(frame.reason)}
            for row, frame in zip(frame_rows(content), content.frames, strict=True)
        ],
        "notes": [as_json(note) for note in content.all_notes],
        "remarks": content.remarks,
    }


def _mark(mark: CalibrationMark, content: ReportContent) -> dict[str, Any]:
    age = mark.age(content.timestamp)
    return {
        "of": mark.of,
        "id": mark.id,
        "sha256": mark.sha256,
        "made_at": None if mark.made_at is None else mark.made_at.isoformat(timespec="seconds"),
        "age_days": None if age is None else round(age.total_seconds() / 86400, 3),
    }
