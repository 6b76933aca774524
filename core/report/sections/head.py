"""The head of page one: title, laboratory, what was measured for whom by whom, when, how and with what."""

from __future__ import annotations

import io

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, HRFlowable, Image, Spacer

from core.messages import label
from core.report.content import ReportContent
from core.report.layout.blocks import GAP, pairs_table, plain_table, side_by_side
from core.report.layout.style import TEXT_WIDTH, ReportLook
from core.report.sections.calibration_tables import age_words
from core.report.wording import short_hash, temperatures_line

TITLE = label("Measurement report")

LOGO = (46 * mm, 16 * mm)
"""Largest width and height of a logo."""

LABEL = 27 * mm  # width of the column of names


def head(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the head of page one: title, laboratory, part, customer, operator, time, and instrument."""
    template, column = content.template, (TEXT_WIDTH - GAP) / 2
    name = template.name or content.laboratory
    lines = [look.text(line, "laboratory") for line in (name, *template.address) if line]
    right: list[Flowable] = [*_logo(template.logo), *lines] or [look.text("", "laboratory")]
    top = plain_table([[look.fixed_text(TITLE, "title"), right]], [0.5 * TEXT_WIDTH] * 2)
    top.setStyle(
        [
            ("VALIGN", (0, 0), (-1, -1), "BOTTOM"),
            ("ALIGN", (1, 0), (1, 0), "RIGHT"),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 3),
        ]
    )
    rule = HRFlowable(width="100%", thickness=1.4, color=look.accent_color, spaceBefore=0, spaceAfter=4)
    columns = [
        pairs_table(look, {label: value for label, value in pairs.items() if value}, column, LABEL)
        for pairs in (_job(look, content), _evidence(look, content))
    ]
    return [top, rule, *_simulated(look, content), side_by_side([columns[0]], [columns[1]], TEXT_WIDTH)]


def _simulated(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """What has to be known first of a result that no real part has; nothing where the pictures are not known to be."""
    if not content.simulated:
        return []
    said = look.fixed_text(
        "Simulated: every picture was rendered by a program, and no real part was measured.", "small_strong"
    )
    return [said, Spacer(0, 1 * mm)]


def _job(look: ReportLook, content: ReportContent) -> dict[str, str]:
    """What was measured, for whom, by whom, under which conditions."""
    words = look.words
    return {
        words("Part"): content.part or look.words("not named"),
        words("Serial number"): content.serial,
        words("Customer"): content.customer,
        words("Laboratory"): content.laboratory if content.template.name else "",
        words("Operator"): content.operator,
        words("Temperatures"): temperatures_line(
            content.air_celsius, content.part_celsius, look.words, corrected=content.at_reference
        ),
        words("Sweeps located by"): look.words.known(content.method),
    }


def _evidence(look: ReportLook, content: ReportContent) -> dict[str, str]:
    """What names the report and all it rests on."""
    words = look.words
    marks = {
        mark.of: words("{id}, age {age}", id=mark.id, age=age_words(look, mark, content))
        for mark in content.calibrations
    }
    return {
        words("Report"): content.report_id,
        words("Measured"): f"{words.time(content.timestamp, seconds=True)} {content.timestamp:%Z}".strip(),
        words("Report made"): "" if content.reported is None else words.day(content.reported),
        words("Rig"): content.rig_id,
        words("Camera calibration"): marks.get("camera", ""),
        **({words("Laser planes"): marks.get("planes", "")} if content.has_fan else {}),
        words("Software"): f"Trisect {content.version}",
        words("Inputs, SHA-256"): short_hash(content.inputs_digest) if content.hashes else "",
    }


def _logo(data: bytes) -> list[Flowable]:
    """The logo as large as there is room, on the right."""
    if not data:
        return []
    columns, rows = ImageReader(io.BytesIO(data)).getSize()
    scale = min(LOGO[0] / columns, LOGO[1] / rows)
    return [Image(io.BytesIO(data), columns * scale, rows * scale, hAlign="RIGHT")]
