"""Studies as the report prints them: what is told of each, and its run chart or control charts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from core.messages import label
from core.report.content import ReportedStudy
from core.report.drawings import CHART_MM
from core.report.layout.style import INK, ReportLook
from core.report.plots.figures import new_figure, plot_style
from core.report.plots.run_chart import LEFT_MM, WORDS_MM, draw_lines, run_chart_figure
from core.wings.studies.files.study_file import read_study
from core.wings.studies.kinds.repeats import RepeatStudy
from core.wings.studies.kinds.series import SeriesStudy
from core.wings.studies.kinds.series_chart import Chart
from core.wings.studies.kinds.study import KINDS, InOrder, Study, kind_of
from core.wings.studies.kinds.type1 import Type1Study
from core.wings.studies.study_facts import chart_names, name_of, study_facts, study_tables

CONTROL_MM = 76.0
"""Height of two control charts at scale 1."""


def read_printed(path: Path) -> ReportedStudy:
    """Read the study.json at `path` as the report prints it; InputError if it is missing or damaged."""
    return printed(read_study(path))


def printed(study: Study) -> ReportedStudy:
    """Prepare a study for printing: its title, facts, tables, notes, and the function that draws its figure."""
    return ReportedStudy(
        KINDS[kind_of(study)],
        name_of(study),
        study_facts(study),
        study_tables(study),
        study.notes,
        partial(_figure, study) if isinstance(study, InOrder) and len(study.values) > 1 else None,
    )


def _figure(study: InOrder, look: ReportLook, width: float) -> Figure:
    if charts := control_charts(study):
        return control_charts_figure(look, charts, study.unit, width, CONTROL_MM)
    U = study.U.tolist() if isinstance(study, RepeatStudy) else ()
    return run_chart_figure(look, study.values.tolist(), U, run_lines(study), study.unit, width, CHART_MM)


def run_lines(study: InOrder) -> dict[str, float]:
    """Collect the horizontal lines of a study's run chart by name, as mean and limits; those not known are missing."""
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
    """Collect the two control charts of a series by the names of their points; empty if the points are too few."""
    if not isinstance(study, SeriesStudy) or study.charts is None:
        return {}
    return dict(zip(chart_names(study), (study.charts.location, study.charts.spread), strict=True))


def control_charts_figure(
    look: ReportLook, charts: Mapping[str, Chart], unit: str, width_mm: float, height_mm: float
) -> Figure:
    """Draw the control charts, by the names of their points, one above the other.

    A point that breaks a rule is a cross, with the rules' numbers beside it. A moving range stands at its second value.
    """
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        each, count = height_mm / len(charts), max(len(chart.points) for chart in charts.values())
        for place, (name, chart) in enumerate(charts.items()):
            last = place == len(charts) - 1
            foot, height = (len(charts) - 1 - place) * each + (9 if last else 5), each - (11 if last else 7)
            room = (width_mm - LEFT_MM - WORDS_MM) / width_mm
            axes = figure.add_axes((LEFT_MM / width_mm, foot / height_mm, room, height / height_mm))
            _control_chart(look, axes, chart, count)
            axes.set_ylabel(look.words.in_unit(look.words(name), unit), labelpad=2)
        axes.set_xlabel(look.words("number of the point"), labelpad=1)
    return figure


def _control_chart(look: ReportLook, axes: Axes, chart: Chart, count: int) -> None:
    values = chart.points
    numbers = np.arange(count - len(values), count) + 1
    rules: dict[int, list[str]] = {}
    for one in chart.breaks:
        rules.setdefault(one.place, []).append(str(one.rule))
    steady = np.array([place not in chart.breaking for place in range(len(values))])
    axes.plot(numbers, values, "-", color=look.accent, lw=0.6)
    axes.plot(numbers[steady], values[steady], "o", color=look.accent, ms=3, zorder=4)
    axes.plot(numbers[~steady], values[~steady], "x", color=INK, ms=5, mew=1.2, zorder=5)
    for place, broken in rules.items():
        at, said = (numbers[place], values[place]), ", ".join(broken)
        axes.annotate(said, at, (0, 4), textcoords="offset points", ha="center", color=INK)
    axes.set_xlim(0.5, count + 0.5)
    axes.margins(y=0.15)
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.spines[["top", "right"]].set_visible(False)
    lines = {
        label("mean"): chart.centre,
        label("upper control limit"): chart.upper,
        label("lower control limit"): chart.lower,
    }
    draw_lines(look, axes, axes, lines)
