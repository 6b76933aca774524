"""Kinds of features and checks that other packages bring, found by the entry points they declare.

A package names a `FeatureKind` under `trisect.feature_kinds`, or a function of an inspection that gives sentences under
`trisect.checks`, in its pyproject.toml. Its code runs in this program with all rights of whoever started it. What it
measures says so in its result, and what of it does not work is told: nothing of a package is left out in silence.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

from core.door import Origin, by_entry_points
from core.findings.brought import note_on_unusable, unusable
from core.inspect.plan.feature_kind import FeatureKind
from core.messages import Message

KINDS_GROUP, CHECKS_GROUP = "trisect.feature_kinds", "trisect.checks"

NAME_TAKEN = Message("plugin.why_taken", "its name is taken")
_NO_KIND = Message("plugin.why_no_kind", "it is no FeatureKind with a name of its own")
_NO_CHECK = Message("plugin.why_no_check", "it is no function")


@dataclass(frozen=True, slots=True)
class Check:
    """Check of inspections: `of` takes a `core.inspect.evaluate.Inspection` and returns sentences about it."""

    name: str
    origin: Origin
    of: Callable[[Any], Iterable[str]]


@dataclass(frozen=True, slots=True)
class Plugins:
    """Kinds and their origin by name, and checks, that other packages bring, with the problems of unusable ones."""

    kinds: dict[str, tuple[FeatureKind, Origin]]
    checks: tuple[Check, ...]
    problems: tuple[Message, ...]


@cache
def plugins() -> Plugins:
    """Load the feature kinds and checks of all installed packages; further calls return the first result."""
    kinds, checks, problems = dict[str, tuple[FeatureKind, Origin]](), list[Check](), list[Message]()
    for group in (KINDS_GROUP, CHECKS_GROUP):
        for one in by_entry_points(group):
            if one.why or one.origin is None:
                problems.append(note_on_unusable(one))
            elif group == CHECKS_GROUP and callable(one.what):
                checks.append(Check(one.name, one.origin, one.what))
            elif group == KINDS_GROUP and isinstance(one.what, FeatureKind) and one.what.name not in kinds:
                kinds[one.what.name] = one.what, one.origin
            else:
                problems.append(unusable(one.name, one.origin, _NO_CHECK if group == CHECKS_GROUP else _NO_KIND))
    return Plugins(kinds, tuple(checks), tuple(problems))
