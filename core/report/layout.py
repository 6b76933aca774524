"""What the sections share: how much of the long lists is shown, pictures, and headings that stay with their text."""

from __future__ import annotations

from dataclasses import dataclass

from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, KeepTogether, Paragraph

from core.report.look import Look
from core.report.style import TEXT_WIDTH, markup


@dataclass(frozen=True, slots=True)
class Limits:
    """How many rows the long lists may have, the rest being 'and n more', and how large the pictures are."""

    inputs: int
    reasons: int
    names: int
    notes: int
    settings: int
    repeats: int
    budgets: int
    picture_scale: float


class Picture(Flowable):  # type: ignore[misc]
    """A picture of the text's width times `scale`, centred."""

    def __init__(self, reader: ImageReader, scale: float) -> None:
        super().__init__()
        columns, rows = reader.getSize()
        self.reader, self.inner = reader, TEXT_WIDTH * scale
        self.width, self.height = TEXT_WIDTH, TEXT_WIDTH * scale * rows / columns

    def draw(self) -> None:
        """Paint it (called by reportlab)."""
        left = (self.width - self.inner) / 2
        self.canv.drawImage(self.reader, left, 0, width=self.inner, height=self.height)


class Bookmark(Flowable):  # type: ignore[misc]
    """A place that links lead to, named in the outline beside the pages; `level` 0 for sections, 1 within them."""

    width = height = 0

    def __init__(self, key: str, title: str, level: int = 0) -> None:
        super().__init__()
        self.key, self.title, self.level = key, title, level

    def wrap(self, *_: float) -> tuple[float, float]:
        """It takes no room (called by reportlab)."""
        return 0, 0

    def draw(self) -> None:
        """Note the place (called by reportlab)."""
        self.canv.bookmarkHorizontal(self.key, 0, 12)
        self.canv.addOutlineEntry(self.title, self.key, self.level)


class Heading(Paragraph):  # type: ignore[misc]
    """A heading that links lead to. The bookmark is its own: before it, its space above would not be counted."""

    def __init__(self, look: Look, key: str, title: str, style: str = "section", level: int = 0) -> None:
        super().__init__(markup(title), look.style(style))
        self.key, self.title, self.level = key, title, level

    def split(self, *_: float) -> list[Flowable]:
        """It stays in one piece (called by reportlab)."""
        return []

    def draw(self) -> None:
        """Note the place and paint it (called by reportlab)."""
        self.canv.bookmarkHorizontal(self.key, 0, self.height)
        self.canv.addOutlineEntry(self.title, self.key, self.level)
        super().draw()


def section(look: Look, key: str, heading: str, first: list[Flowable], **values: object) -> Flowable:
    """A heading that stays with what follows it; `heading` is fixed words, `key` what links call it."""
    title = look.words(heading, **values)
    return KeepTogether([Heading(look, key, title), *first])
