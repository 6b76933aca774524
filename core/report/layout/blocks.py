"""What pages are made of: headings that stay with their text, pictures, and tables.

Tables have thin rules and no boxes, numbers to the right; every cell wraps, so nothing is cut.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, KeepTogether, Spacer, Table, TableStyle

from core.report.facts.fact import Fact, Reader, for_reader
from core.report.facts.table import FactTable, Uncertain, tables_for_reader
from core.report.layout.paragraph import Paragraph
from core.report.layout.style import HAIRLINE, MUTED, SANS, TEXT_WIDTH, TINT, ReportLook, color
from core.report.wording import grouped


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of the long lists, the rest being 'and n more', and the size of the pictures."""

    inputs: int
    reasons: int
    names: int
    notes: int
    settings: int
    repeats: int
    budgets: int
    picture_scale: float


LEAST_SCALE = 0.72
"""Of a picture, below which its numbers could not be read any more."""


class Picture(Flowable):  # type: ignore[misc]
    """Picture of the text's width times `scale`, centred."""

    def __init__(self, reader: ImageReader, scale: float) -> None:
        super().__init__()
        columns, rows = reader.getSize()
        self.reader, self.inner = reader, TEXT_WIDTH * scale
        self.width, self.height = TEXT_WIDTH, TEXT_WIDTH * scale * rows / columns

    @property
    def spare(self) -> float:
        """Height in points by which the picture may still shrink."""
        spare: float = self.height * (1 - LEAST_SCALE * TEXT_WIDTH / self.inner)
        return max(0.0, spare)

    def shrink(self, points: float) -> None:
        """Reduce the picture's height by `points` (1/72 inch), and its width in proportion."""
        share = 1 - points / self.height
        self.inner, self.height = self.inner * share, self.height * share

    def draw(self) -> None:
        """Paint the picture (called by reportlab)."""
        left = (self.width - self.inner) / 2
        self.canv.drawImage(self.reader, left, 0, width=self.inner, height=self.height)


class Bookmark(Flowable):  # type: ignore[misc]
    """Target of links, named in the outline beside the pages; `level` 0 for sections, 1 within them."""

    width = height = 0

    def __init__(self, key: str, title: str, level: int = 0) -> None:
        super().__init__()
        self.key, self.title, self.level = key, title, level

    def wrap(self, *_: float) -> tuple[float, float]:
        """Return the size (0, 0), as a bookmark takes no room (called by reportlab)."""
        return 0, 0

    def draw(self) -> None:
        """Register the bookmark at the current place of the page (called by reportlab)."""
        self.canv.bookmarkHorizontal(self.key, 0, 12)
        self.canv.addOutlineEntry(self.title, self.key, self.level)


class Heading(Paragraph):
    """Heading that is a target of links. The bookmark is its own: before it, its space above would not be counted."""

    def __init__(self, look: ReportLook, key: str, title: str, style: str = "section", level: int = 0) -> None:
        super().__init__(look.markup(title), look.style(style))
        self.key, self.title, self.level = key, title, level

    def split(self, *_: float) -> list[Flowable]:
        """Return no parts, so that the heading is never divided between pages (called by reportlab)."""
        return []

    def draw(self) -> None:
        """Register the heading's bookmark and paint the heading (called by reportlab)."""
        self.canv.bookmarkHorizontal(self.key, 0, self.height)
        self.canv.addOutlineEntry(self.title, self.key, self.level)
        super().draw()


class OnOnePage(KeepTogether):  # type: ignore[misc]
    """Flowables kept together; their pictures shrink where that keeps them on a page that is begun already."""

    def least_height(self, width: float) -> float:
        """Compute the least height in points of all flowables together, with their pictures shrunk."""
        self.wrap(width, 0)
        height: float = self._H - self._spare
        return height

    @property
    def _pictures(self) -> list[Picture]:
        return [one for one in self._content if isinstance(one, Picture)]

    @property
    def _spare(self) -> float:
        return sum(one.spare for one in self._pictures)

    def split(self, width: float, height: float) -> list[Flowable]:
        """Shrink pictures if all then fits into `height` points, else begin a new page (called by reportlab)."""
        self.wrap(width, height)
        spare, lack = self._spare, self._H - height
        if not 0 < lack < spare:
            parts: list[Flowable] = super().split(width, height)
            return parts
        share = min(1.0, (lack + 1) / spare)  # a point for rounding
        for one in self._pictures:
            one.shrink(share * one.spare)
        return list(self._content)


class Sections(KeepTogether):  # type: ignore[misc]
    """Sections in their order; where the next one does not fit on a page, one that does is moved before it."""

    def __init__(self, sections: Sequence[OnOnePage]) -> None:
        super().__init__(list(sections))
        self.sections = list(sections)

    def split(self, width: float, height: float) -> list[Flowable]:
        """Place the first section that fits into `height` points, then the rest in order (called by reportlab)."""
        for one in self.sections:
            one.canv, one._frame = self.canv, getattr(self, "_frame", None)
        fitting = (one for one in self.sections if one.least_height(width) <= height)
        chosen = next(fitting, self.sections[0])
        rest = [one for one in self.sections if one is not chosen]
        return [*chosen.split(width, height), *([Sections(rest)] if rest else [])]


def section(look: ReportLook, key: str, heading: str, first: list[Flowable], **values: object) -> OnOnePage:
    """Make a section whose heading, fixed words with `values`, stays with its content; `key` is the target of links."""
    title = look.words(heading, **values)
    return OnOnePage([Heading(look, key, title), *first])


PLAIN = [
    ("FONTNAME", (0, 0), (-1, -1), SANS),
    ("LEFTPADDING", (0, 0), (-1, -1), 0),
    ("RIGHTPADDING", (0, 0), (-1, -1), 6),
    ("RIGHTPADDING", (-1, 0), (-1, -1), 0),
    ("TOPPADDING", (0, 0), (-1, -1), 1.6),
    ("BOTTOMPADDING", (0, 0), (-1, -1), 1.6),
    ("VALIGN", (0, 0), (-1, -1), "TOP"),
]

GAP = 8 * mm
"""Between two columns of text."""

Cell: TypeAlias = "Flowable | list[Flowable] | str"


def plain_table(rows: Sequence[Sequence[Cell]], widths: Sequence[float]) -> Table:
    """Make a table without lines; column widths in points."""
    return Table(rows, colWidths=widths, style=TableStyle(PLAIN), hAlign="LEFT")


def ruled_table(rows: Sequence[Sequence[Cell]], widths: Sequence[float]) -> Table:
    """Make a table with a line under the head row and a hairline under each other row; column widths in points."""
    style = [
        *PLAIN,
        ("LINEBELOW", (0, 0), (-1, 0), 0.6, color(MUTED)),
        ("LINEBELOW", (0, 1), (-1, -1), 0.25, color(HAIRLINE)),
    ]
    return Table(rows, colWidths=widths, style=TableStyle(style), hAlign="LEFT", repeatRows=1)


def heads(look: ReportLook, *words: str, numbers: Sequence[int] = ()) -> list[Flowable]:
    """Make a table's head row from fixed words ("" for an empty head); those at indices `numbers` are right-aligned."""
    return [
        look.text("" if not word else look.words(word), "head_number" if place in numbers else "head")
        for place, word in enumerate(words)
    ]


def pairs_table(look: ReportLook, pairs: Mapping[str, str], width: float, label_width: float) -> Table:
    """Make a table of two columns, label and value, from `pairs`; widths in points."""
    rows = [[look.text(label, "label"), look.text(value, "small")] for label, value in pairs.items()]
    nothing = [[look.fixed_text("none", "small"), look.text("", "small")]]
    return plain_table(rows or nothing, [label_width, width - label_width])


def side_by_side(left: list[Flowable], right: list[Flowable], width: float, share: float = 0.5) -> Table:
    """Make two columns with a gap between them; `share` is the left column's part of `width` without the gap."""
    inner = (width - GAP) * share
    style = TableStyle([*PLAIN, ("RIGHTPADDING", (0, 0), (-1, -1), 0), ("TOPPADDING", (0, 0), (-1, -1), 0)])
    return Table(
        [[left, "", right]], colWidths=[inner, GAP, width - GAP - inner], style=style, hAlign="LEFT", splitInRow=1
    )


class ShareBar(Flowable):  # type: ignore[misc]
    """Small bar whose length is a share 0…1 of `width`."""

    def __init__(self, look: ReportLook, share: float, width: float) -> None:
        super().__init__()
        self.look, self.share, self.width, self.height = look, share, width, 9.4

    def draw(self) -> None:
        """Paint the bar (called by reportlab)."""
        self.canv.setFillColor(color(TINT))
        self.canv.rect(0, 1.5, self.width, 5, stroke=0, fill=1)
        self.canv.setFillColor(self.look.accent_color)
        self.canv.rect(0, 1.5, self.width * min(max(self.share, 0.0), 1.0), 5, stroke=0, fill=1)


def more_line(look: ReportLook, left: int, where: str = "run.json") -> list[Flowable]:
    """Make the line 'and 12 more, listed in run.json' for `left` entries that are not printed; [] if `left` is 0."""
    if left <= 0:
        return []
    return [look.fixed_text("and {n} more, listed in {where}", "label", n=grouped(left), where=look.words.known(where))]


def figures(look: ReportLook, facts: Iterable[Fact], columns: int = 6) -> Table:
    """Make a table of facts for an auditor, each a name above its value with unit, `columns` of them in a row."""
    words, told = look.words, for_reader(facts, Reader.AUDITOR)
    rows: list[list[Cell]] = []
    for start in range(0, len(told), columns):
        shown = told[start : start + columns]
        padding = [look.text("")] * (columns - len(shown))
        rows.append([*(look.text(fact.heading(words), "label") for fact in shown), *padding])
        rows.append([*(look.text(fact.text(words), "small_strong") for fact in shown), *padding])
    return plain_table(rows, [TEXT_WIDTH / columns] * columns)


def fact_tables(look: ReportLook, tables: Iterable[FactTable]) -> list[Flowable]:
    """Make the printed tables, with space around each, of the `FactTable`s meant for an auditor."""
    read = tables_for_reader(tables, Reader.AUDITOR)
    return [part for table in read for part in (Spacer(0, 1 * mm), _fact_table(look, table), Spacer(0, 1 * mm))]


def _fact_table(look: ReportLook, table: FactTable) -> Table:
    """Numbers stand to the right, below their names with the units."""
    words, places = look.words, range(len(table.columns))
    numeric = [place for place in places if any(isinstance(row[place], (int, float, Uncertain)) for row in table.rows)]
    names = [(words.known(column.label), column.unit) for column in table.columns]
    head = [
        look.text(words.in_unit(name, unit) if unit else name, "head_number" if place in numeric else "head")
        for place, (name, unit) in enumerate(names)
    ]
    body = [
        [look.text(cell, "number" if place in numeric else "small") for place, cell in enumerate(cells)]
        for cells in table.texts(words)
    ]
    widths = [TEXT_WIDTH * (0.14 if place else 0.3) for place in places]
    made = ruled_table([head, *body], widths)
    made.setStyle([("LEFTPADDING", (place, 0), (place, -1), 6) for place in places[1:] if place not in numeric])
    return made


def texts_by_name(look: ReportLook, facts: Iterable[Fact]) -> dict[str, str]:
    """Write the facts meant for an auditor as texts: the value with its unit, by the fact's name."""
    return {fact.heading(look.words): fact.text(look.words) for fact in for_reader(facts, Reader.AUDITOR)}
