"""What a command says on standard error besides errors, and how much: `--quiet` nothing, `--verbose` more."""

from __future__ import annotations

import sys
from contextlib import suppress
from enum import IntEnum

from core.messages import visible


class Loudness(IntEnum):
    """How much is said."""

    QUIET = 0
    USUAL = 1
    VERBOSE = 2


_loudness = Loudness.USUAL


def choose(wanted: Loudness) -> None:
    """Say so much from now on."""
    global _loudness
    _loudness = wanted


def loudness() -> Loudness:
    """How much is said."""
    return _loudness


def is_quiet() -> bool:
    """Whether nothing but errors is said."""
    return _loudness is Loudness.QUIET


def is_verbose() -> bool:
    """Whether more than usual is said."""
    return _loudness is Loudness.VERBOSE


def say(line: str) -> None:
    """Say a line, unless the command is to be quiet."""
    if not is_quiet():
        say_aloud(line)


def say_aloud(line: str) -> None:
    """Say a line whatever was asked for: errors, and what a person has to answer."""
    with suppress(OSError):  # a terminal that was closed hears nothing
        sys.stderr.write(f"{visible(line)}\n")
        sys.stderr.flush()
