import errno
import json
import math
import os
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.errors import InputError
from core.files.project.calibration_store import (
    history,
    put_in_place,
    read_stored,
    read_stored_camera,
    read_stored_planes,
    read_stored_poses,
    store_camera,
    store_planes,
)
from core.files.project.data import Accepted
from core.files.recording.features_file import read_poses
from core.files.results.camera_file import camera_id, read_camera, write_camera
from core.files.results.planes_file import planes_id, read_planes, write_planes
from core.image.targets.target_view import TargetView
from core.messages import plain
from core.model import Camera, Fan, LightPlane
from core.settings.options import Options

POSES = (
    PoseFeatures("p1", TargetView(np.eye(3), np.ones((3, 2)), np.ones(3), "p1"), ()),
    PoseFeatures("p2", None, (), plain("there is no target")),
)


@pytest.fixture
def other_camera(camera):
    other = camera.camera
    return replace(camera, camera=Camera(other.image_size, other.matrix * np.array([1.001, 1, 1]), other.distortion))


@pytest.fixture
def other_fan(fan):
    return replace(fan, fan=Fan(tuple(LightPlane(plane.pi * 1.01) for plane in fan.fan.planes)), rms_mm=(1.0, 2.0, 3.0))


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_kept_camera_comes_back_by_its_id(tmp_path, camera):
    kept = store_camera(tmp_path, camera, Options().run_settings("camera"))
    assert kept == camera_id(camera.camera)
    assert camera_id(read_stored_camera(tmp_path, kept).camera) == kept
    write_camera(tmp_path / "camera.json", camera)
    assert (tmp_path / "calibrations" / f"camera-{kept}.json").read_bytes() == (tmp_path / "camera.json").read_bytes()


def test_a_kept_fan_comes_back_by_its_id_with_its_poses(tmp_path, camera, fan):
    kept = store_planes(tmp_path, fan, camera.camera, POSES)
    assert kept == planes_id(fan.fan)
    assert planes_id(read_stored_planes(tmp_path, kept, camera.camera).fan) == kept
    back = read_stored_poses(tmp_path, kept)
    assert [(pose.name, pose.reason) for pose in back] == [("p1", None), ("p2", plain("there is no target"))]
    assert np.array_equal(back[0].view.points, np.eye(3))
    write_planes(tmp_path / "planes.json", fan, camera.camera)
    assert (tmp_path / "calibrations" / f"planes-{kept}.json").read_bytes() == (tmp_path / "planes.json").read_bytes()


def test_the_history_tells_what_was_kept_the_newest_first(tmp_path, camera, other_camera, fan):
    assert history(tmp_path) == ()
    begun = datetime.now(UTC)
    one = store_camera(tmp_path, camera, Options().run_settings("camera"))
    lines = store_planes(tmp_path, fan, camera.camera, POSES, {"constrained": "never"})
    other = store_camera(
        tmp_path,
        replace(other_camera, cross_validation_mm=0.02),
        Options(excluded=frozenset({"camera/b.png"})).run_settings("camera"),
    )
    newest, middle, oldest = history(tmp_path)
    assert [(entry.kind, entry.id) for entry in (newest, middle, oldest)] == [
        ("camera", other), ("planes", lines), ("camera", one),
    ]  # fmt: skip
    assert begun <= oldest.kept_at <= middle.kept_at <= newest.kept_at <= datetime.now(UTC)
    assert (oldest.used, oldest.total, oldest.rms_px, oldest.rms_mm, oldest.camera_id) == (1, 2, 0.11, (), "")
    assert math.isnan(oldest.expected_error_mm)
    assert newest.expected_error_mm == 0.02
    assert newest.settings["excluded"] == ["camera/b.png"]
    assert "excluded" not in oldest.settings
    assert (middle.used, middle.total, middle.rms_mm, middle.camera_id) == (1, 1, (0.01, 0.02, 0.03), one)
    assert math.isnan(middle.rms_px)
    assert middle.settings == {"constrained": "never"}


def test_light_planes_kept_by_an_earlier_version_under_the_name_of_the_laser_are_in_the_history(tmp_path, camera, fan):
    id_ = store_planes(tmp_path, fan, camera.camera, POSES)
    about = tmp_path / "calibrations" / f"planes-{id_}.kept.json"
    about.write_text(about.read_text().replace('"kind": "planes"', '"kind": "fan"'))
    assert '"fan"' in about.read_text()
    assert [(entry.kind, entry.id) for entry in history(tmp_path)] == [("planes", id_)]
    kept = read_stored(tmp_path, "planes", id_)
    assert kept is not None and kept.kind == "planes"


def test_what_is_kept_again_becomes_the_newest(tmp_path, camera, other_camera):
    one = store_camera(tmp_path, camera, Options().run_settings("camera"))
    other = store_camera(tmp_path, other_camera, Options().run_settings("camera"))
    assert one != other
    assert store_camera(tmp_path, camera, Options().run_settings("camera")) == one
    assert [entry.id for entry in history(tmp_path)] == [one, other]


def test_planes_whose_file_does_not_know_its_facts_are_kept_anew_under_their_id(tmp_path, camera, fan):
    kept_id = store_planes(tmp_path, fan, camera.camera, POSES)
    (entry,) = history(tmp_path)
    assert not entry.facts_known, "as of an earlier version"
    every = np.zeros((3 * fan.fan.lines, 10))
    known = replace(fan, converged=True, points_off_alike=None, flatness_assumed=False, by_camera=every)
    assert store_planes(tmp_path, known, camera.camera, POSES) == kept_id
    (entry,) = history(tmp_path)
    assert entry.facts_known, "and that its few poses leave one of them open"
    assert read_stored_planes(tmp_path, kept_id, camera.camera).converged is True
    (tmp_path / "calibrations" / f"planes-{kept_id}.json").write_text("{")
    assert not history(tmp_path)[0].facts_known, "a damaged one tells nothing, and does not hide the others"


def test_a_calibration_that_was_taken_away_is_not_in_the_history(tmp_path, camera):
    kept = store_camera(tmp_path, camera, Options().run_settings("camera"))
    (tmp_path / "calibrations" / f"camera-{kept}.json").unlink()
    assert history(tmp_path) == ()
    with pytest.raises(InputError, match=f"the calibration {kept} is not in the project; calibrate again"):
        read_stored_camera(tmp_path, kept)
    with pytest.raises(InputError, match="the calibration nothing is not in the project"):
        read_stored_planes(tmp_path, "nothing", camera.camera)
    with pytest.raises(InputError, match="the calibration nothing is not in the project"):
        read_stored_poses(tmp_path, "nothing")


def test_a_calibration_half_kept_is_none(tmp_path, camera, monkeypatch):
    before = Path.replace

    def full(path, target):
        if target.name.endswith(".kept.json"):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return before(path, target)

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(InputError, match="the disk is full"):
        store_camera(tmp_path, camera, Options().run_settings("camera"))
    assert history(tmp_path) == ()


def test_a_damaged_entry_is_named(tmp_path, camera):
    kept = store_camera(tmp_path, camera, Options().run_settings("camera"))
    about = tmp_path / "calibrations" / f"camera-{kept}.kept.json"
    tables = json.loads(about.read_text())
    about.write_text(json.dumps({**tables, "kept_at": "long ago"}))
    with pytest.raises(InputError, match=r'kept\.json: kept_at is "long ago", not a date and time'):
        history(tmp_path)
    about.write_text("{")
    with pytest.raises(InputError, match=r"kept\.json: this is no valid JSON"):
        history(tmp_path)


def test_a_calibration_changed_by_hand_is_refused(tmp_path, camera, fan):
    kept, lines = (
        store_camera(tmp_path, camera, Options().run_settings("camera")),
        store_planes(tmp_path, fan, camera.camera, POSES),
    )
    for name, key in ((f"camera-{kept}.json", "matrix"), (f"planes-{lines}.json", "planes")):
        path = tmp_path / "calibrations" / name
        tables = json.loads(path.read_text())
        if key == "matrix":
            tables["matrix"][0][0] += 1
        else:
            tables["planes"] = tables["planes"][::-1]
        path.write_text(json.dumps(tables))
    with pytest.raises(InputError, match="the file holds the calibration"):
        read_stored_camera(tmp_path, kept)
    with pytest.raises(InputError, match="the file holds the calibration"):
        read_stored_planes(tmp_path, lines, camera.camera)


def test_the_accepted_ones_are_put_in_place_byte_by_byte(tmp_path, camera, other_camera, fan, other_fan):
    results = tmp_path / "results"
    one = Accepted(
        store_camera(tmp_path, camera, Options().run_settings("camera")),
        store_planes(tmp_path, fan, camera.camera, POSES),
    )
    other = Accepted(
        store_camera(tmp_path, other_camera, Options().run_settings("camera")),
        store_planes(tmp_path, other_fan, other_camera.camera, POSES[:1]),
    )
    for accepted, calibration, lines in ((one, camera, fan), (other, other_camera, other_fan), (one, camera, fan)):
        put_in_place(tmp_path, accepted, results)
        assert names_in(results) == ["camera.json", "planes.json", "planes.npz"]
        found = read_camera(results / "camera.json").camera
        assert camera_id(found) == camera_id(calibration.camera)
        assert read_planes(results / "planes.json", found).rms_mm == lines.rms_mm
        assert len(read_poses(results / "planes.npz", accepted.planes)) == (2 if accepted is one else 1)
    stored = tmp_path / "calibrations"
    assert (results / "camera.json").read_bytes() == (stored / f"camera-{one.camera}.json").read_bytes()
    assert (results / "planes.json").read_bytes() == (stored / f"planes-{one.planes}.json").read_bytes()
    assert (results / "planes.npz").read_bytes() == (stored / f"planes-{one.planes}.npz").read_bytes()


def test_what_is_in_place_already_is_left_alone(tmp_path, camera, fan):
    accepted = Accepted(
        store_camera(tmp_path, camera, Options().run_settings("camera")),
        store_planes(tmp_path, fan, camera.camera, POSES),
    )
    put_in_place(tmp_path, accepted, tmp_path / "results")
    before = {path: path.stat().st_ino for path in (tmp_path / "results").iterdir()}
    put_in_place(tmp_path, accepted, tmp_path / "results")
    assert {path: path.stat().st_ino for path in (tmp_path / "results").iterdir()} == before
    (tmp_path / "results" / "planes.json").write_text("{}")
    put_in_place(tmp_path, accepted, tmp_path / "results")
    changed = {path.name for path in (tmp_path / "results").iterdir() if path.stat().st_ino != before[path]}
    assert changed == {"planes.json"}


def test_nothing_is_put_in_place_unless_both_are_accepted_and_belong_together(
    tmp_path, camera, other_camera, fan, other_fan
):
    one = store_camera(tmp_path, camera, Options().run_settings("camera"))
    other = store_camera(tmp_path, other_camera, Options().run_settings("camera"))
    lines = store_planes(tmp_path, fan, camera.camera, POSES)
    results = tmp_path / "results"
    for accepted, said in (
        (Accepted("", lines), "no calibration of the camera is accepted yet"),
        (Accepted(one, ""), "no calibration of the laser planes is accepted yet"),
        (Accepted(other, lines), "the camera was calibrated again"),
        (Accepted(one, planes_id(other_fan.fan)), "is not in the project"),
    ):
        with pytest.raises(InputError, match=said):
            put_in_place(tmp_path, accepted, results)
    assert not results.exists()
