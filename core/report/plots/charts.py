"""Plots of the surface, of the faces' residuals and of the cloud: one function, one Figure.

Colours tell values apart by lightness as well, or by sign with a pale middle (orange–purple), so they survive colour
blindness and grey printing; lines differ in form.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import cv2
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from core.inspect.results import Face, GaugeResult, PairCandidate
from core.inspect.shown.deviation_map import classes_of, mark
from core.inspect.shown.seen_from import SeenFrom
from core.inspect.shown.view_frame import Ground
from core.model import LightPlane
from core.model.arrays import Array
from core.progress import Progress, silent
from core.report.content import Deviations, ReportContent
from core.report.facts.of_features import characteristic_facts
from core.report.layout.style import HAIRLINE, INK, MUTED, ReportLook
from core.report.plots.figures import (
    DPI,
    MM_PER_INCH,
    NO_DATA,
    add_color_bar,
    color_scale,
    drawable,
    families,
    mixed,
    new_figure,
    paint_map,
    plot_style,
    round_up,
)
from core.report.plots.surface_view import (
    SurfacePicture,
    Viewpoint,
    left_viewpoint,
    surface_picture,
    usual_viewpoint,
    viewer_axes,
)
from core.report.wording import SIGNS, points_counted, shown_name
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh

DEPTH_MAP, SIGMA_MAP, SIGN_MAP = "cividis", "viridis", "PuOr_r"
ABOVE_FOOTPRINT = 0.65
"""Share of the picture, from above, that callouts stand in: the dimensions of the footprint stand below."""
CALLOUT_INSET = 0.006
"""Share of its width that their words stand from its sides: the frames round them are seen whole."""


def height_map(accent: str) -> LinearSegmentedColormap:
    """Make the colour map for heights, from a pale colour to `accent`."""
    return LinearSegmentedColormap.from_list("height", ["#DDE2E5", mixed(accent, 0.5), accent])


def surface_figure(
    look: ReportLook,
    mesh: Mesh,
    cloud: Cloud,
    plane: LightPlane | None,
    width_mm: float,
    height_mm: float,
    callouts: Sequence[Callout] = (),
    progress: Progress = silent,
) -> Figure:
    """Draw the surface, shaded and coloured by height above `plane` (None: towards the camera), with callouts.

    Each callout points at its place.
    """
    points = np.asarray(mesh.vertices if len(mesh.triangles) else cloud.points)
    ground, size = Ground.of(plane, points), (width_mm, height_mm)
    seen = surface_picture(mesh, cloud, ground, *_pixels_of(size), progress)
    with plot_style():
        figure, axes = _shown(look, seen, ground.local(points)[:, 2], size)
        _draw_footprint(axes, ground.local(points))
        axes.set_xlim(seen.extent[:2])
        axes.set_ylim(seen.extent[2:])
        _draw_callouts(axes, callouts, ground, usual_viewpoint())
    return figure


def view_figure(
    look: ReportLook, content: ReportContent, view: SeenFrom, size: tuple[float, float], progress: Progress = silent
) -> Figure:
    """Draw the surface in the view that the user chose in 3D, coloured by height, in a figure of `size` in mm.

    What was hidden then is left out. A result's words are there if its place is in sight.
    """
    mesh, cloud, gauge = content.mesh, content.cloud, content.gauge
    points = np.asarray(mesh.vertices if len(mesh.triangles) else cloud.points)
    ground = Ground.of(gauge.lower.plane if gauge else None, points)
    width_px, aspect = _pixels_of(size)
    viewpoint = left_viewpoint(view, ground, aspect)
    kept = mesh.triangles[~view.hides(mesh.vertices)[mesh.triangles].any(axis=1)]
    bare = replace(mesh, triangles=kept), cloud.select(~view.hides(cloud.points))
    seen = surface_picture(*bare, ground, width_px, aspect, progress, viewpoint)
    shown = [one for one in callouts(look, content) if view.in_sight(one.place[None])[0]]
    with plot_style():
        figure, axes = _shown(look, seen, ground.local(points)[:, 2], size)
        axes.set_xlim(seen.extent[:2])
        axes.set_ylim(seen.extent[2:])
        _draw_callouts(axes, shown, ground, viewpoint)
    return figure


BAR_MM = 22.0
"""Room of the colour bar at the right of a surface."""


def _pixels_of(size: tuple[float, float]) -> tuple[int, float]:
    """Width in pixels of a surface in a figure of `size` in mm, twice as fine as printed; and width by height."""
    width_mm = size[0] - BAR_MM
    return 2 * round(width_mm / MM_PER_INCH * DPI), width_mm / size[1]


def _shown(look: ReportLook, seen: SurfacePicture, heights: Array, size: tuple[float, float]) -> tuple[Figure, Axes]:
    """A figure with the picture of a surface, coloured by height, and its colour bar."""
    width_mm, _ = size
    figure = new_figure(*size)
    low, high = (float(value) for value in np.quantile(heights, [0.002, 0.998]))
    colors = color_scale(height_map(look.accent), low, high if high > low else low + 1e-6)
    width_px, aspect = _pixels_of(size)
    half = (width_px // 2, round(width_px / 2 / aspect))
    small = cv2.resize(_painted(seen, colors), half, interpolation=cv2.INTER_AREA)
    axes = figure.add_axes((0, 0, 1 - BAR_MM / width_mm, 1))
    axes.imshow(small, extent=seen.extent, interpolation="antialiased", aspect="auto")
    axes.set_axis_off()
    add_color_bar(figure, (1 - (BAR_MM - 4) / width_mm, 0.12, 3 / width_mm, 0.7), colors, look.words("height, mm"))
    return figure, axes


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
            "",
            seen[1],
            seen[0],
            arrowprops={"arrowstyle": "|-|,widthA=0.25,widthB=0.25", "lw": 0.6, "color": MUTED},
            annotation_clip=False,  # it lies outside what is measured, perhaps outside the picture of that
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


class Callout(NamedTuple):
    """Text at a place (3,) of the camera frame."""

    said: str
    place: Array


def callouts(look: ReportLook, content: ReportContent) -> list[Callout]:
    """Make the callouts of the surface's figure: the worst characteristic of each feature, with U and verdict."""
    made = []
    for one, indices in content.shown_at:
        points = content.cloud.points[indices]
        middle = points[np.argmin(((points - points.mean(axis=0)) ** 2).sum(axis=1))]
        name, sign = shown_name(one, look.words), f" {SIGNS[one.verdict]}" if one.limits is not None else ""
        made.append(Callout(f"{name}{sign}\n{characteristic_facts(one)[0].text(look.words)}", middle))
    return made


def _draw_callouts(axes: Axes, shown: Sequence[Callout], ground: Ground, viewpoint: Viewpoint) -> None:
    """Words in a column at either side, in the order of their places from above, so that no two lines cross."""
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    seen = [(one.said, *(viewpoint.axes[:2] @ ground.local(one.place[None])[0])) for one in shown]
    seen.sort(key=lambda one: one[1])
    half = (len(seen) + 1) // 2
    inset = CALLOUT_INSET * (right - left)
    for at, align, side in ((left + inset, "left", seen[:half]), (right - inset, "right", seen[half:])):
        rows = max(len(side), 4)
        for place, (said, x, y) in enumerate(sorted(side, key=lambda one: -one[2])):
            axes.annotate(
                said,
                (x, y),
                (at, top - (place + 0.5) / rows * ABOVE_FOOTPRINT * (top - bottom)),
                ha=align,
                va="center",
                color=INK,
                zorder=8,
                bbox={"boxstyle": "square,pad=0.25", "fc": "white", "ec": HAIRLINE, "lw": 0.4},
                arrowprops={"arrowstyle": "-", "lw": 0.6, "color": INK, "shrinkB": 0, "patchB": None},
            )
            axes.plot([x], [y], "o", ms=2.5, mfc="white", mec=INK, mew=0.7, zorder=9)


def residual_figure(look: ReportLook, gauge: GaugeResult, cloud: Cloud, width_mm: float, height_mm: float) -> Figure:
    """Draw the mean residuals in mm over both faces of a thickness in one colour scale, and a histogram of them."""
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


def _residual_panel(look: ReportLook, axes: Axes, title: str, face: Face, cloud: Cloud, colors: ScalarMappable) -> None:
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


def _spread_panel(look: ReportLook, axes: Axes, gauge: GaugeResult, limit: float) -> None:
    """How the residuals of both faces spread: density over the residual, told apart by line form."""
    edges = np.linspace(-limit, limit, 61)
    for face, name, form, tone in (
        (gauge.upper, look.words("upper"), "-", INK),
        (gauge.lower, look.words("lower"), (0, (3, 1.2)), "#8A6D00"),
    ):
        if len(face.residuals):
            density = np.histogram(np.clip(face.residuals, -limit, limit), edges)[0] / len(face.residuals)
            axes.stairs(100 * density, edges, color=tone, lw=0.9, ls=form, label=name, baseline=None)
    axes.axvline(0, color=HAIRLINE, lw=0.6, zorder=0)
    axes.set_xlim(-limit, limit)
    axes.set_ylim(bottom=0)
    axes.set_title(look.words("Spread"), fontsize=7.5)
    axes.set_xlabel(look.words("residual, mm"), labelpad=1)
    axes.set_ylabel(look.words("points, %"), labelpad=1)
    axes.spines[["top", "right"]].set_visible(False)
    if axes.patches:
        axes.legend(frameon=False, fontsize=6, loc="upper left", handlelength=1.6, borderaxespad=0.1)


def cloud_figure(
    look: ReportLook, cloud: Cloud, image_size: tuple[int, int], width_mm: float, height_mm: float
) -> Figure:
    """Draw two maps over the camera's picture: the depth of the points, and its standard uncertainty σ, in mm."""
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        panels = (
            (look.words("Depth z from the camera"), cloud.points[:, 2], DEPTH_MAP, 11.0),
            (look.words("Standard uncertainty σ of depth"), cloud.sigma, SIGMA_MAP, 98.0),
        )
        for title, values, name, left in panels:
            axes = figure.add_axes((left / width_mm, 12 / height_mm, 56 / width_mm, 1 - 18 / height_mm))
            axes.set_title(title)
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


COLORS = ("#14586E", "#E06C00", "#6A3D9A", "#8A6D00", "#B2182B", "#3B7A3B", "#1B9E9E", "#737373")
MARKS = ("s", "o", "^", "D", "v", "P", "X", "*")
"""Told apart by form as well as by colour, in the legend."""

MOST_DRAWN = 4000
"""Points drawn of each: more would only cover each other."""


def points_figure(
    look: ReportLook,
    cloud: Cloud,
    points: Mapping[str, NDArray[np.int64]],
    image_size: tuple[int, int],
    width_mm: float,
    height_mm: float,
    pairs: Sequence[PairCandidate] = (),
) -> Figure:
    """Draw which points were used: all points grey, those of each face or feature in `points` coloured, in pixels.

    Of several `pairs` of faces that could be meant, the measured one is outlined, and dashed the next best.
    """
    with plot_style():
        figure = new_figure(width_mm, height_mm)
        columns, rows = image_size
        foot, left, legend = 9.0, 11.0, 52.0
        scale = min((width_mm - left - legend) / columns, (height_mm - foot - 1) / rows)
        box = (left / width_mm, foot / height_mm, columns * scale / width_mm, rows * scale / height_mm)
        axes = figure.add_axes(box)
        every = max(1, len(cloud) // (2 * MOST_DRAWN))
        axes.plot(*cloud.uv[::every].T, ".", ms=1.2, color=HAIRLINE, zorder=1)
        largest_first = sorted(points.items(), key=lambda item: -len(item[1]))
        for number, (name, indices) in enumerate(largest_first):
            drawn = cloud.uv[indices[:: max(1, len(indices) // MOST_DRAWN)]]
            mark, color = MARKS[number % len(MARKS)], COLORS[number % len(COLORS)]
            # what lies below another keeps a rim
            axes.plot(*drawn.T, ".", ms=max(3.2 - 0.8 * number, 1.2), color=color, zorder=2)
            count = look.words(points_counted(len(indices)))
            axes.plot([], [], mark, ms=4, color=color, label=f"{_short(drawable(name))}\n{count}")
        _outline_pairs(look, axes, pairs)
        axes.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5))
        axes.set_xlabel("u, px", labelpad=1)
        axes.set_ylabel("v, px", labelpad=0)
        axes.set_aspect("equal")
        axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.02), frameon=False, handletextpad=0.6,
                    prop={"family": families("".join(points)), "size": 6.5})  # fmt: skip
    return figure


def _outline_pairs(look: ReportLook, axes: Axes, pairs: Sequence[PairCandidate]) -> None:
    words = look.words
    for place, pair in enumerate(pairs[:2]):
        mm, style = words.fixed(pair.thickness_mm, 1), (0, (3, 1.5)) if place else "-"
        for outline in filter(None, pair.outlines_px):
            corners = np.array([*outline, outline[0]])
            axes.plot(*corners.T, color="white", lw=2.2, zorder=3)
            axes.plot(*corners.T, color=INK, lw=1.0, ls=style, zorder=4)
        said = (
            words("next best pair, {mm} mm: not measured", mm=mm) if place else words("measured pair, {mm} mm", mm=mm)
        )
        axes.plot([], [], color=INK, lw=1.0, ls=style, label=said)


def _short(name: str) -> str:
    """A name that fits beside the picture."""
    return name if len(name) <= 34 else f"{name[:33]}…"


MARKS_ACROSS = 14
"""Marks over the width of the picture."""


def deviation_figure(look: ReportLook, one: Deviations, width_mm: float, height_mm: float) -> Figure:
    """Draw the map of mean deviations from a nominal surface in the camera's view, and a histogram of them."""
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


def _histogram(look: ReportLook, axes: Axes, one: Deviations) -> None:
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
