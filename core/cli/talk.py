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
    """Set how much is printed from now on."""
    global _loudness
    _loudness = wanted


def loudness() -> Loudness:
    """Return how much is printed: quiet, normal or verbose."""
    return _loudness


def is_quiet() -> bool:
    """Whether nothing but errors and questions is printed on standard error (`--quiet`)."""
    return _loudness is Loudness.QUIET


def is_verbose() -> bool:
    """Whether more than usual is printed on standard error (`--verbose`)."""
    return _loudness is Loudness.VERBOSE


def print_line(line: str) -> None:
    """Print a line on standard error, unless the command is quiet."""
    if not is_quiet():
        print_always(line)


def print_always(line: str) -> None:
    """Print a line on standard error even if the command is quiet, as errors and questions."""
    with suppress(OSError):  # a terminal that was closed hears nothing
        sys.stderr.write(f"{visible(line)}\n")
        sys.stderr.flush()
