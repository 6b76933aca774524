"""Every bad input a technician can hand over: one clear sentence naming file and field, and nothing half written."""

import errno
import json
import os
import signal
import subprocess
import sys
import time

import cv2
import numpy as np
import pytest

from core.files.pictures import read_picture, write_picture
from tests.simulated import CUT, SMALL, TINY, copy_of, trisect


@pytest.fixture
def folder(simulated, tmp_path):
    return copy_of(simulated, tmp_path / "set")


@pytest.fixture
def tiny(tiny_set, tmp_path):
    return copy_of(tiny_set, tmp_path / "set")


@pytest.fixture
def out(measured, tmp_path):
    return copy_of(measured, tmp_path / "out")


def frames_of(folder):
    return sorted(path for path in (folder / "scan").iterdir() if path.stem != "reference")


def frame_records(out):
    return json.loads((out / "run.json").read_text())["frames"]


def edit_rig(folder, old, new):
    rig = folder / "rig.toml"
    text = rig.read_text()
    assert old in text
    rig.write_text(text.replace(old, new, 1))


def test_empty_set(tmp_path):
    (tmp_path / "set").mkdir()
    said = trisect("run", tmp_path / "set", "--out", tmp_path / "out")
    assert said.code == 2
    assert "set: the recording set is empty; it needs rig.toml" in said.sentence
    assert not (tmp_path / "out").exists()


def test_no_set_at_all(tmp_path):
    said = trisect("run", tmp_path / "nowhere", "--out", tmp_path / "out")
    assert said.code == 2
    assert "nowhere: there is no such folder" in said.sentence


@pytest.mark.parametrize(
    ("part", "what"), [("scan", "no frames"), ("camera", "no pictures of the camera target"), ("planes", "fan on")]
)
def test_a_part_without_pictures_is_told_before_anything_is_measured(folder, tmp_path, part, what):
    for path in (folder / part).iterdir():
        path.unlink()
    said = trisect("run", folder, "--out", tmp_path / "new")
    assert said.code == 2
    assert part in said.sentence
    assert what in said.sentence
    assert not (tmp_path / "new").exists()


def test_errors_in_json_for_machines(tmp_path):
    said = trisect("run", tmp_path / "nowhere", "--out", tmp_path / "out", "--json")
    assert said.code == 2
    assert "nowhere" in json.loads(said.out)["error"]


def test_one_truncated_frame_among_good_ones_is_skipped_counted_and_reported(folder, out):
    victim = frames_of(folder)[3]
    victim.write_bytes(victim.read_bytes()[: victim.stat().st_size // 2])
    said = trisect("scan", folder, "--out", out, *CUT, "--json")
    assert said.code == 0, said.err
    values = json.loads(said.out)
    name = f"scan/{victim.name}"
    early = {"code": "picture.ends_early", "text": "ends early", "values": {}}
    why = {"reason": "the picture ends early", "code": "picture.damaged", "values": {"reason": early}}
    assert values["frames_left_out"] == [{"name": name} | why]
    assert any(name in note["text"] and "1 of" in note["text"] and note["code"] for note in values["notes"])
    assert len(frame_records(out)) == SMALL.frames
    assert (frame_records(out)[3]["name"], frame_records(out)[3]["points"]) == (name, 0)
    assert frame_records(out)[4]["points"] > 0


def test_truncated_reference_is_named(folder, out):
    reference = folder / "scan" / "reference.png"
    reference.write_bytes(reference.read_bytes()[:-100])
    said = trisect("scan", folder, "--out", out, *CUT)
    assert said.code == 2
    assert "reference.png: the picture ends early" in said.sentence


def test_mixed_picture_sizes_name_the_odd_file(folder, out):
    victim = frames_of(folder)[5]
    write_picture(victim, np.ascontiguousarray(read_picture(victim)[:, :-2]))
    said = trisect("scan", folder, "--out", out, *CUT)
    assert said.code == 2
    assert victim.name in said.sentence
    assert "pixels" in said.sentence


def test_pictures_of_another_size_than_the_calibration(folder, out):
    for path in folder.rglob("*.png"):
        write_picture(path, np.ascontiguousarray(read_picture(path)[:, :-2]))
    for step, said in ((step, trisect(step, folder, "--out", out)) for step in ("planes", "scan")):
        assert said.code == 2, step
        assert "camera.json was calibrated at" in said.sentence


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("square_mm", "squares_mm", ["camera_target.squares_mm is an unknown key", "did you mean square_mm"]),
        ("inner_corners = [", 'inner_corners = "x" #', ["camera_target.inner_corners", '"x"', "[columns, rows]"]),
        ("lines = 3", "lines = 3000", ["laser_fan.lines is 3000", "from 1 to 20"]),
        ("side_mm = ", "side_mm = -", ["plane_target.side_mm is -", "above 0"]),
        ("[laser_fan]", "[laser_fun]", ["laser_fun is an unknown key", "laser_fan"]),
    ],
)
def test_wrong_rig(folder, tmp_path, old, new, parts):
    edit_rig(folder, old, new)
    said = trisect("run", folder, "--out", tmp_path / "new")
    assert said.code == 2
    for part in ["rig.toml", *parts]:
        assert part in said.sentence


def test_missing_rig(folder, tmp_path):
    (folder / "rig.toml").unlink()
    said = trisect("run", folder, "--out", tmp_path / "new")
    assert said.code == 2
    assert "rig.toml: the file is missing" in said.sentence


def test_wrong_inner_corners(tiny, tmp_path):
    edit_rig(tiny, "inner_corners = [", "inner_corners = [8, 5] # [")
    for view in sorted((tiny / "camera").iterdir())[2:]:
        view.unlink()
    said = trisect("camera", tiny, "--out", tmp_path / "new")
    assert said.code == 2
    assert "camera" in said.sentence
    assert "in the first 2 pictures the board shows 17 × 12 inner corners, not 8 × 5" in said.sentence
    assert "rig.toml" in said.sentence
    assert not (tmp_path / "new" / "camera.json").exists()


def spoil(path, how):
    picture = read_picture(path)
    if how == "noise":
        picture = np.random.default_rng(0).normal(90, 4, picture.shape).astype(np.uint8)
    write_picture(path, np.full_like(picture, {"black": 0, "white": 255}[how]) if how != "noise" else picture)


def test_a_view_without_a_board_and_a_black_and_a_white_one_are_left_out(tiny, tmp_path):
    views = sorted((tiny / "camera").iterdir())
    for view, how in zip(views, ("noise", "black", "white"), strict=False):
        spoil(view, how)
    said = trisect("camera", tiny, "--out", tmp_path / "new", "--json")
    assert said.code == 0, said.err
    values = json.loads(said.out)
    assert values["views_used"] == TINY.camera_views - 3
    assert [view["name"] for view in values["views_left_out"]] == [f"camera/{view.name}" for view in views[:3]]
    assert all(view["reason"] and view["code"] and view["values"] is not None for view in values["views_left_out"])
    assert any(f"camera/{views[0].name}" in note["text"] for note in values["notes"])


@pytest.mark.accuracy
def test_black_and_white_frames_among_good_ones(folder, out):
    frames = frames_of(folder)
    spoil(frames[2], "black")
    spoil(frames[6], "white")
    said = trisect("scan", folder, "--out", out, *CUT)
    assert said.code == 0, said.err
    records = frame_records(out)
    assert [record["points"] > 0 for record in (records[2], records[6])] == [False, False]
    assert records[2]["reason"]["code"] == "scan.frame_black"
    assert records[6]["reason"]["code"] == "scan.frame_white"


@pytest.mark.parametrize("how", ["black", pytest.param("white", marks=pytest.mark.accuracy)])
def test_only_black_or_white_frames(folder, out, how):
    for frame in frames_of(folder):
        spoil(frame, how)
    said = trisect("scan", folder, "--out", out, *CUT)
    assert said.code == 2
    assert "scan" in said.sentence


@pytest.mark.parametrize("how", ["black", "white"])
def test_black_or_white_reference(folder, out, how):
    spoil(folder / "scan" / "reference.png", how)
    said = trisect("scan", folder, "--out", out, *CUT)
    assert said.code == 2
    assert "reference" in said.sentence


def test_fewer_fan_lines_than_promised(folder, out):
    edit_rig(folder, "lines = 3", "lines = 4")
    said = trisect("planes", folder, "--out", out)
    assert said.code == 2
    assert "planes" in said.sentence
    assert "3 of the 4" in said.sentence
    assert "laser_fan.lines" in said.sentence


def test_no_sweep_crosses_the_fan(folder, out):
    size = 220
    reference = read_picture(folder / "scan" / "reference.png")
    row, column = darkest_patch(reference, size)
    rows, columns = np.mgrid[:size, :size]
    for number, frame in enumerate(frames_of(folder)):
        stripe = 120 * np.exp(-((rows - columns * 0.03 * (number % 5) - 100) ** 2) / 5)
        picture = reference.astype(np.float64)
        picture[row : row + size, column : column + size] += stripe
        write_picture(frame, np.clip(picture, 0, 255).astype(np.uint8))
    said = trisect("scan", folder, "--out", out, *CUT)
    assert said.code == 2
    assert "scan: no sweep crosses the fan" in said.sentence


def darkest_patch(picture, size):
    """Corner of the patch of `size` pixels that the fan's light is farthest from."""
    brightest = cv2.dilate(cv2.GaussianBlur(picture, (0, 0), 2), np.ones((size, size)), anchor=(0, 0))
    inside = brightest[: -size or None, : -size or None]
    return np.unravel_index(np.argmin(inside), inside.shape)


def move_from(folder, first):
    for frame in frames_of(folder)[first:]:
        write_picture(frame, np.roll(read_picture(frame), (2, 3), axis=(0, 1)))


@pytest.mark.accuracy
def test_the_object_moves_towards_the_end(folder, out):
    move_from(folder, 14)
    said = trisect("scan", folder, "--out", out, *CUT, "--json")
    assert said.code == 0, said.err
    moved = [record for record in frame_records(out) if record["reason"] and "moved" in record["reason"]["text"]]
    assert [record["index"] for record in moved] == list(range(14, SMALL.frames))
    assert any("moved" in note["text"] for note in json.loads(said.out)["notes"])


def test_the_object_moves_before_enough_is_seen(folder, out):
    move_from(folder, 10)
    said = trisect("scan", folder, "--out", out, *CUT)
    assert said.code == 2
    assert "moved during the scan, the first frame after it is scan/frame0010.png, and only 10 frames" in said.sentence


@pytest.mark.parametrize(
    ("name", "change", "parts"),
    [
        ("camera.json", lambda t: t["matrix"][0].__setitem__(0, float("nan")), ["matrix[0][0] is NaN"]),
        ("camera.json", lambda t: t["matrix"][1].__setitem__(1, 0.0), ["matrix[1][1] is 0", "focal length"]),
        ("planes.json", lambda t: t["planes"][1]["pi"].__setitem__(2, float("nan")), ["planes[1].pi[2] is NaN"]),
        ("planes.json", lambda t: t["planes"][0].__setitem__("pi", [0, 0, 0]), ["planes[0].pi is [0, 0, 0]"]),
    ],
)
def test_nan_or_zero_in_a_calibration_file(simulated, out, name, change, parts):
    tables = json.loads((out / name).read_text())
    change(tables)
    (out / name).write_text(json.dumps(tables))
    said = trisect("scan", simulated, "--out", out, *CUT)
    assert said.code == 2
    for part in [str(out / name), *parts]:
        assert part in said.sentence


def test_a_step_without_the_one_before_says_which(simulated, tmp_path):
    out = tmp_path / "new"
    for step, before in (("planes", "trisect camera"), ("scan", "trisect camera"), ("gauge", "trisect camera")):
        said = trisect(step, simulated, "--out", out)
        assert said.code == 2
        assert "camera.json: the file is missing" in said.sentence
        assert before in said.sentence


def test_a_cloud_of_another_calibration_is_refused(simulated, out):
    for name in ("camera.json", "planes.json"):
        tables = json.loads((out / name).read_text())
        if name == "camera.json":
            tables["matrix"][0][0] *= 1.001
        else:
            del tables["camera_id"]
        (out / name).write_text(json.dumps(tables))
    for step in ("gauge", "report"):
        said = trisect(step, simulated, "--out", out)
        assert said.code == 2
        assert "was measured with calibration" in said.sentence


def test_output_folder_that_cannot_be_made(simulated, tmp_path):
    (tmp_path / "file").write_text("in the way")
    for out in (tmp_path / "file", tmp_path / "file" / "deep"):
        said = trisect("run", simulated, "--out", out)
        assert said.code == 2
        assert str(out) in said.sentence
        assert "a file stands where a folder is needed" in said.sentence


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="the superuser may write everywhere")
def test_output_folder_without_permission(simulated, tmp_path):
    out = tmp_path / "locked"
    out.mkdir(mode=0o500)
    said = trisect("run", simulated, "--out", out)
    assert said.code == 2
    assert "no permission to write here" in said.sentence


def test_results_inside_the_set_are_refused(simulated):
    said = trisect("camera", simulated, "--out", simulated)
    assert said.code == 2
    assert "cannot go into the recording set itself" in said.sentence


def test_full_disk(simulated, out, monkeypatch):
    before = {path.name: path.read_bytes() for path in out.iterdir()}

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    said = trisect("gauge", simulated, "--out", out)
    assert said.code == 2
    assert "cannot be written, because the disk is full" in said.sentence
    assert str(out) in said.sentence
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


@pytest.mark.accuracy
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for a single child")
def test_interrupt_half_way_leaves_whole_files_only(simulated, tmp_path):
    out = tmp_path / "new"
    process = subprocess.Popen(
        [sys.executable, "-m", "core.cli", "run", str(simulated), "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 120
    while not (out / "camera.json").exists() and time.monotonic() < deadline:
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, complaint = process.communicate(timeout=60)
    assert process.returncode == 130
    assert complaint.splitlines()[-1].startswith("trisect: interrupted")
    assert json.loads((out / "camera.json").read_text())["matrix"]
    assert not [path.name for path in out.iterdir() if path.name.endswith(".part")]
    assert not (out / "report.pdf").exists()
