"""What a command says on standard error besides errors, and how much: `--quiet` nothing, `--verbose` more."""

from __future__ import annotations

import sys
from contextlib import suppress
from enum import IntEnum

from core.messages import visible


class Loudness(IntEnum):
    """Amount of output: quiet, normal or verbose."""

    QUIET = 0
    USUAL = 1
    VERBOSE = 2


_loudness = Loudness.USUAL


def choose(wanted: Loudness) -> None:
    """Set the loudness from now on."""
    global _loudness
    _loudness = wanted


def loudness() -> Loudness:
    """Return the loudness."""
    return _loudness


def is_quiet() -> bool:
    """Whether only errors are printed."""
    return _loudness is Loudness.QUIET


def is_verbose() -> bool:
    """Whether more than usual is printed."""
    return _loudness is Loudness.VERBOSE


def print_line(line: str) -> None:
    """Print a line, unless the command is quiet."""
    if not is_quiet():
        print_always(line)


def print_always(line: str) -> None:
    """Print a line even if the command is quiet: errors, and questions to the user."""
    with suppress(OSError):  # a terminal that was closed hears nothing
        sys.stderr.write(f"{visible(line)}\n")
        sys.stderr.flush()
