"""Values in the order of measuring: the run chart with its histogram."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from core.checks.repeats import histogram
from core.messages import label
from core.report.content import RepeatLine
from core.report.layout.style import MUTED, ReportLook
from core.report.plots.figures import DPI, MM_PER_INCH, mixed, new_figure, plot_style

LEFT_MM, WORDS_MM, HISTOGRAM_MM = 15.0, 34.0, 22.0
"""Room for the axis, for the words beside the lines, and for the histogram."""
FEWEST_FOR_HISTOGRAM = 5
"""Values: fewer make no shape."""
FORMS = ("--", ":", ":", "-.")
"""Of the lines after the first: told apart without colour."""


def repeats_figure(
    look: ReportLook,
    repeats: Sequence[RepeatLine],
    nominal_mm: float | None,
    tolerance_mm: float | None,
    width_mm: float,
    height_mm: float,
) -> Figure:
    """Draw a run chart of thicknesses of `repeats` with ±U, their mean, the nominal value and tolerance, in mm."""
    values = [repeat.thickness_mm for repeat in repeats]
    lines = {label("mean"): float(np.mean(values))}
    if nominal_mm is not None:
        lines["nominal"] = nominal_mm
        if tolerance_mm is not None:
            lines |= {label("upper limit"): nominal_mm + tolerance_mm, label("lower limit"): nominal_mm - tolerance_mm}
    U = [repeat.U_mm for repeat in repeats]
    return run_chart_figure(look, values, U, lines, look.words("thickness, mm"), width_mm, height_mm)


def run_chart_figure(
    look: ReportLook,
    values: Sequence[float],
    U: Sequence[float],
    lines: Mapping[str, float],
    quantity: str,
    width_mm: float,
    height_mm: float,
) -> Figure:
    """Draw a run chart of `values` with ±U, horizontal `lines` by their names, and a histogram if there are enough.

    The names of `lines` are fixed words.
    """
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        beside = HISTOGRAM_MM if len(values) >= FEWEST_FOR_HISTOGRAM else 0.0
        foot, height = 9 / height_mm, (height_mm - 11) / height_mm
        chart_mm = width_mm - LEFT_MM - WORDS_MM - beside
        axes = figure.add_axes((LEFT_MM / width_mm, foot, chart_mm / width_mm, height))
        numbers = np.arange(1, len(values) + 1)
        bars = np.nan_to_num(U, nan=0.0, posinf=0.0) if len(U) else None
        axes.errorbar(
            numbers, values, bars, fmt="o-", color=look.accent, ms=3.5, lw=0.6, elinewidth=0.9, capsize=2, zorder=4
        )
        axes.set_xlim(0.5, len(values) + 0.5)
        axes.set_xlabel(look.words("number of the scan"), labelpad=1)
        axes.set_ylabel(quantity, labelpad=2)
        axes.ticklabel_format(axis="y", useOffset=False)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.spines[["top", "right"]].set_visible(False)
        last = axes
        if beside:
            place = ((LEFT_MM + chart_mm + 2) / width_mm, foot, (beside - 2) / width_mm, height)
            last = _histogram(look, figure.add_axes(place, sharey=axes), values)
        draw_lines(look, axes, last, lines)
    return figure


def _histogram(look: ReportLook, axes: Axes, values: Sequence[float]) -> Axes:
    """How many of the values lie in each bin, along the same axis as theirs."""
    found = histogram(np.asarray(values, dtype=np.float64))
    axes.barh(
        found.edges[:-1], found.counts, np.diff(found.edges), align="edge", color=mixed(look.accent, 0.35),
        edgecolor=look.accent, lw=0.4,
    )  # fmt: skip
    axes.set_xlabel(look.words("scans"), labelpad=1)
    axes.xaxis.set_major_locator(MaxNLocator(2, integer=True))
    axes.tick_params(axis="y", left=False, labelleft=False)
    axes.spines[["top", "right"]].set_visible(False)
    return axes


def draw_lines(look: ReportLook, axes: Axes, last: Axes, lines: Mapping[str, float]) -> None:
    """Draw labelled horizontal lines across `axes` and `last`, the label of each to the right of `last`."""
    tones = [look.accent] + [MUTED] * len(lines)
    for value, form, tone in zip(lines.values(), ("-", *FORMS), tones, strict=False):
        for one in dict.fromkeys((axes, last)):
            one.axhline(value, color=tone, lw=0.7, ls=form, zorder=2)
    room_mm = float(last.get_window_extent().width) / DPI * MM_PER_INCH
    places = _apart(list(lines.values()), axes.get_ylim())
    for (name, value), tone, place in zip(lines.items(), tones, places, strict=False):
        last.annotate(
            look.words(name),
            (1.0, value),
            (1.0 + 3 / room_mm, place),
            xycoords=last.get_yaxis_transform(),
            textcoords=last.get_yaxis_transform(),
            va="center",
            color=tone,
            arrowprops={"arrowstyle": "-", "lw": 0.4, "color": tone, "shrinkA": 1, "shrinkB": 0},
        )


def _apart(values: Sequence[float], limits: tuple[float, float]) -> list[float]:
    """Heights for the words beside lines at `values`: in the same order, a line of text or more apart."""
    step = 0.12 * (limits[1] - limits[0])
    order = np.argsort(values, kind="stable")
    places = np.asarray(values, dtype=np.float64)[order]
    for _ in range(20):  # neighbours push each other apart until none is too near
        for low in range(len(places) - 1):
            lack = step - (places[low + 1] - places[low])
            if lack > 0:
                places[low] -= lack / 2
                places[low + 1] += lack / 2
    heights = np.empty(len(places))
    heights[order] = places
    return [float(height) for height in heights]
