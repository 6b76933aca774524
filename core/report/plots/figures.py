"""What the report's plots share: the figure, its looks, colour bars, and maps of scattered values.

No pyplot: every figure has a canvas of its own, so nothing is shared between reports or threads but the settings
that `plot_style` sets for the moment.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import Formatter, ScalarFormatter
from numpy.typing import NDArray

from core.model.arrays import Array
from core.report.layout.foreign_fonts import drawn_family
from core.report.layout.style import INK, MUTED, has_character

DPI = 200
"""Pixels per inch of every picture on paper."""

MM_PER_INCH = 25.4
"""Matplotlib measures figures in inches."""

NO_DATA = "#E9EDEF"
"""Ground of maps: shows where there is no value."""

FAMILY = "DejaVu Sans"

RC: dict[Any, Any] = {
    "font.family": FAMILY,
    "font.size": 7,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.5,
    "axes.titlesize": 7.5,
    "axes.titlelocation": "left",
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "path.simplify": True,
}
"""On top of matplotlib's own defaults, so that the user's settings do not change a report."""


def plot_style() -> AbstractContextManager[None]:
    """Apply the style of the report's plots within a `with` block."""
    return matplotlib.style.context(["default", RC])


def drawable(text: str) -> str:
    """Replace each character of `text` that no font for plots has by a question mark."""
    return "".join(character if has_character(character) or drawn_family(character) else "?" for character in text)


def families(text: str) -> list[str]:
    """List the font families that are needed to draw `text` in a plot, the report's own first."""
    foreign = dict.fromkeys(drawn_family(character) for character in text if not has_character(character))
    return [FAMILY, *(family for family in foreign if family)]


def new_figure(width_mm: float, height_mm: float) -> Figure:
    """Make an empty figure of the given width and height on paper, in mm."""
    figure = Figure(figsize=(width_mm / MM_PER_INCH, height_mm / MM_PER_INCH), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def mixed(accent: str, share: float) -> str:
    """Mix white with the hex colour `accent`: `share` 0 gives white, 1 gives `accent`."""
    red, green, blue = (1 - share * (1 - part) for part in to_rgb(accent))
    return to_hex((red, green, blue))


def pixels(figure: Figure, decimal: str = ".") -> NDArray[np.uint8]:
    """Render the figure to RGB pixels (H, W, 3) uint8; `decimal` is the decimal sign of the numbers on its axes.

    Raises
    ------
    ValueError
        If the figure is not one of `new_figure`.
    """
    canvas = figure.canvas
    if not isinstance(canvas, FigureCanvasAgg):
        raise ValueError("the figure was not made for drawing into memory")
    with plot_style():
        if decimal != ".":
            _number_with(figure, decimal)
        for words in figure.findobj(Text):
            if isinstance(words, Text) and not all(map(has_character, words.get_text())):
                words.set_text(drawable(words.get_text()))
                words.set_fontfamily(families(words.get_text()))
        canvas.draw()  # type: ignore[no-untyped-call]
    rgba = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    return np.ascontiguousarray(rgba[:, :, :3], dtype=np.uint8)


def _number_with(figure: Figure, decimal: str) -> None:
    """Give every axis that numbers itself another decimal sign."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            inner = axis.get_major_formatter()
            if isinstance(inner, ScalarFormatter):
                axis.set_major_formatter(_Renumbered(inner, decimal))


class _Renumbered(Formatter):
    """Another formatter's numbers with another decimal sign."""

    def __init__(self, inner: ScalarFormatter, decimal: str) -> None:
        self.inner, self.decimal = inner, decimal

    def __call__(self, x: float, pos: int | None = None) -> str:
        return self.inner(x, pos).replace(".", self.decimal)

    def set_axis(self, axis: Any) -> None:
        super().set_axis(axis)
        self.inner.set_axis(axis)

    def set_locs(self, locs: Any) -> None:
        self.inner.set_locs(locs)

    def get_offset(self) -> str:
        return self.inner.get_offset()


def color_scale(colormap: str | Colormap, low: float, high: float) -> ScalarMappable:
    """Make a colour scale of values from `low` to `high`."""
    return ScalarMappable(Normalize(low, high), colormap)


def add_color_bar(
    figure: Figure, box: tuple[float, float, float, float], colors: ScalarMappable, label: str, extend: str = "neither"
) -> None:
    """Add a colour bar in `box` (left, bottom, width, height as shares of the figure), with its label above it.

    `extend` ("neither", "max", "both") says at which ends values beyond the scale were cut to it.
    """
    axes = figure.add_axes(box)
    bar = figure.colorbar(colors, cax=axes, extend=extend)
    bar.outline.set_linewidth(0.4)
    axes.set_title(label, fontsize=7, pad=6, loc="left")
    axes.tick_params(labelsize=6.5)


_CELLS = 110  # of a map along its longer side, at most


def paint_map(axes: Axes, positions: Array, values: Array, colors: ScalarMappable) -> None:
    """Paint the mean of `values` (N,) in each square cell of a grid; `positions` (N, 2) are to the right and up.

    Empty cells stay blank.
    """
    low, size = positions.min(axis=0), np.maximum(np.ptp(positions, axis=0), 1e-9)
    # few points: larger cells, about three points in each
    cell = float(size.max()) / min(_CELLS, max(8, int(np.sqrt(len(values) / 3))))
    shape = np.floor(size / cell).astype(int) + 1
    index = np.minimum(((positions - low) / cell).astype(int), shape - 1)
    flat = index[:, 1] * shape[0] + index[:, 0]
    known = np.isfinite(values)
    total = np.bincount(flat[known], weights=values[known], minlength=int(shape.prod()))
    number = np.bincount(flat[known], minlength=int(shape.prod()))
    mean = np.where(number > 0, total / np.maximum(number, 1), np.nan).reshape(shape[1], shape[0])
    extent = (low[0], low[0] + shape[0] * cell, low[1], low[1] + shape[1] * cell)
    norm = Normalize(*colors.get_clim())
    axes.imshow(mean, origin="lower", extent=extent, cmap=colors.cmap, norm=norm, interpolation="nearest")


def round_up(value: float) -> float:
    """Round a positive number up to 1, 1.5, 2, 2.5, 3, 4, 5, 6 or 8 times a power of ten; 1 for any other value."""
    if not np.isfinite(value) or value <= 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps = np.array([1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10]) * power
    return float(steps[np.argmax(steps >= value * (1 - 1e-9))])
