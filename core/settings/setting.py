"""What the program knows of a setting besides what it does: the entries of `core.settings.options`.

All of it is data that takes no time to import: project.json is checked by it, the commands get their flags and the
pages of the window their forms from it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields, replace
from typing import Any, TypeAlias, TypeVar

from core.messages import Message

T = TypeVar("T")
_KEY = "setting"
"""Where a field of a dataclass keeps its setting."""


@dataclass(frozen=True, slots=True)
class Number:
    """Kind of a setting: a number above `above`, or `also_at` it, and at most `most`.

    `stated` is what a file that holds another one is told that it must be. In a form it is entered from `least` to
    `largest`, with so many `decimals`; the arrow keys go on by `step`. Where it may be left out, `none` are the words
    for that, and `first` is where it begins when one is wanted.
    """

    above: float
    most: float
    stated: str
    unit: str
    least: float
    largest: float
    decimals: int
    step: float
    none: str = ""
    first: float | None = None
    also_at: bool = False


@dataclass(frozen=True, slots=True)
class Choice:
    """Kind of a setting: one of `values`; `shown` are their words in a form, `stated` as of a Number.

    `type` makes the value of what a file holds: an enumeration.
    """

    values: tuple[Any, ...]
    shown: tuple[str, ...] = ()
    stated: str = ""
    type: Callable[[Any], Any] | None = None


@dataclass(frozen=True, slots=True)
class Whether:
    """Kind of a setting: yes or no."""


@dataclass(frozen=True, slots=True)
class Text:
    """Kind of a setting: a line of text."""


@dataclass(frozen=True, slots=True)
class Names:
    """Kind of a setting: a set of names that match a `pattern`; `stated` as of a Number."""

    pattern: str
    stated: str


@dataclass(frozen=True, slots=True)
class Values:
    """Kind of a setting: an object of several settings by their names, of the class `type`; `optional`: or None."""

    type: type
    settings: Mapping[str, Setting]
    optional: bool = False
    stated: str | None = None


Kind: TypeAlias = Number | Choice | Whether | Text | Names | Values


@dataclass(frozen=True, slots=True)
class Flag:
    """Flag of a setting on the command line: its names, as "--skew/--no-skew", and the name of its value in help."""

    name: str
    help: str
    value: str | None = None
    none: Any = None
    """What is typed, or left, where nothing is stated."""

    @property
    def word(self) -> str:
        """First name of the flag as a parameter of a function: "stripe_width" of "--stripe-width"."""
        return self.name.partition("/")[0].removeprefix("--").replace("-", "_")


@dataclass(frozen=True, slots=True)
class Setting:
    """Setting with its kind, unit, words and flag. Texts are English words that the readers translate.

    Parameters
    ----------
    kind
        What its value is.
    steps
        Those whose result rests on it, and whose commands take its flag.
    title, help
        In forms: what it is called, what it does. Without a title it is in none.
    flag
        On the command line; None: it cannot be typed.
    refused
        The complaint about a value out of range.
    reported
        What the report calls it, and how it words its value; None: the report does not tell it.
    in_file
        Whether project.json holds it.
    keyed
        Whether the key of the step's result holds it even where it is as usual, as it did from the first version on.
    """

    kind: Kind
    steps: tuple[str, ...] = ()
    title: str = ""
    help: str = ""
    flag: Flag | None = None
    refused: Callable[[Any], Message] | None = None
    reported: tuple[str, Callable[[Any], Message | str]] | None = None
    in_file: bool = True
    keyed: bool = False

    def complaint(self, value: Any) -> Message | None:
        """Make the sentence why the setting cannot have this `value`; None if it can."""
        possible = True
        if isinstance(self.kind, Number):
            possible = self.kind.above < value <= self.kind.most
        elif isinstance(self.kind, Choice):
            possible = value in self.kind.values
        return None if possible or self.refused is None else self.refused(value)


def described(kind: Kind, **known: Any) -> Mapping[str, Setting]:
    """Make the metadata by which a dataclass's field is a setting of this `kind`; `known` are fields of `Setting`."""
    return {_KEY: Setting(kind, **known)}


@dataclass(frozen=True, slots=True)
class Row:
    """Setting at its place in a table, as ("camera", "skew") in the options, with its default."""

    path: tuple[str, ...]
    setting: Setting
    default: Any

    @property
    def key(self) -> str:
        """Name of the setting without the table it is in, as forms use it."""
        return self.path[-1]

    @property
    def is_one(self) -> bool:
        """Whether files have the setting as one value, and not as the several settings it consists of."""
        return not isinstance(self.setting.kind, Values) or self.setting.kind.optional

    def value(self, table: Any) -> Any:
        """Return the setting's value in `table`; None if the table within it that holds the setting is None."""
        for name in self.path:
            table = None if table is None else getattr(table, name)
        return table

    def changed(self, table: T, value: Any) -> T:
        """Return a copy of `table` in which the setting has this `value`."""
        first, *within = self.path
        if within:
            value = replace(getattr(table, first), **{within[0]: value})
        return replace(table, **{first: value})  # type: ignore[type-var]


def rows(table: type) -> tuple[Row, ...]:
    """List the settings of a dataclass in its order, without those of which one of them consists."""
    return tuple(Row((one.name,), one.metadata[_KEY], one.default) for one in fields(table) if _KEY in one.metadata)


def rows_within(row: Row) -> tuple[Row, ...]:
    """List the settings that a setting consists of; the setting itself if it is a single value."""
    kind = row.setting.kind
    if not isinstance(kind, Values):
        return (row,)
    usual = {one.name: None if one.default is MISSING else one.default for one in fields(kind.type)}
    return tuple(Row((*row.path, name), one, usual[name]) for name, one in kind.settings.items())
