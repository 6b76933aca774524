"""One thing that is told of a result: its name, value, unit and digits, what it means, and whom it is for."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Literal, TypeAlias

from core.messages import NO_BREAK_SPACE, Message, capital, decimals_of
from core.report.wording import Words, grouped

Grade: TypeAlias = Literal["", "good", "warn", "bad"]
"""Whether a value is good, where that can be said."""
Value: TypeAlias = float | str | Message | None
"""A number (an `int` is counted), fixed words or a name, or a message; None: not known."""


class Reader(IntEnum):
    """Reader whom a fact is for: each reads those of the readers before as well."""

    TECHNICIAN = 1
    AUDITOR = 2
    METROLOGIST = 3


@dataclass(frozen=True, slots=True)
class Fact:
    """Fact of a result: its name, value, unit and meaning.

    Parameters
    ----------
    label
        What it is called: fixed words, in small letters where they are no name.
    value
        A number in `unit`, a share in %, or words; a name that people gave is a `plain` message, which stays as it is.
    unit
        "mm", "px", "°", "%"; "" for a pure number and for words.
    digits
        Decimals of a real number without an uncertainty; None: as it was stated, or `significant`.
    tip
        What it means, and how it is made; a whole sentence without its full stop.
    level
        Whom it is for.
    sd
        Standard uncertainty u in `unit`, shown as "(u = …)"; it decides how many decimals are shown.
    U
        Expanded uncertainty in `unit`, shown as "± …" in place of u; it decides how many decimals are shown.
    interval
        95 % confidence interval in `unit`.
    signed
        Whether a positive number has its sign.
    grade
        Whether it is good.
    significant
        Digits of a real number whose size is not known beforehand, as of a probability.
    above_zero
        Whether a number above zero is never shown as zero: "< 0.001".
    """

    label: str | Message
    value: Value
    unit: str = ""
    digits: int | None = None
    tip: str | Message = ""
    level: Reader = Reader.TECHNICIAN
    sd: float | None = None
    U: float | None = None
    interval: tuple[float, float] | None = None
    signed: bool = False
    grade: Grade = ""
    significant: int | None = None
    above_zero: bool = False

    @property
    def decimals(self) -> int | None:
        r"""Number of decimals to show: two significant digits of the uncertainty if there is one, else `digits`.

        Examples
        --------
        >>> Fact("flatness", 0.0123, "mm", 3, U=0.0421).decimals, Fact("flatness", 0.0123, "mm", 3).decimals
        (3, 3)
        >>> Fact("angle", 5.00213, "°", 3, sd=0.00021).text(Words())
        '5.00213° (u\xa0=\xa00.00021°)'
        """
        return decimals_of(self._uncertainty) if self._uncertainty else self.digits

    def title(self, words: Words) -> str:
        """Write the fact's name in the reader's language, with the coverage of its interval: 'Cg (95 %)'."""
        label = words.known(self.label)
        return label if self.interval is None else words("{quantity} (95 %)", quantity=label)

    def heading(self, words: Words) -> str:
        """Write the fact's name in the reader's language as a row's label, beginning with a capital letter."""
        return heading(self.title(words))

    def text(self, words: Words) -> str:
        r"""Write the fact's value, uncertainty, unit and interval as one text in the reader's language.

        Examples
        --------
        >>> Fact("U", 0.0421, "mm", 3).text(Words()), Fact("Cg", 1.5, digits=2, interval=(1.2, 1.84)).text(Words())
        ('0.042 mm', '1.50 (1.20 to 1.84)')
        >>> Fact("scans", 1204).text(Words()), Fact("thickness", 50.0021, "mm", 3, U=0.0199).text(Words())
        ('1\xa0204', '50.002 ± 0.020 mm')
        >>> Fact("alpha", 2410.42, "px", 2, sd=0.31).text(Words())
        '2410.42 px (u\xa0=\xa00.31 px)'
        """
        said, uncertainty = self.parts(words)
        if self.value is None or isinstance(self.value, (str, Message)):
            return said
        end = "°" if self.unit == "°" else ""
        after = f" {self.unit}" if self.unit and not end else end
        if self.U is not None:
            said = f"{said}{end} ± {uncertainty}{after}"
        elif uncertainty:
            said = f"{said}{after} (u{NO_BREAK_SPACE}={NO_BREAK_SPACE}{uncertainty}{after})"
        else:
            said = f"{said}{after}"
        if self.interval is None:
            return said
        low, high = (self._number(end, words) for end in self.interval)
        return words("{value} ({low} to {high})", value=said, low=low, high=high)

    def parts(self, words: Words) -> tuple[str, str]:
        r"""Write value and uncertainty, U or else u, as two cells of a table, without the unit; "" for none.

        Examples
        --------
        >>> Fact("alpha", 2410.42, "px", 2, sd=0.31).parts(Words())
        ('2410.42', '0.31')
        """
        if self.value is None:
            return words("not known"), ""
        if isinstance(self.value, (str, Message)):
            return words(self.value), ""
        known = self._uncertainty
        return self._number(self.value, words), "" if known is None else self._number(known, words, signed=False)

    def column(self, words: Words) -> str:
        """Write the fact's name with its unit, as the head of a table's column."""
        title = self.title(words)
        return words.in_unit(title, self.unit) if self.unit else title

    @property
    def _uncertainty(self) -> float | None:
        return self.sd if self.U is None else self.U

    def _number(self, value: float, words: Words, *, signed: bool | None = None) -> str:
        signed = self.signed if signed is None else signed
        if isinstance(value, int):
            return words.numeral(f"{value:+d}") if signed else grouped(value)
        if math.isinf(value):
            return "∞" if value > 0 else words.numeral("-∞")
        if self.significant is not None:
            value = float(f"{value:.{self.significant}g}")
        decimals = self.decimals
        if decimals is None:
            return words.general(value)
        least = 10.0**-decimals
        if self.above_zero and 0 < value < least / 2:
            return f"<{NO_BREAK_SPACE}{words.fixed(least, decimals)}"
        return words.fixed(value, decimals, signed=signed)


def heading(name: str) -> str:
    """Capitalise a name for the head of a row or column, unless it begins with a symbol of one letter, as "s (n − 1)".

    Examples
    --------
    >>> heading("largest error"), heading("s (n − 1)"), heading("k₁"), heading("σ, 95 % below")
    ('Largest error', 's (n − 1)', 'k₁', 'σ, 95 % below')
    """
    return capital(name) if name[1:2].isalpha() else name


def for_reader(facts: Iterable[Fact], reader: Reader) -> tuple[Fact, ...]:
    """Select the facts meant for the reader `reader` or for readers with less knowledge."""
    return tuple(fact for fact in facts if fact.level <= reader)


def named(of: str | Message, facts: Iterable[Fact]) -> tuple[Fact, ...]:
    """Prefix the name of each fact with the result `of` that it belongs to: 'ball, diameter'."""
    return tuple(replace(fact, label=Message("told.named", "{of}, {name}", of=of, name=fact.label)) for fact in facts)
