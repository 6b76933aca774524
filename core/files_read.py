"""Which files are read: each is told once to who wants to know it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

_listener: Callable[[Path], None] | None = None
_told: set[Path] = set()


def listen(listener: Callable[[Path], None] | None) -> None:
    """Set the function that is called with the path of each file when it is first read from now on; None sets none."""
    global _listener
    _listener = listener
    _told.clear()


def report_read(path: Path) -> None:
    """Call the function set by `listen`, if there is one, with `path`, a file that is read; once for each file."""
    if _listener is not None and path not in _told:
        _told.add(path)
        _listener(path)
