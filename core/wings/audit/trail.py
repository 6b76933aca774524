"""A project's audit trail: who did what and when, old and new, in a file that only grows.

Each line of audit.jsonl is one entry in JSON and holds the SHA-256 of the one before: nothing can be changed, left out
or put in between without breaking the chain; what is cut off at its end shows against a report that prints the chain's
head. It tells of accidents and of quiet corrections; it does not withstand somebody who writes the whole chain anew.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from core.errors import InputError
from core.files.atomic import cannot_write, vanished
from core.files.complaints import checked_json
from core.files.csv_text import csv_text
from core.files.folder_lock import wait_for
from core.files.limits import DATA_BYTES
from core.files.project.changes import Change
from core.files.project.lock import user_name
from core.files.project.witness import TRAIL, Signed
from core.files.reading import json_of, read_bytes
from core.files.tables import TIME_WORDS, Time
from core.messages import Message, label

START = "0" * 64
"""What the first entry says of the one before."""

What = Literal["created", "saved", "taken over", "measured", "reported", "remark", "people", "people reset", "signed"]

WHAT_NAMES: Mapping[What, str] = {
    "created": label("created"),
    "saved": label("saved"),
    "taken over": label("taken over"),
    "measured": label("results made"),
    "reported": label("report made"),
    "remark": label("remark"),
    "people": label("people changed"),
    "people reset": label("people reset"),
    "signed": label("signed"),
}
"""What was done, in words."""

_Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$", description="64 hex digits")]


@dataclass(frozen=True, slots=True)
class Entry:
    """Entry of an audit trail.

    Parameters
    ----------
    n
        Its number, from 1.
    at, who, host
        When, by which user of which computer.
    what
        What was done.
    before, hash
        SHA-256 in hex of the entry before, and of this one without its own hash.
    changes
        What was decided: field by field, old and new.
    why
        What somebody said of it.
    files
        SHA-256 in hex of the results that were made, by their names within the project.
    state
        SHA-256 in hex of project.json as it was saved; nothing where it was not.
    by, role
        Who had signed in, by `core.wings.audit.people`; nothing where nobody had.
    """

    n: Annotated[int, Field(ge=1, description="a whole number from 1")]
    at: Annotated[Time, Field(description=TIME_WORDS)]
    who: str
    host: str
    what: What
    before: _Hash
    hash: _Hash
    changes: tuple[Change, ...] = ()
    why: str = ""
    files: Mapping[str, str] = field(default_factory=dict, hash=False)
    state: str = ""
    by: str = ""
    role: str = ""
    __pydantic_config__ = ConfigDict(extra="forbid", strict=True)


@dataclass(frozen=True, slots=True)
class Trail:
    """Entries of an audit trail as far as they can be read, and faults of the chain.

    `torn`: the last line has no end.
    """

    entries: tuple[Entry, ...] = ()
    problems: tuple[Message, ...] = ()
    torn: bool = False

    @property
    def head(self) -> str:
        """Hash of the audit trail's last entry, which stands for all of them; "" if it has none."""
        return self.entries[-1].hash if self.entries else ""


def append(
    folder: Path,
    what: What,
    changes: Sequence[Change] = (),
    *,
    why: str = "",
    files: Mapping[str, str] | None = None,
    state: str = "",
    by: Signed | None = None,
) -> Entry:
    """Add an entry to the audit trail of the project in `folder`, return it, and wait until the disk holds it.

    A line that a crash left without its end is cut off first: nobody was told that it was written.

    Raises
    ------
    InputError
        If the folder is gone, or the trail cannot be read or written to.
    """
    if not folder.is_dir():
        raise vanished(folder)
    path = folder / TRAIL
    try:
        with _held(path) as handle:
            kept = _whole_lines(handle)
            n, before = _after(kept, path)
            values = {
                "n": n,
                "at": datetime.now().astimezone().isoformat(),
                "who": user_name(),
                "host": platform.node(),
                "what": what,
                "before": before,
                **({"changes": [asdict(change) for change in changes]} if changes else {}),
                **({"why": why} if why else {}),
                **({"files": dict(sorted(files.items()))} if files else {}),
                **({"state": state} if state else {}),
                **({"by": by.name, "role": by.role} if by else {}),
            }
            line = json.dumps({**values, "hash": _hash(values)}, ensure_ascii=False)
            os.lseek(handle, 0, os.SEEK_END)
            _write_all(handle, line.encode() + b"\n")
            os.fsync(handle)
    except OSError as error:
        raise cannot_write(path, error) from error
    return _entry(line, path)


def read_trail(folder: Path) -> Trail:
    """Read the audit trail of a project, checked link by link; InputError if its file cannot be read at all."""
    path = folder / TRAIL
    if not path.exists():
        return Trail()
    *lines, rest = read_bytes(path, most=DATA_BYTES).split(b"\n")
    entries: list[Entry] = []
    problems: list[Message] = []
    before = START
    for number, line in enumerate(lines, start=1):
        try:
            values = json_of(line.decode(), path)
            entry = _entry(line.decode(), path)
        except (InputError, ValueError):
            problems.append(Message("audit.line_damaged", "entry {n} cannot be read", n=number))
            before = ""
            continue
        if _hash({name: value for name, value in values.items() if name != "hash"}) != entry.hash:
            problems.append(Message("audit.entry_changed", "entry {n} was changed", n=number))
        elif entry.n != number or (before and entry.before != before):
            problems.append(
                Message("audit.chain_broken", "entry {n} does not follow the one before it: one is missing", n=number)
            )
        before = entry.hash
        entries.append(entry)
    return Trail(tuple(entries), tuple(problems), torn=bool(rest))


def trail_table(trail: Trail) -> str:
    """Write the audit trail as CSV text: a row for each change of an entry, or one for an entry without changes."""
    table: list[tuple[object, ...]] = [
        ("n", "at", "who", "host", "by", "role", "what", "field", "old", "new", "why", "hash")
    ]
    for entry in trail.entries:
        rows = [(change.field, change.old, change.new) for change in entry.changes]
        rows += [(name, "", digest) for name, digest in entry.files.items()]
        first = (entry.n, entry.at.isoformat(), entry.who, entry.host, entry.by, entry.role, entry.what)
        table += [(*first, *row, entry.why, entry.hash) for row in rows or [("", "", "")]]
    return csv_text(table)


def _entry(line: str, path: Path) -> Entry:
    return checked_json(Entry, json_of(line, path), path)


def _hash(values: Mapping[str, object]) -> str:
    text = json.dumps(values, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _after(kept: bytes, path: Path) -> tuple[int, str]:
    """Number and predecessor of the next entry, which goes on even behind one that cannot be read."""
    if not kept:
        return 1, START
    count = kept.count(b"\n")
    last = kept[:-1].rpartition(b"\n")[2]
    try:
        return count + 1, _entry(last.decode(), path).hash
    except (InputError, ValueError):
        return count + 1, hashlib.sha256(last).hexdigest()


def _whole_lines(handle: int) -> bytes:
    """What the file holds, after what follows its last line was cut off."""
    os.lseek(handle, 0, os.SEEK_SET)
    data = b"".join(iter(lambda: os.read(handle, 1 << 20), b""))
    whole = data[: data.rfind(b"\n") + 1]
    if len(whole) < len(data):
        os.ftruncate(handle, len(whole))
    return whole


def _write_all(handle: int, data: bytes) -> None:
    while data:
        data = data[os.write(handle, data) :]


@contextmanager
def _held(path: Path) -> Iterator[int]:
    """The file, open and alone: a job of the window writes to it, too."""
    handle = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o644)
    try:
        wait_for(handle)
        yield handle
    finally:
        os.close(handle)
