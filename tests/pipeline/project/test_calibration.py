"""The calibrations of a project: what is left out has no part in them, and what is accepted is what was solved."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.files.project.data import Accepted
from core.image.exclusion import Exclusion
from core.image.stripes.stripe import StripeSettings
from core.messages import plain
from core.pipeline.project.calibration import accept_planes, find_poses, found_poses, solve_poses, solve_views
from core.pipeline.project.camera_history import recall_camera
from core.pipeline.project.details import show_pose
from core.pipeline.project.measuring import measure_scan
from tests.simulated import contents, copy_of


def test_without_an_accepted_camera_the_fan_cannot_be_looked_at(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    project = replace(done.project, accepted=Accepted())
    with pytest.raises(InputError, match="no calibration of the camera is accepted"):
        find_poses(folder, project)
    with pytest.raises(InputError, match="accepted"):
        measure_scan(folder, project)


def test_a_fan_of_other_settings_than_those_in_force_is_not_accepted(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    project = done.with_options(excluded=frozenset({"planes/pose02"}))
    before = contents(folder)
    with pytest.raises(InputError, match="solve the laser planes again"):
        accept_planes(folder, project, done.fan, done.poses)
    assert contents(folder) == before


def test_a_view_left_out_has_no_part_in_the_camera_but_its_residuals_are_known(done):
    name = done.seen.views[2].name
    without = solve_views(done.folder, done.with_options(excluded=frozenset({name})), done.seen)
    view = without.views[2]
    assert (view.view.name, view.used, view.exclusion) == (name, False, Exclusion.BY_HAND)
    assert np.isfinite(view.residuals).all()
    assert 0 < view.rms_px < 1
    assert [v.view.name for v in without.views] == [v.view.name for v in done.camera.views]
    assert not np.array_equal(without.camera.matrix, done.camera.camera.matrix)
    alone = replace(done.seen, views=tuple(one for one in done.seen.views if one.name != name))
    assert np.array_equal(without.camera.matrix, solve_views(done.folder, done.project, alone).camera.matrix)
    assert any("left out by hand" in str(note) for note in without.notes)


def test_too_few_views_left_says_so(done):
    names = frozenset(one.name for one in done.seen.views[2:])
    with pytest.raises(InputError, match=r"only 2 of 8 views are not left out by hand"):
        solve_views(done.folder, done.with_options(excluded=names), done.seen)


def test_stripes_on_the_plate_are_looked_for_as_the_project_says_and_a_picture_shows_why_none_is_found(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    given = done.with_options(plane_stripe=StripeSettings(8.0, 1000.0))
    (pose, *_) = found = find_poses(folder, given)
    assert {one.reason.code for one in found} == {"fan.other_stripes"}
    assert [one.name for one in found_poses(folder, given)] == [one.name for one in found]
    assert found_poses(folder, done.project) == ()
    stages = show_pose(folder, given, pose)
    assert stages.ridge is not None
    assert stages.ridge.shape == stages.picture.shape
    assert stages.ridge.max() >= 250
    assert show_pose(folder, done.project, done.poses[0]).ridge is None


def test_a_pose_left_out_has_no_part_in_the_fan_and_says_so(done):
    without = solve_poses(done.folder, done.with_options(excluded=frozenset({"planes/pose02"})), done.poses)
    pose = without.poses[2]
    assert (pose.name, pose.used, pose.exclusion) == ("pose02", False, Exclusion.BY_HAND)
    assert pose.pose.translation[2] > 100
    rest = tuple(pose for pose in done.poses if pose.name != "pose02")
    assert np.array_equal(without.fan.pis, solve_poses(done.folder, done.project, rest).fan.pis)


@pytest.mark.accuracy
def test_a_fan_need_not_be_a_pencil(done, tmp_path):
    project = done.with_options(constrain_fan=False)
    free = solve_poses(done.folder, project, done.poses)
    assert np.array_equal(free.fan.pis, free.free.pis)
    assert str(free.verdict).endswith("as asked")
    assert free.constraint_suits == done.fan.constraint_suits
    folder = copy_of(done.folder, tmp_path / "project")
    project = replace(
        project, accepted=replace(project.accepted, planes=accept_planes(folder, project, free, done.poses))
    )
    summary = measure_scan(folder, project)
    assert summary.gauge.thickness_mm == pytest.approx(50.0, abs=3 * summary.gauge.U_mm)


def test_a_fan_of_a_minority_of_poses_is_kept_only_by_a_decision(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    reason = plain("it disagrees")
    poses = (replace(one, used=i < 2, exclusion=reason if i > 1 else None) for i, one in enumerate(done.fan.poses))
    few = replace(done.fan, poses=tuple(poses))
    with pytest.raises(InputError, match="only 2 of"):
        accept_planes(folder, done.project, few, done.poses)
    assert accept_planes(folder, done.project, few, done.poses, accept_few_poses=True)


@pytest.mark.parametrize(("columns", "rows", "is_of"), [(0, 0, True), (1, 0, False), (0, 1, False), (-1, 0, False)])
def test_an_accepted_camera_is_of_a_board_of_its_own_size_only(done, columns, rows, is_of):
    """The corners of a board are among those of every larger one."""
    board = done.project.rig.camera_target
    target = replace(board, columns=board.columns + columns, rows=board.rows + rows)
    recalled = recall_camera(done.folder, replace(done.project, rig=replace(done.project.rig, camera_target=target)))
    assert (recalled.seen is not None) is is_of
