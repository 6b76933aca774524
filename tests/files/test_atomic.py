"""Folders of programs that were killed in the middle."""

import os
import time

from core.files.atomic import remove_leftovers


def left(parent, name, hours):
    folder = parent / name
    inside = folder / "project" / "results"
    inside.mkdir(parents=True)
    (inside / "cloud.ply").write_bytes(b"half")
    then = time.time() - 3600 * hours
    for path in (inside, inside.parent, folder):
        os.utime(path, (then, then))
    return folder


def test_only_what_was_to_become_this_folder_goes_and_only_when_it_is_quiet(tmp_path):
    old, fresh = left(tmp_path, ".Sample.abc", 1), left(tmp_path, ".Sample.def", 0)
    other, whole = left(tmp_path, ".Other.abc", 1), left(tmp_path, "Sample", 1)
    remove_leftovers(tmp_path / "Sample")
    assert not old.exists()
    assert all(path.exists() for path in (fresh, other, whole))
    remove_leftovers(tmp_path / "Sample", quiet_s=0)
    assert not fresh.exists()
    assert whole.exists()


def test_work_deep_inside_keeps_a_folder(tmp_path):
    busy = left(tmp_path, ".Sample.abc", 1)
    os.utime(busy / "project" / "results")
    remove_leftovers(tmp_path / "Sample")
    assert busy.exists()


def test_where_there_is_nothing_nothing_happens(tmp_path):
    remove_leftovers(tmp_path / "nowhere" / "Sample")
