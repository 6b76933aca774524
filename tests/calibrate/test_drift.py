"""How much further a rig may have changed, the warmer and the later it is."""

import numpy as np
import pytest

from core.calibrate.change import DEFAULT_STABILITY, STABLE, Evidence, Stability, lasting
from core.calibrate.drift import NO_DRIFT, USUAL_KELVINS, Apart, Drift, apart, stability_after, widened_evidence
from tests.calibrate.test_change import DEVIATIONS, seen

AT_REST = Stability(50e-6, 0.005, 0.05, 2e-5)
WARMING = Drift(per_kelvin=Stability(40e-6, 0.0034, 0.04, 2e-5), per_hour=Stability(turn=1e-6, shift_mm=0.0))


def test_a_rig_as_warm_as_it_was_calibrated_changes_by_what_is_stated_and_one_10_k_warmer_by_more():
    cool, warm = (stability_after(AT_REST, WARMING, apart(20.0, celsius, 0.0, 5.0)) for celsius in (20.0, 30.0))
    assert cool == AT_REST
    assert warm is not None and warm.turn == pytest.approx(np.hypot(50e-6, 400e-6))
    assert warm.shift_mm == pytest.approx(np.hypot(0.005, 0.034))


def test_hours_count_whether_before_or_after():
    only = Drift(per_hour=Stability(2e-6, 0.0, 0.0, 0.0))
    for hours in (100.0, -100.0):
        found = stability_after(STABLE, only, apart(20.0, 20.0, hours, 5.0))
        assert found is not None and found.turn == pytest.approx(200e-6)


def test_what_is_not_known_of_temperature_and_time_is_said_to_be_assumed():
    assert apart(20.0, None, 3.0, 5.0) == Apart(5.0, 3.0, kelvins_assumed=True)
    assert apart(20.0, 22.0, None, 5.0).hours_assumed


def test_the_default_stands_for_as_much_as_is_usual_and_grows_beyond():
    assert stability_after(None, NO_DRIFT, apart(20.0, None, None, USUAL_KELVINS)) is None
    assert stability_after(None, NO_DRIFT, apart(20.0, 25.0, None, USUAL_KELVINS)) is None
    warmer = stability_after(None, NO_DRIFT, apart(20.0, 30.0, None, USUAL_KELVINS))
    assert warmer is not None and warmer.turn == pytest.approx(2 * DEFAULT_STABILITY.turn)
    assert stability_after(AT_REST, NO_DRIFT, apart(20.0, 60.0, None, USUAL_KELVINS)) is AT_REST, "it is stated"


def test_a_check_says_all_it_saw_where_nothing_has_changed_since():
    evidence = seen(1.0)
    assert widened_evidence(evidence, DEVIATIONS, STABLE) is evidence


def test_what_has_changed_since_a_check_is_left_open_by_it():
    since = DEFAULT_STABILITY.times(0.5, 0.0, 0.5, 0.5)
    known = 1e6 * np.eye(len(DEVIATIONS))
    evidence = widened_evidence(Evidence(known, known, np.zeros(len(DEVIATIONS))), DEVIATIONS, since)
    _, left = lasting(DEVIATIONS, evidence, DEFAULT_STABILITY.times(100.0, 100.0, 100.0, 100.0))
    of_change = np.array([one.source == "change" for one in DEVIATIONS])
    assert np.sqrt(np.diag(left)[of_change]) == pytest.approx([0.5] * 3 + [1e-3] * 3 + [0.5] * 3, rel=0.01)


def test_a_loosened_check_is_unbiased_and_as_sure_as_it_says(seed=7, times=4000):
    """Drawn: a change x, what has changed since the check d, and what the check saw of x − d."""
    rng = np.random.default_rng(seed)
    of_change = np.array([one.source == "change" for one in DEVIATIONS])
    root = rng.normal(size=(len(DEVIATIONS), len(DEVIATIONS)))
    known = root @ root.T
    sd = DEFAULT_STABILITY.over_default
    off = []
    for _ in range(times):
        x = rng.normal(size=len(DEVIATIONS))
        before = x.copy()
        before[of_change] -= 0.7 * sd * rng.normal(size=9)
        saw = Evidence(known, known, known @ before + root @ rng.normal(size=len(root)))
        estimate, left = lasting(
            DEVIATIONS, widened_evidence(saw, DEVIATIONS, DEFAULT_STABILITY.times(*[0.7] * 4)), DEFAULT_STABILITY
        )
        off.append(np.linalg.solve(np.linalg.cholesky(left), estimate - x))
    found = np.array(off)
    assert np.cov(found.T) == pytest.approx(np.eye(len(DEVIATIONS)), abs=6 / np.sqrt(times))
