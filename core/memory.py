"""Memory that is free again, given back to the system: C libraries keep it for what the process may ask for next."""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress


def give_back() -> None:
    """Return free memory to the system where the C library can do so on request (glibc)."""
    if sys.platform == "linux":
        with suppress(OSError, AttributeError):  # another library than glibc
            ctypes.CDLL(None).malloc_trim(0)
