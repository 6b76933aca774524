"""Results of a study that prove nothing by themselves, whatever their uncertainty: nor does the study."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TypeAlias

from core.findings.proof import Doubt, Doubts, notes_of
from core.findings.table import note_of
from core.messages import Message


class DoubtedResult(NamedTuple):
    """Result that has doubts, by its label in the study."""

    label: str
    doubts: Doubts


Doubted: TypeAlias = tuple[DoubtedResult, ...]


def doubted_among(results: Iterable[tuple[str, Doubts]]) -> Doubted:
    """Select the results that have doubts, reasons why they prove nothing, from pairs of label and doubts."""
    found: dict[str, dict[Doubt, None]] = {}
    for label, doubts in results:
        if doubts:
            found.setdefault(label, {}).update(dict.fromkeys(doubts))
    return tuple(DoubtedResult(label, tuple(doubts)) for label, doubts in found.items())


def doubts_of_study(doubted: Doubted) -> Doubts:
    """Make the doubt of a study that rests on results with doubts, and so proves nothing; () if there are none.

    Examples
    --------
    >>> (doubt,) = doubts_of_study((DoubtedResult("scan 2", (Doubt.named("moved"),)),))
    >>> str(doubt.note)
    'By their own results scan 2 (something moved during the scan) prove nothing, and so the study does not.'
    """
    if not doubted:
        return ()
    names = [
        Message("study.doubted_result", "{label} ({why:;})", label=one.label, why=notes_of(one.doubts))
        for one in doubted
    ]
    return (Doubt.of(note_of("study.doubted", names=names)),)
