"""The section of repeated scans: their statistics, the run chart, and every scan in a row."""

from __future__ import annotations

import re

from reportlab.lib.units import mm
from reportlab.platypus import Flowable

from core.messages import label, plural_message
from core.report.content import RepeatLine, ReportContent
from core.report.layout.blocks import Cell, heads, more_line, ruled_table
from core.report.layout.style import SANS, ReportLook, words_width
from core.report.wording import decimals_of
from core.study.repeats import RepeatStatistics

WIDTHS = [shares * mm for shares in (7, 45, 29, 21, 17, 9, 18, 24)]
"""Number, scan, time, thickness, U, k, error, calibration."""

NUMERIC = (3, 4, 5, 6)
"""Columns of numbers, to the right."""

GAP = 4 * mm
"""Between headings of the statistics."""


def repeats_head(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """What the repeats are, and their statistics."""
    statistics, words = content.repeat_statistics, look.words
    if statistics is None:
        return []
    nominal = content.nominal_mm
    said = words(
        "{scans} of the part", scans=words(plural_message("report.scans", "{n:,} scan", "{n:,} scans", n=statistics.n))
    )
    if nominal is not None:
        said += words("; errors are measured − nominal value, {nominal} mm.", nominal=words.general(nominal))
    else:
        said += words("; no nominal value was given.")
    if statistics.n > 1:
        said += words(" The standard deviation is that of a single scan (over n − 1).")
    calibrations = {repeat.calibration_id for repeat in content.repeats}
    if len(calibrations) > 1:
        said += words(" They rest on {n} different calibrations.", n=len(calibrations))
    return [look.text(said, "small"), _statistics_table(look, statistics, sum(WIDTHS))]


def _statistics_table(look: ReportLook, statistics: RepeatStatistics, width: float) -> Flowable:
    decimals = max(decimals_of(statistics.std_mm), 3)
    words = look.words
    values = (
        (words("mean, mm"), statistics.mean_mm, False),
        (words("mean error, mm"), statistics.error_mm, True),
        (words("RMSE, mm"), statistics.rmse_mm, False),
        (words("standard deviation, mm"), statistics.std_mm, False),
        (words("largest error, mm"), statistics.largest_error_mm, False),
    )
    known = {name: words.fixed(value, decimals, signed=signed) for name, value, signed in values if value is not None}
    rows = [
        [look.text(name, "head_number") for name in known],
        [look.text(value, "number_strong") for value in known.values()],
    ]
    wide = [
        words_width(name, SANS, look.style("head").fontSize) + GAP for name in known
    ]  # in no heading a unit stands in a line of its own
    return ruled_table(rows, [width * one / sum(wide) for one in wide])


def repeats_table(look: ReportLook, content: ReportContent, most: int) -> list[Flowable]:
    """Every repeat in a row, at most `most` of them."""
    rows: list[list[Cell]] = [
        heads(
            look, "", "Scan", "measured at", "thickness, mm", "U, mm", "k", "error, mm", "calibration", numbers=NUMERIC
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
