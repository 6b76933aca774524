"""What the pictures for a calibration showed is kept in the project, and taken up only for the same pictures."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.views import SeenView, SeenViews
from core.errors import InputError
from core.files.project.calibration_store import history
from core.files.project.data import Accepted
from core.files.recording.features_file import read_views, write_views
from core.files.recording.rig import Rig
from core.image.targets import Checkerboard
from core.image.targets.target_view import TargetView
from core.messages import plain
from core.pipeline.project.calibration import find_views, found_poses, found_views, solve_poses, solve_views
from tests.simulated import copy_of


def test_a_camera_nobody_accepted_is_solved_again_from_what_was_found_to_the_last_digit(done):
    project = replace(done.project, accepted=Accepted())
    seen = found_views(done.folder, project)
    assert [one.name for one in seen.views] == [one.name for one in done.seen.views]
    again = solve_views(done.folder, project, seen)
    assert np.array_equal(again.camera.matrix, done.camera.camera.matrix)
    assert again.rms_px == done.camera.rms_px
    assert [view.reason for view in again.views] == [view.reason for view in done.camera.views]


def test_planes_nobody_accepted_are_solved_again_from_what_was_found_to_the_last_digit(done):
    project = replace(done.project, accepted=replace(done.project.accepted, planes=""))
    poses = found_poses(done.folder, project)
    assert [(pose.name, pose.reason, pose.notes) for pose in poses] == [
        (pose.name, pose.reason, pose.notes) for pose in done.poses
    ]
    again = solve_poses(done.folder, project, poses)
    for one, other in zip(again.fan.planes, done.fan.fan.planes, strict=True):
        assert np.array_equal(one.pi, other.pi)


def test_what_was_found_by_another_target_or_camera_is_not_taken_up(done):
    other_target = Rig(Checkerboard(9, 6, 10.0), done.project.rig.plane_target, 3, done.project.rig.angle)
    assert found_views(done.folder, replace(done.project, rig=other_target)) is None
    assert found_poses(done.folder, replace(done.project, accepted=Accepted("another"))) == ()


def test_pictures_that_were_changed_are_searched_again(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    pictures = copy_of(done.project.sources.camera, tmp_path / "camera")
    project = replace(done.project, sources=replace(done.project.sources, camera=str(pictures)))
    assert found_views(folder, project) is not None  # the same pictures in another place
    next(iter(sorted(pictures.iterdir()))).unlink()
    assert found_views(folder, project) is None
    seen = find_views(folder, project)
    assert len(found_views(folder, project).views) == len(seen.views)


def test_a_damaged_file_is_passed_over_and_none_of_it_is_in_the_history(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    for name in ("camera-found.npz", "planes-found.npz"):
        path = folder / "calibrations" / name
        path.write_bytes(path.read_bytes()[:200])
    assert found_views(folder, done.project) is None
    assert found_poses(folder, done.project) == ()
    assert len(history(folder)) == 2


def test_what_was_seen_reads_back_as_it_was_written(tmp_path):
    view = TargetView(np.array([[0.0, 0, 0], [10, 0, 0]]), np.array([[1.5, 2], [3, 4]]), np.array([0.1, 0.2]), "b")
    views = (
        SeenView("a", None, plain("damaged")),
        SeenView("b", view, None, (64, 48)),
        SeenView("c", None, plain("x"), (9, 8)),
    )
    seen = SeenViews(views, "somewhere")
    path = tmp_path / "views.npz"
    write_views(path, "key", seen)
    back = read_views(path, "key")
    assert back.where == "somewhere"
    assert [(one.name, str(one.reason or ""), one.size) for one in back.views] == [
        ("a", "damaged", None), ("b", "", (64, 48)), ("c", "x", (9, 8)),
    ]  # fmt: skip
    assert back.views[0].view is None and np.array_equal(back.views[1].view.uv, view.uv)
    assert back.views[1].view.name == "b"
    assert read_views(path, "another key") is None
    path.write_bytes(b"nothing")
    with pytest.raises(InputError, match="no whole file of arrays"):
        read_views(path, "key")
