"""A target to print: to scale, on one sheet, with rulers that show whether the printer kept the scale."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas

from core.errors import InputError
from core.image.targets import BlackSquare, Charuco, CircleGrid, Target
from core.report.style import INK, MUTED, SANS, color, prepare_reportlab, text
from core.report.target_art import TargetArt, target_art
from core.report.wording import target_in_words

SheetPaper: TypeAlias = Literal["A4", "A3", "A2", "Letter", "Tabloid"]
"""What a target can be printed on."""

PAPER_MM: Mapping[SheetPaper, tuple[float, float]] = {
    "Letter": (215.9, 279.4),
    "A4": (210.0, 297.0),
    "Tabloid": (279.4, 431.8),
    "A3": (297.0, 420.0),
    "A2": (420.0, 594.0),
}
"""Short and long side in mm, the smallest paper first."""

EDGE_MM = 6.0
"""What printers leave white at the edges of a sheet."""

RULER_MM = 100.0
SIDE_MM, FOOT_MM = 8.0, 26.0
"""Room for the ruler at the left, and for the one below together with the words."""

CLEAR_MM = 5.0
"""White around the target."""

MOST_TITLE = 80
"""Longest title that leaves the words on their lines, in characters."""

HOW_TO_PRINT = (
    "Print at 100 %, without fitting to the page, then measure both rulers: each must be 100.0 mm long. "
    "Glue the sheet flat on a stiff plate."
)


@dataclass(frozen=True, slots=True)
class SheetLayout:
    """Where a target lies on its sheet: sizes of the sheet, and the target's upper left corner from the sheet's, mm."""

    width_mm: float
    height_mm: float
    left_mm: float
    top_mm: float


def target_sheet(target: Target, paper: SheetPaper = "A4", *, title: str = "") -> bytes:
    """One page with `target` to scale, as the bytes of a PDF; upright or across, as it fits better.

    Everything is drawn as lines and areas, so the target is as true as the printer. The same target gives the same
    bytes. `title` is a name of the user's to print with it.

    Raises
    ------
    InputError
        If the target does not fit the paper, or its dictionary has too few markers.
    """
    prepare_reportlab()
    art = target_art(target)
    layout = sheet_layout(target, paper)
    stream = io.BytesIO()
    canvas = Canvas(stream, pagesize=(layout.width_mm * mm, layout.height_mm * mm), invariant=1, initialFontName=SANS)
    canvas.setTitle(title or target_in_words(target))
    canvas.setCreator("Trisect")
    canvas.setViewerPreference("PrintScaling", "None")
    _draw_art(canvas, art, layout)
    _draw_rulers(canvas)
    _draw_words(canvas, target, paper, layout, title)
    canvas.showPage()
    canvas.save()
    return stream.getvalue()


def sheet_layout(target: Target, paper: SheetPaper) -> SheetLayout:
    """Where `target` lies on `paper`: in the middle of the sheet, or as near to it as the rulers leave room.

    Raises
    ------
    InputError
        If it does not fit.
    """
    art = target_art(target)
    layout = _layout(art, paper)
    if layout is not None:
        return layout
    larger = [name for name in PAPER_MM if _layout(art, name)]
    alike = [name for name in larger if name.startswith("A") == paper.startswith("A")]
    most = _largest_length(target, art, paper)
    advice = [f"print it on {(alike or larger)[0]}"] if larger else []
    if most > 0:
        advice.append(f"make {_length_name(target)} at most {most:g} mm for {paper}")
    room = " or ".join(f"{width:.0f} × {height:.0f} mm" for width, height in _rooms(paper))
    raise InputError(
        f"the target is {art.width_mm:.4g} × {art.height_mm:.4g} mm, and {paper} has room for {room}",
        todo=", or ".join(advice) if advice else "",
    )


def _sheets(paper: SheetPaper) -> tuple[tuple[float, float], tuple[float, float]]:
    """The sheet upright and across: width and height."""
    short, long = PAPER_MM[paper]
    return (short, long), (long, short)


def _rooms(paper: SheetPaper) -> list[tuple[float, float]]:
    """Width and height there is for a target, upright and across."""
    beside, above = 2 * EDGE_MM + SIDE_MM + 2 * CLEAR_MM, 2 * EDGE_MM + FOOT_MM + 2 * CLEAR_MM
    return [(width - beside, height - above) for width, height in _sheets(paper)]


def _layout(art: TargetArt, paper: SheetPaper) -> SheetLayout | None:
    """None where the target does not fit; across only where that leaves more white or is the only way."""
    fitting = []
    for (width, height), (room_x, room_y) in zip(_sheets(paper), _rooms(paper), strict=True):
        spare = min(room_x - art.width_mm, room_y - art.height_mm)
        if spare >= -1e-9:
            left = max((width - art.width_mm) / 2, EDGE_MM + SIDE_MM + CLEAR_MM)
            top = min((height - art.height_mm) / 2, height - EDGE_MM - FOOT_MM - CLEAR_MM - art.height_mm)
            fitting.append((spare, SheetLayout(width, height, left, top)))
    return max(fitting, key=lambda one: one[0])[1] if fitting else None


def _largest_length(target: Target, art: TargetArt, paper: SheetPaper) -> float:
    """The square, pitch or side with which the target would fit the paper, in tenths of a mm; 0 for none."""
    scale = max(min(x / art.width_mm, y / art.height_mm) for x, y in _rooms(paper))
    return math.floor(10 * scale * _length(target) + 1e-9) / 10


def _length(target: Target) -> float:
    if isinstance(target, CircleGrid):
        return target.pitch_mm
    return target.side_mm if isinstance(target, BlackSquare) else target.square_mm


def _length_name(target: Target) -> str:
    if isinstance(target, CircleGrid):
        return "its pitch"
    return "its side" if isinstance(target, BlackSquare) else "its squares"


def _draw_art(canvas: Any, art: TargetArt, layout: SheetLayout) -> None:
    """All of the black as one path: so no viewer draws seams between areas that touch."""
    path = canvas.beginPath()
    for x, y, width, height in art.rectangles:
        bottom = layout.height_mm - layout.top_mm - y - height
        path.rect((layout.left_mm + x) * mm, bottom * mm, width * mm, height * mm)
    for x, y, radius in art.discs:
        path.circle((layout.left_mm + x) * mm, (layout.height_mm - layout.top_mm - y) * mm, radius * mm)
    canvas.setFillGray(0)
    canvas.drawPath(path, stroke=0, fill=1)


def _draw_rulers(canvas: Any) -> None:
    """One along the lower and one along the left edge, ticks every 10 mm, from the middle of a tick to the other's."""
    canvas.saveState()
    canvas.setLineWidth(0.15 * mm)
    canvas.setStrokeColor(color(INK))
    canvas.setFillColor(color(MUTED))
    canvas.setFont(SANS, 6)
    start_x, start_y = EDGE_MM + SIDE_MM, EDGE_MM + FOOT_MM
    for turned in (False, True):
        canvas.saveState()
        canvas.translate((EDGE_MM if turned else start_x) * mm, (start_y if turned else start_y - 8) * mm)
        if turned:
            canvas.rotate(90)
            canvas.scale(1, -1)  # ticks and words to the right of it
        canvas.line(0, 0, RULER_MM * mm, 0)
        for tick in range(0, int(RULER_MM) + 1, 10):
            canvas.line(tick * mm, 0, tick * mm, (2.6 if tick % 50 == 0 else 1.6) * mm)
        canvas.restoreState()
    for tick in (0, 50, 100):
        words = f"{tick} mm" if tick == 100 else f"{tick}"
        canvas.drawCentredString((start_x + tick) * mm, (start_y - 11) * mm, words)
        canvas.saveState()
        canvas.translate((EDGE_MM + 3.4) * mm, (start_y + tick) * mm)
        canvas.rotate(-90)
        canvas.drawCentredString(0, 0, words)
        canvas.restoreState()
    canvas.restoreState()


def _draw_words(canvas: Any, target: Target, paper: SheetPaper, layout: SheetLayout, title: str) -> None:
    """What it is and how to print it, below the ruler."""
    left, width = (EDGE_MM + SIDE_MM) * mm, (layout.width_mm - 2 * EDGE_MM - SIDE_MM) * mm
    parts = [f"{target_in_words(target)[:1].upper()}{target_in_words(target)[1:]}"]
    parts += [target.dictionary_id] if isinstance(target, Charuco) else []
    name = f"{title[:MOST_TITLE]} · " if title else ""
    head = text(f"{name}{', '.join(parts)}, on {paper}", "strong")
    top = (EDGE_MM + FOOT_MM - 12.5) * mm
    for paragraph in (head, text(HOW_TO_PRINT, "small")):
        _, height = paragraph.wrap(width, top)
        top -= height
        paragraph.drawOn(canvas, left, top)
