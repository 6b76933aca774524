"""Light profiles of one picture with the thickness that each picture of the fan alone gives, and cross-sections."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from core.model.arrays import Array
from core.report.content import LightProfiles
from core.report.layout.style import MUTED, ReportLook
from core.report.plots.figures import mixed, new_figure, plot_style

FORMS = ("o", "^", "s", "v", "D")
"""Marks of the lines: told apart without colour."""
_LEFT_MM, _FOOT_MM, _HEAD_MM, _BESIDE_MM, _BETWEEN_MM = 13.0, 9.0, 2.0, 44.0, 17.0
"""Room in mm for the numbers at the left and below, above the plot, for the plot beside it, and between the two."""
_DIMENSION_MM = 5.0
"""Room above and beside a cross-section for the line and the number of a dimension."""
_MOST_SECTION_MARKS = 2000
"""Points of a cross-section that are drawn."""
_MOST_MARKS = 120
"""Points of a line that are drawn: more lie over each other."""


def profiles_figure(look: ReportLook, profiles: LightProfiles, width_mm: float, height_mm: float) -> Figure:
    """Draw the light profiles of one picture over the lower face, and the thickness of each picture with ±2u, in mm."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        foot, height = _FOOT_MM / height_mm, (height_mm - _FOOT_MM - _HEAD_MM) / height_mm
        beside = _BESIDE_MM if len(profiles.thickness_mm) > 1 else 0.0
        room = width_mm - _LEFT_MM - (beside + _BETWEEN_MM if beside else 2.0)
        _heights(look, profiles, figure.add_axes((_LEFT_MM / width_mm, foot, room / width_mm, height)))
        if beside:
            left = (width_mm - beside - 1) / width_mm
            _of_each(look, profiles, figure.add_axes((left, foot, beside / width_mm, height)))
    return figure


def section_figure(look: ReportLook, profile: Array, width_mm: float, height_mm: float) -> Figure:
    """Draw a cross-section: heights over positions, `profile` (M, 2) in mm, M ≥ 1; to one scale unless it is flat."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        room = (width_mm - _LEFT_MM - _DIMENSION_MM, height_mm - _FOOT_MM - _DIMENSION_MM)
        axes = figure.add_axes((_LEFT_MM / width_mm, _FOOT_MM / height_mm, room[0] / width_mm, room[1] / height_mm))
        some = np.linspace(0, len(profile) - 1, min(len(profile), _MOST_SECTION_MARKS)).astype(np.int64)
        axes.plot(profile[some, 0], profile[some, 1], "o", color=look.accent, ms=1.2, mew=0)
        axes.margins(0.03, 0.1)
        across, up = float(np.ptp(profile[:, 0])), float(np.ptp(profile[:, 1]))
        if up * room[0] > 0.3 * across * room[1]:  # else a flat profile would be a line without any relief
            axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlabel(look.words("position along the profile, mm"), labelpad=1)
        axes.set_ylabel(look.words("height, mm"), labelpad=2)
        axes.spines[["top", "right"]].set_visible(False)
        _dimensions(look, profile, axes)
    return figure


def _dimensions(look: ReportLook, profile: Array, axes: Axes) -> None:
    """The extent of what was measured, along and up, as a drawing has it."""
    (left, low), (right, high) = profile.min(axis=0), profile.max(axis=0)
    along, up = (f"{look.words.fixed(length, 2)} mm" for length in (right - left, high - low))
    ends = {"arrowstyle": "|-|, widthA=0.25, widthB=0.25", "color": MUTED, "lw": 0.6, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (left, 1.0), (right, 1.0), axes.get_xaxis_transform(), arrowprops=ends)
    axes.annotate("", (1.0, low), (1.0, high), axes.get_yaxis_transform(), arrowprops=ends)
    axes.text((left + right) / 2, 1.02, along, transform=axes.get_xaxis_transform(), ha="center", va="bottom")
    axes.text(1.01, (low + high) / 2, up, transform=axes.get_yaxis_transform(), rotation=90, va="center")


def _heights(look: ReportLook, profiles: LightProfiles, axes: Axes) -> None:
    for place, (number, position, height) in enumerate(profiles.lines):
        some = np.linspace(0, len(position) - 1, min(len(position), _MOST_MARKS)).astype(np.int64)
        tone = mixed(look.accent, 1 - 0.28 * (place % 3))
        form = FORMS[place % len(FORMS)]
        name = look.words("line {n}", n=number)
        axes.plot(position[some], height[some], form, color=tone, ms=1.8, mew=0, label=name, zorder=3)
    for level in (0.0, profiles.step_mm):
        axes.axhline(level, color=MUTED, lw=0.6, ls="--", zorder=2)
    axes.set_xlabel(look.words("position along the profile, mm"), labelpad=1)
    axes.set_ylabel(look.words("height, mm"), labelpad=2)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=6.5, markerscale=2, loc="center left")


def _of_each(look: ReportLook, profiles: LightProfiles, axes: Axes) -> None:
    numbers = np.arange(1, len(profiles.thickness_mm) + 1)
    low, high = (profiles.mean_mm + sign * profiles.U_mm for sign in (-1, 1))
    axes.axhspan(low, high, color=mixed(look.accent, 0.15), lw=0)
    axes.axhline(profiles.mean_mm, color=look.accent, lw=0.7)
    bars = 2 * profiles.own_mm
    axes.errorbar(numbers, profiles.thickness_mm, bars, fmt="o", color=look.accent, ms=3, elinewidth=0.8, capsize=2)
    axes.set_xlim(0.5, len(numbers) + 0.5)
    axes.set_xlabel(look.words("number of the picture"), labelpad=1)
    axes.set_ylabel(look.words("thickness, mm"), labelpad=2)
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.xaxis.set_major_locator(MaxNLocator(4, integer=True))
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.spines[["top", "right"]].set_visible(False)
