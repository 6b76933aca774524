"""Which files are read: each is told once to who wants to know it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

_listener: Callable[[Path], None] | None = None
_told: set[Path] = set()


def listen(listener: Callable[[Path], None] | None) -> None:
    """Have each file told that is read from now on; None: no file is told."""
    global _listener
    _listener = listener
    _told.clear()


def tell(path: Path) -> None:
    """A file is read."""
    if _listener is not None and path not in _told:
        _told.add(path)
        _listener(path)
