"""The deviation of a surface from its nominal one over the picture: colour, marks that need no colour, histogram."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from core.inspect.deviation_map import classes_of, mark
from core.model.arrays import Array
from core.report.content import Deviations
from core.report.figures import NO_DATA, add_color_bar, color_scale, new_figure, paint_map, plot_style
from core.report.look import Look
from core.report.plots import SIGN_MAP
from core.report.style import HAIRLINE, INK

MARKS_ACROSS = 14
"""Marks over the width of the picture."""


def deviation_figure(look: Look, one: Deviations, width_mm: float, height_mm: float) -> Figure:
    """Mean deviation per cell where the camera sees it, with a mark for its class, and how the deviations spread."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        axes = figure.add_axes((11 / width_mm, 10 / height_mm, 96 / width_mm, 1 - 12 / height_mm))
        axes.set_facecolor(NO_DATA)
        colors = color_scale(SIGN_MAP, -one.tolerance_mm, one.tolerance_mm)
        seen = one.uv * (1, -1)  # upwards in the plot as in the picture
        paint_map(axes, seen, one.deviation, colors)
        _marks(axes, seen, one)
        axes.set_aspect("equal")
        axes.set_xticks([])
        axes.set_yticks([])
        bar = (112 / width_mm, 10 / height_mm, 3 / width_mm, 1 - 20 / height_mm)
        add_color_bar(figure, bar, colors, "mm", "both")
        spread = figure.add_axes((138 / width_mm, 10 / height_mm, (width_mm - 140) / width_mm, 1 - 16 / height_mm))
        _histogram(look, spread, one)
    return figure


def _marks(axes: Axes, seen: Array, one: Deviations) -> None:
    """The class of the mean deviation of each coarse cell, as a sign in its middle."""
    low, high = seen.min(axis=0), seen.max(axis=0)
    cell = max(float(np.max(high - low)) / MARKS_ACROSS, 1e-9)
    place = np.floor((seen - low) / cell).astype(int)
    for column, row in np.unique(place, axis=0):
        inside = (place[:, 0] == column) & (place[:, 1] == row)
        sign = mark(int(classes_of(np.array([one.deviation[inside].mean()]), one.tolerance_mm)[0]))
        if sign:
            u, v = seen[inside].mean(axis=0)
            halo = [withStroke(linewidth=1.5, foreground="white")]
            axes.text(float(u), float(v), sign, ha="center", va="center", fontsize=6, color=INK, path_effects=halo)


def _histogram(look: Look, axes: Axes, one: Deviations) -> None:
    widest = 1.5 * one.tolerance_mm
    edges = np.linspace(-widest, widest, 41)
    counts = np.histogram(np.clip(one.deviation, -widest, widest), edges)[0]
    axes.stairs(100 * counts / max(len(one.deviation), 1), edges, color=look.accent, lw=0.9, baseline=None)
    for limit in (-one.tolerance_mm, one.tolerance_mm):
        axes.axvline(limit, color=INK, lw=0.6, ls=":")
    axes.axvline(0, color=HAIRLINE, lw=0.6, zorder=0)
    axes.set_xlim(-widest, widest)
    axes.set_ylim(bottom=0)
    axes.set_xlabel(look.words("deviation, mm"), labelpad=1)
    axes.set_ylabel(look.words("points, %"), labelpad=1)
    axes.spines[["top", "right"]].set_visible(False)
