"""Kinds of features and checks that other packages bring, found by the entry points they declare.

A package names a `FeatureKind` under `trisect.feature_kinds`, or a function of an inspection that gives sentences under
`trisect.checks`, in its pyproject.toml. Its code runs in this program with all rights of whoever started it. What it
measures says so in its result, and what of it does not work is told: nothing of a package is left out in silence.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from core.findings.table import note_of
from core.inspect.plan.feature_kind import FeatureKind
from core.messages import Message

KINDS_GROUP, CHECKS_GROUP = "trisect.feature_kinds", "trisect.checks"

NAME_TAKEN = Message("plugin.why_taken", "its name is taken")
_NO_KIND = Message("plugin.why_no_kind", "it is no FeatureKind with a name of its own")
_NO_CHECK = Message("plugin.why_no_check", "it is no function")


@dataclass(frozen=True, slots=True)
class Origin:
    """The package that something comes from, and its version."""

    package: str
    version: str


@dataclass(frozen=True, slots=True)
class Check:
    """A check of inspections: `of` takes an `core.inspect.evaluate.Inspection` and gives what is to be told."""

    name: str
    origin: Origin
    of: Callable[[Any], Iterable[str]]


@dataclass(frozen=True, slots=True)
class Plugins:
    """What other packages bring: kinds and their origin by name, checks, and what of it cannot be used."""

    kinds: dict[str, tuple[FeatureKind, Origin]]
    checks: tuple[Check, ...]
    problems: tuple[Message, ...]


@cache
def plugins() -> Plugins:
    """All that is installed, loaded once."""
    kinds, checks, problems = dict[str, tuple[FeatureKind, Origin]](), list[Check](), list[Message]()
    for point in (*entry_points(group=KINDS_GROUP), *entry_points(group=CHECKS_GROUP)):
        origin = _origin(point)
        try:
            brought = point.load()
        except Exception as error:  # noqa: BLE001  (whatever a stranger's package raises when it is loaded)
            problems.append(unusable(point.name, origin, f"{type(error).__name__}: {error}"))
            continue
        if point.group == CHECKS_GROUP and callable(brought):
            checks.append(Check(point.name, origin, brought))
        elif point.group == KINDS_GROUP and isinstance(brought, FeatureKind) and brought.name not in kinds:
            kinds[brought.name] = brought, origin
        else:
            problems.append(unusable(point.name, origin, _NO_CHECK if point.group == CHECKS_GROUP else _NO_KIND))
    return Plugins(kinds, tuple(checks), tuple(problems))


def failure(origin: Origin, name: str, error: Exception) -> Message:
    """What is told where a package's code fails."""
    return Message(
        "plugin.failed",
        "{name} of the package {package} {version} failed: {why}",
        name=name,
        package=origin.package,
        version=origin.version,
        why=f"{type(error).__name__}: {error}",
    )


def unusable(name: str, origin: Origin, why: Message | str) -> Message:
    """What is told of what cannot be used at all."""
    return note_of("plugin.unusable", name=name, package=origin.package, version=origin.version, why=why)


def _origin(point: EntryPoint) -> Origin:
    return Origin("?", "?") if point.dist is None else Origin(point.dist.name, point.dist.version)
