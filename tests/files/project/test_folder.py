import errno
import os
import shutil
import subprocess
import sys
import tempfile
import textwrap
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from core.errors import InputError
from core.files.project.data import Done, ProjectFile, ProjectInfo, Sources, new_project
from core.files.project.folder import (
    backups,
    create_project,
    free_folder,
    is_project,
    project_from_set,
    read_project,
    recoverable,
    remove_autosave,
    source_folder,
    sources_of_set,
    stored_source,
    write_autosave,
    write_project,
)
from core.files.project.witness import TRAIL
from core.files.recording.rig import default_rig, read_rig, rig_to_toml

RIG = rig_to_toml(default_rig())


def named(name):
    return ProjectFile(new_project(name))


def names_in(folder):
    return sorted({path.name for path in folder.iterdir()} - {TRAIL})


def test_a_project_opens_by_its_folder_and_by_its_file(tmp_path):
    create_project(tmp_path / "deep" / "project", named("x"))
    folder = tmp_path / "deep" / "project"
    assert read_project(folder) == read_project(folder / "project.json") == named("x")
    assert is_project(folder)
    assert is_project(folder / "project.json")


def test_what_is_no_project(tmp_path):
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "camera.json").write_text("{}")
    for path in (
        tmp_path,
        tmp_path / "rig.toml",
        tmp_path / "camera.json",
        tmp_path / "nowhere",
        tmp_path / "no/where",
    ):
        assert not is_project(path)
    with pytest.raises(InputError, match=r"there is no project\.json here; choose the folder of a project"):
        read_project(tmp_path)
    with pytest.raises(InputError, match="the file is missing"):
        read_project(tmp_path / "nowhere")


def test_a_project_knows_when_it_was_made_and_saved(tmp_path):
    begun = datetime.now(UTC)
    create_project(tmp_path, named("x"))
    first = read_project(tmp_path)
    assert begun <= first.created == first.saved <= datetime.now(UTC)
    create_project(tmp_path, named("y"))
    second = read_project(tmp_path)
    assert second.created == first.created
    assert second.saved > first.saved


def test_saving_the_same_again_changes_no_byte(tmp_path):
    create_project(tmp_path, named("x"))
    create_project(tmp_path, named("y"))
    before = (tmp_path / "project.json").read_bytes()
    create_project(tmp_path, named("y"))
    assert (tmp_path / "project.json").read_bytes() == before
    assert len(backups(tmp_path)) == 1


def test_the_last_five_versions_are_kept_byte_by_byte(tmp_path):
    versions = []
    for number in range(8):
        create_project(tmp_path, named(f"version {number}"))
        versions.append((tmp_path / "project.json").read_bytes())
    kept = backups(tmp_path)
    assert [path.read_bytes() for path in kept] == versions[-2:-7:-1]
    assert [read_project(path).project.info.name for path in kept] == [
        f"version {number}" for number in (6, 5, 4, 3, 2)
    ]
    assert names_in(tmp_path) == sorted(["backups", "project.json", f"{tmp_path.name}.trisect"])


def test_versions_stay_in_order_beyond_any_number_of_digits_and_beside_other_files(tmp_path):
    create_project(tmp_path, named("a"))
    (tmp_path / "backups").mkdir()
    (tmp_path / "backups" / "notes.txt").write_text("mine")
    (tmp_path / "backups" / "project-99999-20260101-120000.json").write_text("{}")
    create_project(tmp_path, named("b"))
    create_project(tmp_path, named("c"))
    assert [path.name[:14] for path in backups(tmp_path)] == ["project-100001", "project-100000", "project-99999-"]
    assert (tmp_path / "backups" / "notes.txt").read_text() == "mine"


def test_a_damaged_project_is_kept_too_when_it_is_written_over(tmp_path):
    (tmp_path / "project.json").write_bytes(b"half a pro")
    create_project(tmp_path, named("x"))
    assert [path.read_bytes() for path in backups(tmp_path)] == [b"half a pro"]
    assert read_project(tmp_path) == named("x")


KILLED = """
import os, signal
from pathlib import Path
from core.files.project.folder import *
from core.files.project.data import *

before = Path.replace

def killed(path, target):
    if Path(target).name == {name!r}:
        os.kill(os.getpid(), signal.SIGKILL)
    return before(path, target)

Path.replace = killed
{call}(Path({folder!r}), ProjectFile(new_project("new")))
"""


@pytest.mark.parametrize(("call", "name"), [("create_project", "project.json"), ("write_autosave", ".autosave.json")])
def test_killed_between_writing_and_renaming_the_old_state_is_whole(tmp_path, call, name):
    for version in ("older", "old"):
        create_project(tmp_path, named(version))
        write_autosave(tmp_path, named(version))
    program = textwrap.dedent(KILLED).format(name=name, call=call, folder=str(tmp_path))
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == -9
    assert read_project(tmp_path) == read_project(tmp_path / ".autosave.json") == named("old")
    create_project(tmp_path, named("new"))  # and it can be saved afterwards
    assert read_project(tmp_path) == named("new")
    assert [read_project(path).project.info.name for path in backups(tmp_path)] == ["old", "older"]


def failing(number):
    def fail(*_args, **_options):
        raise OSError(number, os.strerror(number))

    return fail


@pytest.mark.parametrize(("number", "said"), [
    (errno.EROFS, "cannot be written, because the disk is read-only; "),
    (errno.EACCES, "there is no permission to write here; "),
    (errno.ENOSPC, "the disk is full; free some space"),
])  # fmt: skip
@pytest.mark.parametrize("write", [create_project, write_autosave])
def test_where_nothing_can_be_written_one_sentence_says_so_and_the_old_state_stays(
    tmp_path, monkeypatch, write, number, said
):
    create_project(tmp_path, named("old"))
    with monkeypatch.context() as patch:
        patch.setattr(tempfile, "TemporaryFile", failing(number))
        patch.setattr("core.files.atomic.os.fsync", failing(number))
        patch.setattr(Path, "replace", failing(number))
        with pytest.raises(InputError, match=said) as error:
            write(tmp_path, named("new"))
    assert str(tmp_path) in str(error.value)
    assert read_project(tmp_path) == named("old")
    assert recoverable(tmp_path) is None
    assert not list(tmp_path.rglob("*.part"))


def test_a_failed_save_does_not_push_versions_out(tmp_path, monkeypatch):
    for number in range(3):
        create_project(tmp_path, named(str(number)))
    with monkeypatch.context() as patch:
        patch.setattr("core.files.project.folder.write_text", failing(errno.ENOSPC))
        for _ in range(6):
            with pytest.raises(InputError, match="the disk is full"):
                create_project(tmp_path, named("new"))
    create_project(tmp_path, named("new"))
    assert [read_project(path).project.info.name for path in backups(tmp_path)] == ["2", "1", "0"]


def test_a_file_where_the_folder_should_be_is_named(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="a file stands where a folder is needed"):
        create_project(tmp_path / "file" / "project", named("x"))
    create_project(tmp_path, named("x"))
    (tmp_path / "backups").write_text("x")
    with pytest.raises(InputError, match="a file stands where a folder is needed"):
        create_project(tmp_path, named("y"))


def test_autosaved_changes_can_be_recovered_until_they_are_saved(tmp_path):
    results = {"camera": Done("key", {"views": "1"})}
    create_project(tmp_path, named("saved"))
    assert recoverable(tmp_path) is None
    changed = ProjectFile(new_project("saved"), results)
    write_autosave(tmp_path, changed)
    assert recoverable(tmp_path) == changed
    create_project(tmp_path, changed)
    assert recoverable(tmp_path) is None  # also when the program died before it could remove the autosaved state
    remove_autosave(tmp_path)
    assert names_in(tmp_path) == sorted(["backups", "project.json", f"{tmp_path.name}.trisect"])
    remove_autosave(tmp_path)


def test_an_autosave_older_than_the_project_is_none(tmp_path):
    create_project(tmp_path, named("saved"))
    write_autosave(tmp_path, named("stale"))
    create_project(tmp_path, named("saved later"))
    assert read_project(tmp_path / ".autosave.json") == named("stale")
    assert recoverable(tmp_path) is None


def test_a_damaged_autosave_is_none_and_a_damaged_project_leaves_the_autosave(tmp_path):
    create_project(tmp_path, named("saved"))
    (tmp_path / ".autosave.json").write_bytes(b'{"schema')
    assert recoverable(tmp_path) is None
    write_autosave(tmp_path, named("rescued"))
    (tmp_path / "project.json").write_bytes(b"")
    assert recoverable(tmp_path) == named("rescued")


def test_pictures_inside_a_project_move_with_it(tmp_path):
    project, elsewhere = tmp_path / "project", tmp_path / "set" / "camera"
    inside = project / "recordings" / "scan-20260131-120000"
    inside.mkdir(parents=True)
    elsewhere.mkdir(parents=True)
    assert stored_source(project, inside) == "recordings/scan-20260131-120000"
    assert stored_source(project, elsewhere) == elsewhere.as_posix()
    assert stored_source(project, project / ".." / "set" / "camera") == elsewhere.as_posix()
    assert stored_source(tmp_path / "proj", inside) == inside.as_posix()  # the beginning of a name is no folder
    moved = tmp_path / "elsewhere" / "moved"
    shutil.copytree(project, moved)
    assert source_folder(moved, stored_source(project, inside)) == moved / "recordings" / "scan-20260131-120000"
    assert source_folder(moved, stored_source(project, elsewhere)) == elsewhere
    assert source_folder(moved, "") is None


def test_relative_paths_are_taken_from_where_one_is(tmp_path, monkeypatch):
    (tmp_path / "project" / "scan").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    assert stored_source(Path("project"), Path("project/scan")) == "scan"
    assert stored_source(Path("project"), Path("set")) == (tmp_path / "set").as_posix()


def test_a_recording_set_becomes_a_project_that_measures_it_where_it_lies(tmp_path, monkeypatch):
    folder = tmp_path / "Block 50"
    for part in ("camera", "scan"):
        (folder / part).mkdir(parents=True)
    (folder / "rig.toml").write_text(RIG)
    monkeypatch.chdir(tmp_path)
    project = project_from_set(Path("Block 50"), "first try")
    assert project.sources == Sources((folder / "camera").as_posix(), "", (folder / "scan").as_posix())
    assert sources_of_set(folder) == project.sources
    assert project.info == ProjectInfo(name="first try", part="Block 50")
    assert project.rig == read_rig(folder / "rig.toml")
    assert replace(project, info=ProjectInfo(), sources=Sources(), rig=new_project("").rig) == replace(
        new_project(""), info=ProjectInfo()
    )
    create_project(tmp_path / "project", ProjectFile(project))
    assert read_project(tmp_path / "project").project == project


def test_a_folder_without_rig_is_no_recording_set(tmp_path):
    with pytest.raises(InputError, match=r"rig\.toml: the file is missing"):
        project_from_set(tmp_path, "x")


def test_clocks_that_differ_do_not_hide_a_state_to_recover(tmp_path):
    create_project(tmp_path, named("saved"))
    write_autosave(tmp_path, named("changed"))
    later = datetime.now(UTC) + timedelta(seconds=60)
    os.utime(tmp_path / "project.json", (later.timestamp(), later.timestamp()))  # a copy has other times of its files
    assert recoverable(tmp_path) == named("changed")


@pytest.mark.parametrize("write", [write_project, write_autosave])
def test_a_project_whose_folder_is_gone_is_not_made_anew(tmp_path, write):
    folder = tmp_path / "block"
    create_project(folder, named("old"))
    folder.rename(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="folder is gone; none is made in its place"):
        write(folder, named("new"))
    assert not folder.exists()
    folder.mkdir()  # where a disk was: the empty place of it
    with pytest.raises(InputError, match="folder is gone; none is made in its place"):
        write(folder, named("new"))
    assert not list(folder.iterdir())
    write(tmp_path / "elsewhere", named("new"))


def test_a_version_is_kept_no_sooner_than_asked_for(tmp_path):
    create_project(tmp_path, named("a"))
    for name in ("b", "c", "d"):
        write_project(tmp_path, named(name), keep_s=600.0)
    assert [read_project(path).project.info.name for path in backups(tmp_path)] == ["a"]
    write_project(tmp_path, named("e"))
    assert [read_project(path).project.info.name for path in backups(tmp_path)] == ["d", "a"]


def test_a_free_folder_has_the_name_or_the_next_number_and_may_be_one_that_suits(tmp_path):
    assert free_folder(tmp_path, "Part") == tmp_path / "Part"
    for name in ("Part", "Part 2"):
        (tmp_path / name).mkdir()
    (tmp_path / "Part 3").touch()
    assert free_folder(tmp_path, "Part") == tmp_path / "Part 4"
    assert free_folder(tmp_path, "Part", Path.is_dir) == tmp_path / "Part"
