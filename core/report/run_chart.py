"""The run chart: repeated thicknesses in the order of measuring."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from core.report.content import RepeatLine
from core.report.figures import new_figure, plot_style
from core.report.style import ACCENT, MUTED


def run_chart_figure(
    repeats: Sequence[RepeatLine],
    nominal_mm: float | None,
    tolerance_mm: float | None,
    width_mm: float,
    height_mm: float,
) -> Figure:
    """Thickness of each of `repeats` with ±U over its number, their mean, the nominal value and its tolerance."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        axes = figure.add_axes((15 / width_mm, 9 / height_mm, (width_mm - 43) / width_mm, (height_mm - 11) / height_mm))
        numbers = np.arange(1, len(repeats) + 1)
        values = np.array([repeat.thickness_mm for repeat in repeats])
        U = np.nan_to_num([repeat.U_mm for repeat in repeats], nan=0.0, posinf=0.0)
        axes.errorbar(numbers, values, U, fmt="o-", color=ACCENT, ms=3.5, lw=0.6, elinewidth=0.9, capsize=2, zorder=4)
        lines = [(float(values.mean()), "mean", "-", ACCENT)]
        if nominal_mm is not None:
            lines.append((nominal_mm, "nominal", "--", MUTED))
            if tolerance_mm is not None:
                lines += [
                    (nominal_mm + tolerance_mm, "upper limit", ":", MUTED),
                    (nominal_mm - tolerance_mm, "lower limit", ":", MUTED),
                ]
        for value, _, form, tone in lines:
            axes.axhline(value, color=tone, lw=0.7, ls=form, zorder=2)
        axes.set_xlim(0.5, len(repeats) + 0.5)
        axes.set_xlabel("number of the scan", labelpad=1)
        axes.set_ylabel("thickness, mm", labelpad=2)
        axes.ticklabel_format(axis="y", useOffset=False)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.spines[["top", "right"]].set_visible(False)
        for (value, name, _, tone), place in zip(
            lines, _apart([line[0] for line in lines], axes.get_ylim()), strict=True
        ):
            axes.annotate(
                name,
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
