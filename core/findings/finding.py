"""How grave what is found about a result is, and what it does to all that rests on it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, StrEnum
from string import Formatter
from typing import Any

from core.messages import Message, plural_message


class Weight(IntEnum):
    """Gravity of a finding: notes are ordered and coloured by it."""

    INFORMATION = 0
    """Nothing is wrong."""
    CAUTION = 1
    """A result is less sure than it could be, or rests on something that the user has not stated."""
    GRAVE = 2
    """Something changed, moved or failed, or nothing is proven: said before all others, and in red."""


class Effect(StrEnum):
    """Effect of a finding on what rests on the result it is about; the values are in the manual."""

    NONE = "none"
    WIDENS_U = "widens U"
    NO_PROOF = "no proof"
    NO_RESULT = "no result"


@dataclass(frozen=True, slots=True)
class Finding:
    """Row of the table of findings (`core.findings.table`).

    Parameters
    ----------
    code
        Of the note that tells it.
    weight, effect
        How grave it is, and what it does.
    text, many
        The English text of the note with {places}, as of a `Message`; where it counts `n` things, that of a single one
        and that of any other number.
    fact
        Of what takes away a proof: the fact that does so, by its name in files, which is that of a field of
        `core.findings.proof.ScanFacts` if it is one of a scan.
    told_of
        The field of the record with the note that it tells of, where it has to be known which one: the note goes when
        that changes, and is not shown where the field itself is.

    Raises
    ------
    ValueError
        If nothing is proven, or there is no result, and it is not grave; if it takes away a proof by no fact that is
        named, or names one and takes away none.
    """

    code: str
    weight: Weight
    effect: Effect
    text: str
    many: str = ""
    fact: str = ""
    told_of: str = ""

    def __post_init__(self) -> None:
        if self.effect in (Effect.NO_PROOF, Effect.NO_RESULT) and self.weight != Weight.GRAVE:
            raise ValueError(f"{self.code} takes away a proof and is not grave")
        if bool(self.fact) != (self.effect == Effect.NO_PROOF):
            raise ValueError(f"{self.code} takes away a proof by no fact, or names a fact and takes away none")

    @property
    def places(self) -> frozenset[str]:
        """Names of the values that the note's text has places for, with that of the number it counts."""
        named = [name for text in (self.text, self.many) for _, name, _, _ in Formatter().parse(text) if name]
        return frozenset((*named, "n") if self.many else named)

    def note(self, **values: Any) -> Message:
        """Make the note on this finding, with `values` in the places of its text.

        Raises
        ------
        ValueError
            If the values are not those of its places.
        """
        if values.keys() != self.places:
            raise ValueError(f"{self.code} tells {sorted(self.places)}, not {sorted(values)}")
        if self.many:
            return plural_message(self.code, self.text, self.many, **values)
        return Message(self.code, self.text, **values)
