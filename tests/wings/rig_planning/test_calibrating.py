from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.results import CAMERA_PARAMETERS
from core.errors import InputError
from core.image.targets import Charuco, Checkerboard, CircleGrid
from core.wings.rig_planning.prediction.calibrating import EDGE_PX, plan_camera, plan_fan, square_covariance
from tests.wings.rig_planning.small import SMALL


@pytest.fixture(scope="module")
def camera():
    return plan_camera(SMALL, seed=1)


@pytest.fixture(scope="module")
def fan(camera):
    return plan_fan(SMALL, camera.camera, seed=1)


def test_the_planned_camera_is_found_within_its_stated_deviations(camera):
    true, found = SMALL.camera(), camera.camera
    off = np.array([found.matrix[0, 0] - true.matrix[0, 0], found.matrix[0, 2] - true.matrix[0, 2]])

    assert all(view.used for view in camera.views)
    assert np.all(np.abs(off) < 4 * np.array([camera.sd["alpha"], camera.sd["u0"]]))
    assert 0 < camera.sd["alpha"] < 1.0


def test_four_times_the_views_halve_the_cameras_deviations(camera):
    many = plan_camera(replace(SMALL, views=4 * SMALL.views), seed=1)
    ratios = [many.sd[name] / camera.sd[name] for name in CAMERA_PARAMETERS if camera.sd[name] > 0]

    assert np.median(ratios) == pytest.approx(0.5, abs=0.12)


@pytest.mark.accuracy
def test_the_planned_fan_is_the_true_one_within_its_covariance(fan):
    off = (fan.fan.pis - SMALL.fan().pis).ravel()
    sd = np.sqrt(np.diag(fan.fan.covariance))

    assert all(pose.used for pose in fan.poses)
    assert np.all(np.abs(off) < 5 * sd)


@pytest.mark.accuracy
def test_more_poses_make_the_fan_better_known(fan, camera):
    many = plan_fan(replace(SMALL, poses=4 * SMALL.poses), camera.camera, seed=1)

    assert np.median(np.sqrt(np.diag(many.fan.covariance) / np.diag(fan.fan.covariance))) < 0.75


def test_corners_of_a_square_scatter_as_lines_fitted_to_its_edges():
    corners = np.array([[100.0, 100.0], [300.0, 110.0], [290.0, 305.0], [95.0, 300.0]])
    rng = np.random.default_rng(1)
    found = []
    for _ in range(1500):
        lines = []
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            length = np.linalg.norm(end - start)
            along = (end - start) / length
            normal = np.array([-along[1], along[0]])
            t = np.arange(0.5, length)
            slope, offset = np.polyfit(t, EDGE_PX * rng.standard_normal(len(t)), 1)
            lines.append((start + offset * normal, along + slope * normal))
        meeting = []
        for k in range(4):
            (p, d), (q, e) = lines[k - 1], lines[k]
            meeting.append(p + d * np.linalg.solve(np.column_stack([d, -e]), q - p)[0])
        found.append(np.ravel(np.array(meeting) - corners))
    sampled, stated = np.cov(np.array(found).T), square_covariance(corners, EDGE_PX)

    assert np.abs(sampled - stated).max() < 0.1 * np.diag(stated).max()


def test_a_target_that_does_not_fit_is_told():
    with pytest.raises(InputError, match="does not fit into the picture"):
        plan_camera(replace(SMALL, camera_target=Checkerboard(17, 12, 300.0)), seed=1)


def test_a_board_with_more_markers_than_its_dictionary_is_told():
    with pytest.raises(InputError, match="54 markers, but DICT_4X4_50 only 50"):
        plan_camera(replace(SMALL, camera_target=Charuco(12, 9, 15.0, 11.25, "DICT_4X4_50")), seed=1)


@pytest.mark.accuracy
@pytest.mark.parametrize("target", [Checkerboard(17, 12, 10.0), CircleGrid(13, 10, 14.0)])
def test_any_target_can_carry_the_fans_stripes(camera, target):
    fan = plan_fan(replace(SMALL, plane_target=target), camera.camera, seed=1)

    assert fan.fan.lines == SMALL.lines
    assert np.all(np.isfinite(fan.rms_mm))


def test_a_target_the_fan_misses_is_told(camera):
    with pytest.raises(InputError):
        plan_fan(replace(SMALL, stripe_grey=5.0, read_noise_grey=40.0), camera.camera, seed=1)
