"""Plots of the surface, of the faces' residuals and of the cloud: one function, one Figure.

Colours tell values apart by lightness as well, or by sign with a pale middle (orange–purple), so they survive colour
blindness and grey printing; lines differ in form.
"""

from __future__ import annotations

import cv2
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from core.inspect.results import Face, GaugeResult
from core.model import LightPlane
from core.model.arrays import Array
from core.progress import Progress, silent
from core.report.figures import (
    DPI,
    MM_PER_INCH,
    NO_DATA,
    add_color_bar,
    color_scale,
    mixed,
    new_figure,
    paint_map,
    plot_style,
    round_up,
)
from core.report.look import Look
from core.report.style import HAIRLINE, INK, MUTED
from core.report.surface_view import Ground, SurfacePicture, surface_picture, viewer_axes
from core.scan.cloud import Cloud
from core.scan.surface import Mesh

DEPTH_MAP, SIGMA_MAP, SIGN_MAP = "cividis", "viridis", "PuOr_r"


def height_map(accent: str) -> LinearSegmentedColormap:
    """From pale to the accent: the shading shows the form, the colour the height."""
    return LinearSegmentedColormap.from_list("height", ["#DDE2E5", mixed(accent, 0.5), accent])


def surface_figure(
    look: Look,
    mesh: Mesh,
    cloud: Cloud,
    plane: LightPlane | None,
    width_mm: float,
    height_mm: float,
    progress: Progress = silent,
) -> Figure:
    """The surface, shaded and coloured by height above `plane` (None: towards the camera), with its dimensions."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        bar_mm = 22.0
        points = np.asarray(mesh.vertices if len(mesh.triangles) else cloud.points)
        ground = Ground.of(plane, points)
        aspect = (width_mm - bar_mm) / height_mm
        width_px = round((width_mm - bar_mm) / MM_PER_INCH * DPI)
        seen = surface_picture(mesh, cloud, ground, 2 * width_px, aspect, progress)
        heights = ground.local(points)[:, 2]
        low, high = (float(value) for value in np.quantile(heights, [0.002, 0.998]))
        colors = color_scale(height_map(look.accent), low, high if high > low else low + 1e-6)
        paint = _painted(seen, colors)
        small = cv2.resize(paint, (width_px, round(width_px / aspect)), interpolation=cv2.INTER_AREA)
        axes = figure.add_axes((0, 0, 1 - bar_mm / width_mm, 1))
        axes.imshow(small, extent=seen.extent, interpolation="antialiased", aspect="auto")
        axes.set_axis_off()
        _draw_footprint(axes, ground.local(points))
        axes.set_xlim(seen.extent[:2])
        axes.set_ylim(seen.extent[2:])
        add_color_bar(figure, (1 - (bar_mm - 4) / width_mm, 0.12, 3 / width_mm, 0.7), colors, look.words("height, mm"))
    return figure


def _painted(seen: SurfacePicture, colors: ScalarMappable) -> NDArray[np.uint8]:
    """The colour of each height, darkened by its shade, white where nothing is seen; (H, W, 3)."""
    low, high = colors.get_clim()
    table = colors.to_rgba(np.linspace(low, high, 256))[:, :3].astype(np.float32)
    drawn = np.isfinite(seen.height)
    level = np.clip((seen.height[drawn] - low) * (255 / (high - low)), 0, 255)
    paint = np.full((*seen.height.shape, 3), 255, dtype=np.uint8)
    paint[drawn] = np.round(table[level.astype(np.uint8)] * (255 * seen.shade[drawn, None].astype(np.float32)))
    return paint


def _draw_footprint(axes: Axes, local: Array) -> None:
    """Two dimension lines on the ground along the two edges of the footprint that are nearest the viewer."""
    low, high = np.quantile(local, 0.0005, axis=0), np.quantile(local, 0.9995, axis=0)
    gap = 0.03 * float(np.max(high[:2] - low[:2]))
    base = low[2]
    # the viewer stands at negative `across`, to the left or right by the azimuth's sign
    side = low[0] - gap if viewer_axes()[2, 0] < 0 else high[0] + gap
    front = low[1] - gap
    edges = (
        (np.array([[low[0], front, base], [high[0], front, base]]), high[0] - low[0]),
        (np.array([[side, low[1], base], [side, high[1], base]]), high[1] - low[1]),
    )
    for ends, length in edges:
        seen = ends @ viewer_axes()[:2].T
        axes.annotate(
            "", seen[1], seen[0], arrowprops={"arrowstyle": "|-|,widthA=0.25,widthB=0.25", "lw": 0.6, "color": MUTED}
        )
        middle, along = seen.mean(axis=0), seen[1] - seen[0]
        along = along if along[0] >= 0 else -along
        below = np.array([along[1], -along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
        axes.annotate(
            f"{length:.0f} mm" if length >= 10 else f"{length:.1f} mm",
            middle,
            (3 * float(below[0]), 3 * float(below[1])),
            textcoords="offset points",
            rotation=float(np.degrees(np.arctan2(along[1], along[0]))),
            rotation_mode="anchor",
            ha="center",
            va="top",
            color=INK,
        )


def residual_figure(look: Look, gauge: GaugeResult, cloud: Cloud, width_mm: float, height_mm: float) -> Figure:
    """Residuals of both faces, mean per cell, in mm of the face's own plane; one colour scale, and how they spread."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        spread = np.concatenate([gauge.upper.residuals, gauge.lower.residuals])
        limit = round_up(float(np.quantile(np.abs(spread), 0.95))) if len(spread) else 1.0
        colors = color_scale(SIGN_MAP, -limit, limit)
        panels = ((look.words("Upper face"), gauge.upper, 11.0), (look.words("Lower face"), gauge.lower, 67.0))
        for title, face, left in panels:
            box = (left / width_mm, 12 / height_mm, 43 / width_mm, 1 - 18 / height_mm)
            _residual_panel(look, figure.add_axes(box), title, face, cloud, colors)
        bar_box = (115.5 / width_mm, 12 / height_mm, 3 / width_mm, 1 - 22 / height_mm)
        add_color_bar(figure, bar_box, colors, "mm", "both")
        box = (141 / width_mm, 12 / height_mm, (width_mm - 143) / width_mm, 1 - 18 / height_mm)
        _spread_panel(look, figure.add_axes(box), gauge, 1.8 * limit)
    return figure


def _residual_panel(look: Look, axes: Axes, title: str, face: Face, cloud: Cloud, colors: ScalarMappable) -> None:
    axes.set_title(title)
    axes.set_xlabel(look.words("along, mm"), labelpad=1)
    axes.set_ylabel(look.words("across, mm"), labelpad=0)
    axes.set_facecolor(NO_DATA)
    if not len(face.indices):
        return
    points = cloud.points[face.indices]
    flat = Ground.of(face.plane, points).local(points)[:, :2]
    flat -= (flat.min(axis=0) + flat.max(axis=0)) / 2
    paint_map(axes, flat, face.residuals, colors)


def _spread_panel(look: Look, axes: Axes, gauge: GaugeResult, limit: float) -> None:
    """How the residuals of both faces spread: density over the residual, told apart by line form."""
    edges = np.linspace(-limit, limit, 61)
    for face, name, form, tone in (
        (gauge.upper, "upper", "-", INK),
        (gauge.lower, "lower", (0, (3, 1.2)), "#8A6D00"),
    ):
        if len(face.residuals):
            density = np.histogram(np.clip(face.residuals, -limit, limit), edges)[0] / len(face.residuals)
            axes.stairs(100 * density, edges, color=tone, lw=0.9, ls=form, label=look.words(name), baseline=None)
    axes.axvline(0, color=HAIRLINE, lw=0.6, zorder=0)
    axes.set_xlim(-limit, limit)
    axes.set_ylim(bottom=0)
    axes.set_title(look.words("Spread"), fontsize=7.5)
    axes.set_xlabel(look.words("residual, mm"), labelpad=1)
    axes.set_ylabel(look.words("points, %"), labelpad=1)
    axes.spines[["top", "right"]].set_visible(False)
    if axes.patches:
        axes.legend(frameon=False, fontsize=6, loc="upper left", handlelength=1.6, borderaxespad=0.1)


def cloud_figure(look: Look, cloud: Cloud, image_size: tuple[int, int], width_mm: float, height_mm: float) -> Figure:
    """Depth and its standard uncertainty over the picture, mean per cell: what there is to show without a gauge."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        panels = (
            ("Depth z from the camera", cloud.points[:, 2], DEPTH_MAP, 11.0),
            ("Standard uncertainty σ of depth", cloud.sigma, SIGMA_MAP, 98.0),
        )
        for title, values, name, left in panels:
            axes = figure.add_axes((left / width_mm, 12 / height_mm, 56 / width_mm, 1 - 18 / height_mm))
            axes.set_title(look.words(title))
            axes.set_facecolor(NO_DATA)
            axes.set_xlabel("u, px", labelpad=1)
            axes.set_ylabel("v, px", labelpad=0)
            finite = values[np.isfinite(values)]
            if len(finite):
                low, high = (float(value) for value in np.quantile(finite, [0.01, 0.98]))
                colors = color_scale(name, low if name == DEPTH_MAP else 0.0, max(high, low + 1e-9))
                paint_map(axes, cloud.uv, values, colors)
                box = ((left + 59) / width_mm, 12 / height_mm, 3 / width_mm, 1 - 22 / height_mm)
                add_color_bar(figure, box, colors, "mm", "max")
            axes.set_xlim(-0.5, image_size[0] - 0.5)
            axes.set_ylim(image_size[1] - 0.5, -0.5)
            axes.set_aspect("equal")
            axes.set_anchor("W")
    return figure
