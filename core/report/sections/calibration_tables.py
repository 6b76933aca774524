"""Tables of the calibrations: parameters, light planes, how good they are, and since when they hold."""

from __future__ import annotations

from dataclasses import replace

from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Table

from core.calibrate.results import CameraCalibration, FanCalibration
from core.messages import label, plural_message
from core.report.content import CalibrationMark, ReportContent
from core.report.facts.of_camera import parameter_facts
from core.report.facts.of_planes import plane_cells
from core.report.layout.blocks import heads, ruled_table
from core.report.layout.style import ReportLook
from core.report.wording import short_hash

KINDS = {"camera": label("Camera"), "planes": label("Laser planes")}

HOURS_A_DAY = 24
"""An age is told in days from two days on, else in hours."""


def marks_table(look: ReportLook, content: ReportContent, width: float) -> Table:
    """Make the table of the calibrations that the result rests on: id, date, age and hash."""
    rows: list[list[Flowable]] = [heads(look, "Calibration", "id", "made", "age", "SHA-256 of its file")]
    for mark in content.calibrations:
        made = look.words("not known") if mark.made_at is None else look.words.time(mark.made_at)
        rows.append(
            [
                look.fixed_text(KINDS[mark.of], "small"),
                look.text(mark.id, "small"),
                look.text(made, "small"),
                look.text(age_words(look, mark, content), "small"),
                look.text(short_hash(mark.sha256), "mono"),
            ]
        )
    fixed = [25 * mm, 22 * mm, 25 * mm, 21 * mm]  # an id of twelve wide digits stays in one line
    return ruled_table(rows, [*fixed, width - sum(fixed)])


def age_words(look: ReportLook, mark: CalibrationMark, content: ReportContent) -> str:
    """Write how old a calibration was when it was used: '3 days', 'under 1 hour', 'not known'."""
    age = mark.age(content.timestamp)
    if age is None:
        return look.words("not known")
    hours = int(age.total_seconds() // 3600)
    if hours < 1:
        return look.words("under 1 hour")
    if hours >= 2 * HOURS_A_DAY:
        return look.words(plural_message("report.days", "{n:,} day", "{n:,} days", n=hours // HOURS_A_DAY))
    return look.words(plural_message("report.hours", "{n:,} hour", "{n:,} hours", n=hours))


def camera_table(look: ReportLook, calibration: CameraCalibration, width: float) -> Table:
    """Make the table of the camera's parameters with their standard deviations."""
    words, known = look.words, any(calibration.sd.values())
    rows: list[list[Flowable]] = [heads(look, "Parameter", "value", "standard deviation", numbers=(1, 2))]
    for fact in parameter_facts(calibration):
        value, sd = fact.parts(words)
        spread = sd or words("fixed" if known else "unknown")
        rows.append([look.text(fact.column(words), "small"), look.text(value, "number"), look.text(spread, "number")])
    return ruled_table(rows, [0.34 * width, 0.28 * width, 0.38 * width])


def fan_table(look: ReportLook, calibration: FanCalibration, width: float) -> Table:
    """Make the table of the fan's light planes: fit, normal, distance from the camera, and angle to the next plane."""
    words, planes = look.words, plane_cells(calibration)
    columns = [fact.column(words) for fact in planes[0]]
    rows: list[list[Flowable]] = [heads(look, "Line", *columns, numbers=range(1, len(columns) + 1))]
    for number, cells in enumerate(planes, start=1):
        shown = [replace(fact, unit="").text(words) for fact in cells] + [""] * (len(columns) - len(cells))
        rows.append([look.text(f"{number}", "small"), *(look.text(cell, "number") for cell in shown)])
    shares = (0.08, 0.11, 0.28, 0.15, 0.12, 0.26)[: len(columns) + 1]
    return ruled_table(rows, [width * share / sum(shares) for share in shares])
