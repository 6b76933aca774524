"""Which files are read: each is told once to who wants to know it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

_listener: Callable[[Path], None] | None = None
_told: set[Path] = set()


def listen(listener: Callable[[Path], None] | None) -> None:
    """Call `listener` with each file that is read from now on; None: call nothing."""
    global _listener
    _listener = listener
    _told.clear()


def report_read(path: Path) -> None:
    """Report to the listener that a file is read."""
    if _listener is not None and path not in _told:
        _told.add(path)
        _listener(path)
