"""A project copied: whole or not at all, and its own."""

import pytest

from core.errors import Cancelled, InputError
from core.files.project.copying import copy_project
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project, read_project, write_autosave


@pytest.fixture
def folder(tmp_path):
    place = tmp_path / "original"
    create_project(place, ProjectFile(new_project("Block")))
    (place / "recordings" / "scan-1").mkdir(parents=True)
    (place / "recordings" / "scan-1" / "frame0000.png").write_bytes(b"picture")
    (place / "results" / ".new").mkdir(parents=True)
    (place / "results" / ".new" / "cloud.ply").write_bytes(b"half")
    write_autosave(place, ProjectFile(new_project("Changed")))
    return place


def test_recordings_come_along_and_what_belongs_to_a_running_program_does_not(folder, tmp_path):
    told = []
    to = copy_project(folder, tmp_path / "places" / "copy", lambda *now: told.append(now))
    assert read_project(to) == read_project(folder)
    assert (to / "recordings" / "scan-1" / "frame0000.png").read_bytes() == b"picture"
    assert not (to / ".autosave.json").exists() and not (to / "results").exists()
    assert told[-1][0] == "copying" and told[-1][1] == told[-1][2]


def test_the_copy_of_what_is_read_only_can_be_written_to(folder, tmp_path):
    (folder / "project.json").chmod(0o444)
    to = copy_project(folder, tmp_path / "copy")
    assert (to / "project.json").stat().st_mode & 0o200
    create_project(to, ProjectFile(new_project("Changed")))


def test_a_place_that_is_taken_or_inside_the_project_is_refused(folder, tmp_path):
    (tmp_path / "taken").mkdir()
    with pytest.raises(InputError, match="there already"):
        copy_project(folder, tmp_path / "taken")
    with pytest.raises(InputError, match="within the project"):
        copy_project(folder, folder / "copy")


def test_what_was_not_copied_whole_is_not_there(folder, tmp_path):
    def stop(step, done, total):
        if done == 1:
            raise Cancelled

    with pytest.raises(Cancelled):
        copy_project(folder, tmp_path / "copy", stop)
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="cannot be written"):
        copy_project(folder, tmp_path / "file" / "copy")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "original"]
