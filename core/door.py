"""The door by which packages bring what the program does not import: their entry points, and folders of our own.

A package names what it brings under a group of entry points in its pyproject.toml. Our own wings are the folders of a
package of wings: found without being installed anew, in the packed program as well, and gone with their folder. Light
to import.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pkgutil import iter_modules
from typing import Any

from core.messages import Message

WITHOUT = "TRISECT_WITHOUT_WINGS"
"""The environment variable that names wings to be left out, with commas between them."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Package from which something comes, and its version."""

    package: str
    version: str


@dataclass(frozen=True, slots=True)
class Brought:
    """Object loaded from one entry point, or from one folder of ours, or the reason why it cannot be used.

    Parameters
    ----------
    name
        Of the entry point, or of the folder.
    what
        What was loaded; None where it could not be.
    why
        Why it could not be loaded; "" where it was.
    origin
        The package it comes from; None: the program itself.
    """

    name: str
    what: Any
    why: Message | str = ""
    origin: Origin | None = None


def by_entry_points(group: str) -> Iterator[Brought]:
    """Load what installed packages declare under the entry points' `group`, and yield each, usable or not."""
    for point in entry_points(group=group):
        yield _loaded(point, _origin(point))


def by_folders(package: str, constant: str) -> Iterator[Brought]:
    """Load the `constant` of the module `wing` in each folder of `package`, but for wings left out, and yield each.

    Nothing where the package itself is gone.
    """
    if find_spec(package) is None:
        return
    for found in iter_modules(import_module(package).__path__):
        if found.ispkg and found.name not in left_out():
            yield _loaded(EntryPoint(found.name, f"{package}.{found.name}.wing:{constant}", ""), None)


def left_out() -> frozenset[str]:
    """Return the names of the wings to be left out, from the environment variable WITHOUT."""
    return frozenset(filter(None, map(str.strip, os.environ.get(WITHOUT, "").split(","))))


def names_of_entry_points(group: str) -> frozenset[str]:
    """List the names that installed packages declare under the entry points' `group`, without loading anything."""
    return frozenset(entry_points(group=group).names)


def found_at(place: str) -> Any:
    """Import a module and return the object in it that `place`, "module:name", names."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def _loaded(point: EntryPoint, origin: Origin | None) -> Brought:
    try:
        return Brought(point.name, point.load(), "", origin)
    except Exception as error:  # noqa: BLE001  (whatever a stranger's package raises when it is loaded)
        return Brought(point.name, None, f"{type(error).__name__}: {error}", origin)


def _origin(point: EntryPoint) -> Origin:
    return Origin("?", "?") if point.dist is None else Origin(point.dist.name, point.dist.version)
