"""What is told to people: a code that programs can rely on, the values in its places, and the text made of both.

Algorithms make a `Message` and nothing else; a `Language` turns it into text at the edge: window, command line, report,
``--json``. No logic looks at a text, and none decides by a code. The English text stands in the call; that of a note
on a result stands in the table of findings (`core.findings`), and the call is `note_of(code, values)`. `make
translations` reads both; other languages stand in ``resources/translations``, by the code.

Places are those of `str.format`: ``{rms_px:.3f} px``. A number is a value, never written into the text, so that each
language writes it in its own way. A sequence takes how it is joined as its format: ``{names}`` gives 'a, b, c',
``{names:and}`` 'a, b and c', ``{reasons:;}`` 'a; b'. A message that begins a sentence takes ``{reason:capital}``.
"""

from __future__ import annotations

import json
import math
import re
import string
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, datetime
from pathlib import PurePath
from types import MappingProxyType
from typing import Any

MINUS, NO_BREAK_SPACE = "\N{MINUS SIGN}", "\N{NO-BREAK SPACE}"


_CONTROLS = re.compile("[\\x00-\\x1f\\x7f-\\x9f\\u200e\\u200f\\u2028-\\u202e\\u2066-\\u2069\\ud800-\\udfff]")
"""Characters that a terminal obeys, that turn the direction of a text, or that no text can be written with."""


def visible(text: str, *, keep: str = "") -> str:
    """Replace the control characters in a text, but those in `keep`, by their codes."""
    return _CONTROLS.sub(lambda found: found[0] if found[0] in keep else ascii(found[0])[1:-1], text)


@dataclass(frozen=True, slots=True)
class Field:
    """Field of a file that people write, as a value: 'inner_corners in rig.toml'. A window names its own."""

    key: str
    """Dotted: ``camera_target.inner_corners``."""
    file: str = "rig.toml"
    whole: bool = False
    """Whether the file's name of it is the whole key: 'plane_target.kind in rig.toml'."""


@dataclass(frozen=True, slots=True)
class Command:
    """Command to type on the command line, as a value: ': trisect scan SET --out DIR'. In a window it is nothing."""

    text: str


class Message:
    """Text with a code and values, translated when it is shown.

    Parameters
    ----------
    code
        Names the message for good, ``room.what``: ``camera.few_views``. Unique in the program.
    text
        The English text with {places}.
    values
        What stands in the places: names, whole and real numbers (with the unit at the end of their names: `rms_px`),
        paths, times, `Field`, `Command`, fixed words (`label`), other messages, and sequences of these.

    Notes
    -----
    `str(message)` is the English text. A message that was read from a file has that file's text, and is put into
    another language by its code and values.
    """

    __slots__ = ("code", "many", "text", "values")
    code: str
    text: str
    many: str
    values: Mapping[str, Any]

    def __init__(self, code: str, text: str, /, **values: Any) -> None:
        self._set(code, text, "", values)

    def _set(self, code: str, text: str, many: str, values: Mapping[str, Any]) -> None:
        object.__setattr__(self, "code", code)
        object.__setattr__(self, "text", text)
        object.__setattr__(self, "many", many)
        object.__setattr__(self, "values", MappingProxyType({name: _frozen(value) for name, value in values.items()}))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a message cannot be changed: {name}")

    def __str__(self) -> str:
        return ENGLISH(self)

    def __repr__(self) -> str:
        return f"Message({self.code!r}, {str(self)!r})"

    def __eq__(self, other: object) -> bool:
        """Whether both tell the same; one read from a file has no places left in its English text."""
        return isinstance(other, Message) and self._parts() == other._parts()

    def __hash__(self) -> int:
        return hash((self.code, str(self)))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.code, self.text, self.many, dict(self.values))

    @property
    def is_sentence(self) -> bool:
        """Whether the message is a whole sentence, with a full stop; else it is a part of one."""
        return self.text.endswith(".")

    def with_values(self, change: Callable[[Any], Any]) -> Message:
        """Copy the message with each value replaced by what `change` returns for it."""
        return _restored(self.code, self.text, self.many, {name: change(one) for name, one in self.values.items()})

    def _parts(self) -> tuple[Any, ...]:
        return self.code, str(self), dict(self.values)


def plural_message(code: str, one: str, many: str, /, *, n: int, **values: Any) -> Message:
    """Make a message about `n` things, with the text `one` if `n` is 1 and `many` otherwise; {n} may be in both."""
    return _restored(code, one, many, {"n": n, **values})


def plain(text: str) -> Message:
    """Make a message of a text that is not this program's own: typed by a user, or read from elsewhere."""
    return Message("", text.replace("{", "{{").replace("}", "}}"))


class Label(str):
    """Fixed words, translated where they are in a message; a text like any other elsewhere."""

    __slots__ = ()


def label(english: str, /) -> str:
    """Return `english` unchanged: marks fixed words for the catalogues where no call that shows them holds them."""
    return Label(english)


def _restored(code: str, text: str, many: str, values: Mapping[str, Any]) -> Message:
    message = Message.__new__(Message)
    message._set(code, text, many, values)
    return message


def _frozen(value: Any) -> Any:
    """A value as a message keeps it: nothing that could be changed, nothing that only one library knows."""
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return tuple(_frozen(one) for one in value)
    return value.item() if hasattr(value, "item") else value


def iso_time(at: datetime, seconds: bool) -> str:
    """Format a time as '2026-11-24 11:32', with seconds if asked, as in English texts and files."""
    return f"{at:%Y-%m-%d %H:%M:%S}" if seconds else f"{at:%Y-%m-%d %H:%M}"


@dataclass(frozen=True, eq=False, slots=True)
class Language:
    """Language of a reader: how messages, numbers and times are written.

    Parameters
    ----------
    name
        ``en``, ``de``.
    messages
        By code: the text, or one text for each plural form.
    labels
        By the English text: fixed words that have no code.
    plural_form
        Which of the plural forms a number takes.
    decimal
        The decimal sign.
    conjunction
        How the last of several is joined to those before it: '{0} and {1}'.
    separators
        What stands between several: of a list, and of parts that are sentences themselves.
    times
        How date and time of day are written, with seconds or without.
    days
        How a date alone is written.
    fields
        What this reader calls the field of a file, by its key; others are called as in the file.
    commands
        Whether this reader types commands.
    """

    name: str = "en"
    messages: Mapping[str, str | tuple[str, ...]] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    plural_form: Any = None
    decimal: str = "."
    conjunction: str = "{0} and {1}"
    separators: tuple[str, str] = (", ", "; ")
    times: Callable[[datetime, bool], str] = iso_time
    days: Callable[[date], str] = date.isoformat
    fields: Mapping[str, str] = field(default_factory=dict)
    commands: bool = True

    def __call__(self, message: Message) -> str:
        """The text of a message, its places filled."""
        try:
            told = _Formatter(self).vformat(self._text(message), (), message.values)
        except KeyError:  # a file of an older version lacks a value that today's text tells
            told = _Formatter(self).vformat(message.text, (), message.values)
        return visible(told, keep="\n")

    def label(self, english: str, /, **values: Any) -> str:
        """Translate fixed words, with `values` in their places; English where this language does not have them."""
        text = self._label(english)
        return _Formatter(self).vformat(text, (), values) if values else text

    def number(self, value: float, spec: str = "") -> str:
        """Format a number by Python's format `spec`, with this language's decimal sign.

        It gets a true minus sign, and no-break spaces for ','.
        """
        return format(value, spec).translate(str.maketrans("-.,", f"{MINUS}{self.decimal}{NO_BREAK_SPACE}"))

    def numeral(self, digits: str) -> str:
        """Put this language's decimal sign and a true minus into a number that Python has written."""
        return digits.replace("-", MINUS).replace(".", self.decimal)

    def time(self, at: datetime, *, seconds: bool = False) -> str:
        """Format date and time of day as in this language, in the time zone that `at` is in."""
        return self.times(at, seconds)

    def day(self, on: date) -> str:
        """Format a date as in this language, without time of day."""
        return self.days(on)

    def joined(self, texts: Sequence[str], how: str = "") -> str:
        """Join texts by commas; by semicolons if `how` is ";", with "and" before the last if it is "and"."""
        comma, semicolon = self.separators
        if how == "and" and len(texts) > 1:
            return self.conjunction.format(comma.join(texts[:-1]), texts[-1])
        return (semicolon if how == ";" else comma).join(texts)

    def _label(self, english: str) -> str:
        return self.labels.get(english, english)

    def _text(self, message: Message) -> str:
        known = self.messages.get(message.code) if message.code else None
        n = message.values.get("n")
        if isinstance(known, tuple):
            return known[int(self.plural_form(n)) if self.plural_form else int(n != 1)]
        if known is not None:
            return known
        return message.many if message.many and n != 1 else message.text


_WITH_UNIT = re.compile(r"(?<=\d) (?=(mm²?|µm|µrad|mrad|rad|px|°C|K|%|ms|s|min|h|ppm)(?![^\W\u2e80-\uffff]))")
"""The space between a number and its unit; East Asian words follow without a space."""
_EQUATION = re.compile(r"(?<=\w) = (?=[+\-−±]?\d)")
"""The sign between a symbol and its number, as in U = 0.02 mm."""
_STANDARD = re.compile(r"(?<=\bISO) (?=\d)")
"""The space within the name of a standard, as in ISO 14253-1."""
_COUNTED = re.compile(r"(?<=\d) (?=[\u4e00-\u9fff])")
"""The space between a number and the Chinese measure word it counts in."""

_SPREAD = re.compile(r"(?<=[\d°]) (?=± ?\d)|(?<=±) (?=\d)")
"""The spaces round the sign between a value and its uncertainty, as in 5.002° ± 0.003°."""


def unparted(text: str) -> str:
    """Put no-break spaces where a text must not be broken: between a number and its unit, and the like."""
    for space in (_WITH_UNIT, _STANDARD, _COUNTED, _SPREAD):
        text = space.sub(NO_BREAK_SPACE, text)
    return _EQUATION.sub(f"{NO_BREAK_SPACE}={NO_BREAK_SPACE}", text)


def decimals_of(uncertainty: float) -> int:
    """Compute how many decimals show `uncertainty` with two significant digits (GUM 7.2.6); 3 if it is not positive."""
    if not math.isfinite(uncertainty) or uncertainty <= 0:
        return 3
    exponent = int(f"{uncertainty:.1e}".partition("e")[2])  # after rounding: 0.0996 is shown as 0.10
    return 1 - exponent


def capital(text: str) -> str:
    """Make the first letter of a text a capital, for the beginning of a sentence or a title."""
    return text[:1].upper() + text[1:]


class _Formatter(string.Formatter):
    """`str.format` with the values of messages."""

    def __init__(self, language: Language) -> None:
        self._language = language

    def format_field(self, value: Any, format_spec: str) -> str:
        language = self._language
        if isinstance(value, Message):
            text = language(value)
            return capital(text) if format_spec == "capital" else text
        if isinstance(value, Field):
            known = language.fields.get(value.key)
            name = value.key if value.whole else value.key.rpartition(".")[2]
            return known if known is not None else f"{name} in {value.file}"
        if isinstance(value, Command):
            return language.label("{name}: {value}", name="", value=value.text) if language.commands else ""
        if isinstance(value, Label):
            return language.label(value)
        if isinstance(value, datetime):
            return language.time(value)
        if isinstance(value, tuple):
            return language.joined([self.format_field(one, "") for one in value], format_spec)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return language.number(value, format_spec)
        return visible(format(value, format_spec))


ENGLISH = Language()
"""English as the command line says it."""


def as_json(message: Message) -> dict[str, Any]:
    """Convert a message to a table for JSON files that `from_json` reads: code, English text and values."""
    return {
        "code": message.code,
        "text": str(message),
        "values": {name: _json(v) for name, v in message.values.items()},
    }


def from_json(kept: Mapping[str, Any] | str) -> Message:
    """Read a message from the table of `as_json`, or from a bare text of an older file.

    Raises
    ------
    KeyError, TypeError
        If it is not what `as_json` wrote.
    """
    if isinstance(kept, str):
        return plain(kept)
    values = {str(name): _value(value) for name, value in kept["values"].items()}
    text = str(kept["text"]).replace("{", "{{").replace("}", "}}")
    return _restored(str(kept["code"]), text, "", values)


def as_text(message: Message | None) -> str:
    """Convert a message to one text that `from_text` reads, for files that hold texts alone; '' for None."""
    return "" if message is None else json.dumps(as_json(message), ensure_ascii=False)


def from_text(kept: str) -> Message | None:
    """Read a message from the text of `as_text`, or a bare sentence of an older file; None for ''.

    Raises
    ------
    KeyError, TypeError, ValueError
        If it is not what `as_text` wrote.
    """
    if not isinstance(kept, str):
        raise TypeError("a message is no text")
    if not kept:
        return None
    return from_json(json.loads(kept) if kept.startswith('{"code": ') else kept)


def _json(value: Any) -> Any:
    if isinstance(value, Message):
        return as_json(value)
    if isinstance(value, Field):
        return {"field": value.key, "file": value.file, "whole": value.whole}
    if isinstance(value, Command):
        return {"command": value.text}
    if isinstance(value, Label):
        return {"label": str(value)}
    if isinstance(value, datetime):
        return {"time": value.isoformat()}
    if isinstance(value, tuple):
        return [_json(one) for one in value]
    return value


def _value(kept: Any) -> Any:
    if isinstance(kept, list):
        return tuple(_value(one) for one in kept)
    if isinstance(kept, Mapping):
        if "field" in kept:
            return Field(str(kept["field"]), str(kept["file"]), bool(kept.get("whole")))
        if "label" in kept:
            return Label(kept["label"])
        if "time" in kept:
            return datetime.fromisoformat(kept["time"])
        return Command(str(kept["command"])) if "command" in kept else from_json(kept)
    return kept
