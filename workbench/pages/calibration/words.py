"""What the pages of both calibrations say in the same way."""

from __future__ import annotations

from typing import Any

from core.calibrate.grades import Grade, Limit
from workbench.language import time_of, tr
from workbench.views.colours import Level
from workbench.views.lists.value_rows import ValueRow

LEVELS: dict[Grade, Level] = {Grade.GOOD: "good", Grade.FAIR: "warn", Grade.POOR: "bad"}
"""How grades are shown."""


def graded_row(name: str, text: str, tip: str, value: float, limit: Limit, limits: tuple[str, str]) -> ValueRow:
    """A value with its grade; its tip tells the `limits`, from where on it is good and below which it is poor."""
    good, poor = limits
    said = tr("{what}. Good from {good} on, poor below {poor}", what=tip, good=good, poor=poor)
    return name, text, said, LEVELS[limit.grade(value)]


def used_row(name: str, views: tuple[Any, ...], tip: str, limit: Limit) -> ValueRow:
    """How many of the pictures are used, and whether they are enough."""
    used = sum(view.used for view in views)
    text, limits = tr("{used} of {total}", used=used, total=len(views)), (f"{limit.good:.0f}", f"{limit.poor:.0f}")
    return graded_row(name, text, tip, used, limit, limits)


def history_row(entry: Any, accepted: str, *figures: str) -> tuple[str, ...]:
    """A kept calibration: when, its figures, whether in use."""
    return time_of(entry.kept_at), *figures, tr("in use") if entry.id == accepted else ""
