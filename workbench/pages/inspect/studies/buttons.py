"""Which buttons of the studies can be pressed, told by plain facts; every reason is a sentence, or ""."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from workbench.language import tr


@dataclass(frozen=True, slots=True)
class StudiesFacts:
    """What they rest on."""

    busy: str
    """What is being read or worked out for a study; "": nothing."""
    cannot_write: str
    """Why no study can be kept in the project."""
    no_type1: str
    """Why the repeats give no type-1 study."""
    chosen: bool
    """A study of the list is."""
    rows: bool
    """The table of the study being made has more than its head."""


class StudiesButtons(NamedTuple):
    """Why each button is grey; a study being made can be given up at any time."""

    begin: str
    type1: str
    remove: str
    export: str
    read: str
    """Open a table, or add a project to it."""
    make: str


def studies_buttons(facts: StudiesFacts) -> StudiesButtons:
    """What can be done with the studies, and with the one being made."""
    busy = tr("Wait for what is under way: {what}.", what=facts.busy) if facts.busy else ""
    choose = "" if facts.chosen else tr("Choose a study in the list first.")
    rows = "" if facts.rows else tr("Enter or paste measurements into the table first.")
    return StudiesButtons(
        begin=facts.cannot_write or busy,
        type1=facts.cannot_write or facts.no_type1 or busy,
        remove=choose or busy,
        export=choose or busy,
        read=busy,
        make=facts.cannot_write or busy or rows,
    )
