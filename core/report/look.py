"""What every part of a report shares: its language, its colours and type styles, and what can be linked to."""

from __future__ import annotations

from dataclasses import dataclass

from reportlab.lib.colors import HexColor
from reportlab.lib.styles import ParagraphStyle
from reportlab.platypus import Paragraph

from core.report.content import ReportContent
from core.report.language import Words
from core.report.style import color, markup, styles_of


@dataclass(frozen=True, slots=True)
class Look:
    """How one report looks and speaks.

    Parameters
    ----------
    words
        Its fixed words.
    accent
        The colour of headings, marks and lines, as "#RRGGBB".
    """

    words: Words
    accent: str

    @classmethod
    def of(cls, content: ReportContent) -> Look:
        """The look that a content asks for."""
        return cls(Words(content.language), content.template.accent)

    @property
    def accent_color(self) -> HexColor:
        """The accent."""
        return color(self.accent)

    def style(self, name: str) -> ParagraphStyle:
        """A type style by its name."""
        return styles_of(self.accent)[name]

    def text(self, plain: str, style: str = "body") -> Paragraph:
        """A paragraph of plain words: whatever they hold is printed, never taken for markup."""
        return Paragraph(markup(plain), self.style(style))

    def say(self, english: str, style: str = "body", /, **values: object) -> Paragraph:
        """A paragraph of fixed words in the report's language."""
        return self.text(self.words(english, **values), style)

    def link(self, plain: str, key: str, style: str = "body") -> Paragraph:
        """A paragraph of plain words that leads to the section or row called `key`."""
        return Paragraph(f'<a href="#{key}" color="{self.accent}">{markup(plain)}</a>', self.style(style))

    def bullets(self, sentences: tuple[str, ...]) -> list[Paragraph]:
        """Each sentence behind a small bullet."""
        return [Paragraph(markup(sentence), self.style("bullet"), bulletText="•") for sentence in sentences]
