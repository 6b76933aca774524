"""Sheets of a carrier to print: coded rings for both sides of a plate, to scale, and what to do with them."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas

from core.image.targets.coded_rings import CODE_FROM, CODE_TO, SECTORS, code_of
from core.messages import label
from core.model.arrays import Array
from core.report.layout.style import MUTED, SANS, color, prepare_reportlab
from core.report.target_sheet import CLEAR_MM, EDGE_MM, FOOT_MM, LOOK, PAPER_MM, SIDE_MM, SheetPaper, draw_rulers
from core.views.carrier import Carrier
from core.views.layout import printed_carrier

MARKS, DISC_MM, THICK_MM = 12, 4.0, 4.0
"""Rings on each side, radius of their discs, and thickness of the plate between the sheets."""
SIDES = ("A", "B")
_ARC_STEPS = 6
"""Straight pieces along the arc of a sector: off the circle by less than 0.01 mm."""

TITLE = label("Carrier, side {side}, on {paper}")
STEPS = label(
    "Print both sheets at 100 %, and measure the rulers: each must be 100.0 mm long. Glue them on both sides of a "
    "stiff plate of 4 mm, edge to edge with the rulers together, and cut out a window for the part. Then have "
    "the marks measured: until then they are uncertain by what printing and gluing leave."
)


def carrier_on(paper: SheetPaper) -> Carrier:
    """Make the carrier, as printed, that `paper` laid across has room for."""
    short, long = PAPER_MM[paper]
    width, height = long - 2 * (EDGE_MM + SIDE_MM + CLEAR_MM), short - 2 * EDGE_MM - FOOT_MM - CLEAR_MM
    return printed_carrier(MARKS, (width / 2, height / 2), DISC_MM, THICK_MM)


def carrier_sheets(carrier: Carrier, paper: SheetPaper) -> bytes:
    """Draw the rings of both sides of a carrier to scale, a page each, and return the bytes of the PDF."""
    prepare_reportlab()
    short, long = PAPER_MM[paper]
    stream = io.BytesIO()
    canvas = Canvas(stream, pagesize=(long * mm, short * mm), invariant=1, initialFontName=SANS)
    canvas.setTitle(LOOK.words(TITLE).format(side="A, B", paper=paper))
    canvas.setCreator("Trisect")
    canvas.setViewerPreference("PrintScaling", "None")
    middle = np.array([long / 2, (short + FOOT_MM) / 2])
    for side, name in enumerate(SIDES):
        mine = carrier.on(side)
        seen = np.array([1.0 if side == 0 else -1.0, 1.0])  # from side B, x runs to the left
        path = canvas.beginPath()
        for number, place in zip(carrier.numbers[mine], carrier.positions[mine, :2] * seen + middle, strict=True):
            path.circle(place[0] * mm, place[1] * mm, carrier.radius_mm * mm)
            _add_code(path, int(number), place, carrier.radius_mm)
        canvas.setFillGray(0)
        canvas.drawPath(path, stroke=0, fill=1)
        draw_rulers(canvas)
        _draw_words(canvas, name, paper, long)
        canvas.showPage()
    canvas.save()
    return stream.getvalue()


def _add_code(path: Any, number: int, place: Array, radius_mm: float) -> None:
    """The dark sectors of a code ring; they run clockwise on paper, as a mark's y runs down."""
    for sector in np.flatnonzero(code_of(number)):
        angle = -2 * np.pi * (sector + np.linspace(0.0, 1.0, _ARC_STEPS + 1)) / SECTORS
        circle = np.column_stack([np.cos(angle), np.sin(angle)]) * radius_mm
        outline = place + np.concatenate([CODE_FROM * circle, CODE_TO * circle[::-1]])
        path.moveTo(*(outline[0] * mm))
        for corner in outline[1:]:
            path.lineTo(*(corner * mm))
        path.close()


def _draw_words(canvas: Any, side: str, paper: SheetPaper, width_mm: float) -> None:
    left, room, top = (EDGE_MM + SIDE_MM) * mm, (width_mm - 2 * EDGE_MM - SIDE_MM) * mm, (EDGE_MM + FOOT_MM - 12.5) * mm
    canvas.setFillColor(color(MUTED))
    head = LOOK.text(LOOK.words(TITLE).format(side=side, paper=paper), "strong")
    for paragraph in (head, LOOK.fixed_text(STEPS, "small")):
        _, height = paragraph.wrap(room, top)
        top -= height
        paragraph.drawOn(canvas, left, top)
