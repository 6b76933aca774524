"""Pictures added to pictures that are there."""

import pytest

from core.errors import InputError
from core.files.recording.add_recording import add_recording


def folder_with(folder, *names):
    folder.mkdir()
    for name in names:
        (folder / name).write_text(f"{folder.name}/{name}")
    return folder


def held(folder):
    return {path.name: path.read_text() for path in sorted(folder.iterdir())}


def test_pictures_that_were_there_keep_their_names_and_new_ones_get_the_next(tmp_path):
    before = folder_with(tmp_path / "old", "view00.png", "view01.png", "view03.png")
    recorded = folder_with(tmp_path / "new", "view00.png", "view01.png", "view02.png")
    add_recording(before, recorded)
    assert held(recorded) == {
        "view00.png": "old/view00.png",
        "view01.png": "old/view01.png",
        "view02.png": "new/view02.png",
        "view03.png": "old/view03.png",
        "view04.png": "new/view00.png",
        "view05.png": "new/view01.png",
    }
    assert len(held(before)) == 3


def test_the_two_pictures_of_a_pair_stay_together(tmp_path):
    before = folder_with(tmp_path / "old", "pose00.png", "pose00_off.png")
    recorded = folder_with(tmp_path / "new", "pose00.png", "pose00_off.png")
    add_recording(before, recorded)
    assert held(recorded)["pose01.png"] == "new/pose00.png"
    assert held(recorded)["pose01_off.png"] == "new/pose00_off.png"
    assert held(recorded)["pose00_off.png"] == "old/pose00_off.png"


def test_names_without_a_number_get_one(tmp_path):
    before = folder_with(tmp_path / "old", "left.png")
    recorded = folder_with(tmp_path / "new", "left.png")
    add_recording(before, recorded)
    assert set(held(recorded)) == {"left.png", "left-1.png"}


def test_the_same_name_with_another_ending_is_another_picture_of_that_name(tmp_path):
    before = folder_with(tmp_path / "old", "view00.tif")
    recorded = folder_with(tmp_path / "new", "view00.png")
    add_recording(before, recorded)
    assert set(held(recorded)) == {"view00.tif", "view01.png"}


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    before = folder_with(tmp_path / "old", "view00.png")
    with pytest.raises(InputError):
        add_recording(before, tmp_path / "nowhere")
