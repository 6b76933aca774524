"""The witness of what is written into projects: it puts each change into the project's audit trail."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from core.errors import InputError
from core.files.atomic import remove, write_bytes
from core.files.project.changes import differences
from core.files.project.data import new_project
from core.files.project.folder import RESULTS
from core.files.project.witness import TRAIL, Witness, Written
from core.files.reading import file_hash
from core.messages import Message
from core.wings.audit.people import read_rules, refused, write_rules
from core.wings.audit.trail import Entry, append, read_trail

if TYPE_CHECKING:
    from core.report.content import Evidence

_MAKING = ("measured", "reported")
"""Entries that tell of results."""
CHANGING = ".results-changing"
"""Stands in a project's folder from before its results change until their entry is written."""


@contextmanager
def see(folder: Path, written: Written) -> Iterator[None]:
    """Write the entry of a change into the project's audit trail before or after the block that makes the change.

    Raises
    ------
    InputError
        If the role of who has signed in does not permit the change, the folder is gone, or cannot be written to.
    """
    match written.what:
        case "measured" | "reported":
            with noting_results(folder, reported=written.what == "reported"):
                yield
        case "taken over":
            yield
            append(folder, "taken over", why=written.why)
        case "next part":
            yield
            if written.of is not None and ((rules := read_rules(written.of)).people or rules.reasons):
                write_rules(folder, rules, written.by)
        case _:
            _require_role(folder, written)
            _note_saved(folder, written)
            yield


def evidence(folder: Path) -> Evidence | None:
    """Return the hash of the trail's last entry; reports are left out, so that the same report comes out again."""
    from core.report.content import Evidence

    entries = [entry for entry in read_trail(folder).entries if entry.what != "reported"]
    if not entries:
        return None
    n, digest = entries[-1].n, entries[-1].hash
    return Evidence(Message("audit.evidence", "Audit trail of the project, SHA-256 of entry {n}:", n=n), digest)


WITNESS = Witness(see, evidence)


@contextmanager
def noting_results(folder: Path, *, reported: bool = False) -> Iterator[None]:
    """Write an entry on the project's results into its audit trail when this block has made or changed them.

    A block that fails has its entry where it changed something all the same. Should the program end before the entry
    is written, a mark beside the results says so: `verify` then does not call good results changed.

    Raises
    ------
    InputError
        If the folder is gone, or cannot be written to.
    """
    mark = folder / CHANGING
    write_bytes(mark)
    try:
        yield
    except BaseException:
        told = told_of(read_trail(folder).entries)
        if _hashes(folder) != (dict(told.files) if told else {}):
            note_results(folder)
        remove(mark)
        raise
    note_results(folder, reported=reported)
    remove(mark)


def note_results(folder: Path, *, reported: bool = False) -> None:
    """Write an entry with the hashes of the project's results as they are into its audit trail.

    Raises as `append`.
    """
    append(folder, "reported" if reported else "measured", files=_hashes(folder))


def _hashes(folder: Path) -> dict[str, str]:
    return {name: file_hash(folder / name) for name in names_of_results(folder)}


def _require_role(folder: Path, written: Written) -> None:
    """Raise InputError if the person's role does not permit it; what cannot be read was an empty project."""
    if written.after is None:
        return
    before = new_project("") if written.before is None else written.before.project
    error = refused(read_rules(folder), written.by, before, written.after.project)
    if error is not None:
        raise InputError(error.what, where=folder, todo=error.todo)


def _note_saved(folder: Path, written: Written) -> None:
    """Write the entry before project.json: one without its change is found again, a change without entry never is."""
    if written.of is not None and (written.of / TRAIL).exists():
        shutil.copyfile(written.of / TRAIL, folder / TRAIL)
    append(
        folder,
        "created" if written.what == "created" else "saved",
        () if written.after is None else differences(written.before, written.after),
        why="packed" if written.what == "packed" else written.why,
        state=hashlib.sha256(written.text.encode()).hexdigest(),
        by=written.by,
    )


def told_of(entries: Sequence[Entry]) -> Entry | None:
    """The last entry that tells of results."""
    return next((entry for entry in reversed(entries) if entry.what in _MAKING and entry.files), None)


def names_of_results(folder: Path) -> list[str]:
    """List the files of results in a project by their names within it."""
    results = folder / RESULTS
    found = sorted(results.iterdir()) if results.is_dir() else []
    return [f"{RESULTS}/{path.name}" for path in found if path.is_file() and path.name[0] != "."]
