"""Camera and fan displaced together: what one standard uncertainty of the calibrations does."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.covariance import principal_deviations
from core.calibrate.camera.reprojection import parameters_of
from core.calibrate.deviations import calibration_deviations, fan_behind
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.results import CameraCalibration, FanCalibration
from core.inspect.causes import CALIBRATIONS
from core.inspect.uncertainty.point_errors import PointErrors
from core.model import Camera
from core.scan.common_errors import CommonErrors
from tests.calibrate.camera_views import synthetic_views
from tests.calibrate.fan_scenes import ALPHA, CAMERA, PAPER, Noise, features, poses

THREE = FanOptions(3, ALPHA, "always")
SEEN = features(poses(7, 1), Noise(), 2)


@pytest.fixture(scope="module")
def camera() -> CameraCalibration:
    return calibrate_camera(synthetic_views(3), CAMERA.image_size)


@pytest.fixture(scope="module")
def fan(camera) -> FanCalibration:
    return fit_fan(SEEN, camera.camera, THREE)


@pytest.mark.accuracy
def test_the_fan_follows_a_displaced_camera_as_if_it_were_calibrated_anew(camera, fan):
    """To a tenth of its own uncertainty: weights are estimated anew, too."""
    sd = np.sqrt(np.diag(np.asarray(fan.fan.covariance)))
    followed_far = 0.0
    for displaced in principal_deviations(camera):
        anew = (fit_fan(SEEN, displaced, THREE).fan.pis - fan.fan.pis).ravel() / sd
        followed = (fan_behind(fan, camera.camera, displaced).pis - fan.fan.pis).ravel() / sd
        assert np.abs(followed - anew).max() < 0.1
        followed_far = max(followed_far, float(np.abs(followed).max()))
    assert followed_far > 0.5


def test_deviations_of_the_fan_rebuild_its_covariance(camera, fan):
    steps = [(one.fan.pis - fan.fan.pis).ravel() for one in calibration_deviations(camera, fan) if one.source == "fan"]
    assert len(steps) == 5
    covariance = np.asarray(fan.fan.covariance)
    assert np.transpose(steps) @ steps == pytest.approx(covariance, rel=1e-6, abs=1e-9 * covariance.max())


def test_deviations_of_the_camera_are_those_of_its_covariance_with_the_fan_behind_it(camera, fan):
    found = [one for one in calibration_deviations(camera, fan) if one.source == "camera"]
    steps = np.array([parameters_of(one.camera) - parameters_of(camera.camera) for one in found])
    sd = np.sqrt(np.diag(camera.covariance))
    assert np.diag(steps.T @ steps) == pytest.approx(sd**2, rel=1e-6)
    for one, step in zip(found, steps, strict=True):
        assert (one.fan.pis - fan.fan.pis).ravel() == pytest.approx(fan.by_camera @ step, abs=1e-15)


def test_an_uncertain_size_of_the_target_scales_all_of_space(camera, fan):
    unsure = replace(fan, scale_sd=1e-3)
    (scaled,) = (one for one in calibration_deviations(camera, unsure) if one.source == "scale")
    assert scaled.camera is camera.camera
    assert 1 / scaled.fan.pis == pytest.approx(1.001 / fan.fan.pis, rel=1e-5)
    assert not [one for one in calibration_deviations(camera, fan) if one.source == "scale"]


def test_the_row_of_a_fan_whose_targets_flatness_is_assumed_says_so(camera):
    unstated = fit_fan(SEEN, camera.camera, replace(THREE, target=BoardTolerance(None, 0.0)))
    deviations = calibration_deviations(camera, unstated)
    steps = [(one.fan.pis - unstated.fan.pis).ravel() for one in deviations if one.source == "assumed fan"]
    assert np.transpose(steps) @ steps == pytest.approx(np.asarray(unstated.fan.covariance), rel=1e-6, abs=1e-12)
    assert not [one for one in deviations if one.source == "fan"]
    assert "assumed" in str(CALIBRATIONS["assumed fan"])
    common = CommonErrors.of_fan(camera.camera, unstated.fan, deviations)
    assert "gauge.without_fan" not in [one.code for one in PointErrors(common=common).missing()]


def test_a_fan_of_another_program_stays_where_it_is(camera, fan):
    foreign = replace(fan, by_camera=None)
    moved = [one for one in calibration_deviations(camera, foreign) if one.source == "camera"]
    assert all((one.fan.pis == fan.fan.pis).all() for one in moved)


def depths(camera: Camera, pis: np.ndarray) -> np.ndarray:
    """Depths (3, 2, 5) that camera and fan give to points on the true lines, 490 and 540 mm away."""
    x, z = np.meshgrid(np.linspace(-40, 40, 5), [490.0, 540.0])
    found = []
    for true, pi in zip(PAPER, pis, strict=True):
        points = np.stack([x, (1 - true[0] * x - true[2] * z) / true[1], z], axis=-1)
        rays = camera.rays(CAMERA.project(points.reshape(-1, 3)))
        found.append((1 / (rays @ pi)).reshape(2, 5))
    return np.array(found)


@pytest.mark.accuracy
def test_deviations_carry_the_uncertainty_that_repeated_calibrations_show():
    """Of the mean depth, for which the camera counts most, and of a difference of depths, for which the fan does."""

    def quantities(camera, fan):
        z = depths(camera, fan.pis)
        return np.array([z.mean(), (z[:, 1] - z[:, 0]).mean()])

    ratios = []
    for seed in range(24):
        camera = calibrate_camera(synthetic_views(500 + seed, 10), CAMERA.image_size)
        fan = fit_fan(features(poses(6, 500 + seed), Noise(), 500 + seed), camera.camera, THREE)
        found = quantities(camera.camera, fan.fan)
        changes = [quantities(one.camera, one.fan) - found for one in calibration_deviations(camera, fan)]
        ratios.append((found - [515.0, 50.0]) / np.linalg.norm(changes, axis=0))
    assert (np.sqrt(np.mean(np.square(ratios), axis=0)) > 0.75).all()
    assert (np.sqrt(np.mean(np.square(ratios), axis=0)) < 1.25).all()
