"""Another program holds a file, as on Windows: for a moment, or for good."""

import errno
import os
import shutil
import time

import pytest

from core import held_files
from core.errors import InputError
from core.files.atomic import beside_of, cannot_write, folder_beside, write_bytes
from core.files.step_graph import FILES
from core.held_files import HeldOpen, remove, remove_tree, rename
from core.pipeline.steps.workspace import made_beside, put_results

DENIED, SHARED, PATH_NOT_FOUND = 5, 32, 3
CLOSE_IT = "cannot be written, because another program holds it open; close it in the other program, then try again."


def refused(number, *names):
    """What Windows raises."""
    error = PermissionError(errno.EACCES, "Access is denied", *names)
    if len(names) > 1:
        error = PermissionError(errno.EACCES, "Access is denied", names[0], None, names[1])
    error.winerror = number
    return error


@pytest.fixture
def holding(monkeypatch):
    """Have the system refuse so many times; returns what counts the tries."""

    def hold(name, times, number=SHARED, of=os):
        tries, really = [], getattr(of, name)

        def act(*names, **more):
            tries.append(names)
            if len(tries) <= times:
                raise refused(number, *map(str, names))
            return really(*names, **more)

        monkeypatch.setattr(of, name, act)
        return tries

    return hold


@pytest.fixture
def impatient():
    token = held_files.PATIENCE_S.set(0.2)
    yield
    held_files.PATIENCE_S.reset(token)


@pytest.mark.parametrize("number", [DENIED, SHARED])
def test_a_file_that_is_let_go_is_replaced(tmp_path, holding, number):
    (tmp_path / "report.pdf").write_bytes(b"old")
    tries = holding("replace", 3, number)
    write_bytes(tmp_path / "report.pdf", b"new")
    assert len(tries) == 4
    assert (tmp_path / "report.pdf").read_bytes() == b"new"


def test_a_folder_is_renamed_once_the_scanner_is_done(tmp_path, holding):
    tries = holding("rename", 2)
    with folder_beside(tmp_path / "Copy") as beside:
        (beside / "a").touch()
        rename(beside, tmp_path / "Copy")
    assert len(tries) == 3
    assert [path.name for path in tmp_path.iterdir()] == ["Copy"]


def test_a_tree_and_a_file_are_removed_once_they_are_let_go(tmp_path, holding):
    (tmp_path / "set" / "scan").mkdir(parents=True)
    (tmp_path / "a").touch()
    trees, files = holding("rmtree", 2, of=shutil), holding("unlink", 2, of=type(tmp_path))
    remove_tree(tmp_path / "set")
    remove(tmp_path / "a")
    assert (len(trees), len(files)) == (3, 3)
    assert list(tmp_path.iterdir()) == []


def test_what_is_not_let_go_is_told_after_two_seconds_and_nothing_half_written_stays(tmp_path, holding):
    report = tmp_path / "report.pdf"
    report.write_bytes(b"old")
    holding("replace", 10**6)
    began = time.monotonic()
    with pytest.raises(InputError) as told:
        write_bytes(report, b"new")
    assert 2.0 <= time.monotonic() - began < 3.0
    assert str(told.value) == f"{report}: {CLOSE_IT}"
    assert told.value.code == "file.cannot_be_written"
    assert [path.name for path in tmp_path.iterdir()] == ["report.pdf"]
    assert report.read_bytes() == b"old"


def test_of_several_files_the_one_that_is_held_is_named(tmp_path, holding, impatient):
    holding("replace", 10**6)
    (tmp_path / "a").touch()
    with pytest.raises(HeldOpen) as held:
        rename(tmp_path / "a", tmp_path / "cloud.ply")
    assert str(cannot_write(tmp_path, held.value)) == f"{tmp_path / 'cloud.ply'}: {CLOSE_IT}"


def test_a_tree_that_cannot_be_removed_may_be_left(tmp_path, holding, impatient):
    (tmp_path / "set").mkdir()
    holding("rmdir", 10**6)
    with pytest.raises(HeldOpen):
        remove_tree(tmp_path / "set")
    remove_tree(tmp_path / "set", leave=True)
    assert (tmp_path / "set").exists()


def test_no_time_is_lost_where_waiting_does_not_help(tmp_path, holding):
    """Another system's missing permission, and on Windows a folder in the way or a file that is read only."""
    began = time.monotonic()
    (tmp_path / "a").touch()
    (tmp_path / "folder").mkdir()
    with pytest.raises(IsADirectoryError):
        rename(tmp_path / "a", tmp_path / "folder")
    tries = holding("replace", 10**6, DENIED)
    with pytest.raises(InputError, match="there is no permission to write here"):
        write_bytes(tmp_path / "folder", b"")
    assert len(tries) == 1
    holding("replace", 10**6, None)
    with pytest.raises(InputError, match="there is no permission to write here"):
        write_bytes(tmp_path / "b", b"")
    assert time.monotonic() - began < 1.0


def test_a_file_that_is_read_only_is_not_waited_for(tmp_path, holding, monkeypatch):
    (tmp_path / "a").touch()
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # an administrator may write to it here
    tries = holding("replace", 10**6, DENIED)
    with pytest.raises(InputError, match="there is no permission to write here"):
        write_bytes(tmp_path / "a", b"")
    assert len(tries) == 1


def test_the_longest_name_that_a_disk_takes_can_be_written(tmp_path):
    longest = "a" * 251 + ".png"
    write_bytes(tmp_path / longest, b"whole")
    assert [path.name for path in tmp_path.iterdir()] == [longest]
    for name in ("a", "report.pdf", "a" * 31, "a" * 32, "a" * 255, "ü" * 127):
        assert len(beside_of(tmp_path / name).name) <= max(32, len(name))


def test_a_name_that_is_too_long_is_told(tmp_path):
    with pytest.raises(InputError, match="longer than this system takes; choose a folder with a shorter path"):
        write_bytes(tmp_path / ("a" * 256), b"")


def test_a_path_too_long_for_windows_is_told(tmp_path):
    """It says that a folder is not found."""
    gone = FileNotFoundError(errno.ENOENT, "The system cannot find the path specified", str(tmp_path / ("a" * 250)))
    gone.winerror = PATH_NOT_FOUND
    assert "its path is longer than this system takes" in str(cannot_write(tmp_path, gone))
    gone.filename = None
    assert "longer" not in str(cannot_write(tmp_path, gone))


def test_results_of_a_killed_run_that_are_held_are_never_taken_for_new(tmp_path, holding, impatient):
    (tmp_path / ".new").mkdir()
    (tmp_path / ".new" / "cloud.ply").write_bytes(b"stale")
    holding("unlink", 10**6)
    with pytest.raises(InputError, match="another program holds it open"), made_beside(tmp_path):
        pytest.fail("it would be put among the results")


def test_a_report_that_a_reader_holds_keeps_the_results_as_they_were(tmp_path, holding, impatient):
    old = {name: tmp_path / FILES[name] for name in ("report", "gauge")}
    for path in old.values():
        path.write_bytes(b"old")
    holding("unlink", 10**6)
    with pytest.raises(InputError) as told:
        put_results(tmp_path, None, tuple(old))
    assert str(told.value) == f"{old['report']}: {CLOSE_IT}"
    assert {path.read_bytes() for path in old.values()} == {b"old"}
