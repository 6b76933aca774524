"""Sheets of a corner to print: two boards to be glued up at an angle, and what to measure on them and state of them."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas

from core.image.targets import Charuco, Rectangle, Target
from core.messages import label
from core.report.layout.style import MUTED, SANS, color, prepare_reportlab
from core.report.target_sheet import (
    EDGE_MM,
    LOOK,
    PAPER_MM,
    SIDE_MM,
    SheetPaper,
    draw_target,
    rooms,
    sheet_layout,
    target_art,
)

CornerKind: TypeAlias = Literal["charuco", "rectangle"]
"""What the boards of a corner show: one is told from the other by its markers, or by where it is in the picture."""
BOARDS = ("floor", "wall")
"""What the two boards are called, in rig.toml as on their sheets."""
SQUARE_MM, MARKER_SHARE = 15.0, 0.75
"""Of the ChArUco boards."""
DICTIONARY = "DICT_4X4_250"
"""Its markers are the coarsest of which there are enough for both boards."""
LINE_MM = 6.0
"""Width of a rectangle's outline."""
ROUND_MM = 10.0
"""Sides of a rectangle are whole multiples of it, as they are to be measured with a ruler."""
MEASURE_MM = 4.4
"""Distance of the lines to measure from the print: nearer ones would be seen as its edges."""
_TICK_MM, _LINE_MM = 0.6, 0.1
"""Half a tick's length, and how thick these lines are: thin enough for a ruler."""

TITLE = label("A corner of two boards")
STEPS = (
    label("Print both sheets at 100 %, and measure the rulers on each: all must be 100.0 mm long."),
    label(
        "Glue each sheet flat on a stiff board that goes on at least 5 mm beyond what is printed: glass, dibond or MDF."
    ),
    label(
        "Join the boards at about 90° along their long sides, like an open book, so that they cannot move against each "
        "other. The angle need not be exact: it is seen in the pictures."
    ),
    label(
        "Measure the lines beside each print with a steel ruler or a calliper, from tick to tick. Where one is not as "
        "long as it says, change the sizes in rig.toml by the same share; state as scale_sd by what share you may be "
        "wrong: 0.1 mm in 200 mm is 5e-4."
    ),
    label(
        "Copy the tables below into rig.toml. Set the corner up behind the part so that the laser line crosses both "
        "boards in every frame. Take a picture of them there, lasers off, and save it under two names: "
        "scan/planes/floor.png and scan/planes/wall.png."
    ),
)
STEP_OF_RECTANGLES = label(
    "Both prints look the same, so say where each is: in its table, region_px = [[u, v], …], a polygon around the "
    "board in that picture, in pixels."
)


def corner_targets(kind: CornerKind, paper: SheetPaper) -> dict[str, Target]:
    """Make the targets of a corner's two boards, as large as `paper` has room for, by the boards' names."""
    width, height = max(rooms(paper), key=lambda room: room[0])  # across, as the boards are joined
    if kind == "rectangle":
        across, down = (ROUND_MM * int(side // ROUND_MM) for side in (width, height))
        return {name: Rectangle(across, down, LINE_MM) for name in BOARDS}
    columns, rows = (int(side // SQUARE_MM) for side in (width, height))
    markers = columns * rows // 2
    return {
        name: Charuco(columns, rows, SQUARE_MM, MARKER_SHARE * SQUARE_MM, DICTIONARY, number * markers)
        for number, name in enumerate(BOARDS)
    }


def corner_sheets(targets: Mapping[str, Target], paper: SheetPaper, tables: str) -> bytes:
    """Draw the sheets of a corner's boards to scale, a page each, and a page that says what to do; return the PDF.

    `tables` is the text of rig.toml that states the boards.

    Raises
    ------
    InputError
        If a target does not fit the paper.
    """
    prepare_reportlab()
    stream = io.BytesIO()
    canvas = Canvas(stream, invariant=1, initialFontName=SANS)
    canvas.setTitle(LOOK.words(TITLE))
    canvas.setCreator("Trisect")
    canvas.setViewerPreference("PrintScaling", "None")
    for name, target in targets.items():
        layout = sheet_layout(target, paper)
        canvas.setPageSize((layout.width_mm * mm, layout.height_mm * mm))
        draw_target(canvas, target, paper, title=name)
        _draw_lines(canvas, target, paper)
        canvas.showPage()
    alike = any(isinstance(target, Rectangle) for target in targets.values())
    _draw_steps(canvas, paper, tables, (STEP_OF_RECTANGLES,) if alike else ())
    canvas.showPage()
    canvas.save()
    return stream.getvalue()


def _draw_lines(canvas: Any, target: Target, paper: SheetPaper) -> None:
    """The lines to measure: above the print and at its right, with their lengths."""
    art, layout = target_art(target), sheet_layout(target, paper)
    left, top = layout.left_mm, layout.height_mm - layout.top_mm
    canvas.saveState()
    canvas.setLineWidth(_LINE_MM * mm)
    canvas.setStrokeColor(color(MUTED))
    canvas.setFillColor(color(MUTED))
    canvas.setFont(SANS, 6)
    for x, y, length, turn in (
        (left, top + MEASURE_MM, art.width_mm, 0),
        (left + art.width_mm + MEASURE_MM, top, art.height_mm, -90),
    ):
        canvas.saveState()
        canvas.translate(x * mm, y * mm)
        canvas.rotate(turn)
        canvas.line(0, 0, length * mm, 0)
        for end in (0.0, length):
            canvas.line(end * mm, -_TICK_MM * mm, end * mm, _TICK_MM * mm)
        canvas.drawCentredString(length / 2 * mm, 0.5 * mm, f"{length:.1f} mm")
        canvas.restoreState()
    canvas.restoreState()


def _draw_steps(canvas: Any, paper: SheetPaper, tables: str, further: tuple[str, ...]) -> None:
    """What to do, step by step, and the tables to copy."""
    width, height = PAPER_MM[paper]
    canvas.setPageSize((width * mm, height * mm))
    left, room = (EDGE_MM + SIDE_MM) * mm, (width - 2 * (EDGE_MM + SIDE_MM)) * mm
    y = (height - EDGE_MM - SIDE_MM) * mm
    steps = [LOOK.fixed_text(step) for step in (*STEPS, *further)]
    for number, paragraph in enumerate([LOOK.fixed_text(TITLE, "strong"), *steps]):
        _, tall = paragraph.wrap(room - 6 * mm, y)
        y -= tall + 1.5 * mm
        paragraph.drawOn(canvas, left + (6 * mm if number else 0), y)
        if number:
            canvas.setFont(SANS, 8)
            canvas.drawString(left, y + tall - 8, f"{number}.")
    text = canvas.beginText(left, y - 8 * mm)
    text.setFont("Courier", 8.5)
    text.setLeading(11)
    text.textLines(tables)
    canvas.drawText(text)
