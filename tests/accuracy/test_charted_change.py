"""Coverage of what the history of a rig says of its change: rigs of known spread from day to day, many of them."""

from dataclasses import replace
from datetime import timedelta

import numpy as np
import pytest

from core.calibrate.change import DEFAULT_STABILITY, Evidence, changes, lasting
from core.calibrate.deviations import Deviation, moved_fan
from core.calibrate.rig_spread import log_likelihoods
from core.files.results.rig_history import QUIET_DAYS, PastCheck, RigHistory
from core.model import Fan, LightPlane
from tests.calibrate.fan_scenes import CAMERA, PAPER
from tests.check_cases import check

FAN = Fan(tuple(LightPlane(pi) for pi in PAPER))
DEVIATIONS = (*(Deviation("fan", CAMERA, moved_fan(FAN, step)) for step in 1e-7 * np.eye(9)), *changes(CAMERA, FAN))
CHANGES = slice(9, 18)
SEEN = 6
"""Combinations of deviations that a check sees, by 0.3 to 3 times their size; what a step feels it sees best."""
FIRST = PastCheck.of(check())
KINDS = {"all": np.ones(9), "drift": np.array([*[0.25] * 6, 1.0, 1.0, 0.25])}
"""How much the rig turns, shifts and drifts, in parts of the default's proportions."""


def covered(kind: str, times: float, days: int, rigs: int = 60) -> tuple[float, float]:
    """Share of steps measured without a check of the day that lie within twice the charted row; mean factor."""
    draw = np.random.default_rng(11)
    share, factors = [], []
    for _ in range(rigs):
        size, by = times * KINDS[kind], np.r_[0.1 * np.ones(9), np.ones(9)] * draw.normal(size=18)
        design = np.geomspace(0.3, 3, SEEN)[:, None] * draw.normal(size=(SEEN, 18))
        design[-1] = 10 * by / np.linalg.norm(by)
        row = float(np.linalg.norm(by[CHANGES]))
        own, checks = draw.normal(size=9), []
        for day in range(days):
            truth = np.r_[own, size * draw.normal(size=9)]
            evidence = Evidence(
                design.T @ design, design.T @ design, design.T @ (design @ truth + draw.normal(size=SEEN))
            )
            estimate, _ = lasting(DEVIATIONS, evidence, DEFAULT_STABILITY)
            seen = replace(
                FIRST,
                taken_at=FIRST.taken_at + timedelta(days=day),
                pictures_id=str(day),
                error_mm=float(-by @ estimate),
                stated_mm=row,
                likelihoods=tuple(map(float, log_likelihoods(DEVIATIONS, evidence))),
            )
            checks.append(seen)
        when = FIRST.taken_at + timedelta(days=days, hours=1)
        spread = RigHistory("bench", tuple(checks)).spread(FIRST.calibration_id, when)
        factors.append(1.0 if spread is None else spread.factor)
        errors = (size * draw.normal(size=(1000, 9))) @ by[CHANGES]
        share.append(np.mean(np.abs(errors) <= 2 * factors[-1] * row))
    return float(np.mean(share)), float(np.mean(factors))


@pytest.mark.parametrize(
    ("kind", "times", "days"),
    [
        ("all", 1.0, 8),
        ("all", 4.0, 8),
        ("drift", 4.0, 8),
        pytest.param("all", 1.0, QUIET_DAYS, marks=pytest.mark.accuracy),
        pytest.param("drift", 4.0, 20, marks=pytest.mark.accuracy),
    ],
)
def test_what_is_charted_holds_as_many_errors_as_it_says(kind, times, days):
    share, factor = covered(kind, times, days)
    assert 0.93 <= share <= 0.99, (share, factor)


def test_a_quiet_rig_is_held_to_the_default_until_there_are_many_days():
    assert covered("all", 0.5, 20, rigs=20)[1] == pytest.approx(1.0, abs=0.02)
    share, factor = covered("all", 0.5, QUIET_DAYS, rigs=20)
    assert 0.5 <= factor < 0.75
    assert share >= 0.93
