"""Channels of colour pictures that give other light planes: the difference is in their covariance, and told."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration
from tests.calibrate.fan.test_calibration import THREE
from tests.calibrate.fan_scenes import CAMERA, GRID, PAPER, Noise, features, poses

TOLD = "fan.channels_differ"


def in_two_channels(seed: int, shift: float, lines: int = 1, count: int = 8) -> list[PoseFeatures]:
    """Poses of which the blue channel sees planes nearer by this share, with speckle of its own."""
    where = poses(count, seed)
    red = features(where, Noise(), seed, points=GRID, pis=PAPER[:lines])
    blue = features(where, Noise(), seed + 1000, points=GRID, pis=PAPER[:lines] * (1 + shift))
    return [replace(one, others={"blue": other.centrelines}) for one, other in zip(red, blue, strict=True)]


def fitted(seen: list[PoseFeatures], lines: int = 1) -> FanCalibration:
    return fit_fan(seen, CAMERA, THREE if lines == 3 else FanOptions(lines))


def in_one(seen: list[PoseFeatures]) -> list[PoseFeatures]:
    return [replace(one, others={}) for one in seen]


def off_in_sigmas(result: FanCalibration, step: np.ndarray) -> float:
    covariance = np.asarray(result.fan.covariance)
    return float(np.sqrt(step @ np.linalg.pinv(covariance, rcond=1e-9, hermitian=True) @ step))


@pytest.mark.parametrize("lines", [1, 3])
def test_channels_that_differ_make_the_planes_uncertain_by_it(lines):
    """Which of them is right is not known: the planes of either are within the uncertainty of those in use."""
    seen = in_two_channels(1, 0.001, lines)
    both, alone = fitted(seen, lines), fitted(in_one(seen), lines)
    assert np.array_equal(both.fan.pis, alone.fan.pis), "the channel in use gives the planes"
    other = fitted([replace(one, centrelines=one.others["blue"], others={}) for one in seen], lines)
    step = (other.fan.pis - alone.fan.pis).ravel()
    assert off_in_sigmas(alone, step) > 10
    assert off_in_sigmas(both, step) < 1.1
    (note,) = (one for one in both.notes if one.code == TOLD)
    assert note.values["mm"] == pytest.approx(0.12, abs=0.03), "0.001 of how far the planes pass the camera by"
    assert note.values["times"] > 10
    assert "blue" in str(note)


def test_a_small_difference_is_in_the_covariance_and_not_told():
    seen = in_two_channels(1, 0.0003)
    both, alone = fitted(seen), fitted(in_one(seen))
    assert np.trace(both.fan.covariance) > 2 * np.trace(alone.fan.covariance)
    assert both.notes == alone.notes


@pytest.mark.parametrize("lines", [1, 3])
def test_channels_that_agree_change_nothing(lines):
    """One set in a hundred may by chance."""
    for seed in range(4):
        seen = in_two_channels(10 * seed, 0.0, lines)
        both, alone = fitted(seen, lines), fitted(in_one(seen), lines)
        assert np.array_equal(both.fan.covariance, alone.fan.covariance)
        assert both.notes == alone.notes


def test_a_channel_that_shows_stripes_on_few_poses_says_nothing():
    seen = in_two_channels(3, 0.002)
    few = [one if number < 3 else replace(one, others={}) for number, one in enumerate(seen)]
    assert np.array_equal(fitted(few).fan.covariance, fitted(in_one(seen)).fan.covariance)
