"""Which buttons of a live source can be pressed, told by plain facts; every reason is a sentence, or ""."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from workbench.language import tr


@dataclass(frozen=True, slots=True)
class LiveFacts:
    """Facts from which the buttons follow."""

    running: bool
    """From start until the source is closed."""
    named: bool
    """It has said what it is: pictures come."""
    stopping: bool
    cannot_start: str
    """Why it cannot be started, apart from these."""


class LiveButtons(NamedTuple):
    """Reason for each disabled button, or ""."""

    start: str
    """Start; Stop while it runs."""
    steer: str
    """Pause, take a picture, mark a frame."""


def live_buttons(facts: LiveFacts) -> LiveButtons:
    """Derive why each button of the live source is disabled; "" for each that is enabled."""
    if not facts.running:
        return LiveButtons(facts.cannot_start, tr("Start the live source first."))
    if facts.stopping:
        return LiveButtons(tr("Stopping …"), tr("Stopping …"))
    return LiveButtons("", "" if facts.named else tr("Opening the source …"))
