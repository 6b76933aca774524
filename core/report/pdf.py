"""The report put together: a few pages, the same bytes for the same content."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import BaseDocTemplate, Flowable, Frame, PageTemplate

from core.messages import capital
from core.progress import Progress, StepProgress, silent
from core.report.content import ReportContent
from core.report.drawings import drawings, image
from core.report.layout.blocks import LEAST_SCALE, Limits
from core.report.layout.paragraph import Paragraph
from core.report.layout.style import (
    HAIRLINE,
    INK,
    MUTED,
    PAGE_SIZES,
    SANS,
    TEXT_WIDTH,
    ReportLook,
    color,
    draw_words,
    font_note,
    markup,
    prepare_reportlab,
)
from core.report.plots.figures import new_figure
from core.report.sections.head import TITLE
from core.report.sections.standard import story
from core.report.template import Paper
from core.report.wording import Words, shown_name

MOST_PAGES = 5
"""Of one scan with one result, half a page of which says how to read it;
more results, repeats, studies or long remarks may have more."""
RESULTS_A_PAGE = 2
"""Results whose rows and budgets ask for one page more: no budget is to be left out for want of a page."""
LEAST_OF_A_PAGE = 0.3
"""What is on the last page, unless smaller pictures do without it."""
SMALLER = (0.94, 0.88, 0.82, 0.76)
"""Scales of pictures that are tried to save a page."""
LONG_REMARKS = 1000
"""Characters of remarks beyond which they need room of their own."""

FOOT = 16 * mm  # of the page, for its number and the report's name
LONGEST_FOOTER = 160
"""Characters of a company's line: what fits below the page's own."""
HEAD = 15 * mm  # of the page, above the text

LIMITS = (
    Limits(inputs=150, budgets=40, reasons=10, names=6, notes=12, settings=30, repeats=60, picture_scale=1.0),
    Limits(inputs=96, budgets=30, reasons=8, names=6, notes=10, settings=20, repeats=40, picture_scale=1.0),
    Limits(inputs=72, budgets=20, reasons=6, names=6, notes=8, settings=16, repeats=30, picture_scale=1.0),
    Limits(inputs=60, budgets=16, reasons=6, names=5, notes=8, settings=14, repeats=25, picture_scale=1.0),
    Limits(inputs=48, budgets=12, reasons=5, names=4, notes=6, settings=14, repeats=20, picture_scale=0.92),
    Limits(inputs=30, budgets=8, reasons=3, names=2, notes=5, settings=10, repeats=15, picture_scale=0.84),
    Limits(inputs=9, budgets=4, reasons=2, names=1, notes=4, settings=6, repeats=10, picture_scale=0.72),
    Limits(inputs=3, budgets=2, reasons=1, names=1, notes=2, settings=4, repeats=10, picture_scale=0.72),
)
"""Tried in this order until the report has no more pages than it may."""


def prepare() -> None:
    """Load the fonts and draw one small figure, so that the first report takes no longer than others."""
    prepare_reportlab()
    figure = new_figure(20, 20)
    figure.add_axes((0.2, 0.2, 0.7, 0.7)).set_title("1")
    image(figure, photo=False, decimal=".")


def build_report(content: ReportContent, progress: Progress = silent) -> bytes:
    """Lay out the report and return the bytes of its PDF; nothing is written to disk.

    The same content gives the same bytes: no clock and no random number is in it. Text is selectable and the fonts
    are embedded, and the file is PDF/A. Where this computer has no font for an East Asian text it is not, and a note
    says that the reader's program brings it.

    Raises
    ------
    core.errors.Cancelled
        If `progress` asks to stop.
    """
    from core.report.archival import archived  # its library is loaded by the first report

    prepare_reportlab()
    if note := font_note(_names(content)):
        content = replace(content, notes=(*content.notes, note))
    progress = told = StepProgress(progress)
    look = ReportLook(Words.of(content.language), content.template.accent)
    step, pending = "report", drawings(look, content, told.within_step)
    total = len(pending) + 2
    pictures = {}
    for done, (name, draw) in enumerate(pending.items()):
        progress(step, done, total)
        figure = draw()
        progress(step, done, total)
        pictures[name] = image(figure, photo=name == "frame", decimal=look.words.numeral("."))
    progress(step, total - 2, total)
    most_pages = _most_pages(content)
    shorter = _page_room(content.paper) / _page_room("A4")
    for step_limits in LIMITS:
        progress(step, total - 2, total)
        limits = replace(step_limits, picture_scale=step_limits.picture_scale * shorter)
        longest = None if step_limits is LIMITS[-1] else most_pages
        try:
            tried = _typeset(look, content, pictures, limits, most_pages, longest, trial=True)
        except _TooLongError:
            continue
        break
    if tried.last_page < LEAST_OF_A_PAGE and tried.pages > 1:
        limits, tried = _without_last_page(look, content, pictures, limits, tried)
    progress(step, total - 1, total)
    data = archived(_typeset(look, content, pictures, limits, tried.pages).data, content.attachments)
    progress(step, total, total)
    return data


def _without_last_page(
    look: ReportLook, content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits, tried: _Typeset
) -> tuple[Limits, _Typeset]:
    """The same with smaller pictures, where that saves a last page with hardly anything on it; else as it was."""
    for share in SMALLER:
        smaller = replace(limits, picture_scale=limits.picture_scale * share)
        if smaller.picture_scale < LEAST_SCALE:
            break
        try:
            return smaller, _typeset(look, content, pictures, smaller, tried.pages - 1, tried.pages - 1, trial=True)
        except _TooLongError:
            continue
    return limits, tried


def _names(content: ReportContent) -> Iterator[str]:
    """What people have called things, and what else may be in any script."""
    people, company = (content.laboratory, content.operator, content.customer), content.template
    yield from (content.part, content.serial, content.remarks, *people, *map(str, content.notes), *content.rig.values())
    yield from (company.name, company.text, company.footer, *company.address, *company.signatures)
    yield from (one.name for one in content.inspected)
    yield from (one.name for one in content.deviations)
    yield from (frame.name for frame in content.frames)
    yield from (*content.hashes, *content.points)
    for brought in (*content.brought, *content.below_results.values()):
        yield from (brought.title, *(str(text) for one in brought.facts for text in (one.label, one.value)))
    for study in content.studies:
        cells = (str(cell) for table in study.tables for row in table.rows for cell in row)
        yield from (study.title(), *map(str, study.notes), *cells)


def _most_pages(content: ReportContent) -> int:
    """Pages beyond which lists are shortened."""
    more = len(content.repeats) > 0 or len(content.remarks) > LONG_REMARKS
    results = (len(content.characteristics) - 1) / RESULTS_A_PAGE
    sections = len(content.studies) + len(content.deviations) + len(content.brought)
    return MOST_PAGES + more + max(0, math.ceil(results)) + sections


def _page_room(paper: Paper) -> float:
    """Height for text on one page, in points."""
    return float(PAGE_SIZES[paper][1] - HEAD - FOOT)


class _Trial(Canvas):  # type: ignore[misc]
    """A canvas of which no file is made: to learn how many pages there are."""

    def save(self) -> None:
        """Compress nothing."""


class _TrialFrame(Frame):  # type: ignore[misc]
    """Where everything comes to stand, without drawing any of it."""

    def _add(self, flowable: Flowable, canvas: Canvas, trySplit: int = 0) -> int:
        flowable._drawOn = _draw_nothing
        return int(super()._add(flowable, canvas, trySplit))

    add = _add


def _draw_nothing(_: Canvas) -> None:
    """Stand where it stands."""


class _Typeset(NamedTuple):
    """How many pages there are, how much of the last one is filled (0 … 1), and the file."""

    pages: int
    last_page: float
    data: bytes


class _TooLongError(Exception):
    """A report has begun a page more than it may have."""


def _typeset(
    look: ReportLook,
    content: ReportContent,
    pictures: Mapping[str, ImageReader],
    limits: Limits,
    pages: int,
    most_pages: int | None = None,
    *,
    trial: bool = False,
) -> _Typeset:
    """Lay everything out. `pages` is what the foot of each page says; of a `trial` nothing is drawn.

    Raises
    ------
    _TooLongError
        As soon as there are more than `most_pages`.
    """
    stream = io.BytesIO()
    page = PAGE_SIZES[content.paper]
    margin = (page[0] - TEXT_WIDTH) / 2
    laboratory = content.laboratory or content.template.name
    document = BaseDocTemplate(
        stream,
        pagesize=page,
        title=f"{look.words(TITLE)} {content.report_id}",
        author=", ".join(name for name in (laboratory, content.operator) if name) or look.words("not named"),
        subject=_subject(look, content),
        creator=f"Trisect {content.version}",
        keywords="",
        invariant=1,
        initialFontName=SANS,
        lang=content.language,
    )
    frame = (_TrialFrame if trial else Frame)(
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
        if most_pages is not None and canvas.getPageNumber() > most_pages:
            raise _TooLongError
        canvas.showOutline()
        # the file's own date is the measurement's, not that of a clock
        canvas.setDateFormatter(lambda *_: f"{content.timestamp:D:%Y%m%d%H%M%S}{_pdf_zone(content)}")
        _foot(canvas, look, content, pages, margin)

    document.addPageTemplates(PageTemplate("page", [frame], onPage=on_page))
    document.build(story(look, content, pictures, limits), canvasmaker=_Trial if trial else Canvas)
    filled = 1 - (document.frame._y - document.frame._y1p) / _page_room(content.paper)
    return _Typeset(document.page, filled, stream.getvalue())


def _subject(look: ReportLook, content: ReportContent) -> str:
    found = content.characteristics
    what = shown_name(found[0], look.words) if len(found) == 1 else look.words("Inspection" if found else "Point cloud")
    what = capital(what)
    return look.words("{what} of {part}", what=what, part=content.part) if content.part else what


def _pdf_zone(content: ReportContent) -> str:
    """'+01'00'' as PDF dates have it; nothing for a time without a zone."""
    zone = f"{content.timestamp:%z}"
    return f"{zone[:3]}'{zone[3:5]}'" if zone else ""


def _foot(canvas: Any, look: ReportLook, content: ReportContent, pages: int, margin: float) -> None:
    """Rule, report id, software, page n of m; the company's own line below."""
    words, footer = look.words, content.template.footer
    canvas.saveState()
    canvas.setStrokeColor(color(HAIRLINE))
    canvas.setLineWidth(0.5)
    canvas.line(margin, 12.5 * mm, margin + TEXT_WIDTH, 12.5 * mm)
    canvas.setFillColor(color(MUTED))
    foot = 8.8 * mm
    draw_words(canvas, (margin, foot), f"{words(TITLE)} {content.report_id}", SANS, 7)
    draw_words(canvas, (margin + TEXT_WIDTH / 2, foot), f"Trisect {content.version}", SANS, 7, share=0.5)
    canvas.setFillColor(color(INK))
    page = words("page {n} of {all}", n=canvas.getPageNumber(), all=pages)
    draw_words(canvas, (margin + TEXT_WIDTH, foot), page, SANS, 7, share=1.0)
    canvas.restoreState()
    if footer:
        line = Paragraph(markup(footer[:LONGEST_FOOTER]), look.style("footer"))
        _, height = line.wrap(TEXT_WIDTH, 8 * mm)
        line.drawOn(canvas, margin, 7.6 * mm - height)
