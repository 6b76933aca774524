"""Paragraphs whose East Asian lines break between characters, but within no number, unit or foreign word."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from reportlab import platypus
from reportlab.lib.textsplit import ALL_CANNOT_END, ALL_CANNOT_START
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.platypus.paragraph import ParaLines, _handleBulletWidth, cjkU, makeCJKParaLine

NOT_FIRST = frozenset(ALL_CANNOT_START) | frozenset("，．：；？！％…～·”’》〉")
NOT_LAST = frozenset(ALL_CANNOT_END) | frozenset("(“‘《〈")
"""Characters no line begins or ends with: reportlab's, and those of Chinese that it lacks."""
BREAK_AFTER = frozenset(" /\u200b")
"""Between characters that are not East Asian, lines break after these only."""
WIDE = "\u2e80"
"""From here on characters are East Asian: there may be a break on either side of them."""
LEEWAY = 1e-6
"""Points by which a line may be too long: widths are sums."""


class Paragraph(platypus.Paragraph):  # type: ignore[misc]
    """Paragraph of reportlab with our rules for line ends. Where its style has ``wordWrap="CJK"`` it parts what it
    should not: this one does not.
    """

    def breakLinesCJK(self, maxWidths: Any) -> Any:
        widths = list(maxWidths) if isinstance(maxWidths, (list, tuple)) else [maxWidths]
        if not self.frags or (hasattr(self, "blPara") and getattr(self, "_splitpara", False)):
            return super().breakLinesCJK(widths)
        given = list(widths)
        _handleBulletWidth(self.bulletText, self.style, widths)
        if self._fits_on_a_line(widths[0]):
            return super().breakLinesCJK(given)  # most cells of tables: several times as fast
        self.height = 0
        with_bounds = getattr(self, "autoLeading", getattr(self.style, "autoLeading", "")) not in ("", "off")
        characters = [cjkU(one, frag, "utf8") for frag in self.frags for one in (frag.text or [""])]
        lines: list[Any] = []
        start = 0
        for end in line_ends(characters, widths):
            line = characters[start:end]
            shown = line[: len(line) - _spaces_at_end(line)]
            room, used = widths[min(len(lines), len(widths) - 1)], sum(one.width for one in shown)
            forced = hasattr(line[-1].frag, "lineBreak")
            lines.append(makeCJKParaLine(line, room, used, room - used, forced, with_bounds))
            start = end
        return ParaLines(kind=1, lines=lines)

    def _fits_on_a_line(self, width: float) -> bool:
        """Whether it is of one font and need not be broken."""
        first = self.frags[0]
        if len(self.frags) > 1 or hasattr(first, "cbDefn") or hasattr(first, "lineBreak"):
            return False
        return bool(stringWidth(first.text, first.fontName, first.fontSize) <= width)


def line_ends(characters: Sequence[Any], widths: Sequence[float]) -> list[int]:
    """Find where to break a text into lines: the index of the first character of each next line.

    A line is as long as it fits between two places where it may break; what has none is cut where the line is full.
    Spaces at an end stand beyond it.

    Parameters
    ----------
    characters
        reportlab's `cjkU`: one character each, its `width` in points and its `frag`; "" for what is no character.
    widths
        Of the lines, in points; the last one also of all that follow.
    """
    ends: list[int] = []
    start = place = 0
    used, good = 0.0, 0
    while place < len(characters):
        one = characters[place]
        if place > start and may_break(characters[place - 1], one):
            good = place
        used += one.width
        if used > widths[min(len(ends), len(widths) - 1)] + LEEWAY and one != " " and place > start:
            place = good if good > start else place
            ends.append(place)
            start, used = place, 0.0
            continue
        place += 1
        if hasattr(one.frag, "lineBreak"):
            ends.append(place)
            start, used = place, 0.0
    return ends if start == len(characters) else [*ends, len(characters)]


def may_break(before: str, after: str) -> bool:
    """Whether a line may be broken between the characters `before` and `after`."""
    if not before or not after or after in NOT_FIRST or before in NOT_LAST or "\u00a0" in (before, after):
        return False
    if before in BREAK_AFTER:
        return after not in BREAK_AFTER
    return after not in BREAK_AFTER and (before >= WIDE or after >= WIDE)


def _spaces_at_end(line: Sequence[str]) -> int:
    """How many spaces a line ends with."""
    return len(line) - len("".join(one or "x" for one in line).rstrip(" "))
