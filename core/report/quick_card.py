"""The quick card: one page to hang beside the rig, with what is done each time and what the words mean."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass

from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import Flowable, Frame, Table, TableStyle

from core.messages import label
from core.report.layout.paragraph import Paragraph
from core.report.layout.style import (
    ACCENT,
    HAIRLINE,
    MUTED,
    PAGE_SIZES,
    SANS,
    ReportLook,
    color,
    markup,
    prepare_reportlab,
)
from core.report.template import Paper
from core.report.wording import Words

EDGE, BETWEEN = 14 * mm, 8 * mm
"""White around the page, and between its two columns."""
HEAD, FOOT = 17 * mm, 22 * mm
"""Room above the columns for the title, and below for what is filled in by hand."""


@dataclass(frozen=True, slots=True)
class Part:
    """Heading with the steps, or facts, under it."""

    title: str
    lines: tuple[str, ...]


TITLE = label("Trisect: quick card")
CLAIM = label("The manual (F1 in the window) says why.")
LEFT = (
    Part(
        label("1. Before anything"),
        (
            label("Camera and fan screwed tight; focus and aperture locked. Both warm: half an hour."),
            label("Room light dim and steady. Exposure so that stripes are bright and not clipped."),
            label("Never look into a laser, nor into its reflection on a shiny part."),
        ),
    ),
    Part(
        label("2. Camera: when lens or camera was touched"),
        (
            label("10 to 15 pictures of the board, lasers off: every corner of the picture, tilted by 30° each way."),
            label("Calibrate. A view stands out: take it again. Then Accept."),
        ),
    ),
    Part(
        label("3. Laser planes: when anything was moved"),
        (
            label("Plate in the fan, about ten poses: near, middle, far; each tilted another way; at rest."),
            label("Each pose with the fan on and with it off. Calibrate. Few poses agree: do not accept."),
        ),
    ),
    Part(
        label("4. Check: every day, before the first part"),
        (
            label("Plate in the fan: three pictures, near, middle and far of where the parts will be."),
            label("In order: measure. In doubt: check again. Changed: re-adjust or calibrate; nothing conforms."),
        ),
    ),
    Part(
        label("5. Scan: each part"),
        (
            label("Part and table at rest from the reference to the last frame. Take the reference: the fan alone."),
            label("Sweep slowly, across all three lines, on the part and beside it; turn and tilt the laser."),
            label("30 to 60 frames. Follow the hint above the picture."),
        ),
    ),
)
RIGHT = (
    Part(
        label("6. Inspect and report"),
        (
            label("Click a face, or two, in the 3D view (C, Shift+C): values with U."),
            label("Read the notes, the red ones first. Then make the report."),
        ),
    ),
    Part(
        label("What the verdict means"),
        (
            label("Conforming: the value is inside its limits, by more than U."),
            label("Not conforming: it is outside, by more than U."),
            label("Not proven: a limit is nearer than U, or something is assumed. Measure better; do not guess."),
        ),
    ),
    Part(
        label("When it says no"),
        (
            label("Read the whole sentence: what, where, why, what to do next."),
            label("Stripes clipped: shorter exposure. Shiny part: spray it, or turn it."),
            label("Something moved: begin again with the check. A code in brackets: the manual, Troubleshooting."),
            label("A decision was wrong: Ctrl+Z takes it back."),
        ),
    ),
)
KEYS = (
    ("Ctrl+R", label("Do this step")),
    ("Ctrl+Shift+R", label("Measure everything")),
    ("Ctrl+Return", label("Accept a calibration")),
    ("Ctrl+L", label("Live source on or off")),
    ("Ctrl+Space", label("Take a picture")),
    ("PgDown, PgUp", label("Presenter or foot switch: take or go on; pause")),
    ("Ctrl+.", label("Cancel the running job")),
    ("Ctrl+Z", label("Undo")),
    ("F1, ?", label("The manual; all keys")),
)
KEYS_TITLE = label("Keys")
BY_HAND = (label("Rig"), label("Calibrated on"), label("By"), label("Next due"))
"""What is written on the card with a pen."""


SIZES = (11.5, 11.0, 10.5, 10.0, 9.5, 9.0, 8.5, 8.0)
"""Type sizes in points, tried in this order until everything fits."""


def quick_card(language: str = "en", paper: Paper = "A4") -> bytes:
    """Make the quick card, one page on each step and each word, as the bytes of a PDF in `language` on `paper`.

    Raises
    ------
    KeyError
        If there is no such language.
    ValueError
        If the language is too long for the page.
    """
    prepare_reportlab()
    look = ReportLook(Words.of(language), ACCENT)
    width, height = PAGE_SIZES[paper]
    room = (width - 2 * EDGE - BETWEEN) / 2, height - 2 * EDGE - HEAD - FOOT
    for size in SIZES:  # the longest language is read at the smallest one
        columns = _columns(look, size, room[0])
        if all(_height(column, room) <= room[1] for column in columns):
            break
    else:
        raise ValueError(f"the quick card has no room for all of its words in {language!r}")
    stream = io.BytesIO()
    canvas = Canvas(stream, pagesize=(width, height), invariant=1, initialFontName=SANS)
    canvas.setTitle(look.words(TITLE))
    canvas.setCreator("Trisect")
    _draw(canvas, _head(look), (EDGE, height - EDGE - HEAD, width - 2 * EDGE, HEAD))
    for place, column in enumerate(columns):
        _draw(canvas, column, (EDGE + place * (room[0] + BETWEEN), EDGE + FOOT, *room))
    _draw(canvas, [_by_hand(look, width - 2 * EDGE)], (EDGE, EDGE, width - 2 * EDGE, FOOT))
    canvas.showPage()
    canvas.save()
    return stream.getvalue()


def _columns(look: ReportLook, size: float, width: float) -> tuple[list[Flowable], list[Flowable]]:
    heading = look.style("section").clone("card heading", fontSize=1.15 * size, leading=1.5 * size, spaceBefore=size)
    line = look.style("bullet").clone(
        "card line", fontSize=size, leading=1.32 * size, bulletFontSize=size, leftIndent=size, spaceAfter=0.25 * size
    )

    def parts(of: tuple[Part, ...]) -> Iterator[Flowable]:
        for part in of:
            yield Paragraph(markup(look.words(part.title)), heading)
            yield from (Paragraph(markup(look.words(said)), line, bulletText="•") for said in part.lines)

    keys = [Paragraph(markup(look.words(KEYS_TITLE)), heading), _keys(look, size, width)]
    return [*parts(LEFT)], [*parts(RIGHT), *keys]


def _height(column: list[Flowable], room: tuple[float, float]) -> float:
    """How high a column is, in points."""
    return float(sum(one.wrap(*room)[1] + one.getSpaceBefore() + one.getSpaceAfter() for one in column))


def _draw(canvas: Canvas, parts: list[Flowable], box: tuple[float, float, float, float]) -> None:
    """Parts one below the other in a box: left, bottom, width and height in points."""
    Frame(*box, leftPadding=0, rightPadding=0, topPadding=0, bottomPadding=0).addFromList(parts, canvas)


def _head(look: ReportLook) -> list[Flowable]:
    said = ((TITLE, "title"), (CLAIM, "label"))
    return [Paragraph(markup(look.words(text)), look.style(style)) for text, style in said]


def _keys(look: ReportLook, size: float, width: float) -> Table:
    cell = look.style("body").clone("card key", fontSize=0.95 * size, leading=1.2 * size)
    rows = [[Paragraph(markup(key), cell), Paragraph(markup(look.words(meaning)), cell)] for key, meaning in KEYS]
    table = Table(rows, colWidths=(0.36 * width, 0.64 * width))
    whole = (0, 0), (-1, -1)
    rules = [("LINEBELOW", *whole, 0.4, color(HAIRLINE)), ("VALIGN", *whole, "TOP"), ("LEFTPADDING", *whole, 0)]
    table.setStyle(TableStyle([*rules, ("TOPPADDING", *whole, 2), ("BOTTOMPADDING", *whole, 2)]))
    return table


def _by_hand(look: ReportLook, width: float) -> Table:
    words = [Paragraph(markup(look.words(word)), look.style("label")) for word in BY_HAND]
    table = Table(
        [[""] * len(BY_HAND), words], colWidths=[width / len(BY_HAND)] * len(BY_HAND), rowHeights=[11 * mm, None]
    )
    table.setStyle(
        TableStyle([("LINEABOVE", (0, 1), (-1, 1), 0.6, color(MUTED)), ("LEFTPADDING", (0, 0), (-1, -1), 0)])
    )
    return table
