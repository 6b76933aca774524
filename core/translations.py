"""The languages messages can be told in: catalogues in ``resources/translations``, by the name of their language.

A catalogue is a gettext file, NAME.po: messages stand in it by their code (msgctxt), fixed words by the English ones.
What it lacks is told in English. The decimal sign, dates and how several things are joined are those of Babel's locale
data.
`make translations` brings the catalogues up to date with the code.
"""

from __future__ import annotations

import gettext
import re
import string
from collections.abc import Iterable, Sequence
from datetime import date, datetime
from functools import cache, partial
from importlib.resources import files
from typing import TYPE_CHECKING

from core.messages import ENGLISH, Language, Message

if TYPE_CHECKING:  # costs 0.05 s, and English needs none of it
    from babel import Locale

PSEUDO = "en-XA"
"""A pseudo-language: English with accents, longer, in brackets. It shows texts that are in no catalogue, and
texts that have no room to be longer."""

_FOLDER = files("resources") / "translations"
_ACCENTS = str.maketrans(
    "aceghijklnorstuwyzACDEGHIJKLNORSTUWYZ",
    "áçéĝĥíĵķļñóŕšţúŵýžÁÇĎÉĜĤÍĴĶĻÑÓŔŠŢÚŴÝŽ",
)
_VOWELS = re.compile("([aeiou])")
_FIXED = re.compile(r"(<[^<>]*>|&\w+;|%\w+)")
"""Parts of a text that a reader does not see: marks of rich text, entities, places of Qt's."""


@cache
def languages() -> tuple[str, ...]:
    """List the names of all available languages, English first."""
    names = (path.name.removesuffix(".po") for path in _FOLDER.iterdir() if path.name.endswith(".po"))
    return ("en", *sorted(names))


def preferred(wanted: Iterable[str]) -> str:
    """Choose the first available of the languages `wanted`, or one near it ('de' for 'de_CH'); English if none is."""
    from babel.core import negotiate_locale

    names = [name.replace("-", "_") for name in wanted if name]
    return PSEUDO if PSEUDO.replace("-", "_") in names[:1] else negotiate_locale(names, languages(), sep="_") or "en"


def own_name(name: str) -> str:
    """Return the name of a language in that language, as 'Deutsch'; the code of the pseudo-language."""
    from babel import Locale

    return name if name == PSEUDO else str(Locale.parse(name).get_language_name() or name)


@cache
def language(name: str) -> Language:
    """Load a language by its name; reading its catalogue takes 0.1 to 0.15 s of processor time, once.

    Raises
    ------
    KeyError
        If there is no such language.
    """
    if name == "en":
        return ENGLISH
    if name == PSEUDO:
        return _Pseudo(PSEUDO)
    if name not in languages():
        raise KeyError(name)
    from babel import Locale
    from babel.messages.pofile import read_po
    from babel.numbers import get_decimal_symbol

    with (_FOLDER / f"{name}.po").open("rb") as file:
        catalog = read_po(file, locale=name)
    known = [(entry.context, entry.id, entry.string) for entry in catalog if entry.id and not entry.fuzzy]
    locale = Locale.parse(name)
    return Language(
        name,
        messages={code: _forms(texts) for code, _, texts in known if code and _forms(texts)},
        labels={str(english): str(text) for code, english, text in known if not code and text},
        plural_form=gettext.c2py(catalog.plural_expr),
        decimal=get_decimal_symbol(locale),
        conjunction=locale.list_patterns["standard"]["end"],
        separators=_separators(locale.list_patterns["standard"]["middle"].format("", "")),
        times=partial(_local_time, locale),
        days=partial(_local_day, locale),
    )


def _separators(comma: str) -> tuple[str, str]:
    """Both separators of a language, from that of its lists: Chinese ones have no space after them."""
    return comma, "; " if comma.endswith(" ") else "；"


def _local_time(locale: Locale, at: datetime, seconds: bool) -> str:
    """Date and time of day as they are written where a language is spoken: '24.11.2026, 11:32'."""
    from babel.dates import format_time

    time = format_time(at, "medium" if seconds else "short", locale=locale)
    return str(locale.datetime_formats["medium"]).format(time, _local_day(locale, at))


def _local_day(locale: Locale, on: date) -> str:
    from babel.dates import format_date

    return format_date(on, "medium", locale=locale)


def _forms(texts: str | Sequence[str] | None) -> str | tuple[str, ...]:
    """A message's text, or one for each plural form; "" where any is missing."""
    if isinstance(texts, str):
        return texts
    return tuple(texts) if texts and all(texts) else ""


class _Pseudo(Language):
    """English that can be told from English."""

    __slots__ = ()

    def _text(self, message: Message) -> str:
        return strange(super()._text(message)) if message.code else super()._text(message)

    def _label(self, english: str) -> str:
        return strange(english)


def strange(text: str) -> str:
    """Make the pseudo-translation of a text: letters accented, vowels doubled, brackets around it; its {places} stay.

    >>> strange("{n} of {m} frames")
    '⟦{n} óóf {m} fŕáámééš⟧'
    """
    parts = []
    for words, name, spec, _ in string.Formatter().parse(text):
        shown = "".join(
            part if place % 2 else _VOWELS.sub(r"\1\1", part).translate(_ACCENTS)
            for place, part in enumerate(_FIXED.split(words))
        )
        parts.append(shown.replace("{", "{{").replace("}", "}}"))
        if name is not None:
            parts.append(f"{{{name}{':' if spec else ''}{spec}}}")
    return f"⟦{''.join(parts)}⟧"
