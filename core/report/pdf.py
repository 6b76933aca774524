"""The report put together: one to three pages, the same bytes for the same content."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import cv2
from matplotlib.figure import Figure
from reportlab.lib.pagesizes import A4, LETTER
from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import BaseDocTemplate, Frame, PageTemplate

from core.progress import Progress, Told, silent
from core.report import figures, plots
from core.report.content import ReportContent
from core.report.layout import Limits
from core.report.overlay_plot import overlay_figure
from core.report.run_chart import run_chart_figure
from core.report.sections import TITLE, story
from core.report.style import HAIRLINE, INK, MUTED, SANS, TEXT_WIDTH, color, prepare_reportlab
from core.report.template import Paper

MOST_PAGES = 3
"""Of one scan; repeats or long remarks may have one more."""
LONG_REMARKS = 1000
"""Characters of remarks beyond which they need room of their own."""

PAGE_SIZES: Mapping[Paper, tuple[float, float]] = {"A4": A4, "Letter": LETTER}
FOOT = 16 * mm
HEAD = 15 * mm

LIMITS = (
    Limits(inputs=150, reasons=10, names=6, notes=12, settings=30, repeats=60, picture_scale=1.0),
    Limits(inputs=96, reasons=8, names=6, notes=10, settings=20, repeats=40, picture_scale=1.0),
    Limits(inputs=72, reasons=6, names=6, notes=8, settings=16, repeats=30, picture_scale=1.0),
    Limits(inputs=60, reasons=6, names=5, notes=8, settings=14, repeats=25, picture_scale=1.0),
    Limits(inputs=48, reasons=5, names=4, notes=6, settings=14, repeats=20, picture_scale=0.92),
    Limits(inputs=30, reasons=3, names=2, notes=5, settings=10, repeats=15, picture_scale=0.84),
    Limits(inputs=9, reasons=2, names=1, notes=4, settings=6, repeats=10, picture_scale=0.72),
    Limits(inputs=3, reasons=1, names=1, notes=2, settings=4, repeats=10, picture_scale=0.72),
)
"""Tried in this order until the report has no more pages than it may."""

SURFACE_MM, OVERLAY_MM, FACES_MM, CLOUD_MM, CHART_MM = 104.0, 116.0, 50.0, 58.0, 42.0
"""Heights of the pictures at scale 1."""


def build_report(content: ReportContent, progress: Progress = silent) -> bytes:
    """The report as the bytes of a PDF; nothing is written to disk.

    The same content gives the same bytes: no clock and no random number is in it. Text is selectable and the fonts
    are embedded (except East Asian ones, which the viewer brings).

    Raises
    ------
    core.errors.Cancelled
        If `progress` asks to stop.
    """
    prepare_reportlab()
    progress = told = Told(progress)
    step, drawings = "report", _drawings(content, told.again)
    total = len(drawings) + 2
    pictures = {}
    for done, (name, draw) in enumerate(drawings.items()):
        progress(step, done, total)
        figure = draw()
        progress(step, done, total)
        pictures[name] = _image(figure, photo=name == "frame")
    progress(step, total - 2, total)
    most_pages = MOST_PAGES + (len(content.repeats) > 0 or len(content.remarks) > LONG_REMARKS)
    shorter = _page_room(content.paper) / _page_room("A4")
    for step_limits in LIMITS:
        progress(step, total - 2, total)
        limits = replace(step_limits, picture_scale=step_limits.picture_scale * shorter)
        pages, _ = _typeset(content, pictures, limits, 0)
        if pages <= most_pages:
            break
    progress(step, total - 1, total)
    _, data = _typeset(content, pictures, limits, pages)
    progress(step, total, total)
    return data


def _page_room(paper: Paper) -> float:
    """Height for text on one page, in points."""
    return float(PAGE_SIZES[paper][1] - HEAD - FOOT)


def _drawings(content: ReportContent, progress: Progress) -> dict[str, Callable[[], Figure]]:
    """What is to be drawn, by name."""
    width = TEXT_WIDTH / mm
    gauge, overlay = content.gauge, content.overlay
    drawings: dict[str, Callable[[], Figure]] = {}
    if len(content.cloud) or len(content.mesh.triangles):
        plane = gauge.lower.plane if gauge else None
        drawings["surface"] = lambda: plots.surface_figure(
            content.mesh, content.cloud, plane, width, SURFACE_MM, progress
        )
    if overlay is not None:
        drawings["frame"] = lambda: overlay_figure(overlay, width, OVERLAY_MM)
    if gauge is not None:
        drawings["maps"] = lambda: plots.residual_figure(gauge, content.cloud, width, FACES_MM)
    elif len(content.cloud):
        size = content.camera.camera.image_size
        drawings["maps"] = lambda: plots.cloud_figure(content.cloud, size, width, CLOUD_MM)
    if len(content.repeats) > 1:
        tolerance = gauge.tolerance_mm if gauge else None
        drawings["repeats"] = lambda: run_chart_figure(content.repeats, content.nominal_mm, tolerance, width, CHART_MM)
    return {name: draw for name, draw in drawings.items() if name not in content.hidden}


def _image(figure: Figure, *, photo: bool) -> ImageReader:
    """A drawn figure, compressed without loss, or as JPEG with full colour resolution where it holds a photograph."""
    bgr = figures.pixels(figure)[:, :, ::-1]
    if photo:
        how = [cv2.IMWRITE_JPEG_QUALITY, 93, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444]
        _, data = cv2.imencode(".jpg", bgr, how)
    else:
        _, data = cv2.imencode(".png", bgr)
    return ImageReader(io.BytesIO(data.tobytes()))


def _typeset(
    content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits, pages: int
) -> tuple[int, bytes]:
    """Lay everything out; gives the number of pages and the file. `pages` is what the foot of each page says."""
    stream = io.BytesIO()
    page = PAGE_SIZES[content.paper]
    margin = (page[0] - TEXT_WIDTH) / 2
    document = BaseDocTemplate(
        stream,
        pagesize=page,
        title=f"{TITLE} {content.report_id}",
        author=", ".join(name for name in (content.laboratory, content.operator) if name) or "not named",
        subject=_subject(content),
        creator=f"Trisect {content.version}",
        keywords="",
        invariant=1,
        initialFontName=SANS,
        lang="en",
    )
    frame = Frame(
        margin,
        FOOT,
        TEXT_WIDTH,
        _page_room(content.paper),
        leftPadding=0,
        rightPadding=0,
        topPadding=0,
        bottomPadding=0,
    )

    def on_page(canvas: Any, _: BaseDocTemplate) -> None:
        # the file's own date is the measurement's, not that of a clock
        canvas.setDateFormatter(lambda *_: f"{content.timestamp:D:%Y%m%d%H%M%S}{_pdf_zone(content)}")
        _foot(canvas, content, pages, margin)

    document.addPageTemplates(PageTemplate("page", [frame], onPage=on_page))
    document.build(story(content, pictures, limits))
    return document.page, stream.getvalue()


def _subject(content: ReportContent) -> str:
    what = "Thickness" if content.gauge else "Point cloud"
    return f"{what} of {content.part}" if content.part else what


def _pdf_zone(content: ReportContent) -> str:
    """'+01'00'' as PDF dates have it; nothing for a time without a zone."""
    zone = f"{content.timestamp:%z}"
    return f"{zone[:3]}'{zone[3:5]}'" if zone else ""


def _foot(canvas: Any, content: ReportContent, pages: int, margin: float) -> None:
    """Rule, report id, software, page n of m."""
    canvas.saveState()
    canvas.setStrokeColor(color(HAIRLINE))
    canvas.setLineWidth(0.5)
    canvas.line(margin, 12.5 * mm, margin + TEXT_WIDTH, 12.5 * mm)
    canvas.setFillColor(color(MUTED))
    canvas.setFont(SANS, 7)
    canvas.drawString(margin, 8.8 * mm, f"{TITLE} {content.report_id}")
    canvas.drawCentredString(margin + TEXT_WIDTH / 2, 8.8 * mm, f"Trisect {content.version}")
    canvas.setFillColor(color(INK))
    canvas.drawRightString(margin + TEXT_WIDTH, 8.8 * mm, f"page {canvas.getPageNumber()} of {pages}")
    canvas.restoreState()
