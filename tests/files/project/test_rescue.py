"""What a damaged project can be opened from."""

import os

import pytest

from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import can_be_saved, create_project, read_project, rescues, write_autosave
from core.files.project.json_form import NewerProject


def named(name):
    return ProjectFile(new_project(name))


def damaged(folder, *names):
    for name in names:
        create_project(folder, named(name))
    (folder / "project.json").write_bytes(b'{"schema_version": 1, "info": {"na')
    return folder


def test_the_newest_good_backup_is_found_past_the_damaged_ones(tmp_path):
    folder = damaged(tmp_path, "first", "second", "third")
    newest = max((folder / "backups").iterdir())
    newest.write_bytes(b"")
    (version,) = rescues(folder)
    assert version.file == named("first")
    assert not version.autosaved


def test_the_newer_of_autosave_and_backup_comes_first(tmp_path):
    folder = damaged(tmp_path, "first", "second")
    write_autosave(folder, named("typed last"))
    autosave, backup = rescues(folder)
    assert (autosave.file, backup.file) == (named("typed last"), named("first"))
    assert (autosave.autosaved, backup.autosaved) == (True, False)


def test_nothing_is_made_up_where_nothing_is_good(tmp_path):
    folder = damaged(tmp_path)
    assert rescues(folder) == ()
    (folder / ".autosave.json").write_bytes(b"also damaged")
    assert rescues(folder) == ()


def test_a_project_of_a_newer_program_is_told_apart_from_a_damaged_one(tmp_path):
    (tmp_path / "project.json").write_text('{"schema_version": 999}')
    with pytest.raises(NewerProject, match="newer version of Trisect"):
        read_project(tmp_path)


def test_a_folder_that_cannot_be_written_to_is_known(tmp_path, monkeypatch):
    assert can_be_saved(tmp_path)
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert not can_be_saved(tmp_path)
