"""The interim check: does it see a laser that moved, and is it silent where nothing did?"""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.change import DEFAULT_STABILITY, changes, displaced_fan, judge
from core.calibrate.deviations import Deviation, moved_fan
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.interim_check import check_poses, step_errors
from tests.calibrate.fan_scenes import ALPHA, CAMERA, GRID, PAPER, QUIET, SQUARE, Noise, features, poses

LASER = np.array([48.0, 81.0, 312.0])


@pytest.fixture(scope="module")
def calibrated():
    return fit_fan(features(poses(9, 2), Noise(), 2), CAMERA, FanOptions(3, ALPHA))


def deviations_of(fan):
    values, vectors = np.linalg.eigh(np.asarray(fan.fan.covariance))
    steps = (vectors * np.sqrt(np.maximum(values, 0))).T[-5:]
    return (*(Deviation("fan", CAMERA, moved_fan(fan.fan, step)) for step in steps), *changes(CAMERA, fan.fan))


def checked(fan, pis, seed=5, count=3, noise=None, points=SQUARE):
    """What a check of `count` poses finds in light planes `pis`."""
    shown = features(poses(count + 2, 40 + seed)[1:-1], noise or Noise(), seed, pis=pis, points=points)
    deviations = deviations_of(fan)
    found, evidence = check_poses(shown, CAMERA, fan, deviations)
    return found, judge(CAMERA, fan.fan, deviations, evidence, DEFAULT_STABILITY)


def test_stripes_lie_where_a_true_calibration_has_them(calibrated):
    true = replace(calibrated, fan=replace(calibrated.fan, planes=fan_of(PAPER).planes))
    found, change = checked(true, PAPER, noise=QUIET)
    assert all(pose.located.used and len(pose.offset_mm) == 3 for pose in found)
    assert max(np.abs(pose.offset_mm).max() for pose in found) < 1e-4
    assert change.notes == ()


def fan_of(pis):
    from core.model import Fan, LightPlane

    return Fan(tuple(LightPlane(pi) for pi in pis))


@pytest.mark.parametrize("points", [SQUARE, GRID], ids=["square", "grid"])
def test_a_mount_that_turned_by_a_hundredth_of_a_degree_is_seen(calibrated, points):
    now = displaced_fan(fan_of(PAPER), np.radians([0.01, 0.0, 0.0]), LASER)
    found, change = checked(calibrated, now.pis, points=points)
    assert change.p < 1e-3
    assert np.concatenate([np.abs(pose.offset_px) for pose in found]).max() > 0.1


def test_a_laser_that_points_elsewhere_is_told_for_what_it_is(calibrated):
    now = displaced_fan(fan_of(PAPER), np.array([0.0, 0.0, 0.2]), LASER)
    found, _ = checked(calibrated, now.pis)
    reasons = {pose.located.reason.code for pose in found if pose.located.reason is not None}
    assert reasons <= {"check.no_stripe_near"}
    assert [pose.misses_fan for pose in found] == [pose.located.reason is not None for pose in found]


def test_what_a_turn_does_to_a_step_is_what_it_does_to_its_light(calibrated):
    """The derivative against the fan turned in truth: a step of 50 mm where the target is."""
    deviations = deviations_of(calibrated)
    found, _ = checked(calibrated, PAPER)
    by = step_errors(found, CAMERA, calibrated.fan, deviations, 50.0)
    turned = Deviation("change", CAMERA, displaced_fan(calibrated.fan, np.array([400e-6, 0, 0]), LASER))
    (whole,) = step_errors(found, CAMERA, calibrated.fan, [turned], 50.0)
    first_turn = by[[one.source for one in deviations].index("change")]
    assert whole == pytest.approx(2 * first_turn, rel=0.15)
    assert abs(whole) > 0.05


def test_a_check_says_nothing_of_the_size_of_the_target_it_is_made_with(calibrated):
    """A fan calibrated with a target that is larger than stated has its stripes where they were, on that target."""
    larger = Deviation("scale", CAMERA, moved_fan(calibrated.fan, -5e-4 * calibrated.fan.pis.ravel()))
    shown = features(poses(4, 45)[1:-1], Noise(), 5, pis=PAPER, points=SQUARE)
    deviations = (*deviations_of(calibrated), larger)
    _, evidence = check_poses(shown, CAMERA, calibrated, deviations)
    assert evidence.information[0, 0] > 0
    left = judge(CAMERA, calibrated.fan, deviations, evidence, DEFAULT_STABILITY).deviations
    steps = np.array([one.fan.pis.ravel() - calibrated.fan.pis.ravel() for one in left if one.source == "scale"])
    assert np.linalg.norm(steps) == pytest.approx(np.linalg.norm(larger.fan.pis - calibrated.fan.pis), rel=0.01)


def test_a_stripe_that_happens_to_scatter_little_is_no_surer_than_the_others(calibrated):
    """Its noise is known from some ten pieces of it, that of all of them from ninety."""
    exact = Noise(corner_px=1e-6)
    where = poses(5, 45)[1:-1]
    usual, quiet = features(where, exact, 5), features(where, replace(exact, stripe_px=1e-3), 5)
    by_chance = replace(usual[1], centrelines=(as_stated(quiet[1].centrelines[0]), *usual[1].centrelines[1:]))
    known = replace(calibrated, stripe_sd_mm=0.0)
    found, _ = check_poses([usual[0], by_chance, usual[2]], CAMERA, known, deviations_of(known))
    sd_px = np.concatenate([pose.sd_mm * np.abs(pose.offset_px / pose.offset_mm) for pose in found])
    assert sd_px.min() > 0.7 * np.median(sd_px)


def as_stated(line):
    """The centreline with the σ that the others state."""
    return replace(line, sigma=np.full(len(line), Noise().stripe_px))


@pytest.mark.accuracy
def test_a_hundred_rigs_that_have_not_changed_raise_two_alarms_at_most():
    alarms, squares = 0, []
    for seed in range(100):
        fan = fit_fan(features(poses(9, seed), Noise(), seed), CAMERA, FanOptions(3, ALPHA))
        _, change = checked(fan, PAPER, seed=seed)
        alarms += bool(change.notes)
        squares.append(change.times**2)
    assert alarms <= 2
    assert 0.6 < np.mean(squares) < 1.6
