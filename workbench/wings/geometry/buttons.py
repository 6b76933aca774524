"""Why each button of the comparison is disabled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from workbench.language import tr


@dataclass(frozen=True, slots=True)
class ComparisonFacts:
    """Facts from which the buttons of the comparison follow."""

    no_surface: str
    """Why there is no scan to compare."""
    cannot_write: str
    """Why nothing can be kept among the results."""
    running: bool
    shown: bool
    """One is shown."""


class ComparisonButtons(NamedTuple):
    """Reason for each disabled button, or ""."""

    compare: str
    take_away: str
    look: str
    """Choose what is seen of it."""


def comparison_buttons(facts: ComparisonFacts) -> ComparisonButtons:
    """Derive why each button of the comparison is disabled; "" for each that is enabled."""
    busy = tr("The surfaces are being compared.") if facts.running else ""
    none = "" if facts.shown else tr("Compare with another surface first.")
    return ComparisonButtons(
        facts.no_surface or facts.cannot_write or busy, busy or none or facts.cannot_write, busy or none
    )
