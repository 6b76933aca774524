"""Which buttons of the features can be pressed, told by plain facts; every reason is a sentence, or ""."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from workbench.language import tr


@dataclass(frozen=True, slots=True)
class FeaturesFacts:
    """What they rest on."""

    no_scan: str
    """Why there is no scan to be measured."""
    cannot_write: str
    """Why nothing can be measured into the project."""
    measured: bool
    """There is a result: of a plan that was emptied since it goes by measuring."""
    measuring: bool
    count: int
    """How many features there are."""
    place: int
    """Of the chosen one, from 0; −1: none is."""
    cannot_remove: str
    """Why the chosen one cannot be taken out: what rests on it."""


class FeaturesButtons(NamedTuple):
    """Why each button is grey."""

    measure: str
    remove: str
    up: str
    down: str
    save: str
    """Save the plan as a template."""


def features_buttons(facts: FeaturesFacts) -> FeaturesButtons:
    """What can be done with the features."""
    none = "" if facts.count else tr("Add a feature first.")
    choose = "" if facts.place >= 0 else tr("Choose a feature first.")
    return FeaturesButtons(
        measure=facts.no_scan
        or facts.cannot_write
        or ("" if facts.measured else none)
        or (tr("The features are being measured.") if facts.measuring else ""),
        remove=choose or facts.cannot_remove,
        up=choose or ("" if facts.place else tr("It is the first.")),
        down=choose or ("" if facts.place < facts.count - 1 else tr("It is the last.")),
        save=none,
    )
