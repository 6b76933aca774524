"""Who may do what in a project, by names with PINs; and whether changed limits want a reason. Off until it is set up.

people.json says it, each change of it is in the audit trail. It is an agreement between people who share a project and
a help to know who did what; it keeps nobody out who may write to the folder. Whoever has lost the last administrator's
PIN resets it (`reset_rules`), which stays in the trail for good.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from core.errors import InputError
from core.files.atomic import remove, write_text
from core.files.complaints import checked_json
from core.files.json_text import to_json
from core.files.project.changes import Change
from core.files.project.data import Done, Project
from core.files.project.witness import PEOPLE, Signed
from core.files.reading import read_json
from core.messages import Message, label
from core.wings.audit.trail import Entry, append

Role = Literal["operator", "inspector", "administrator"]
ROLES: tuple[Role, ...] = ("operator", "inspector", "administrator")
"""Each may do what those before it may: run the plan; edit; change limits, the report's template and the people."""
ROLE_NAMES: Mapping[str, str] = {
    "operator": label("operator"),
    "inspector": label("inspector"),
    "administrator": label("administrator"),
}
SHORTEST_PIN = 4
"""Fewest characters of a PIN."""
_SCRYPT = {"n": 1 << 14, "r": 8, "p": 1, "dklen": 32}
_JUDGED = ("gauge", "inspection", "report")
_CHECKED = ConfigDict(extra="forbid", strict=True)


@dataclass(frozen=True, slots=True)
class Person:
    """Person with a role; of the PIN there is a salt and what scrypt makes of both (RFC 7914), in hex."""

    name: Annotated[str, Field(min_length=1, max_length=100, description="a name")]
    role: Annotated[Role, Field(description=" or ".join(f'"{one}"' for one in ROLES))]
    salt: Annotated[str, Field(pattern="^[0-9a-f]{32}$", description="32 hex digits")]
    hash: Annotated[str, Field(pattern="^[0-9a-f]{64}$", description="64 hex digits")]
    __pydantic_config__ = _CHECKED


@dataclass(frozen=True, slots=True)
class Rules:
    """Rules of a project: its people, and whether changes of limits after a result need a reason.

    Without people everything is permitted.
    """

    people: Annotated[tuple[Person, ...], Field(max_length=500, description="a list of people")] = ()
    reasons: bool = False
    __pydantic_config__ = _CHECKED


def read_rules(folder: Path) -> Rules:
    """Read the people and rules of a project, empty ones without a file; InputError if the file is damaged."""
    path = folder / PEOPLE
    return checked_json(Rules, read_json(path), path) if path.exists() else Rules()


def person(name: str, role: Role, pin: str) -> Person:
    """Make a person of the project with name, role and PIN; InputError if the PIN is too short."""
    if len(pin) < SHORTEST_PIN:
        raise InputError(
            Message("people.pin_short", "the PIN has fewer than {n} characters", n=SHORTEST_PIN), where=name
        )
    salt = secrets.token_bytes(16)
    return Person(name, role, salt.hex(), _hash(pin, salt))


def with_pin(rules: Rules, name: str, pin: str) -> Person:
    """Return the person of this name; InputError if there is none, or `pin` is not theirs."""
    found = next((one for one in rules.people if one.name == name), None)
    if found is None or not hmac.compare_digest(_hash(pin, bytes.fromhex(found.salt)), found.hash):
        raise InputError(Message("people.wrong_pin", "name and PIN do not belong together"), where=name)
    return found


def write_rules(folder: Path, rules: Rules, by: Signed | None = None) -> None:
    """Write a project's people and rules, and into the audit trail their change; InputError if `by` may not.

    Raises
    ------
    InputError
        If there are people already and `by` is no administrator of them, no administrator would be left, a name is
        there twice, or nothing can be written.
    """
    before = read_rules(folder)
    if before.people and (by not in before.people or by is None or by.role != "administrator"):
        raise InputError(
            Message("people.administrator_needed", "only an administrator may change the people"), where=folder
        )
    if rules.people and all(one.role != "administrator" for one in rules.people):
        raise InputError(
            Message("people.no_administrator", "there would be no administrator, and nobody could change that"),
            where=folder,
            todo=Message("people.advice_administrator", "name an administrator first, or remove everybody"),
        )
    if len({one.name for one in rules.people}) < len(rules.people):
        raise InputError(Message("people.name_twice", "a name is there twice"), where=folder)
    text = to_json(asdict(rules))
    digest = hashlib.sha256(text.encode()).hexdigest()
    append(folder, "people", _changes(before, rules), files={PEOPLE: digest}, by=by)
    write_text(folder / PEOPLE, text)


def reset_rules(folder: Path, why: str) -> None:
    """Remove all people and rules of a project without a PIN; the reason `why` goes into the audit trail.

    Raises
    ------
    InputError
        If no reason is given, or nothing can be written.
    """
    if not why.strip():
        raise InputError(
            Message("people.reason_needed", "a reason must be given, it stays in the audit trail"), where=folder
        )
    append(folder, "people reset", why=why.strip())
    remove(folder / PEOPLE)


def sign(folder: Path, name: str, pin: str, meaning: str) -> Entry:
    """Sign the project as it is, by name and PIN; adds an entry with `meaning` to its audit trail and returns it.

    Raises
    ------
    InputError
        If name and PIN do not belong together, or nothing can be written.
    """
    return append(folder, "signed", why=meaning.strip(), by=with_pin(read_rules(folder), name, pin))


def refused(rules: Rules, by: Signed | None, before: Project, after: Project) -> InputError | None:
    """Make the error that a person's role does not permit a change of the project; None if it does.

    Who has not signed in (`by` is None), or is none of the project's people, is an operator.
    """
    role = by.role if by is not None and by in rules.people else "operator"
    needed = needed_role(before, after)
    if not rules.people or ROLES.index(role) >= ROLES.index(needed):
        return None
    return InputError(
        Message("people.role_needed", "only an {role} may change this", role=ROLE_NAMES[needed]),
        todo=Message("people.advice_sign_in", "sign in (File, Sign in)"),
    )


def needed_role(before: Project, after: Project) -> Role:
    """Return the lowest role that permits the change of a project from `before` to `after`.

    Operators set what is measured of which pictures, administrators limits.
    """
    if limits_changed(before, after) or before.report.template != after.report.template:
        return "administrator"
    run = replace(before, info=after.info, sources=after.sources, repeats=after.repeats)
    return "operator" if run == after else "inspector"


def limits_changed(before: Project, after: Project) -> bool:
    """Whether a nominal value, a limit or a tolerance differs between two states of a project."""
    return _limits(before) != _limits(after)


def needs_reason(rules: Rules, results: Mapping[str, Done], before: Project, after: Project) -> bool:
    """Whether the rules ask for a reason for this change: limits change by which something was judged already."""
    return rules.reasons and any(step in results for step in _JUDGED) and limits_changed(before, after)


def _limits(project: Project) -> tuple[object, ...]:
    gauge = project.rig.gauge
    features = {
        one.name: (
            one.limits,
            one.nominal_heights,
            None if one.deviation is None else (one.deviation.nominal, one.deviation.tolerance_mm),
            one.position,
        )
        for one in project.inspection.features
        if one.limits or one.nominal_heights or one.deviation is not None or one.position is not None
    }
    return (None if gauge is None else (gauge.nominal_mm, gauge.tolerance_mm)), features


def _changes(before: Rules, after: Rules) -> tuple[Change, ...]:
    old, new = ({f"people.{one.name}": one for one in rules.people} for rules in (before, after))
    found = [
        Change(name, old[name].role if name in old else "", new[name].role if name in new else "")
        for name in dict.fromkeys((*old, *new))
        if old.get(name) != new.get(name)
    ]
    if before.reasons != after.reasons:
        found.append(Change("reasons", str(before.reasons).lower(), str(after.reasons).lower()))
    return tuple(found)


def _hash(pin: str, salt: bytes) -> str:
    return hashlib.scrypt(pin.encode(), salt=salt, **_SCRYPT).hex()
