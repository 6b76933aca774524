"""What may have changed since the calibrations, and what pictures leave of it."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.reprojection import parameters_of
from core.calibrate.change import DEFAULT_STABILITY, STABLE, Evidence, Stability, agrees, changes, judge, lasting
from core.calibrate.deviations import Deviation, moved_fan
from core.model import Fan, LightPlane
from tests.calibrate.fan_scenes import CAMERA, PAPER

FAN = Fan(tuple(LightPlane(pi) for pi in PAPER))
CALIBRATED = [Deviation("fan", CAMERA, moved_fan(FAN, step)) for step in 1e-7 * np.eye(9)]
DEVIATIONS = (*CALIBRATED, *changes(CAMERA, FAN))
NOTHING = Evidence.none(len(DEVIATIONS))


def covariance(deviations) -> np.ndarray:
    """Of the parameters of camera and fan, in units of what the changes do by default."""
    steps = np.array([np.r_[parameters_of(one.camera), one.fan.pis.ravel()] for one in deviations])
    steps -= np.r_[parameters_of(CAMERA), FAN.pis.ravel()]
    return steps.T @ steps


def test_a_rig_that_nothing_can_change_keeps_the_deviations_of_its_calibrations():
    assert judge(CAMERA, FAN, DEVIATIONS, NOTHING, STABLE).deviations == tuple(CALIBRATED)


def test_without_pictures_change_adds_its_whole_stability():
    found = judge(CAMERA, FAN, DEVIATIONS, NOTHING, DEFAULT_STABILITY).deviations
    expected = covariance(DEVIATIONS)
    size = np.sqrt(np.maximum(np.diag(expected), 1e-30))
    assert np.abs(covariance(found) - expected).max(initial=0, where=np.outer(size, size) > 1e-20) == pytest.approx(
        0, abs=1e-8 * size.max() ** 2
    )
    assert {one.source for one in found} == {"fan", "change"}


def test_half_as_stable_is_twice_as_uncertain():
    twice = Stability(
        2 * DEFAULT_STABILITY.turn,
        2 * DEFAULT_STABILITY.shift_mm,
        2 * DEFAULT_STABILITY.centre_px,
        2 * DEFAULT_STABILITY.focal_share,
    )
    mine = slice(len(CALIBRATED), None)
    one, two = (lasting(DEVIATIONS, NOTHING, stability)[1] for stability in (DEFAULT_STABILITY, twice))
    assert np.diag(two)[mine] == pytest.approx(4 * np.diag(one)[mine])


def test_pictures_that_see_everything_leave_nothing_but_what_they_saw():
    truth = np.zeros(len(DEVIATIONS))
    truth[-1] = 1.5
    information = 1e8 * np.eye(len(DEVIATIONS))
    evidence = Evidence(information, information, information @ truth)
    estimate, left = lasting(DEVIATIONS, evidence, DEFAULT_STABILITY)
    assert estimate == pytest.approx(truth, abs=1e-6)
    assert np.abs(left).max() < 1e-7
    change = judge(CAMERA, FAN, DEVIATIONS, evidence, DEFAULT_STABILITY)
    assert change.p < 1e-9
    assert change.notes[0].code == "scan.fan_has_moved"


def seen(times: float) -> Evidence:
    """Precise pictures that see every change, each as many noises of theirs large."""
    of_change = np.array([one.source == "change" for one in DEVIATIONS], dtype=float)
    information = np.diag(1e4 * of_change)
    return Evidence(information, information, 1e2 * times * of_change)


@pytest.mark.parametrize(
    ("times", "of_unchecked", "of_checked"),
    [
        (1.0, (False, False), (False, False)),
        (1.6, (False, True), (False, False)),
        (2.0, (True, False), (True, False)),
    ],
)
def test_what_may_be_chance_in_one_of_100_rigs_proves_nothing_unless_a_check_of_the_day_has_passed(
    times, of_unchecked, of_checked
):
    change = judge(CAMERA, FAN, DEVIATIONS, seen(times), DEFAULT_STABILITY)
    assert (0.001 < change.p < 0.01) is (times == 1.6)
    changes = [replace(change, checked=checked) for checked in (False, True)]
    assert [(one.surely, one.seemingly) for one in changes] == [of_unchecked, of_checked]


def test_only_pictures_that_see_a_change_agree_with_the_calibrations():
    assert agrees(DEVIATIONS, seen(1.0))
    assert not agrees(DEVIATIONS, seen(1.6))
    assert not agrees(DEVIATIONS, NOTHING)


def test_change_is_told_as_seldom_as_chance_looks_like_it():
    """1 % of rigs that have not changed; calibrations and pictures err by what they state."""
    rng = np.random.default_rng(0)
    by = rng.normal(size=(40, len(DEVIATIONS)))
    information = by.T @ by
    told = 0
    for _ in range(2000):
        truth = np.r_[rng.normal(size=len(CALIBRATED)), np.zeros(len(DEVIATIONS) - len(CALIBRATED))]
        evidence = Evidence(information, information, by.T @ (by @ truth + rng.normal(size=40)))
        told += bool(judge(CAMERA, FAN, DEVIATIONS, evidence, STABLE).notes)
    assert 6 <= told <= 38


@pytest.mark.parametrize("wrong", [-1.0, np.nan, np.inf])
def test_an_absurd_stability_is_refused(wrong):
    with pytest.raises(ValueError, match="not below 0"):
        Stability(turn=wrong)
