"""What the pages of both calibrations say in the same way."""

from __future__ import annotations

from typing import Any

from workbench.language import time_of, tr
from workbench.views.lists.value_rows import ValueRow


def used_row(name: str, views: tuple[Any, ...], tip: str) -> ValueRow:
    """How many of the pictures are used."""
    used = sum(view.used for view in views)
    return name, tr("{used} of {total}", used=used, total=len(views)), tip, ""


def history_row(entry: Any, accepted: str, *figures: str) -> tuple[str, ...]:
    """A kept calibration: when, its figures, whether in use."""
    return time_of(entry.kept_at), *figures, tr("in use") if entry.id == accepted else ""
