"""Sentences that other rooms say in English, put into another language by a table of patterns with {places}."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

_PLACE = re.compile(r"{(\w+)}")
_NUMBER = re.compile(r"[+\-−]?\d+\.\d+(e[+-]?\d+)?( ?(mm|px|°|%|µm|°C))?( ± \d+\.\d+( ?(mm|px|°|%|µm|°C))?)?")
_LISTS = (re.compile("(; )"), re.compile("(; |, | and )"))


@dataclass(frozen=True)
class Sentences:
    """Sentences with {places} and fixed `words` by the English ones, and how the language writes numbers and lists."""

    table: Mapping[str, str]
    words: Mapping[str, str]
    decimal: str = ","
    conjunction: str = " und "

    @cached_property
    def _patterns(self) -> tuple[tuple[re.Pattern[str], str], ...]:
        """Those with places, the most particular first."""
        with_places = [english for english in self.table if _PLACE.search(english)]
        with_places.sort(key=lambda english: -len(_PLACE.sub("", english)))
        return tuple((_pattern(english), self.table[english]) for english in with_places)

    def find(self, sentence: str) -> str | None:
        """The sentence in the other language; None if it is not known there."""
        if sentence in self.words or sentence in self.table:
            return self.words.get(sentence) or self.table[sentence]
        for pattern, other in self._patterns:
            if found := pattern.fullmatch(sentence):
                return other.format(**{name: self._value(value) for name, value in found.groupdict().items()})
        return self._list(sentence, _LISTS[0]) or self._after_name(sentence)

    def _value(self, value: str) -> str:
        """What stands in a place: something known or a list of such, or a name that stays as it is."""
        found = (self._part(value), *(self._list(value, separator) for separator in _LISTS))
        return next((one for one in found if one), value)

    def _part(self, value: str) -> str | None:
        """A known sentence, a number, or 'pose03 (a known reason)'."""
        if _NUMBER.fullmatch(value):
            return value.replace(".", self.decimal)
        name, bracket, reason = value.partition(" (")
        known = self.find(reason[:-1]) if bracket and reason.endswith(")") else None
        return f"{name} ({known})" if known else self.find(value)

    def _list(self, value: str, separator: re.Pattern[str]) -> str | None:
        """A list, if every part of it is known."""
        parts = separator.split(value)
        if len(parts) < 2:
            return None
        known = [self._part(part) for part in parts[::2]]
        if None in known:
            return None
        between = [self.conjunction if part == " and " else part for part in parts[1::2]]
        return "".join(f"{part}{then}" for part, then in zip(known, [*between, ""], strict=True))

    def _after_name(self, sentence: str) -> str | None:
        """'block thickness: a sentence that is known'."""
        name, colon, rest = sentence.partition(": ")
        known = self.find(rest) if colon else None
        return f"{name}: {known}" if known else None


def _pattern(english: str) -> re.Pattern[str]:
    """A regular expression for an English sentence with places."""
    pieces: list[Any] = _PLACE.split(english)
    literal = [re.escape(piece) if place % 2 == 0 else f"(?P<{piece}>.+?)" for place, piece in enumerate(pieces)]
    return re.compile("".join(literal), re.DOTALL)
