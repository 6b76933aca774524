"""The ways of locating sweeps: the one place where they are named. Light to import: command line and files need it."""

from __future__ import annotations

from enum import StrEnum


class Method(StrEnum):
    """How the sweeps of a scan are located; the value is its name in files and on the command line."""

    NETWORK = "network"
    """All sweeps adjusted together."""
    THREE_CROSSINGS = "three-crossings"
    """Each frame by itself, from its own crossings with the fan: Sun et al. 2023, section 4."""
