"""How the report looks: one accent colour, four embedded fonts, few type sizes; text made safe for any script."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import matplotlib
from reportlab import rl_config
from reportlab.lib.colors import HexColor
from reportlab.lib.enums import TA_CENTER, TA_RIGHT
from reportlab.lib.pagesizes import A4, LETTER
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfbase import pdfmetrics

from core.messages import Message, unparted
from core.report.layout.foreign_fonts import east_asian_font, embedded_font, is_east_asian, truetype
from core.report.layout.paragraph import Paragraph
from core.report.template import Paper
from core.report.wording import Words

ALARM = "#A61B1B"
"""What is grave is written in it."""
ACCENT, INK, MUTED, HAIRLINE, TINT = "#14586E", "#1D2327", "#5C6870", "#CBD3D7", "#EFF4F6"
"""The accent, text, secondary text, thin rules, and the ground of the result box; hex, for plots as well."""

MOST_CHARACTERS = 900
"""Longest text of one cell or paragraph; a page could not hold a cell without any limit."""

PAGE_SIZES: Mapping[Paper, tuple[float, float]] = {"A4": A4, "Letter": LETTER}
"""Width and height in points."""

TEXT_WIDTH = 170 * mm
"""On every paper, centred: so tables and pictures are the same on all of them."""

NOT_EMBEDDED = Message(
    "report.fonts_not_embedded",
    "No font of this computer that can be embedded has some of the East Asian characters in this report: the program "
    "that shows it has to bring them.",
)
NO_FONT = Message(
    "report.no_font",
    "No font of this computer has some of the characters in this report: they are printed by their code points.",
)

MOST_REMARKS = 6000
"""Longest remarks of an operator, in characters."""

SANS, BOLD, OBLIQUE, MONO = "Trisect-Sans", "Trisect-Bold", "Trisect-Oblique", "Trisect-Mono"
_FILES = {
    SANS: "DejaVuSans.ttf",
    BOLD: "DejaVuSans-Bold.ttf",
    OBLIQUE: "DejaVuSans-Oblique.ttf",
    MONO: "DejaVuSansMono.ttf",
}


def color(value: str) -> HexColor:
    """Convert a colour as hex text, '#rrggbb', to a colour for reportlab."""
    return HexColor(value)


@cache
def _covered() -> frozenset[int]:
    """Code points that every embedded face has. Registers the fonts, once."""
    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    covered: frozenset[int] | None = None
    for name, file in _FILES.items():
        font = truetype(name, str(folder / file))
        pdfmetrics.registerFont(font)
        if name in (SANS, BOLD):
            points = frozenset(font.face.charToGlyph)
            covered = points if covered is None else covered & points
    pdfmetrics.registerFontFamily(SANS, normal=SANS, bold=BOLD, italic=OBLIQUE, boldItalic=BOLD)
    return covered or frozenset()


def has_character(character: str) -> bool:
    """Whether one of the report's embedded fonts has the character; true for any kind of space."""
    return ord(character) in _covered() or character.isspace()


def prepare_reportlab() -> None:
    """Register the report's fonts with reportlab and set its options; further calls change nothing."""
    _covered()
    rl_config.useA85 = 0  # its base-85 text costs more time than all the layout, and a quarter of the size


def markup(text: str) -> str:
    """Convert `text` to reportlab's markup: escaped, in fonts that have its characters, numbers kept with their units.

    Characters the report's own fonts lack are set in a font of this computer, else in an East Asian one that the
    reader's program brings, and else printed by their code point, [U+1F600]: `font_note` says so.
    """
    runs = _runs(unparted(re.sub(r"[ \t\r\n\f\v]+", " ", text)))
    return "".join(f'<font name="{font}">{escape(part)}</font>' if font else escape(part) for font, part in runs)


def _runs(text: str) -> list[tuple[str, str]]:
    """`text` in parts of one font each; "" is the report's own."""
    covered, runs = _covered(), list[tuple[str, str]]()
    for character in text:
        font = "" if ord(character) in covered else _foreign(character, text)
        shown = character if font or ord(character) in covered else f"[U+{ord(character):04X}]"
        if runs and runs[-1][0] == font:
            runs[-1] = font, runs[-1][1] + shown
        else:
            runs.append((font, shown))
    return runs


def words_width(text: str, font: str, size: float) -> float:
    """Compute the width in points of `text` in the font `font` of `size` points, in any script."""
    return float(sum(pdfmetrics.stringWidth(part, foreign or font, size) for foreign, part in _runs(text)))


def draw_words(canvas: Any, place: tuple[float, float], text: str, font: str, size: float, share: float = 0.0) -> None:
    """Draw `text` on the page at `place` (x, y) in points; `share` (0 … 1) of its width lies left of x."""
    x, y = place[0] - share * words_width(text, font, size), place[1]
    for foreign, part in _runs(text):
        canvas.setFont(foreign or font, size)
        canvas.drawString(x, y, part)
        x += pdfmetrics.stringWidth(part, foreign or font, size)


def _foreign(character: str, text: str) -> str:
    """The font for a character of `text` that the report's own lack, or ""."""
    return embedded_font(character) or (east_asian_font(text) if is_east_asian(character) else "")


def font_note(texts: Iterable[str]) -> Message | None:
    """Make the note that some characters in `texts` are not embedded or not printable; None if all are embedded."""
    foreign = {character for text in texts for character in text if not has_character(character)}
    lacking = {character for character in foreign if not embedded_font(character)}
    if not lacking:
        return None
    return NOT_EMBEDDED if all(is_east_asian(character) for character in lacking) else NO_FONT


def _style(name: str, size: float, leading: float, **options: object) -> ParagraphStyle:
    defaults: dict[str, object] = {
        "fontName": SANS,
        "bulletFontName": SANS,
        "bulletFontSize": size,
        "textColor": color(INK),
    }
    return ParagraphStyle(name, fontSize=size, leading=leading, **(defaults | options))


EAST_ASIAN = ("zh", "ja", "ko")
"""Languages whose lines break between any two characters but before a full stop or after a bracket."""


@cache
def styles_of(accent: str, *, east_asian: bool = False) -> Mapping[str, ParagraphStyle]:
    """Make the report's paragraph styles, by name; headings have the colour `accent`.

    `east_asian` lines do not begin with a stop.
    """
    if east_asian:
        return {name: style.clone(name, wordWrap="CJK") for name, style in styles_of(accent).items()}
    return {
        "title": _style("title", 20, 24, fontName=BOLD, textColor=color(accent)),
        "laboratory": _style("laboratory", 8.5, 11, alignment=TA_RIGHT, textColor=color(MUTED)),
        "section": _style("section", 10.5, 13, fontName=BOLD, textColor=color(accent), spaceBefore=9, spaceAfter=3),
        "body": _style("body", 8, 11),
        "strong": _style("strong", 8, 11, fontName=BOLD),
        "small": _style("small", 7, 9.4),
        "label": _style("label", 7, 9.4, textColor=color(MUTED)),
        "number": _style("number", 7, 9.4, alignment=TA_RIGHT),
        "number_strong": _style("number_strong", 7, 9.4, alignment=TA_RIGHT, fontName=BOLD),
        "small_strong": _style("small_strong", 7, 9.4, fontName=BOLD),
        "head": _style("head", 7, 9.4, textColor=color(MUTED)),
        "head_number": _style("head_number", 7, 9.4, textColor=color(MUTED), alignment=TA_RIGHT),
        "rule": _style("rule", 6, 7.8, textColor=color(MUTED)),
        "caption": _style("caption", 7, 9.4, textColor=color(MUTED), spaceBefore=2),
        "bullet": _style("bullet", 7.5, 10.2, leftIndent=8, bulletIndent=0, spaceAfter=1.2),
        "alarm": _style(
            "alarm", 7.5, 10.2, leftIndent=8, spaceAfter=1.2, textColor=color(ALARM), bulletColor=color(ALARM)
        ),
        "result": _style("result", 20, 25, fontName=BOLD),
        "fact": _style("fact", 9, 12, fontName=BOLD),
        "mono": _style("mono", 5.6, 7.6, fontName=MONO),
        "hash": _style("hash", 6, 7.8),
        "hash_folder": _style("hash_folder", 6, 7.8, fontName=BOLD),
        "footer": _style("footer", 6, 7.2, alignment=TA_CENTER, textColor=color(MUTED)),
        "end": _style("end", 7, 9.4, alignment=TA_CENTER, textColor=color(MUTED), spaceBefore=6),
    }


@dataclass(frozen=True, slots=True)
class ReportLook:
    """Colours, type and language of one report.

    Parameters
    ----------
    words
        Its fixed words.
    accent
        The colour of headings, marks and lines, as "#RRGGBB".
    """

    words: Words
    accent: str

    @property
    def accent_color(self) -> HexColor:
        """Accent colour of the report, for reportlab."""
        return color(self.accent)

    def style(self, name: str) -> ParagraphStyle:
        """Return the paragraph style called `name`."""
        return styles_of(self.accent, east_asian=self.words.language.name.startswith(EAST_ASIAN))[name]

    def text(self, plain: str, style: str = "body") -> Paragraph:
        """Make a paragraph of plain text, in which no markup is recognised."""
        return Paragraph(self.markup(plain), self.style(style))

    def markup(self, plain: str) -> str:
        """Convert plain text to reportlab's markup, shortened with a remark beyond MOST_CHARACTERS characters."""
        if len(plain) > MOST_CHARACTERS:
            said = self.words("(shortened from {n} characters; all of it is in run.json)", n=len(plain))
            plain = f"{plain[:MOST_CHARACTERS]}… {said}"
        return markup(plain)

    def lines(self, plain: str) -> list[Paragraph]:
        """Make small paragraphs of a long plain text, one for each line; shortened beyond MOST_REMARKS characters."""
        if len(plain) > MOST_REMARKS:
            said = self.words("(shortened from {n} characters)", n=len(plain))
            plain = f"{plain[:MOST_REMARKS]}…\n{said}"
        pieces = [
            line[start : start + MOST_CHARACTERS]
            for line in (one.strip() for one in plain.strip().splitlines())
            for start in range(0, len(line) or 1, MOST_CHARACTERS)
        ]
        return [Paragraph(markup(piece) or "\u00a0", self.style("small")) for piece in pieces]

    def fixed_text(self, english: str, style: str = "body", /, **values: object) -> Paragraph:
        """Make a paragraph of fixed words, translated to the report's language, with `values` in their places."""
        return self.text(self.words(english, **values), style)

    def link(self, plain: str, key: str, style: str = "body") -> Paragraph:
        """Make a paragraph of plain text that links to the section or row whose link key is `key`."""
        return Paragraph(f'<a href="#{key}" color="{self.accent}">{self.markup(plain)}</a>', self.style(style))

    def bullets(self, sentences: tuple[str, ...], style: str = "bullet") -> list[Paragraph]:
        """Make a bulleted paragraph of each sentence in the paragraph style `style`, as "bullet" or "alarm"."""
        return [Paragraph(self.markup(sentence), self.style(style), bulletText="•") for sentence in sentences]
