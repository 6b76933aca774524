"""Settings of cameras that come back by themselves: each step's and each source's own."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from core.acquire.settings import Region, SourceSettings
from core.acquire.source import SourceChoice, Step
from core.errors import InputError

_Key = tuple[str, str, Step]


@dataclass(frozen=True, slots=True)
class KeptSettings:
    """Settings of each source for each step: a target needs more light than a laser.

    It is a value: `with_settings` gives another one. As text it is JSON, which any settings file can hold.
    """

    _kept: Mapping[_Key, SourceSettings] = field(default_factory=dict)

    def settings(self, choice: SourceChoice, step: Step) -> SourceSettings:
        """Return the settings last used with the source `choice` in this `step`; all None if there are none."""
        return self._kept.get((choice.kind, choice.id, step), SourceSettings())

    def with_settings(self, choice: SourceChoice, step: Step, settings: SourceSettings) -> KeptSettings:
        """Return a copy in which the source `choice` has these `settings` in this `step`."""
        return KeptSettings({**self._kept, (choice.kind, choice.id, step): settings})

    def to_text(self) -> str:
        """Write the settings of all sources and steps as a text of JSON."""
        rows = [
            {"kind": kind, "id": identifier, "step": step, "settings": _plain(settings)}
            for (kind, identifier, step), settings in sorted(self._kept.items())
        ]
        return json.dumps(rows, ensure_ascii=False)

    @classmethod
    def from_text(cls, text: str) -> KeptSettings:
        """Read the settings that `to_text` wrote; entries in another version's form are left out."""
        try:
            rows = json.loads(text)
        except ValueError:
            return cls()
        kept: dict[_Key, SourceSettings] = {}
        for row in rows if isinstance(rows, list) else ():
            try:
                kept[row["kind"], row["id"], row["step"]] = _settings(row["settings"])
            except (KeyError, TypeError, InputError):
                continue
        return cls(kept)


def _plain(settings: SourceSettings) -> dict[str, Any]:
    return {name: asdict(value) if isinstance(value, Region) else value for name, value in settings.stated.items()}


def _settings(told: dict[str, Any]) -> SourceSettings:
    region = told.get("region")
    return SourceSettings(**{**told, "region": None if region is None else Region(**region)})
