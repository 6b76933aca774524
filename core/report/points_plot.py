"""Where in the picture the points lie that each result rests on."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from core.report.figures import drawable, families, new_figure, plot_style
from core.report.look import Look
from core.report.style import HAIRLINE
from core.scan.cloud import Cloud

COLORS = ("#14586E", "#E06C00", "#6A3D9A", "#8A6D00", "#B2182B", "#3B7A3B", "#1B9E9E", "#737373")
MARKS = ("s", "o", "^", "D", "v", "P", "X", "*")
"""Told apart by form as well as by colour, in the legend."""

MOST_DRAWN = 4000
"""Points drawn of each: more would only cover each other."""


def points_figure(
    look: Look,
    cloud: Cloud,
    points: Mapping[str, NDArray[np.int64]],
    image_size: tuple[int, int],
    width_mm: float,
    height_mm: float,
) -> Figure:
    """The pixels of all points in grey, those of each of `points` (indices into the cloud) in a colour of its own."""
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
            count = look.words.count(len(indices), "point")
            axes.plot([], [], mark, ms=4, color=color, label=f"{_short(drawable(name))}\n{count}")
        axes.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5))
        axes.set_xlabel("u, px", labelpad=1)
        axes.set_ylabel("v, px", labelpad=0)
        axes.set_aspect("equal")
        axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.02), frameon=False, handletextpad=0.6,
                    prop={"family": families("".join(points)), "size": 6.5})  # fmt: skip
    return figure


def _short(name: str) -> str:
    """A name that fits beside the picture."""
    return name if len(name) <= 34 else f"{name[:33]}…"
