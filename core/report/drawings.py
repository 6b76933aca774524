"""The pictures of a report: what is to be drawn, and how a drawing becomes a picture on paper."""

from __future__ import annotations

import io
from collections.abc import Callable
from functools import partial

import cv2
from matplotlib.figure import Figure
from PIL import Image
from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader

from core.messages import Label
from core.progress import Progress
from core.report.content import ReportContent
from core.report.layout.style import TEXT_WIDTH, ReportLook
from core.report.plots import charts as plots
from core.report.plots import figures
from core.report.plots.charts import deviation_figure, points_figure
from core.report.plots.overlay_plot import overlay_figure
from core.report.plots.profile_plot import profiles_figure, section_figure
from core.report.plots.run_chart import repeats_figure

(
    SURFACE_MM,
    VIEW_MM,
    OVERLAY_MM,
    POINTS_MM,
    FACES_MM,
    CLOUD_MM,
    CHART_MM,
    DEVIATION_MM,
    PROFILES_MM,
    SECTION_MM,
) = (
    104.0,
    84.0,
    116.0,
    78.0,
    50.0,
    58.0,
    42.0,
    80.0,
    62.0,
    50.0,
)
"""Heights of the pictures at scale 1."""


def drawings(look: ReportLook, content: ReportContent, progress: Progress) -> dict[str, Callable[[], Figure]]:
    """Collect the functions that draw the report's figures, by the figure's name, for what `content` holds."""
    width = TEXT_WIDTH / mm
    gauge, overlay, size = content.gauge, content.overlay, content.camera.camera.image_size
    drawings: dict[str, Callable[[], Figure]] = {}
    if len(content.cloud) or len(content.mesh.triangles):
        plane = gauge.lower.plane if gauge else None
        drawings["surface"] = lambda: plots.surface_figure(
            look, content.mesh, content.cloud, plane, width, SURFACE_MM, plots.callouts(look, content), progress
        )
        if (view := content.view_shown) is not None:
            drawings["view"] = lambda: plots.view_figure(look, content, view, (width, VIEW_MM), progress)
    if overlay is not None:
        drawings["frame"] = lambda: overlay_figure(look, overlay, width, OVERLAY_MM)
    if (profiles := content.profiles) is not None:
        drawings["profiles"] = lambda: profiles_figure(look, profiles, width, PROFILES_MM)
    drawings |= {
        f"section-{number}": partial(section_figure, look, profile, width, SECTION_MM)
        for number, profile in enumerate(content.sections.values())
    }
    if content.points_used and len(content.cloud):
        used = content.points_used.items()
        named = {look.words(name) if isinstance(name, Label) else name: indices for name, indices in used}
        pairs = () if gauge is None else gauge.candidates
        drawings["points"] = lambda: points_figure(look, content.cloud, named, size, width, POINTS_MM, pairs)
    if gauge is not None:
        drawings["maps"] = lambda: plots.residual_figure(look, gauge, content.cloud, width, FACES_MM)
    elif len(content.cloud):
        drawings["maps"] = lambda: plots.cloud_figure(look, content.cloud, size, width, CLOUD_MM)
    if len(content.repeats) > 1:
        tolerance = gauge.tolerance_mm if gauge else None
        drawings["repeats"] = lambda: repeats_figure(
            look, content.repeats, content.nominal_mm, tolerance, width, CHART_MM
        )
    drawings |= {
        f"deviation-{number}": partial(deviation_figure, look, one, width, DEVIATION_MM)
        for number, one in enumerate(content.deviations)
        if len(one.deviation)
    }
    drawings |= {
        f"study-{number}": partial(study.figure, look, width)
        for number, study in enumerate(content.studies)
        if study.figure is not None
    }
    section_of = {"study": "studies", "section": "sections"}
    hidden = content.hidden
    return {
        name: draw
        for name, draw in drawings.items()
        if section_of.get(name.partition("-")[0], name.partition("-")[0]) not in hidden
    }


def image(figure: Figure, *, photo: bool, decimal: str) -> ImageReader:
    """Render a matplotlib figure for reportlab, as JPEG if `photo`, else lossless; `decimal` is the decimal sign."""
    rgb = figures.pixels(figure, decimal)
    if not photo:
        return ImageReader(Image.fromarray(rgb))
    how = [cv2.IMWRITE_JPEG_QUALITY, 93, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444]
    _, data = cv2.imencode(".jpg", rgb[:, :, ::-1], how)
    return ImageReader(io.BytesIO(data.tobytes()))
