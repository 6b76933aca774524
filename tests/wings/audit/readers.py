"""The readers of the wing's files, with a good file of each kind: for `tests.hostile`."""

from __future__ import annotations

from pathlib import Path

from core.wings.audit.people import Rules, person, read_rules, write_rules
from core.wings.audit.trail import read_trail
from tests.hostile.readers import Reader

READERS = {
    "audit": Reader("witnessed/audit.jsonl", lambda path: read_trail(path.parent)),
    "people": Reader("witnessed/people.json", lambda path: read_rules(path.parent)),
}


def good_files(folder: Path) -> None:
    """Write a good file of each kind into `folder`."""
    (folder / "witnessed").mkdir()
    write_rules(folder / "witnessed", Rules((person("Anna", "administrator", "anna-1"),), reasons=True))
