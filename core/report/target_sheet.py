"""A target to print: to scale, on one sheet, with rulers that show whether the printer kept the scale."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import cv2
import numpy as np
from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas

from core.errors import InputError
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Rectangle, Target
from core.image.targets.charuco import dictionary_of
from core.messages import Message, capital, label
from core.model.arrays import Array, frozen_array, set_field
from core.report.layout.style import ACCENT, INK, MUTED, SANS, ReportLook, color, prepare_reportlab
from core.report.wording import ENGLISH, target_in_words

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

RULER_MM = 100.0  # printed beside the target, to check the printer's scale by
SIDE_MM, FOOT_MM = 8.0, 26.0
"""Room for the ruler at the left, and for the one below together with the words."""

CLEAR_MM = 5.0
"""White around the target."""

MOST_TITLE = 80
"""Longest title that leaves the words on their lines, in characters."""

HOW_TO_PRINT = label(
    "Print at 100 %, without fitting to the page, then measure both rulers: each must be 100.0 mm long. "
    "Glue the sheet flat on a stiff plate."
)
LOOK = ReportLook(ENGLISH, ACCENT)
"""Of every sheet: its words are English."""


@dataclass(frozen=True, slots=True)
class SheetLayout:
    """Layout of a target on its sheet: sizes of the sheet, and the target's upper left corner from the sheet's, mm."""

    width_mm: float
    height_mm: float
    left_mm: float
    top_mm: float


def target_sheet(target: Target, paper: SheetPaper = "A4", *, title: str = "") -> bytes:
    """Draw a calibration target to scale on one page, upright or across, and return the bytes of the PDF.

    Everything is drawn as lines and areas, so the target is as true as the printer. The same target gives the same
    bytes. `title` is a name of the user's to print with it.

    Raises
    ------
    InputError
        If the target does not fit the paper, or its dictionary has too few markers.
    """
    prepare_reportlab()
    layout = sheet_layout(target, paper)
    stream = io.BytesIO()
    canvas = Canvas(stream, pagesize=(layout.width_mm * mm, layout.height_mm * mm), invariant=1, initialFontName=SANS)
    canvas.setTitle(title or target_in_words(target))
    canvas.setCreator("Trisect")
    canvas.setViewerPreference("PrintScaling", "None")
    draw_target(canvas, target, paper, title=title)
    canvas.showPage()
    canvas.save()
    return stream.getvalue()


def draw_target(canvas: Any, target: Target, paper: SheetPaper, *, title: str = "") -> None:
    """Draw a target on a page of reportlab's `canvas`, with rulers and words; InputError if it does not fit `paper`."""
    layout = sheet_layout(target, paper)
    _draw_art(canvas, target_art(target), layout)
    draw_rulers(canvas)
    _draw_words(canvas, target, paper, layout, title)


def sheet_layout(target: Target, paper: SheetPaper) -> SheetLayout:
    """Compute where `target` lies on `paper`: in the middle, or as near to it as the rulers leave room.

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
    next_paper = (alike or larger or [paper])[0]
    larger_paper = Message("target.advice_larger_paper", "print it on {paper}", paper=next_paper)
    smaller = _smaller(target, most, paper)
    both = Message("target.advice_paper_or_size", "{first}, or {second}", first=larger_paper, second=smaller)
    (width, height), (across, down) = rooms(paper)
    raise InputError(
        Message(
            "target.too_large_for_paper",
            "the target is {width_mm:.4g} × {height_mm:.4g} mm, and {paper} has room for {room_width_mm:.0f} × "
            "{room_height_mm:.0f} mm or {across_width_mm:.0f} × {across_height_mm:.0f} mm",
            width_mm=art.width_mm,
            height_mm=art.height_mm,
            paper=paper,
            room_width_mm=width,
            room_height_mm=height,
            across_width_mm=across,
            across_height_mm=down,
        ),
        todo=(both if larger else smaller) if most > 0 else (larger_paper if larger else ""),
    )


def _sheets(paper: SheetPaper) -> tuple[tuple[float, float], tuple[float, float]]:
    """The sheet upright and across: width and height."""
    short, long = PAPER_MM[paper]
    return (short, long), (long, short)


def rooms(paper: SheetPaper) -> list[tuple[float, float]]:
    """List width and height in mm that `paper` has for a target, upright and across."""
    beside, above = 2 * EDGE_MM + SIDE_MM + 2 * CLEAR_MM, 2 * EDGE_MM + FOOT_MM + 2 * CLEAR_MM
    return [(width - beside, height - above) for width, height in _sheets(paper)]


def _layout(art: TargetArt, paper: SheetPaper) -> SheetLayout | None:
    """None where the target does not fit; across only where that leaves more white or is the only way."""
    fitting = []
    for (width, height), (room_x, room_y) in zip(_sheets(paper), rooms(paper), strict=True):
        spare = min(room_x - art.width_mm, room_y - art.height_mm)
        if spare >= -1e-9:
            left = max((width - art.width_mm) / 2, EDGE_MM + SIDE_MM + CLEAR_MM)
            top = min((height - art.height_mm) / 2, height - EDGE_MM - FOOT_MM - CLEAR_MM - art.height_mm)
            fitting.append((spare, SheetLayout(width, height, left, top)))
    return max(fitting, key=lambda one: one[0])[1] if fitting else None


def _largest_length(target: Target, art: TargetArt, paper: SheetPaper) -> float:
    """The square, pitch or side with which the target would fit the paper, in tenths of a mm; 0 for none."""
    scale = max(min(x / art.width_mm, y / art.height_mm) for x, y in rooms(paper))
    return math.floor(10 * scale * _length(target) + 1e-9) / 10


def _length(target: Target) -> float:
    if isinstance(target, CircleGrid):
        return target.pitch_mm
    if isinstance(target, Rectangle):
        return target.width_mm
    return target.side_mm if isinstance(target, BlackSquare) else target.square_mm


def _smaller(target: Target, most_mm: float, paper: SheetPaper) -> Message:
    """Advice to make the target smaller, by the length that the user states of it."""
    values = {"most_mm": most_mm, "paper": paper}
    if isinstance(target, CircleGrid):
        return Message("target.advice_smaller_pitch", "make its pitch at most {most_mm:g} mm for {paper}", **values)
    if isinstance(target, BlackSquare):
        return Message("target.advice_smaller_side", "make its side at most {most_mm:g} mm for {paper}", **values)
    if isinstance(target, Rectangle):
        return Message("target.advice_smaller_width", "make its width at most {most_mm:g} mm for {paper}", **values)
    return Message("target.advice_smaller_squares", "make its squares at most {most_mm:g} mm for {paper}", **values)


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


def draw_rulers(canvas: Any) -> None:
    """Draw rulers along the lower and the left edge, ticks every 10 mm, from the middle of a tick to the other's."""
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
    parts = [capital(target_in_words(target))]
    parts += [target.dictionary_id] if isinstance(target, Charuco) else []
    name = f"{title[:MOST_TITLE]} · " if title else ""
    head = LOOK.text(f"{name}{', '.join(parts)}, on {paper}", "strong")
    top = (EDGE_MM + FOOT_MM - 12.5) * mm
    for paragraph in (head, LOOK.fixed_text(HOW_TO_PRINT, "small")):
        _, height = paragraph.wrap(width, top)
        top -= height
        paragraph.drawOn(canvas, left, top)


@dataclass(frozen=True, eq=False, slots=True)
class TargetArt:
    """Black areas of a target, in mm from its upper left corner, x to the right and y down.

    Parameters
    ----------
    width_mm, height_mm
        The smallest upright rectangle around everything black.
    rectangles
        (N, 4) left, top, width, height; they may touch, and do not overlap.
    discs
        (M, 3) centre x, centre y, radius.
    """

    width_mm: float
    height_mm: float
    rectangles: Array
    discs: Array

    def __post_init__(self) -> None:
        set_field(self, "rectangles", frozen_array(self.rectangles, (None, 4), "rectangles"))
        set_field(self, "discs", frozen_array(self.discs, (None, 3), "discs"))


def target_art(target: Target) -> TargetArt:
    """Compute the black areas of a calibration target in mm, at its true size.

    Raises
    ------
    InputError
        If a ChArUco board needs more markers than its dictionary has.
    """
    match target:
        case Checkerboard():
            columns, rows = target.columns + 1, target.rows + 1
            return _of_rectangles(_black_squares(columns, rows, target.square_mm), columns, rows, target.square_mm)
        case Charuco():
            return _charuco(target)
        case CircleGrid():
            return _circle_grid(target)
        case BlackSquare():
            return _of_rectangles(np.array([[0.0, 0.0, target.side_mm, target.side_mm]]), 1, 1, target.side_mm)
        case Rectangle():
            return _rectangle(target)


def _of_rectangles(rectangles: Array, columns: int, rows: int, square: float) -> TargetArt:
    return TargetArt(columns * square, rows * square, rectangles, np.zeros((0, 3)))


def _black_squares(columns: int, rows: int, square: float) -> Array:
    """Every second square, the first one black, as rectangles (N, 4)."""
    row, column = np.nonzero(np.add.outer(np.arange(rows), np.arange(columns)) % 2 == 0)
    side = np.full(len(row), square)
    return np.column_stack([column * square, row * square, side, side])


def _rectangle(rectangle: Rectangle) -> TargetArt:
    """Dark throughout, or four bars that leave the inside white."""
    width, height, line = rectangle.width_mm, rectangle.height_mm, rectangle.line_mm
    beside = height - 2 * line
    bars = [[0, 0, width, line], [0, height - line, width, line], [0, line, line, beside]]
    bars += [[width - line, line, line, beside]]
    return TargetArt(width, height, np.array(bars if line else [[0.0, 0.0, width, height]], float), np.zeros((0, 3)))


def _charuco(board: Charuco) -> TargetArt:
    """OpenCV's pattern since 4.6: the first square black, markers numbered row by row in the white ones."""
    dictionary = dictionary_of(board)
    square, marker = board.square_mm, board.marker_mm
    row, column = np.nonzero(np.add.outer(np.arange(board.rows), np.arange(board.columns)) % 2 == 1)
    cells = dictionary.markerSize + 2  # with the black rim
    cell, rim = marker / cells, (square - marker) / 2
    rectangles = [_black_squares(board.columns, board.rows, square)]
    for number, (j, i) in enumerate(zip(row, column, strict=True), board.first_id):
        black = cv2.aruco.generateImageMarker(dictionary, number, cells) < 128
        y, x = np.nonzero(black)
        side = np.full(len(x), cell)
        rectangles.append(np.column_stack([i * square + rim + x * cell, j * square + rim + y * cell, side, side]))
    return _of_rectangles(np.concatenate(rectangles), board.columns, board.rows, square)


def _circle_grid(grid: CircleGrid) -> TargetArt:
    """Discs half as wide as they are apart."""
    centres = grid.points[:, :2]
    nearest = float(np.sort(np.linalg.norm(centres - centres[0], axis=1))[1])
    radius = nearest / 4
    width, height = np.ptp(centres, axis=0) + 2 * radius
    discs = np.column_stack([centres + radius, np.full(len(centres), radius)])
    return TargetArt(float(width), float(height), np.zeros((0, 4)), discs)
