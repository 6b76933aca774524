"""How much a rig changes, by the likelihoods of its checks."""

import numpy as np
import pytest

from core.calibrate.change import Evidence, changes
from core.calibrate.deviations import Deviation, moved_fan
from core.calibrate.rig_spread import log_likelihoods, most_likely_factor
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
