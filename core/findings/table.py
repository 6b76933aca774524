"""The table of findings: of every note its code, how grave it is, what it does to what rests on it, its text.

To add one: its row in the module of its subject (`of_camera`, `of_planes`, …), and a call of `note_of` with its code
where the fact is known. The order and colour of notes, the catalogues and the manual's page of messages come from the
rows; that nothing is proven comes from the facts (`core.findings.proof`), never from a note.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, TypeGuard

from core.door import Brought
from core.findings import of_artefacts, of_camera, of_part, of_pictures, of_planes, of_proof, of_rig, of_scan, of_views
from core.findings.finding import Finding, Weight
from core.messages import Message
from core.wing import rows_of_wings

_SUBJECTS = (of_camera, of_planes, of_rig, of_pictures, of_scan, of_part, of_artefacts, of_views, of_proof)
FINDINGS: Mapping[str, Finding] = {row.code: row for subject in _SUBJECTS for row in subject.ROWS}
"""By the code of the note; those of the wings are not among them: see `finding_of`."""
assert len(FINDINGS) == sum(len(subject.ROWS) for subject in _SUBJECTS)


def _why_unusable(code: str) -> Message:
    if not code:
        return Message("plugin.why_no_finding", "one of its findings is no Finding")
    return Message("plugin.why_code_taken", "the code of its finding {code} is taken", code=code)


def _is_finding(row: object) -> TypeGuard[Finding]:
    return isinstance(row, Finding)


@cache
def _of_wings() -> tuple[Mapping[str, Finding], tuple[Brought, ...]]:
    """The rows that wings add, by their codes, and those that cannot be used."""
    found, bad = rows_of_wings(lambda wing: wing.findings, _is_finding, lambda row: row.code, FINDINGS, _why_unusable)
    return {code: row for code, (row, _) in found.items()}, bad


def unusable_findings() -> tuple[Brought, ...]:
    """What wings name as findings and cannot be used: rows, or all of a wing, which then have no notes."""
    return _of_wings()[1]


def finding_of(code: str) -> Finding | None:
    """Find the finding, a row of the program's table or of a wing's, with this code; None if there is none.

    The wings are asked last: their modules may import those that tell findings of the house when they are imported.
    """
    return FINDINGS.get(code) or _of_wings()[0].get(code)


def all_findings() -> Mapping[str, Finding]:
    """Every row, of the house and of the wings, by its code."""
    return {**_of_wings()[0], **FINDINGS}


def note_of(code: str, /, **values: Any) -> Message:
    """Make the note on the finding with this `code`, with `values` in the places of its text.

    Raises
    ------
    KeyError
        If no row has the code.
    ValueError
        If the values are not those of the text's places.

    Examples
    --------
    >>> str(note_of("camera.few_views", n=4, least=6))
    'Only 4 views are used: take at least 6, better 10 to 15.'
    """
    row = finding_of(code)
    if row is None:
        raise KeyError(code)
    return row.note(**values)


def weight_of(note: Message) -> Weight:
    """Return the weight of a note's finding; for an unknown note the gravest within it, else CAUTION."""
    row = finding_of(note.code)
    told = [weight_of(one) for one in note.values.values() if isinstance(one, Message) and row is None]
    return max(told) if told else Weight.CAUTION if row is None else row.weight


def is_grave(note: Message) -> bool:
    """Whether a note has the greatest weight, GRAVE, so that it is shown first and in red."""
    return weight_of(note) == Weight.GRAVE


def fact_of(note: Message) -> str:
    """Return the name of the fact by which nothing is proven that a note's finding tells; "" if it tells none."""
    row = finding_of(note.code)
    return "" if row is None else row.fact


def without_notes_on(field: str, notes: Iterable[Message]) -> tuple[Message, ...]:
    """Remove those notes whose findings belong to the field called `field` of a record."""
    return tuple(note for note in notes if (row := finding_of(note.code)) is None or row.told_of != field)


def gravest_first(notes: Iterable[Message]) -> tuple[Message, ...]:
    """Sort notes by weight, the gravest first, in their order if alike; a repeated note is kept once."""
    return tuple(sorted(dict.fromkeys(notes), key=lambda note: -weight_of(note)))
