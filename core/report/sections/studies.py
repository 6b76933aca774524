"""The section of studies: what is told of each, its run chart, and its notes."""

from __future__ import annotations

import math
from collections.abc import Mapping

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, Spacer

from core.messages import label
from core.report.content import ReportContent
from core.report.facts.of_studies import chart_names, study_facts, study_tables, study_title
from core.report.layout.blocks import Heading, Limits, OnOnePage, Picture, fact_tables, figures, section
from core.report.layout.style import ReportLook
from core.study.repeats import RepeatStudy
from core.study.series import SeriesStudy
from core.study.series_chart import Chart
from core.study.study import InOrder
from core.study.type1 import Type1Study


def studies(
    look: ReportLook, content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits
) -> list[Flowable]:
    """Make the section of every study, each with a heading of its own."""
    parts: list[Flowable] = []
    for number, study in enumerate(content.studies):
        body: list[Flowable] = [
            Heading(look, f"study-{number}", study_title(study, look.words), "small_strong", 1),
            figures(look, study_facts(study)),
            *fact_tables(look, study_tables(study)),
        ]
        if f"study-{number}" in pictures:
            body += [Spacer(0, 2 * mm), Picture(pictures[f"study-{number}"], limits.picture_scale)]
        body += [*look.bullets(tuple(look.words(note) for note in study.notes)), Spacer(0, 2 * mm)]
        parts.append(OnOnePage(body) if number else section(look, "studies", "Studies", body))
    return parts


def run_lines(study: InOrder) -> dict[str, float]:
    """List the lines of a run chart by their names; only those that there are."""
    lines: dict[str, float | None]
    match study:
        case RepeatStudy():
            lines = {label("mean"): study.statistics.mean_mm, label("nominal"): study.nominal}
            if study.run is not None:
                lines[label("upper control limit")] = study.run.upper
                lines[label("lower control limit")] = study.run.lower
        case SeriesStudy():
            lines = {label("mean"): study.mean, label("upper limit"): study.upper, label("lower limit"): study.lower}
        case Type1Study():
            tenth = 0.1 * study.tolerance
            lines = {label("mean"): study.mean, label("reference value"): study.reference}
            lines |= {
                label("reference + 0.1 T"): study.reference + tenth,
                label("reference − 0.1 T"): study.reference - tenth,
            }
    return {name: value for name, value in lines.items() if value is not None and math.isfinite(value)}


def control_charts(study: InOrder) -> dict[str, Chart]:
    """List the control charts of a series, by the names of their points; none where they are too few for limits."""
    if not isinstance(study, SeriesStudy) or study.charts is None:
        return {}
    return dict(zip(chart_names(study), (study.charts.location, study.charts.spread), strict=True))
