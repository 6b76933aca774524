"""Re-adjustment by a check, at the level of centrelines: what is found, what stays uncertain, what is refused."""

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.change import changes, displaced_fan
from core.calibrate.deviations import calibration_deviations
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.interim_check import check_poses, step_errors
from core.calibrate.readjustment import CheckPictures, readjusted
from core.calibrate.results import CameraCalibration
from core.errors import InputError
from core.model import Fan, LightPlane
from tests.calibrate.fan_scenes import ALPHA, CAMERA, PAPER, SQUARE, Noise, features, poses

LASER = np.array([48.0, 81.0, 312.0])
STEP_MM = 50.0
DRIFT = np.array([1.0, 0.6])
CHANGED = {
    "turned": (np.array([262e-6, 0, 0]), 0.0),
    "turned aside": (np.array([0, 262e-6, 100e-6]), 0.0),
    "drifted": (np.zeros(3), 2.0),
    "both": (np.array([262e-6, 0, 0]), 2.0),
}


@pytest.fixture(scope="module")
def camera():
    return CameraCalibration(CAMERA, np.zeros((10, 10)), (), 0.1, 0.1, 1.0, 0.5, 0.01)


def true_fan() -> Fan:
    return Fan(tuple(LightPlane(pi) for pi in PAPER))


def calibrated(seed):
    return fit_fan(features(poses(9, seed), Noise(), seed), CAMERA, FanOptions(3, ALPHA))


def drifted(px):
    return camera_of(parameters_of(CAMERA) + px * np.array([0, 0, 0, *DRIFT, 0, 0, 0, 0, 0]), CAMERA.image_size)


def moved(shown, px, size):
    """What a pose shows on a sensor that has moved, the target's sides stated as of another size."""
    view = replace(shown.view, uv=shown.view.uv + px, points=size * shown.view.points)
    return replace(shown, view=view, centrelines=tuple(replace(line, uv=line.uv + px) for line in shown.centrelines))


def adjusted(camera, fan, *, turn=(0, 0, 0), px=0.0, seed=5, count=3, size=1.0):
    """The calibrations re-adjusted by a check of a rig that has changed, and what of it is checked."""
    now = displaced_fan(true_fan(), np.asarray(turn, dtype=float), LASER)
    shown = features(poses(count + 2, 40 + seed)[1:-1], Noise(), seed, pis=now.pis, points=SQUARE)
    shown = [moved(one, px * DRIFT, size) for one in shown]
    deviations = (*calibration_deviations(camera, fan), *changes(CAMERA, fan.fan))
    found, evidence = check_poses(shown, CAMERA, fan, deviations)
    squares, freedom = sum(pose.squares for pose in found), sum(pose.freedom for pose in found)
    pictures = CheckPictures(squares, freedom, sum(pose.located.used for pose in found), datetime.now(UTC), "abc")
    return readjusted((camera, fan, "before"), deviations, evidence, pictures, None), found, now


def step_off(camera_now, fan_now, found, truth, px):
    """By how much a step is measured too high, and the standard uncertainty of that."""
    left = calibration_deviations(camera_now, fan_now)
    there = drifted(px)
    off = step_errors(found, there, truth, [replace(left[0], camera=camera_now.camera, fan=fan_now.fan)], STEP_MM)[0]
    by = step_errors(found, camera_now.camera, fan_now.fan, left, STEP_MM)
    return float(off), float(np.linalg.norm(by))


@pytest.mark.accuracy
@pytest.mark.parametrize("name", CHANGED)
def test_what_changed_is_found_and_what_stays_uncertain_is_true(camera, name):
    turn, px = CHANGED[name]
    times, before = [], []
    for seed in range(8):
        fan = calibrated(seed)
        (camera_now, fan_now), found, truth = adjusted(camera, fan, turn=turn, px=px, seed=seed)
        off, u = step_off(camera_now, fan_now, found, truth, px)
        was = step_errors(found, drifted(px), truth, [replace(changes(CAMERA, fan.fan)[0], camera=CAMERA, fan=fan.fan)],
                          STEP_MM)[0]  # fmt: skip
        times.append(off / u)
        before.append(abs(was) / u)
        assert fan_now.readjusted.p_before < 1e-3 < fan_now.readjusted.p_after
        assert u < 0.05
    print(f"{name}: error over u {np.round(times, 1)}, before {np.round(before, 1)}")
    assert np.max(np.abs(times)) < 3 and np.mean(np.square(times)) < 2.5
    assert np.mean(before) > 2.5 * np.mean(np.abs(times))  # turned aside it was only 1.4 u off before


def test_the_record_holds_all_that_stays_uncertain(camera):
    """Deviations read back from the record have the covariance that the files' other forms have."""
    (camera_now, fan_now), *_ = adjusted(camera, calibrated(2), turn=CHANGED["turned"][0])
    record = fan_now.readjusted
    joint = record.deviations.T @ record.deviations
    assert joint[:10, :10] == pytest.approx(camera_now.covariance, abs=1e-12)
    both = fan_now.by_camera @ joint[:10, :10]
    assert both == pytest.approx(joint[10:, :10], rel=1e-3, abs=1e-3 * np.abs(joint[10:, :10]).max())
    assert "readjusted" in record.sources and record.of == "before"
    sources = {one.source for one in calibration_deviations(camera_now, fan_now)}
    assert "change" not in sources, "further changes are reckoned with anew"


@pytest.mark.parametrize("size", [1.004, 61 / 60])
def test_another_target_is_no_reason_to_readjust(camera, size):
    with pytest.raises(InputError) as refused:
        adjusted(camera, calibrated(2), size=size)
    assert refused.value.code == "readjust.refused"


def test_one_pose_is_too_few(camera):
    with pytest.raises(InputError, match="needs 2"):
        adjusted(camera, calibrated(2), turn=CHANGED["turned"][0], count=1)


def test_a_laser_that_was_knocked_is_to_be_calibrated(camera):
    with pytest.raises(InputError):
        adjusted(camera, calibrated(2), turn=(8e-3, 0, 0))
