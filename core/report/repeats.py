"""The section of repeated scans: their statistics, the run chart, and every scan in a row."""

from __future__ import annotations

from reportlab.lib.units import mm
from reportlab.platypus import Flowable

from core.report import tables
from core.report.content import RepeatLine, ReportContent
from core.report.style import text
from core.report.wording import count, decimals_of, fixed
from core.study.repeats import RepeatStatistics

WIDTHS = [shares * mm for shares in (7, 45, 29, 21, 17, 9, 18, 24)]
"""Number, scan, time, thickness, U, k, error, calibration."""


def repeats_head(content: ReportContent) -> list[Flowable]:
    """What the repeats are, and their statistics."""
    statistics = content.repeat_statistics
    if statistics is None:
        return []
    nominal = content.nominal_mm
    words = f"{count(statistics.n, 'scan')} of the part" + (
        f"; errors are measured − nominal value, {nominal:g} mm."
        if nominal is not None
        else "; no nominal value was given."
    )
    if statistics.n > 1:
        words += " The standard deviation is that of a single scan (over n − 1)."
    calibrations = {repeat.calibration_id for repeat in content.repeats}
    if len(calibrations) > 1:
        words += f" They rest on {len(calibrations)} different calibrations."
    return [text(words, "small"), _statistics_table(statistics, sum(WIDTHS))]


def _statistics_table(statistics: RepeatStatistics, width: float) -> Flowable:
    decimals = max(decimals_of(statistics.std_mm), 3)
    values: dict[str, float | None] = {
        "mean, mm": statistics.mean_mm,
        "mean error, mm": statistics.error_mm,
        "RMSE, mm": statistics.rmse_mm,
        "standard deviation, mm": statistics.std_mm,
        "largest error, mm": statistics.largest_error_mm,
    }
    known = {name: value for name, value in values.items() if value is not None}
    rows: list[list[Flowable]] = [
        [text(name, "head_number") for name in known],
        [
            text(fixed(value, decimals, signed=name.startswith("mean error")), "number_strong")
            for name, value in known.items()
        ],
    ]
    return tables.ruled_table(rows, [width / len(known)] * len(known))


def repeats_table(content: ReportContent, most: int) -> list[Flowable]:
    """Every repeat in a row, at most `most` of them."""
    heads = ("", "Scan", "measured", "thickness, mm", "U, mm", "k", "error, mm", "calibration")
    numeric = {3, 4, 5, 6}
    rows = [[text(head, "head_number" if place in numeric else "head") for place, head in enumerate(heads)]]
    for number, repeat in enumerate(content.repeats[:most], start=1):
        cells = (f"{number}", *_cells(repeat, content.nominal_mm))
        rows.append([text(cell, "number" if place in numeric else "small") for place, cell in enumerate(cells)])
    table = tables.ruled_table(rows, WIDTHS)
    table.setStyle([("LEFTPADDING", (7, 0), (7, -1), 4)])
    return [table, *tables.more_line(len(content.repeats) - most, "the project")]


def _cells(repeat: RepeatLine, nominal_mm: float | None) -> tuple[str, ...]:
    decimals = decimals_of(repeat.U_mm)
    error = "" if nominal_mm is None else fixed(repeat.thickness_mm - nominal_mm, decimals, signed=True)
    return (
        repeat.scan,
        f"{repeat.measured_at:%Y-%m-%d %H:%M}",
        fixed(repeat.thickness_mm, decimals),
        fixed(repeat.U_mm, decimals),
        f"{repeat.k:g}",
        error,
        repeat.calibration_id,
    )
