"""What two states of a project differ in, field by field: for the audit trail, and for who is to choose one."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ConfigDict

from core.files.project.data import ProjectFile
from core.files.project.json_form import project_tables

_OF_SAVING = ("schema_version", "version", "created", "saved")


@dataclass(frozen=True, slots=True)
class Change:
    """Change of one field of project.json, by its name, with its values as JSON; "": it is not there."""

    field: str
    old: str
    new: str
    __pydantic_config__ = ConfigDict(extra="forbid", strict=True)


def differences(before: ProjectFile | None, after: ProjectFile) -> tuple[Change, ...]:
    """List the fields in which two states of a project differ, with old and new value; None before: all fields."""
    old, new = ({} if file is None else dict(_fields(_decided(file))) for file in (before, after))
    names = dict.fromkeys((*old, *new))
    return tuple(Change(name, old.get(name, ""), new.get(name, "")) for name in names if old.get(name) != new.get(name))


def _decided(file: ProjectFile) -> Mapping[str, Any]:
    tables = {name: value for name, value in project_tables(file).items() if name not in _OF_SAVING}
    return {**tables, "results": {step: done.key for step, done in file.results.items()}}


def _fields(value: Any, name: str = "") -> Iterator[tuple[str, str]]:
    """Leaves of tables by their dotted names; a list is one leaf."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _fields(item, f"{name}.{key}" if name else str(key))
    elif value not in (None, "", [], ()):
        yield name, json.dumps(value, ensure_ascii=False, default=str)
