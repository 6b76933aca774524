"""`trisect import`: the table of a dry run, what is written, and what it refuses."""

import json

import cv2
import numpy as np

from tests.simulated import trisect


def shots(folder, *names):
    folder.mkdir()
    for name in names:
        cv2.imwrite(str(folder / name), np.full((24, 32), 90, np.uint8))
    return folder


def test_a_dry_run_shows_every_pair_and_writes_nothing(tmp_path):
    folder = shots(tmp_path / "shots", "laser_1.png", "board_1.png")
    words = ("import", tmp_path / "set", "--planes", f"{folder}/laser_*", "--planes-off", f"{folder}/board_*")
    said = trisect(*words, "--dry-run")
    assert said.code == 0
    assert "planes/laser_1.png  laser_1.png  board_1.png" in said.out
    assert "what the stars in laser_* and board_* stand for" in said.out
    assert not (tmp_path / "set").exists()


def test_the_set_is_written_and_told_for_machines(tmp_path):
    folder = shots(tmp_path / "shots", "v1.png", "v2.png")
    said = trisect("import", tmp_path / "set", "--camera", folder, "--json")
    told = json.loads(said.out)
    assert sorted(path.name for path in (tmp_path / "set/camera").iterdir()) == ["v1.png", "v2.png"]
    assert told["files"] == {"hard link": 2}
    assert told["pictures"][0] == {"name": "camera/v1.png", "from": str(folder / "v1.png")}


def test_what_cannot_be_understood_leaves_with_2(tmp_path):
    said = trisect("import", tmp_path / "set", "--camera", tmp_path / "gone")
    assert said.code == 2
    assert "there is no such folder" in said.err
