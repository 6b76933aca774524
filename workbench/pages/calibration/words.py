"""What the pages of both calibrations say in the same way."""

from __future__ import annotations

import math
from typing import Any

from workbench.language import tr
from workbench.views.lists.value_rows import ValueRow


def length(value: float, unit: str, digits: int = 3) -> str:
    """A length in px or mm; a dash for NaN."""
    return "–" if math.isnan(value) else f"{value:.{digits}f} {unit}"


def px(value: float) -> str:
    """A length in pixels."""
    return length(value, "px")


def mm(value: float, digits: int = 3) -> str:
    """A length in millimetres."""
    return length(value, "mm", digits)


def used_row(name: str, views: tuple[Any, ...], tip: str) -> ValueRow:
    """How many of the pictures are used."""
    used = sum(view.used for view in views)
    return name, tr("{used} of {total}", used=used, total=len(views)), tip, ""


def history_row(entry: Any, accepted: str, *figures: str) -> tuple[str, ...]:
    """A kept calibration: when, its figures, whether in use."""
    when = entry.kept_at.astimezone().strftime("%Y-%m-%d %H:%M")
    return when, *figures, tr("in use") if entry.id == accepted else ""
