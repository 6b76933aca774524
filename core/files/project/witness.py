"""Witnesses: wings that are told of what is written into a project, at each place where the house writes there.

A project that has a trail of its changes says so by `TRAIL`. Where no wing goes on with it nothing is changed: a gap
in the trail could not be told from a change that was hidden.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol

from core.door import found_at
from core.errors import InputError
from core.files.project.data import ProjectFile
from core.findings.brought import OURS, failure
from core.messages import Message
from core.wing import AUDIT, why_away, wings

if TYPE_CHECKING:
    from core.report.content import Evidence

TRAIL = "audit.jsonl"
"""The file in which a wing keeps the trail of a project's changes."""
PEOPLE = "people.json"
"""The file in which it keeps who may change what in the project."""


class Signed(Protocol):
    """Person who has signed in, with name and role."""

    @property
    def name(self) -> str:
        """Name of the person."""
        ...

    @property
    def role(self) -> str:
        """Role of the person in the project."""
        ...


@dataclass(frozen=True, slots=True)
class Written:
    """Change that is about to be written into a project.

    Parameters
    ----------
    what
        What is written: project.json ("created", "saved", "packed"), results ("measured", "reported"), who has it open
        ("taken over"), or all files of the next part's project ("next part").
    before, after
        The project's states before and after; None: there is none, or it stays.
    text
        What project.json is to say; "" where it stays.
    why, by
        The reason given for it, and who has signed in.
    of
        The project that a packed one, or that of the next part, is made of.
    """

    what: Literal["created", "saved", "packed", "measured", "reported", "taken over", "next part"]
    before: ProjectFile | None = None
    after: ProjectFile | None = None
    text: str = ""
    why: str = ""
    by: Signed | None = None
    of: Path | None = None


@dataclass(frozen=True, slots=True)
class Witness:
    """Functions of a wing that is told of changes.

    Parameters
    ----------
    sees
        Makes the block in which a change is written into the project in a folder: it is told before and after.
    evidence
        What the report prints of the project in a folder; None: nothing.
    """

    sees: Callable[[Path, Written], AbstractContextManager[None]]
    evidence: Callable[[Path], Evidence | None]


@contextmanager
def witnessed(folder: Path, written: Written) -> Iterator[None]:
    """Tell every witness before and after the block that writes a change into the project in `folder`.

    Raises
    ------
    InputError
        If a wing that is a witness cannot be used, or the project's trail has no witness: nothing may be written then.
    """
    for place in filter(None, (folder, written.of)):
        if (refused := unwitnessed(place)) is not None:
            raise refused
    with ExitStack() as stack:
        for witness in _witnesses(folder):
            stack.enter_context(witness.sees(folder, written))
        yield


def unwitnessed(folder: Path) -> InputError | None:
    """Return the error that the project in `folder` has a trail and its wing is away; None if it may change.

    A witness of another package does not write the trail.
    """
    goes_on = any(wing.name == AUDIT and wing.witness and origin is None for wing, origin in wings().wings)
    if goes_on or not (folder / TRAIL).exists():
        return None
    why, todo = why_away(AUDIT)
    what = Message(
        "project.unwitnessed",
        "nothing of it can be changed, as its changes stand in {trail}, which is written by the wing {name}, {why}",
        trail=TRAIL,
        name=AUDIT,
        why=why,
    )
    return InputError(what, where=folder, todo=todo)


def evidence_of(folder: Path) -> tuple[Evidence, ...]:
    """Collect what witnesses have the report print of the project in `folder`."""
    return tuple(one for witness in _witnesses(folder) if (one := witness.evidence(folder)) is not None)


def _witnesses(folder: Path) -> Iterator[Witness]:
    for wing, origin in wings().wings:
        if wing.witness:
            try:
                witness: Any = found_at(wing.witness)
            except Exception as error:  # whatever a stranger's module raises: no change goes by unseen
                raise InputError(failure(origin or OURS, wing.name, error), where=folder) from error
            yield witness
