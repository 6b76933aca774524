"""The picture of one frame and what was found in it."""

from __future__ import annotations

import cv2
import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.report.content import Overlay
from core.report.layout.style import INK, ReportLook
from core.report.plots.figures import DPI, MM_PER_INCH, add_color_bar, color_scale, new_figure, plot_style, round_up

FAN_COLOR, SWEEP_MAP, UNKNOWN = "#E06C00", "viridis", "#737373"


def overlay_figure(look: ReportLook, overlay: Overlay, width_mm: float, height_mm: float) -> Figure:
    """Draw one frame with the fan's centrelines, the sweep's centreline coloured by σ, and the crossings used."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        rows, columns = overlay.picture.shape
        bar_mm, foot_mm, left_mm = 17.0, 13.0, 11.0
        scale = min((width_mm - bar_mm - left_mm) / columns, (height_mm - foot_mm - 1) / rows)
        shown_w, shown_h = columns * scale, rows * scale
        left, bottom = left_mm / width_mm, 1 - (shown_h + 1) / height_mm
        axes = figure.add_axes((left, bottom, shown_w / width_mm, shown_h / height_mm))
        limits = (-0.5, columns - 0.5, rows - 0.5, -0.5)
        axes.imshow(
            _lightened(overlay.picture, round(shown_w / MM_PER_INCH * DPI)),
            cmap="gray",
            vmin=0,
            vmax=255,
            extent=limits,
        )
        for number, lines in enumerate(overlay.fan, start=1):
            _draw_fan_line(axes, lines, number)
        colors = _draw_sweep(axes, overlay)
        for edge, width in (("white", 2.2), (INK, 1.0)):
            axes.plot(*overlay.crossings.T, "o", ms=5, mfc="none", mec=edge, mew=width, zorder=6)
        axes.set(xlim=limits[:2], ylim=limits[2:])
        axes.set_xlabel("u, px", labelpad=1)
        axes.set_ylabel("v, px", labelpad=1)
        axes.legend(
            handles=_overlay_legend(look, overlay),
            loc="upper left",
            bbox_to_anchor=(-0.01, -7.5 / shown_h),
            ncols=4,
            frameon=False,
            handlelength=2.2,
            columnspacing=1.8,
        )
        if colors is not None:
            box = (left + (shown_w + 3) / width_mm, bottom, 3 / width_mm, (shown_h - 7) / height_mm)
            add_color_bar(figure, box, colors, "σ, mm", "max")
    return figure


def _lightened(picture: NDArray[np.uint8], width_px: int) -> NDArray[np.uint8]:
    """The picture no larger than it is printed, its dark parts lifted so that lines and marks stand out."""
    factor = min(1.0, width_px / picture.shape[1])
    small = cv2.resize(picture, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA) if factor < 1 else picture
    white = max(float(np.quantile(small, 0.999)), 1.0)
    lifted = 105 + 150 * np.clip(small / white, 0, 1) ** 0.7
    return np.round(lifted).astype(np.uint8)


def _draw_fan_line(axes: Axes, lines: tuple[Centreline, ...], number: int) -> None:
    for line in lines:
        axes.plot(*line.uv.T, color="white", lw=1.8, alpha=0.7, zorder=3)
        axes.plot(*line.uv.T, color=FAN_COLOR, lw=0.9, ls=(0, (5, 1.5)), zorder=4)
    if lines:
        ends = np.vstack([line.uv[[0, -1]] for line in lines])
        u, v = ends[np.argmin(ends[:, 1])] if np.ptp(ends[:, 1]) > np.ptp(ends[:, 0]) else ends[np.argmin(ends[:, 0])]
        axes.annotate(
            f"{number}",
            (float(u), float(v)),
            xytext=(4, -6),
            textcoords="offset points",
            color=FAN_COLOR,
            fontsize=8,
            fontweight="bold",
            path_effects=[withStroke(linewidth=2, foreground="white")],
            zorder=8,
        )


def _draw_sweep(axes: Axes, overlay: Overlay) -> ScalarMappable | None:
    """The sweep's centrelines coloured by σ, grey where it is not known; gives the colours, or None without any σ."""
    known = np.concatenate([np.ravel(sigma) for sigma in overlay.sweep_sigma] or [np.zeros(0)])
    known = known[np.isfinite(known)]
    colors = None
    if len(known):
        high = round_up(float(np.quantile(known, 0.95)))
        colors = color_scale(SWEEP_MAP, 0.0, high)
    for line, sigma in zip(overlay.sweep, overlay.sweep_sigma, strict=True):
        axes.plot(*line.uv.T, color="white", lw=3.4, zorder=4.5, solid_capstyle="round")
        shade = np.full((len(sigma), 4), to_rgba(UNKNOWN))
        if colors is not None:
            finite = np.isfinite(sigma)
            shade[finite] = colors.to_rgba(np.asarray(sigma)[finite])
        segments = np.stack([line.uv[:-1], line.uv[1:]], axis=1)
        axes.add_collection(LineCollection(list(segments), colors=shade[:-1], linewidths=2.0, zorder=5))
    return colors


def _overlay_legend(look: ReportLook, overlay: Overlay) -> list[Line2D]:
    handles = []
    if any(overlay.fan):
        handles.append(
            Line2D([], [], color=FAN_COLOR, lw=1.2, ls=(0, (5, 1.5)), label=look.words("fan line, with its number"))
        )
    if overlay.sweep:
        middle = matplotlib.colormaps[SWEEP_MAP](0.4)
        handles.append(
            Line2D([], [], color=middle, lw=2.2, label=look.words("hand-moved line, coloured by σ of depth"))
        )
        if any(not np.isfinite(sigma).all() for sigma in overlay.sweep_sigma):
            handles.append(Line2D([], [], color=UNKNOWN, lw=2.2, label=look.words("no depth")))
    if len(overlay.crossings):
        handles.append(
            Line2D([], [], marker="o", ls="", ms=5, mfc="none", mec=INK, mew=1.0, label=look.words("crossing used"))
        )
    return handles
