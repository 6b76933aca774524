"""The σ map of a planned rig as a picture: own, common and total σ of the depth over the camera's picture."""

from __future__ import annotations

import io

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.image import imsave

from core.messages import label
from core.model.arrays import Array
from core.report.plots.charts import SIGMA_MAP
from core.report.plots.figures import NO_DATA, add_color_bar, color_scale, new_figure, pixels, plot_style

WIDTH_MM, HEIGHT_MM = 184.0, 56.0  # on paper
_PANEL_MM, _GAP_MM = 46.0, 9.0  # a panel's side, and between two


def plan_map_png(own: Array, common: Array, image_size: tuple[int, int], title: str) -> bytes:
    """Draw maps of the own, common and total σ of depth, (rows, columns) in mm, in one scale, as a PNG file's bytes."""
    total = np.hypot(own, common)
    known = total[np.isfinite(total)]
    colors = color_scale(SIGMA_MAP, 0.0, max(float(np.quantile(known, 0.98)), 1e-6) if len(known) else 1.0)
    with plot_style():
        figure = new_figure(WIDTH_MM, HEIGHT_MM)
        figure.suptitle(title, x=11 / WIDTH_MM, ha="left", fontsize=8)
        for panel, (name, values) in enumerate(
            ((label("of each point"), own), (label("common to the scan"), common), (label("both together"), total))
        ):
            left = (11 + panel * (_PANEL_MM + _GAP_MM)) / WIDTH_MM
            axes = figure.add_axes((left, 9 / HEIGHT_MM, _PANEL_MM / WIDTH_MM, 1 - 21 / HEIGHT_MM))
            axes.set_title(name)
            axes.set_facecolor(NO_DATA)
            extent = (-0.5, image_size[0] - 0.5, image_size[1] - 0.5, -0.5)
            axes.imshow(
                values, extent=extent, cmap=colors.cmap, norm=Normalize(*colors.get_clim()), interpolation="nearest"
            )
            axes.set_xlabel("u, px", labelpad=1)
            if panel == 0:
                axes.set_ylabel("v, px", labelpad=0)
        box = ((WIDTH_MM - 14) / WIDTH_MM, 9 / HEIGHT_MM, 2.5 / WIDTH_MM, 1 - 21 / HEIGHT_MM)
        add_color_bar(figure, box, colors, "mm", "max")
    written = io.BytesIO()
    imsave(written, pixels(figure), format="png", metadata={"Software": ""})
    return written.getvalue()
