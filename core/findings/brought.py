"""Notes on what other packages bring, where it fails or cannot be used."""

from __future__ import annotations

from core import __version__
from core.door import Brought, Origin
from core.findings.table import note_of
from core.messages import Message

OURS = Origin("trisect", __version__)
"""The program itself, as the package of its own wings."""


def failure(origin: Origin, name: str, error: Exception) -> Message:
    """Make the message that code of an installed package failed with `error`; `name` is what it brings."""
    return Message(
        "plugin.failed",
        "{name} of the package {package} {version} failed: {why}",
        name=name,
        package=origin.package,
        version=origin.version,
        why=f"{type(error).__name__}: {error}",
    )


def unusable(name: str, origin: Origin, why: Message | str) -> Message:
    """Make the note that what a package brings as `name` cannot be used, and why."""
    return note_of("plugin.unusable", name=name, package=origin.package, version=origin.version, why=why)


def note_on_unusable(brought: Brought) -> Message:
    """Make the note that an installed package's entry point, or one of the program's own folders, cannot be used."""
    return unusable(brought.name, brought.origin or OURS, brought.why)
