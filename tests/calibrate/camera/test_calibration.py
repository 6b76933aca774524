"""The camera calibration against synthetic truth."""

from functools import cache

import numpy as np
import pytest

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.covariance import principal_deviations
from core.calibrate.camera.options import CameraOptions
from core.calibrate.camera.reprojection import linearise, moved, parameters_of
from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration
from core.errors import Cancelled, InputError
from core.image.exclusion import Exclusion
from core.image.targets.target_view import TargetView
from core.model import Camera, Pose
from tests.calibrate.camera_views import TRUTH, board, changed, random_pose, synthetic_views

SIZE = TRUTH.image_size


@cache
def calibrated(seed: int, bend_px: float = 0.0) -> CameraCalibration:
    return calibrate_camera(synthetic_views(seed, bend_px=bend_px), SIZE, CameraOptions(skew=True))


def errors_in_sd(calibration: CameraCalibration) -> np.ndarray:
    error = parameters_of(calibration.camera) - parameters_of(TRUTH)
    sd = np.array([calibration.sd[name] for name in CAMERA_PARAMETERS])
    return error[sd > 0] / sd[sd > 0]


def normalised_square(calibration: CameraCalibration) -> float:
    """Mahalanobis distance of the parameters from the truth, per free parameter: 1 on average when honest."""
    error = (parameters_of(calibration.camera) - parameters_of(TRUTH))[:9]
    return float(error @ np.linalg.solve(calibration.covariance[:9, :9], error)) / 9


@pytest.mark.parametrize("name", ["camera", "pose"])
def test_the_analytic_derivatives_are_the_numeric_ones(name):
    points = board()
    pose = random_pose(np.random.default_rng(1), points, 0.6)
    camera = Camera(SIZE, TRUTH.matrix, [0.08, -0.38, 0.004, -0.0004, 0.2])
    _, by_camera, by_pose = linearise(camera, pose, points)
    if name == "camera":
        start = parameters_of(camera)
        for i, step in enumerate(np.maximum(np.abs(start), 1e-2) * 1e-5):
            sides = []
            for sign in (1, -1):
                p = start.copy()
                p[i] += sign * step
                matrix = [[p[0], p[2], p[3]], [0, p[1], p[4]], [0, 0, 1]]
                sides.append(Camera(SIZE, matrix, p[5:]).project_pose(pose, points))
            numeric = (sides[0] - sides[1]) / (2 * step)
            assert np.abs(by_camera[:, :, i] - numeric).max() < 1e-6 * max(np.abs(numeric).max(), 1)
    else:
        for i in range(6):
            step = np.zeros(6)
            step[i] = 1e-5
            numeric = (
                camera.project_pose(moved(pose, step), points) - camera.project_pose(moved(pose, -step), points)
            ) / 2e-5
            assert np.abs(by_pose[:, :, i] - numeric).max() < 1e-6 * np.abs(numeric).max()


def test_without_noise_the_camera_is_found_exactly():
    calibration = calibrate_camera(synthetic_views(0, noise_px=0), SIZE)
    assert parameters_of(calibration.camera) == pytest.approx(parameters_of(TRUTH), abs=1e-6)
    assert calibration.rms_px < 1e-8
    assert calibration.cross_validation_mm < 1e-8


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.accuracy) for seed in (2, 3, 4))])
def test_parameters_are_within_four_of_their_own_standard_deviations(seed):
    assert np.abs(errors_in_sd(calibrated(seed))).max() < 4
    assert calibrated(seed).rms_px == pytest.approx(0.03 * np.sqrt(2), rel=0.05)


@pytest.mark.accuracy
def test_standard_deviations_are_honest_over_twenty_seeds():
    assert 0.7 < np.mean([normalised_square(calibrated(seed)) for seed in range(20)]) < 1.3


@pytest.mark.accuracy
def test_standard_deviations_stay_honest_when_corners_of_a_view_err_together():
    bent = [calibrated(seed, bend_px=0.03) for seed in range(12)]
    assert 0.6 < np.mean([normalised_square(calibration) for calibration in bent]) < 1.8
    assert all(any("err together" in str(note) for note in calibration.notes) for calibration in bent)
    plain = [calibrated(seed) for seed in range(20)]
    assert sum(any("err " in str(note) for note in calibration.notes) for calibration in plain) <= 1


@pytest.mark.parametrize(("bend_px", "told"), [(0.0, False), (0.06, True)])
def test_a_skew_that_is_left_out_is_no_error_that_corners_of_a_view_share(monkeypatch, bend_px, told):
    """Nothing is wrong with target and pictures where left-out views do not show clearly enough that γ is there."""
    monkeypatch.setattr("core.calibrate.camera.calibration.skew_helps", lambda *_: False)
    views = synthetic_views(1, bend_px=bend_px)
    left_out, stated = (calibrate_camera(views, SIZE, CameraOptions(skew=skew)) for skew in (None, False))
    codes = {note.code for note in left_out.notes}
    assert left_out.camera.matrix[0, 1] == 0.0 and ("camera.corners_err_together" in codes) == told
    assert left_out.sd["u0"] >= stated.sd["u0"]
    assert "camera.corners_err_together" in {note.code for note in stated.notes}  # who states it, hears of it


@pytest.mark.accuracy
def test_standard_deviations_stay_honest_when_the_target_is_printed_wrong():
    squares = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        printed = board()
        printed[:, :2] += rng.normal(0, 0.02, (len(printed), 2))
        views = []
        for quality in calibrated(seed).views:
            uv = TRUTH.project_pose(quality.pose, printed) + rng.normal(0, 0.03, quality.view.uv.shape)
            views.append(changed(quality.view, uv))
        calibration = calibrate_camera(views, SIZE, CameraOptions(skew=True))
        squares.append(normalised_square(calibration))
        assert any("alike in every view" in str(note) for note in calibration.notes)
    assert 0.4 < np.mean(squares) < 2


def test_the_stated_sigma_of_the_corners_does_not_change_the_standard_deviations():
    views = synthetic_views(1)
    louder = [TargetView(view.points, view.uv, 10 * view.sigma, view.name) for view in views]
    assert calibrate_camera(louder, SIZE, CameraOptions(skew=True)).sd == pytest.approx(calibrated(1).sd, rel=1e-6)


def test_noisy_corners_that_say_so_count_for_less():
    rng = np.random.default_rng(5)
    views = synthetic_views(5)
    noisy, silent_about_it = [], []
    for view in views:
        sigma = np.where(rng.uniform(size=len(view.uv)) < 0.5, 0.15, 0.03)
        uv = view.uv + rng.normal(size=view.uv.shape) * np.sqrt(sigma**2 - 0.03**2)[:, None]
        noisy.append(TargetView(view.points, uv, sigma, view.name))
        silent_about_it.append(changed(view, uv))
    weighted, plain = calibrate_camera(noisy, SIZE), calibrate_camera(silent_about_it, SIZE)
    assert np.abs(errors_in_sd(weighted)).max() < 4
    assert weighted.sd["alpha"] < 0.6 * plain.sd["alpha"]


def test_fixed_parameters_are_zero_and_have_no_deviation():
    options = CameraOptions(skew=False, fixed=frozenset({"p1", "k2"}), k3=True)
    calibration = calibrate_camera(synthetic_views(2), SIZE, options)
    fixed = {"gamma": calibration.camera.matrix[0, 1], "k2": calibration.camera.distortion[1]}
    assert fixed == {"gamma": 0, "k2": 0}
    assert {name for name, sd in calibration.sd.items() if sd == 0} == {"gamma", "p1", "k2"}
    with pytest.raises(ValueError, match="k9"):
        CameraOptions(fixed=frozenset({"k9"}))


def test_k3_is_found_when_asked_for():
    camera = Camera(SIZE, TRUTH.matrix, [0.08, -0.38, 0.004, -0.0004, 1.5])
    rng = np.random.default_rng(3)
    views = []
    for view, quality in zip(synthetic_views(3), calibrated(3).views, strict=True):
        uv = camera.project_pose(quality.pose, view.points)
        views.append(changed(view, uv + rng.normal(0, 0.01, uv.shape)))
    calibration = calibrate_camera(views, SIZE, CameraOptions(k3=True))
    assert abs(calibration.camera.distortion[4] - 1.5) < 4 * calibration.sd["k3"] < 0.5


def test_poses_are_found():
    views = synthetic_views(4, noise_px=0)
    calibration = calibrate_camera(views, SIZE)
    for view, quality in zip(views, calibration.views, strict=True):
        assert np.abs(TRUTH.project_pose(quality.pose, view.points) - view.uv).max() < 1e-6
        assert quality.residuals.shape == view.uv.shape


def test_views_are_ranked_from_the_best_to_the_worst():
    views = synthetic_views(6)
    rng = np.random.default_rng(6)
    views[3] = changed(views[3], views[3].uv + rng.normal(0, 0.06, views[3].uv.shape))
    ranked = calibrate_camera(views, SIZE).ranked
    assert ranked[-1].view.name == "view03.png"
    assert [quality.rms_px for quality in ranked] == sorted(quality.rms_px for quality in ranked)


def spoilt(view: TargetView, how: str) -> TargetView:
    rng = np.random.default_rng(7)
    if how == "wrong order":
        return changed(view, view.uv.reshape(12, 17, 2).swapaxes(0, 1).reshape(-1, 2))
    if how == "shuffled":
        return changed(view, rng.permutation(view.uv))
    if how == "half moved":
        return changed(view, view.uv + np.where(view.points[:, :1] > 80, 2.0, 0.0))
    if how == "blurred":
        return changed(view, view.uv + rng.normal(0, 0.4, view.uv.shape))
    if how == "too few corners":
        return TargetView(view.points[:4], view.uv[:4], view.sigma[:4], view.name)
    if how == "not a number":
        return changed(view, np.where(view.points[:, :1] > 80, np.nan, view.uv))
    return TargetView(view.points[:17], view.uv[:17], view.sigma[:17], view.name)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ("wrong order", "wrong order"),
        ("shuffled", "another target"),
        ("half moved", "out of line"),
        ("blurred", "out of line"),
        ("too few corners", "only 4 corners"),
        ("not a number", "without finite"),
        ("one row", "straight line"),
    ],
)
def test_a_bad_view_is_left_out_with_its_reason_and_does_no_harm(how, words):
    views = synthetic_views(8, count=9)
    views[5] = spoilt(views[5], how)
    calibration = calibrate_camera(views, SIZE)
    assert [quality.used for quality in calibration.views] == [i != 5 for i in range(9)]
    assert words in str(calibration.views[5].reason)
    assert any(str(note).startswith("view05.png is left out") for note in calibration.notes)
    assert calibration.ranked[-1].view is views[5]
    assert np.abs(errors_in_sd(calibration)).max() < 4
    assert calibration.rms_px < 0.05


def test_views_left_out_by_hand_change_nothing_but_their_own_residuals_are_known():
    views = synthetic_views(8)
    views[5], views[9] = spoilt(views[5], "shuffled"), changed(views[9], views[9].uv + 3.0)
    names = {views[i].name for i in (2, 5, 9)}
    with_them = calibrate_camera(views, SIZE, excluded=names)
    without = calibrate_camera([view for view in views if view.name not in names], SIZE)
    assert np.array_equal(parameters_of(with_them.camera), parameters_of(without.camera))
    assert np.array_equal(with_them.covariance, without.covariance)
    assert with_them.rms_px == without.rms_px
    assert [quality.view for quality in with_them.views] == views
    good, shuffled, moved_aside = (with_them.views[i] for i in (2, 5, 9))
    assert (good.used, good.exclusion) == (False, Exclusion.BY_HAND)
    assert good.rms_px < 2 * without.rms_px
    assert np.isnan(shuffled.residuals).all()
    assert str(shuffled.reason).startswith(str(Exclusion.BY_HAND.message))
    assert "pattern" in str(shuffled.reason)
    assert moved_aside.rms_px < 1  # the pose takes up a shift
    assert str(with_them.notes[0]) == ("3 of 14 views are left out by hand: view02.png, view05.png, view09.png.")


@pytest.mark.parametrize("outliers", ["gross", pytest.param("all", marks=pytest.mark.accuracy)])
def test_a_few_misfound_corners_do_not_matter(outliers):
    views = synthetic_views(9)
    rng = np.random.default_rng(9)
    for i, size in ((0, 100.0), (4, 5.0), (11, 1.0)):
        uv = views[i].uv.copy()
        uv[rng.choice(len(uv), 3, replace=False)] += size * np.array([1, -1])
        views[i] = changed(views[i], uv)
    calibration = calibrate_camera(views, SIZE, CameraOptions(outliers=outliers))
    assert [int((~quality.counted).sum()) for quality in calibration.views] == [
        3 if i in (0, 4, 11) else 0 for i in range(14)
    ]
    assert all(quality.used for quality in calibration.views)
    assert np.abs(errors_in_sd(calibration)).max() < 4
    kept = calibrate_camera(views, SIZE, CameraOptions(outliers="keep"))
    assert kept.rms_px > 1


def test_too_few_good_views_are_refused_with_every_reason():
    views = synthetic_views(10, count=4)
    views[1], views[2] = spoilt(views[1], "shuffled"), spoilt(views[2], "too few corners")
    with pytest.raises(InputError, match=r"only 2 of 4 views .*view01.png: .* view02.png: only 4 corners .* take 10"):
        calibrate_camera(views, SIZE)
    with pytest.raises(InputError, match="only 0 of 0 views"):
        calibrate_camera([], SIZE)


@pytest.mark.parametrize("noise_px", [0.0, pytest.param(0.03, marks=pytest.mark.accuracy)])
@pytest.mark.parametrize("tilt_deg", [0.0, pytest.param(25.0, marks=pytest.mark.accuracy)])
def test_views_all_in_parallel_are_refused(noise_px, tilt_deg):
    rng = np.random.default_rng(11)
    points = board()
    views = []
    for i in range(8):
        rotation = Pose.from_vector([0, np.deg2rad(tilt_deg), 0, 0, 0, 0]).rotation
        pose = Pose(rotation, [rng.uniform(-120, -60), rng.uniform(-80, -40), rng.uniform(500, 700)])
        uv = TRUTH.project_pose(pose, points)
        views.append(TargetView(points, uv + rng.normal(0, noise_px, uv.shape), np.full(len(uv), 0.03), f"{i}"))
    with pytest.raises(InputError, match=r"parallel .* tilted by up to 30°"):
        calibrate_camera(views, SIZE)


def test_hardly_tilted_views_give_a_wide_deviation_and_a_note():
    calibration = calibrate_camera(synthetic_views(12, max_tilt_deg=6), SIZE)
    assert any("tilted by at most" in str(note) for note in calibration.notes)
    assert np.abs(errors_in_sd(calibration)).max() < 4
    assert calibration.sd["alpha"] > 5 * calibrated(0).sd["alpha"]


def test_missing_coverage_and_few_views_are_told():
    views = [view for view in synthetic_views(13, count=40) if view.uv[:, 0].min() > SIZE[0] * 0.34][:6]
    assert len(views) >= 3
    notes = " ".join(map(str, calibrate_camera(views, SIZE).notes))
    assert "no corner in the" in notes
    assert "left" in notes
    assert f"Only {len(views)} views" in notes
    assert calibrate_camera(views, SIZE).coverage < calibrated(0).coverage < 1


@pytest.mark.accuracy
def test_cross_validation_grows_with_the_noise_and_needs_six_views():
    quiet = calibrate_camera(synthetic_views(14, noise_px=0.01), SIZE).cross_validation_mm
    loud = calibrate_camera(synthetic_views(14, noise_px=0.1), SIZE).cross_validation_mm
    assert loud == pytest.approx(10 * quiet, rel=0.1)
    assert 1e-4 < quiet < 0.01
    assert np.isnan(calibrate_camera(synthetic_views(14, count=5), SIZE).cross_validation_mm)


def test_principal_deviations_carry_the_covariance():
    calibration = calibrated(0)
    deviations = principal_deviations(calibration)
    steps = np.array([parameters_of(camera) - parameters_of(calibration.camera) for camera in deviations])
    assert len(deviations) == 9
    assert steps.T @ steps == pytest.approx(calibration.covariance, rel=1e-6, abs=1e-12)
    assert_rays_scatter_as_stated(calibration, seeds=5)


@pytest.mark.accuracy
def test_principal_deviations_are_as_rays_of_twenty_calibrations_scatter():
    assert_rays_scatter_as_stated(calibrated(0), seeds=20)


def assert_rays_scatter_as_stated(calibration: CameraCalibration, seeds: int) -> None:
    uv = np.array([[100.0, 100.0]])
    deviations = principal_deviations(calibration)
    spread = sum((camera.rays(uv) - calibration.camera.rays(uv)) ** 2 for camera in deviations) ** 0.5
    sampled = [calibrated(seed).camera.rays(uv)[0] for seed in range(seeds)]
    assert np.std(sampled, axis=0)[:2] == pytest.approx(spread[0, :2], rel=0.8)


def test_progress_is_told_and_can_cancel():
    told = []
    calibrate_camera(synthetic_views(0), SIZE, progress=lambda step, done, total: told.append((done, total)))
    assert told[0][0] == 0
    assert told[-1][0] == told[-1][1]

    def stop(step: str, done: int, total: int) -> None:
        raise Cancelled

    with pytest.raises(Cancelled):
        calibrate_camera(synthetic_views(0), SIZE, progress=stop)
