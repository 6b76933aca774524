"""The fixed words of a report in its language, and how that language writes numbers.

Words stand in the code in English; `TABLES` has them in every other language. A test holds that none is missing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import ROUND_HALF_EVEN, Decimal
from types import MappingProxyType

from core.report.german import GERMAN
from core.report.german_notes import GERMAN_NOTES
from core.report.sentences import Sentences
from core.report.template import Language

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

TABLES: Mapping[Language, Mapping[str, str]] = MappingProxyType({"de": GERMAN})
"""By language: its words by the English ones."""

SENTENCES: Mapping[Language, Sentences] = MappingProxyType({"de": Sentences(GERMAN_NOTES, GERMAN)})
"""By language: what other rooms say, by patterns."""


@dataclass(frozen=True, slots=True)
class Words:
    """The words of one language: `words("{n} of {m} used", n=3, m=5)`."""

    language: Language = "en"

    def __call__(self, english: str, /, **values: object) -> str:
        """A fixed text, its places filled with `values`; KeyError if the language lacks it."""
        text = english if self.language == "en" else TABLES[self.language][english]
        return text.format(**values) if values else text

    def known(self, sentence: str) -> str:
        """A sentence that comes from elsewhere: in the report's language if it is known there, else as it is."""
        if self.language == "en":
            return sentence
        return SENTENCES[self.language].find(sentence) or sentence

    def fixed(self, value: float, decimals: int, *, signed: bool = False) -> str:
        """`value` with so many decimals (negative: rounded to tens, hundreds), true minus sign, no minus zero."""
        if not math.isfinite(value):
            return self("unknown")
        step = Decimal(1).scaleb(-decimals)
        rounded = Decimal(repr(float(value))).quantize(step, rounding=ROUND_HALF_EVEN)
        if rounded == 0:
            rounded = abs(rounded)
        return self.numeral(f"{rounded:+f}" if signed and rounded != 0 else f"{rounded:f}")

    def general(self, value: float) -> str:
        """A value as somebody stated it: no more digits than it has, a power of ten for very small and large ones."""
        digits, _, power = f"{value:g}".partition("e")
        return self.numeral(digits) + (f"·10{str(int(power)).translate(RAISED)}" if power else "")

    def numeral(self, digits: str) -> str:
        """Digits with the language's decimal sign and a true minus sign."""
        return digits.replace("-", "−").replace(".", "," if self.language == "de" else ".")

    def count(self, number: int, noun: str) -> str:
        """'1 frame', '1 204 frames' (no-break spaces between thousands)."""
        return f"{grouped(number)} {self(noun if number == 1 else f'{noun}s')}"


ENGLISH = Words()


def grouped(number: int) -> str:
    """An integer with no-break spaces between thousands."""
    return f"{number:,}".replace(",", "\u00a0")
