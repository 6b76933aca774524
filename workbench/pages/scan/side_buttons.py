"""Which buttons beside the scan can be pressed, told by plain facts: those of the Check card, and of fixed lines alone.

Every reason is a sentence, or "" where nothing speaks against it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from workbench.language import tr


@dataclass(frozen=True, slots=True)
class CheckFacts:
    """What the Check card's buttons rest on."""

    taking: bool
    """Pictures of the check are being taken."""
    stopping: bool
    """Stop was pressed; the source is not closed yet."""
    cannot_take: str
    """Why none can be taken, apart from these."""
    checking: bool
    cannot_check: str
    cannot_readjust: str
    moved: bool
    """The check of the pictures in force says that something has changed."""


class CheckButtons(NamedTuple):
    """Why each button is grey; `readjust` is None where it is not shown."""

    take: str
    """Take pictures; Stop while they are being taken."""
    choose: str
    run: str
    """Check; Cancel while it is being checked."""
    readjust: str | None


def check_buttons(facts: CheckFacts) -> CheckButtons:
    """What can be done on the Check card."""
    taken = tr("Pictures of the check are being taken.") if facts.taking else ""
    cannot_start = "" if facts.taking else facts.cannot_take
    return CheckButtons(
        take=tr("Stopping …") if facts.stopping else cannot_start,
        choose=taken,
        run="" if facts.checking else taken or facts.cannot_check,
        readjust=facts.cannot_readjust if facts.moved and not facts.taking else None,
    )


@dataclass(frozen=True, slots=True)
class ProfilesFacts:
    """What measuring by the fixed lines alone rests on."""

    measuring: bool
    cannot: str
    """Why the scan cannot be measured: without the same things these pictures cannot."""


def why_not_profiles(facts: ProfilesFacts) -> str:
    """Why nothing can be measured by the fixed lines."""
    return tr("The pictures are being measured.") if facts.measuring else facts.cannot
