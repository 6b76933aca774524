"""Notes on what other packages bring, where it fails or cannot be used."""

from __future__ import annotations

from core import __version__
from core.door import Brought, Origin
from core.findings.table import note_of
from core.messages import Message

OURS = Origin("trisect", __version__)
"""The program itself, as the package of its own wings."""


def failure(origin: Origin, name: str, error: Exception) -> Message:
    """Make the message that a package's code failed."""
    return Message(
        "plugin.failed",
        "{name} of the package {package} {version} failed: {why}",
        name=name,
        package=origin.package,
        version=origin.version,
        why=f"{type(error).__name__}: {error}",
    )


def unusable(name: str, origin: Origin, why: Message | str) -> Message:
    """Make the note that something a package brings cannot be used at all."""
    return note_of("plugin.unusable", name=name, package=origin.package, version=origin.version, why=why)


def note_on_unusable(brought: Brought) -> Message:
    """Make the note on an entry point, or a folder of ours, that cannot be used."""
    return unusable(brought.name, brought.origin or OURS, brought.why)
