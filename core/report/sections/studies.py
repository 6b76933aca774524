"""The section of studies: what is told of each, its run chart, and its notes."""

from __future__ import annotations

from collections.abc import Mapping

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, Spacer

from core.report.content import ReportContent
from core.report.layout.blocks import Heading, Limits, OnOnePage, Picture, fact_tables, figures, section
from core.report.layout.style import ReportLook


def studies(
    look: ReportLook, content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits
) -> list[Flowable]:
    """Make the section of each study, with its heading, facts, chart and notes."""
    parts: list[Flowable] = []
    for number, study in enumerate(content.studies):
        body: list[Flowable] = [
            Heading(look, f"study-{number}", study.title(look.words), "small_strong", 1),
            figures(look, study.facts),
            *fact_tables(look, study.tables),
        ]
        if f"study-{number}" in pictures:
            body += [Spacer(0, 2 * mm), Picture(pictures[f"study-{number}"], limits.picture_scale)]
        body += [*look.bullets(tuple(look.words(note) for note in study.notes)), Spacer(0, 2 * mm)]
        parts.append(OnOnePage(body) if number else section(look, "studies", "Studies", body))
    return parts
