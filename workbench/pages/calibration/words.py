"""What the pages of both calibrations say in the same way."""

from __future__ import annotations

from typing import Any

from workbench.language import time_of, tr


def history_row(entry: Any, accepted: str, *figures: str) -> tuple[str, ...]:
    """A kept calibration: when, its figures, whether in use."""
    return time_of(entry.kept_at), *figures, tr("in use") if entry.id == accepted else ""
