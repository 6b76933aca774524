"""What the sections share: how much of the long lists is shown, pictures, and headings that stay with their text."""

from __future__ import annotations

from dataclasses import dataclass

from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, KeepTogether

from core.report.style import TEXT_WIDTH, text


@dataclass(frozen=True, slots=True)
class Limits:
    """How many rows the long lists may have, the rest being 'and n more', and how large the pictures are."""

    inputs: int
    reasons: int
    names: int
    notes: int
    settings: int
    repeats: int
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


def section(heading: str, first: list[Flowable]) -> Flowable:
    """A heading that stays with what follows it."""
    return KeepTogether([text(heading, "section"), *first])
