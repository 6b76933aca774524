"""Which buttons of the repeats can be pressed, told by plain facts; every reason is a sentence, or ""."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from workbench.language import tr


@dataclass(frozen=True, slots=True)
class RepeatsFacts:
    """What they rest on."""

    no_surface: str
    """Why no scan is shown."""
    stale: bool
    """What is shown is the one before: a newer one is being read."""
    thickness: bool
    """What is shown has one."""
    scan_old: bool
    """The scan is out of date."""
    outdated: bool
    """The thickness is."""
    among: bool
    """This scan is among the repeats already."""
    some: bool
    """There are repeats."""
    chosen: bool
    """One of them is."""


class RepeatsButtons(NamedTuple):
    """Why each button is grey."""

    add: str
    remove: str
    copy: str


def repeats_buttons(facts: RepeatsFacts) -> RepeatsButtons:
    """What can be done with the repeats."""
    none = "" if facts.some else tr("There are no repeats yet.")
    choose = "" if facts.chosen else tr("Choose a repeat in the table first.")
    return RepeatsButtons(_why_not_add(facts), none or choose, none)


def _why_not_add(facts: RepeatsFacts) -> str:
    if facts.no_surface:
        return facts.no_surface
    if facts.stale:
        return tr("The scan is being read.")
    if not facts.thickness:
        return tr("Measure the thickness first.")
    if facts.scan_old:
        return tr("The scan is out of date: measure it again first, on the page before.")
    if facts.outdated:
        return tr("The thickness is out of date: measure it again first.")
    if facts.among:
        return tr(
            "This scan is among the repeats already. A repeat is another scan of the part: measuring the same "
            "pictures again says nothing about how well the measurement repeats."
        )
    return ""
