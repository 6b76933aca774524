"""How much a rig changes, by the likelihoods of its checks."""

import numpy as np
import pytest

from core.calibrate.change import DEFAULT_STABILITY, Evidence, Stability, changes, lasting
from core.calibrate.deviations import Deviation, moved_fan
from core.calibrate.rig_spread import log_likelihoods, most_likely_factor, stability_by_pictures
from core.model import Fan, LightPlane
from tests.calibrate.fan_scenes import CAMERA, PAPER

FAN = Fan(tuple(LightPlane(pi) for pi in PAPER))
DEVIATIONS = (*(Deviation("fan", CAMERA, moved_fan(FAN, step)) for step in 1e-7 * np.eye(9)), *changes(CAMERA, FAN))
SEEN = 6
"""Combinations of deviations that a check sees."""


def history(factor: float, checks: int, seed: int = 3, precision: float = 10.0) -> np.ndarray:
    """Likelihoods of checks of a rig that changes by so many times the default; the calibrations' errors stay."""
    draw = np.random.default_rng(seed)
    own = draw.normal(size=9)
    found = []
    for _ in range(checks):
        design = precision * draw.normal(size=(SEEN, len(DEVIATIONS)))
        design[:, :9] *= 0.1
        truth = np.r_[own, factor * draw.normal(size=9)]
        information = design.T @ design
        gradient = design.T @ (design @ truth + draw.normal(size=SEEN))
        found.append(log_likelihoods(DEVIATIONS, Evidence(information, information, gradient)))
    return np.array(found)


@pytest.mark.parametrize("factor", [0.25, 0.5, 1.0, 3.0, 8.0])
def test_checks_tell_by_how_much_a_rig_changes(factor):
    found = [most_likely_factor(history(factor, 8, seed)) for seed in range(20)]
    assert np.exp(np.mean(np.log(found))) == pytest.approx(factor, rel=0.15)
    assert np.all((0.6 * factor < np.array(found)) & (np.array(found) < 1.6 * factor))


def test_checks_that_see_nothing_leave_the_default():
    assert most_likely_factor(history(4.0, 8, precision=0.0)) == pytest.approx(1.0)


def held(factor: float, *, by_pictures: bool) -> float:
    """Share of unchecked rigs, changed by so many times the default, whose lengths are within U of the truth.

    A scan sees a few combinations of deviations well, and most badly.
    """
    draw, within, rigs = np.random.default_rng(5), 0, 400
    for _ in range(rigs):
        design = draw.normal(size=(40, len(DEVIATIONS))) * np.geomspace(0.006, 0.3, 40)[:, None]
        design[:, :9] *= 0.05
        truth = np.r_[draw.normal(size=9), factor * draw.normal(size=9)]
        information = design.T @ design
        evidence = Evidence(information, information, design.T @ (design @ truth + draw.normal(size=40)))
        stability = stability_by_pictures(DEVIATIONS, evidence) if by_pictures else DEFAULT_STABILITY
        estimate, left = lasting(DEVIATIONS, evidence, stability)
        of_length = draw.normal(size=len(DEVIATIONS)) * np.r_[np.full(9, 0.5), np.ones(9)]
        within += abs(of_length @ truth) <= 2 * np.hypot(np.sqrt(of_length @ left @ of_length), of_length @ estimate)
    return within / rigs


def test_a_rig_that_changed_more_than_is_assumed_is_within_u_by_what_its_scan_shows():
    assert held(5.0, by_pictures=False) < 0.6
    assert held(5.0, by_pictures=True) > 0.92
    assert held(1.0, by_pictures=True) > 0.95


def test_no_scan_makes_an_unchecked_rig_more_stable_than_is_assumed():
    nothing = Evidence.none(len(DEVIATIONS))
    precise = 1e4 * np.eye(len(DEVIATIONS))
    assert stability_by_pictures(DEVIATIONS, nothing) == DEFAULT_STABILITY
    assert stability_by_pictures(DEVIATIONS, Evidence(precise, precise, nothing.gradient)) == Stability()
