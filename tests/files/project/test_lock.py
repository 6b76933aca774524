"""A project is changed by one program at a time, and who has it is told."""

from __future__ import annotations

import contextlib
import json
import pickle
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from core.errors import InputError
from core.files.folder_lock import alone_in
from core.files.project import lock
from core.files.project.lock import LOCK, ProjectInUse, lock_owner, take_lock, user_name

HOLD = """
import sys, time
from pathlib import Path
from core.files.project.lock import take_lock
lock = take_lock(Path(sys.argv[1]))
print("held", flush=True)
time.sleep(60)
"""


def test_who_opens_second_is_told_who_has_the_project_where_and_since_when(tmp_path: Path) -> None:
    lock = take_lock(tmp_path)
    with pytest.raises(ProjectInUse, match=r"is open elsewhere, by .+ on .+ since 20") as told:
        take_lock(tmp_path)
    assert told.value.holder == lock.holder
    assert lock.holder.owner == user_name()
    again = pickle.loads(pickle.dumps(told.value))
    assert (again.holder, str(again)) == (told.value.holder, str(told.value))
    lock.release()
    assert lock_owner(tmp_path) is None
    assert not list(tmp_path.iterdir())
    take_lock(tmp_path).release()


def test_who_takes_over_has_it_and_the_first_one_learns_of_it_and_does_not_let_go_for_the_second(
    tmp_path: Path,
) -> None:
    first = take_lock(tmp_path)
    second = take_lock(tmp_path, take_over=True)
    with pytest.raises(InputError, match=r"was taken over by .* what is changed here is not saved"):
        first.check()
    first.release()
    second.check()
    assert lock_owner(tmp_path) == second.holder
    second.release()


@pytest.mark.skipif(sys.platform == "win32", reason="there, whoever opens the project decides")
def test_a_killed_program_holds_nothing(tmp_path: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        assert program.stdout.readline() == "held\n"
        assert lock_owner(tmp_path) is not None
        program.kill()
        program.wait()
    assert (tmp_path / LOCK).exists()
    assert lock_owner(tmp_path) is None
    take_lock(tmp_path).release()


def test_another_computers_hold_stays_until_somebody_takes_over(tmp_path: Path) -> None:
    there = {"owner": "anna", "host": "bench-2", "since": "2026-11-23T09:12:00+01:00", "key": "aa"}
    (tmp_path / LOCK).write_text(json.dumps(there))
    with pytest.raises(ProjectInUse, match="by anna on bench-2 since 2026-11-23"):
        take_lock(tmp_path)
    take_lock(tmp_path, take_over=True).release()


@pytest.mark.parametrize(
    "text", ["", "{", "[]", '{"owner": 3}', '{"owner": "a", "host": "b", "since": "x", "key": "k"}']
)
def test_a_lock_that_says_nothing_holds_nothing(tmp_path: Path, text: str) -> None:
    (tmp_path / LOCK).write_text(text)
    take_lock(tmp_path).release()


def test_a_project_whose_folder_is_gone_is_no_longer_ours(tmp_path: Path) -> None:
    folder = tmp_path / "block"
    folder.mkdir()
    lock = take_lock(folder)
    (folder / LOCK).unlink()
    with pytest.raises(InputError, match="folder is gone; none is made in its place"):
        lock.check()
    lock.release()


def test_of_many_who_open_at_once_one_has_it(tmp_path: Path) -> None:
    start = time.time() + 1.5
    code = f"""
import sys, time
from pathlib import Path
from core.files.project.lock import ProjectInUse, take_lock
time.sleep(max(0.0, {start} - time.time()))
try:
    take_lock(Path({str(tmp_path)!r}))
    print("mine", flush=True)
except ProjectInUse:
    print("in use", flush=True)
sys.stdin.read()
"""
    programs = [
        subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for _ in range(4)
    ]
    try:
        said = [program.stdout.readline() for program in programs if program.stdout is not None]
    finally:
        for program in programs:  # whoever has it keeps it until all have answered
            program.communicate()
    assert sorted(said) == ["in use\n"] * 3 + ["mine\n"]


def test_what_a_killed_program_left_half_written_goes_when_the_project_is_opened(tmp_path: Path) -> None:
    (tmp_path / ".project.json.0123abcd.part").write_text("half a pro")
    (tmp_path / "project.json").write_text("{}")
    take_lock(tmp_path).release()
    assert [path.name for path in tmp_path.iterdir()] == ["project.json"]


def test_who_looks_while_another_takes_the_project_does_not_take_it_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    look, taken, others = lock.lock_owner, list[lock.ProjectLock](), list[threading.Thread]()

    def take() -> None:
        with contextlib.suppress(ProjectInUse):
            taken.append(take_lock(tmp_path))

    def look_slowly(folder: Path) -> lock.LockOwner | None:
        found = look(folder)
        if not others:
            others.append(threading.Thread(target=take))
            others[0].start()
            others[0].join(0.3)
        return found

    monkeypatch.setattr(lock, "lock_owner", look_slowly)
    take()
    others[0].join()
    assert len(taken) == 1
    taken[0].release()


def test_what_a_killed_program_was_making_goes_when_the_project_is_opened_unless_another_one_is_making_it(
    tmp_path: Path,
) -> None:
    for name in ("results", "check"):
        (tmp_path / name / ".new").mkdir(parents=True)
        (tmp_path / name / ".new" / "cloud.ply").write_bytes(b"half a cloud")
    (tmp_path / "results" / ".gauge.json.0123abcd.part").write_text("half a gau")
    (tmp_path / "results" / "gauge.json").write_text("{}")
    with alone_in(tmp_path / "check"):
        (tmp_path / "check" / ".new").mkdir(exist_ok=True)
        take_lock(tmp_path).release()
        assert (tmp_path / "check" / ".new").exists()
    assert [path.name for path in (tmp_path / "results").iterdir()] == ["gauge.json"]
