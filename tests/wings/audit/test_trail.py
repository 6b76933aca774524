"""The audit trail: it grows with every change, and nothing in it can be changed unseen."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import InputError
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project, write_project
from core.files.project.lock import user_name
from core.files.project.witness import TRAIL
from core.wings.audit.trail import START, append, read_trail, trail_table


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Made, saved twice, and remarked on."""
    folder = tmp_path / "block"
    made = new_project("Block")
    create_project(folder, ProjectFile(made))
    for part in ("A", "=B"):
        write_project(folder, ProjectFile(replace(made, info=replace(made.info, part=part))))
    append(folder, "remark", why="the customer asked for it")
    return folder


def test_every_change_is_told_with_who_when_old_and_new(project: Path) -> None:
    trail = read_trail(project)
    assert [(entry.n, entry.what) for entry in trail.entries] == [
        (1, "created"), (2, "saved"), (3, "saved"), (4, "remark")
    ]  # fmt: skip
    assert {entry.who for entry in trail.entries} == {user_name()}
    assert [(one.field, one.old, one.new) for one in trail.entries[2].changes] == [("info.part", '"A"', '"=B"')]
    assert trail.entries[3].why == "the customer asked for it"
    assert trail.entries[0].before == START
    assert [entry.before for entry in trail.entries[1:]] == [entry.hash for entry in trail.entries[:-1]]
    assert trail.head == trail.entries[-1].hash
    assert not trail.problems


def test_saving_the_same_again_leaves_no_entry(project: Path) -> None:
    made = new_project("Block")
    write_project(project, ProjectFile(replace(made, info=replace(made.info, part="=B"))))
    assert len(read_trail(project).entries) == 4


def changed(lines: list[str]) -> list[str]:
    entry = json.loads(lines[1])
    entry["changes"][0]["new"] = '"C"'
    return [lines[0], json.dumps(entry), *lines[2:]]


def forged(lines: list[str]) -> list[str]:
    """Changed, and its own hash made right again."""
    from core.wings.audit.trail import _hash

    entry = json.loads(changed(lines)[1])
    entry.pop("hash")
    return [lines[0], json.dumps({**entry, "hash": _hash(entry)}), *lines[2:]]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (changed, "entry 2 was changed"),
        (forged, "entry 3 does not follow the one before it"),
        (lambda lines: [lines[0], *lines[2:]], "entry 2 does not follow the one before it"),
        (lambda lines: [*lines[:2], lines[1], *lines[2:]], "entry 3 does not follow the one before it"),
        (lambda lines: [lines[0], lines[2], lines[1], lines[3]], "entry 2 does not follow the one before it"),
        (lambda lines: [lines[0], "{", *lines[2:]], "entry 2 cannot be read"),
    ],
)
def test_what_was_changed_left_out_or_put_in_between_is_told(
    project: Path, change: Callable[[list[str]], list[str]], said: str
) -> None:
    path = project / TRAIL
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")
    problems = [str(problem) for problem in read_trail(project).problems]
    assert problems[0].startswith(said)
    append(project, "remark", why="it goes on all the same")
    assert [str(problem) for problem in read_trail(project).problems] == problems


@pytest.mark.parametrize("left", [1, 40, 200])
def test_a_line_that_a_crash_cut_off_is_told_and_goes_with_the_next_entry(project: Path, left: int) -> None:
    path = project / TRAIL
    whole = path.read_bytes()
    path.write_bytes(whole + whole.splitlines()[1][:left])
    trail = read_trail(project)
    assert trail.torn
    assert (len(trail.entries), trail.problems) == (4, ())
    append(project, "remark", why="next")
    after = read_trail(project)
    assert (len(after.entries), after.problems, after.torn) == (5, (), False)
    assert path.read_bytes().startswith(whole)


def test_two_programs_append_one_after_the_other(project: Path) -> None:
    code = (
        "from pathlib import Path; from core.wings.audit.trail import append\n"
        f"for _ in range(20): append(Path({str(project)!r}), 'remark', why='x')"
    )
    both = [subprocess.Popen([sys.executable, "-c", code], env=os.environ) for _ in range(2)]
    assert [program.wait() for program in both] == [0, 0]
    trail = read_trail(project)
    assert (len(trail.entries), trail.problems) == (44, ())


def test_the_table_has_a_row_for_each_change_and_no_formula(project: Path) -> None:
    rows = list(csv.DictReader(trail_table(read_trail(project)).splitlines()))
    assert {row["n"] for row in rows} == {"1", "2", "3", "4"}
    assert not any(cell[:1] in ("=", "+", "@", "\t") for row in rows for cell in row.values())


def test_no_trail_begins_where_there_is_no_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="folder is gone"):
        append(tmp_path / "gone", "remark", why="x")
    assert not (tmp_path / "gone").exists()
