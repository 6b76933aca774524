"""Pose from one view: truth, covariance, the planar ambiguity, outliers, and whether a target moved."""

import numpy as np
import pytest

from core.image.targets import BlackSquare, Checkerboard, TargetNotFound, camera_shift, detect, estimate_pose
from core.image.targets.target_view import TargetView
from core.model import Pose
from tests.image.rendered_targets import pose, render, rig, square

BOARD = Checkerboard(9, 6, 10.0)
CAMERA = rig(0.5)
TILTED = pose(30, -12, 40, (40, 25), 450, (30, -20))


def seen(target, where, sigma=0.0, seed=0):
    uv = CAMERA.project_pose(where, target.points)
    noise = np.random.default_rng(seed).normal(0, sigma, uv.shape)
    return TargetView(target.points, uv + noise, np.full(len(uv), max(sigma, 0.01)))


@pytest.mark.parametrize("target", [BOARD, BlackSquare(60.0)], ids=["board", "square"])
def test_exact_points_give_the_exact_pose(target):
    found = estimate_pose(seen(target, TILTED), CAMERA)
    assert found.pose.vector == pytest.approx(TILTED.vector, abs=1e-6)
    assert found.rms_px < 1e-7
    assert not found.ambiguous


@pytest.mark.accuracy
def test_errors_over_many_noisy_views_are_what_the_covariance_says():
    normalised = []
    for seed in range(150):
        found = estimate_pose(seen(BOARD, TILTED, 0.1, seed), CAMERA)
        error = found.pose.vector - TILTED.vector
        normalised.append(error @ np.linalg.solve(found.covariance, error))
    assert np.mean(normalised) == pytest.approx(6, rel=0.15)


def test_residuals_are_observed_minus_predicted():
    view = seen(BOARD, TILTED, 0.2)
    found = estimate_pose(view, CAMERA)
    assert found.residuals == pytest.approx(view.uv - CAMERA.project_pose(found.pose, view.points), abs=1e-12)
    assert found.rms_px == pytest.approx(np.sqrt(np.mean((found.residuals[found.used] ** 2).sum(axis=1))))


def test_a_weak_perspective_view_is_reported_as_ambiguous_and_a_strong_one_is_not():
    small = BlackSquare(10.0)
    weak = estimate_pose(seen(small, pose(25, 0, 0, (5, 5), 900), 0.05, 3), CAMERA)
    assert weak.ambiguous
    assert weak.alternative is not None
    strong = estimate_pose(seen(BlackSquare(60.0), pose(25, 0, 0, (30, 30), 350), 0.05, 3), CAMERA)
    assert not strong.ambiguous


def test_corners_that_a_stripe_has_moved_are_left_out():
    view = seen(BOARD, TILTED, 0.05)
    uv = view.uv.copy()
    uv[[3, 17, 30, 44]] += [4.0, -6.0]
    found = estimate_pose(TargetView(view.points, uv, view.sigma), CAMERA)
    assert np.flatnonzero(~found.used).tolist() == [3, 17, 30, 44]
    assert found.rms_px < 0.1
    assert found.pose.apply(BOARD.points) == pytest.approx(TILTED.apply(BOARD.points), abs=0.1)


def test_skew_and_distortion_are_part_of_the_model():
    camera = type(CAMERA)(
        CAMERA.image_size, CAMERA.matrix + [[0, 40, 0], [0, 0, 0], [0, 0, 0]], [-0.3, 0.2, 0.01, 0.02]
    )
    view = TargetView(BOARD.points, camera.project_pose(TILTED, BOARD.points), np.full(54, 0.01))
    assert estimate_pose(view, camera).pose.vector == pytest.approx(TILTED.vector, abs=1e-6)


def test_the_target_stands_before_the_camera_for_any_pose():
    for seed in range(20):
        turn = np.random.default_rng(seed).uniform([-50, -50, -180], [50, 50, 180])
        where = pose(*turn, (30, 30), 400)
        found = estimate_pose(seen(BlackSquare(60.0), where, 0.01, seed), CAMERA)
        assert (found.pose.apply(BlackSquare(60.0).points)[:, 2] > 0).all()
        assert found.pose.translation == pytest.approx(where.translation, abs=1.0)


def test_points_that_no_pose_explains_are_refused_or_misfit_openly():
    view = seen(BOARD, TILTED)
    shuffled = TargetView(view.points, np.random.default_rng(0).permutation(view.uv), view.sigma)
    try:
        assert estimate_pose(shuffled, CAMERA).rms_px > 20
    except TargetNotFound as failure:
        assert "no pose" in str(failure)
    with pytest.raises(ValueError, match="four points"):
        estimate_pose(TargetView(view.points[:3], view.uv[:3], view.sigma[:3]), CAMERA)


def test_a_rendered_square_gives_its_pose():
    camera, target = rig(0.25), BlackSquare(60.0)
    where = pose(30, -12, 7, (30, 30), 420)
    view = detect(target, render(camera, where, square(60.0), blur=0.9), camera=camera)
    found = estimate_pose(view, camera).pose
    assert found.apply(target.points) == pytest.approx(where.apply(target.points), abs=0.1)


def test_a_target_that_moved_is_told_from_one_that_stood_still():
    still = camera_shift(seen(BOARD, TILTED, 0.05, 1), seen(BOARD, TILTED, 0.05, 2))
    moved = camera_shift(
        seen(BOARD, TILTED, 0.05, 1), seen(BOARD, Pose(TILTED.rotation, TILTED.translation + [0.2, 0, 0]), 0.05, 2)
    )
    assert still < 0.15
    assert moved == pytest.approx(0.2 * CAMERA.focal / 450, rel=0.15)


def test_a_square_that_is_numbered_from_another_corner_has_not_moved():
    view = seen(BlackSquare(60.0), TILTED)
    turned = TargetView(view.points, np.roll(view.uv, 1, axis=0) + 0.3, view.sigma)
    assert camera_shift(view, turned) == pytest.approx(0.3 * np.sqrt(2), rel=1e-6)


def test_views_of_different_parts_cannot_be_compared():
    view = seen(BOARD, TILTED)
    with pytest.raises(ValueError, match="no point of the target in common"):
        camera_shift(
            TargetView(view.points[:20], view.uv[:20], view.sigma[:20]),
            TargetView(view.points[20:], view.uv[20:], view.sigma[20:]),
        )
