"""How grave what is found about a result is, and what it does to all that rests on it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, StrEnum


class Weight(IntEnum):
    """How grave a finding is: by it notes are ordered and coloured."""

    INFORMATION = 0
    """Nothing is wrong."""
    CAUTION = 1
    """A result is less sure than it could be, or rests on something that the user has not stated."""
    GRAVE = 2
    """Something changed, moved or failed, or nothing is proven: said before all others, and in red."""


class Effect(StrEnum):
    """What a finding does to what rests on the result it is about; the values stand in the manual."""

    NONE = "none"
    WIDENS_U = "widens U"
    NO_PROOF = "no proof"
    NO_RESULT = "no result"


@dataclass(frozen=True, slots=True)
class Finding:
    """One row of the table of findings (`core.findings.table`).

    Parameters
    ----------
    code
        Of the message that tells it.
    weight, effect
        How grave it is, and what it does.

    Raises
    ------
    ValueError
        If nothing is proven, or there is no result, and it is not grave.
    """

    code: str
    weight: Weight
    effect: Effect = Effect.NONE

    def __post_init__(self) -> None:
        if self.effect in (Effect.NO_PROOF, Effect.NO_RESULT) and self.weight != Weight.GRAVE:
            raise ValueError(f"{self.code} takes away a proof and is not grave")
