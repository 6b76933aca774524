"""The section of repeated scans: their statistics, the run chart, and every scan in a row."""

from __future__ import annotations

import re

from reportlab.lib.units import mm
from reportlab.platypus import Flowable

from core.messages import decimals_of, label
from core.report.content import RepeatLine, ReportContent
from core.report.facts.of_repeats import repeat_facts
from core.report.layout.blocks import Cell, figures, heads, more_line, ruled_table
from core.report.layout.style import ReportLook

WIDTHS = [shares * mm for shares in (7, 41, 29, 21, 17, 9, 22, 24)]
"""Number, scan, time, thickness, U, k, deviation, calibration."""

NUMERIC = (3, 4, 5, 6)
"""Columns of numbers, to the right."""


def repeats_head(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the summary of repeated scans: their statistics, and a remark if their calibrations differ; [] if none."""
    statistics, words = content.repeat_statistics, look.words
    if statistics is None:
        return []
    parts: list[Flowable] = [figures(look, repeat_facts(statistics, nominal=content.nominal_mm))]
    calibrations = {repeat.calibration_id for repeat in content.repeats}
    if len(calibrations) > 1:
        said = words("They rest on {n} different calibrations.", n=len(calibrations))
        parts.append(look.text(said, "small"))
    return parts


def repeats_table(look: ReportLook, content: ReportContent, most: int) -> list[Flowable]:
    """Make the table of repeated scans, at most `most` rows."""
    rows: list[list[Cell]] = [
        heads(
            look,
            "",
            "Scan",
            "measured at",
            "thickness, mm",
            "U, mm",
            "k",
            "deviation, mm",
            "calibration",
            numbers=NUMERIC,
        )
    ]
    for number, repeat in enumerate(content.repeats[:most], start=1):
        cells = (f"{number}", *_cells(look, repeat, content.nominal_mm))
        row = [look.text(cell, "number" if place in NUMERIC else "small") for place, cell in enumerate(cells)]
        camera_and_fan = re.split("(?<=-)", repeat.calibration_id)  # a line each: together too wide
        rows.append([*row, [look.text(one, "small") for one in camera_and_fan]])
    table = ruled_table(rows, WIDTHS)
    table.setStyle([("LEFTPADDING", (7, 0), (7, -1), 4)])
    return [table, *more_line(look, len(content.repeats) - most, label("the project"))]


def _cells(look: ReportLook, repeat: RepeatLine, nominal_mm: float | None) -> tuple[str, ...]:
    fixed, decimals = look.words.fixed, decimals_of(repeat.U_mm)
    error = "" if nominal_mm is None else fixed(repeat.thickness_mm - nominal_mm, decimals, signed=True)
    return (
        repeat.scan,
        look.words.time(repeat.measured_at),
        fixed(repeat.thickness_mm, decimals),
        fixed(repeat.U_mm, decimals),
        look.words.general(repeat.k),
        error,
    )
