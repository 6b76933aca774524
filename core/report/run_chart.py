"""The run chart: values in the order of measuring, with lines to compare them with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from core.report.content import RepeatLine
from core.report.figures import new_figure, plot_style
from core.report.look import Look
from core.report.style import MUTED

FORMS = ("--", ":", ":", "-.")
"""Of the lines after the first: told apart without colour."""


def repeats_figure(
    look: Look,
    repeats: Sequence[RepeatLine],
    nominal_mm: float | None,
    tolerance_mm: float | None,
    width_mm: float,
    height_mm: float,
) -> Figure:
    """Thickness of each of `repeats` with ±U over its number, their mean, the nominal value and its tolerance."""
    values = [repeat.thickness_mm for repeat in repeats]
    lines = {"mean": float(np.mean(values))}
    if nominal_mm is not None:
        lines["nominal"] = nominal_mm
        if tolerance_mm is not None:
            lines |= {"upper limit": nominal_mm + tolerance_mm, "lower limit": nominal_mm - tolerance_mm}
    U = [repeat.U_mm for repeat in repeats]
    return run_chart_figure(look, values, U, lines, "thickness, mm", width_mm, height_mm)


def run_chart_figure(
    look: Look,
    values: Sequence[float],
    U: Sequence[float],
    lines: Mapping[str, float],
    label: str,
    width_mm: float,
    height_mm: float,
) -> Figure:
    """Values with ±U (nothing for none) over their number; `lines` by the fixed words they are called."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        room = 34.0
        box = (15 / width_mm, 9 / height_mm, (width_mm - 15 - room) / width_mm, (height_mm - 11) / height_mm)
        axes = figure.add_axes(box)
        numbers = np.arange(1, len(values) + 1)
        bars = np.nan_to_num(U, nan=0.0, posinf=0.0) if len(U) else None
        axes.errorbar(
            numbers, values, bars, fmt="o-", color=look.accent, ms=3.5, lw=0.6, elinewidth=0.9, capsize=2, zorder=4
        )
        tones = [look.accent] + [MUTED] * len(lines)
        for value, form, tone in zip(lines.values(), ("-", *FORMS), tones, strict=False):
            axes.axhline(value, color=tone, lw=0.7, ls=form, zorder=2)
        axes.set_xlim(0.5, len(values) + 0.5)
        axes.set_xlabel(look.words("number of the scan"), labelpad=1)
        axes.set_ylabel(label if label not in ("thickness, mm",) else look.words(label), labelpad=2)
        axes.ticklabel_format(axis="y", useOffset=False)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.spines[["top", "right"]].set_visible(False)
        places = _apart(list(lines.values()), axes.get_ylim())
        for (name, value), tone, place in zip(lines.items(), tones, places, strict=False):
            axes.annotate(
                look.words(name),
                (1.0, value),
                (1.03, place),
                xycoords=axes.get_yaxis_transform(),
                textcoords=axes.get_yaxis_transform(),
                va="center",
                color=tone,
                arrowprops={"arrowstyle": "-", "lw": 0.4, "color": tone, "shrinkA": 1, "shrinkB": 0},
            )
    return figure


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
