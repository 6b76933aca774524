"""What the mean of repeats proves, by its own uncertainty."""

import math
from dataclasses import replace

import numpy as np
import pytest

from core.inspect.causes import Cause
from core.inspect.results import Contribution
from core.report.facts.of_budget import EFFECTIVE, freedom_fact
from core.report.wording import Words
from core.wings.studies.kinds.budget import from_budgets, from_stated
from core.wings.studies.kinds.repeats import Requirement, repeat_study
from core.wings.studies.study_facts import study_facts


def study(values, u, **asked):
    return repeat_study(values, from_stated(values, u), complete=u is not None, asked=Requirement(**asked))


def test_the_verdict_is_that_of_the_mean_with_its_own_uncertainty():
    values = [50.02, 50.04, 50.03, 50.03]
    good = study(values, 0.01, nominal=50.0, limits=(-0.1, 0.1))
    assert good.verdict == "conforming"
    assert good.budget.u == pytest.approx(math.hypot(0.01, np.std(values, ddof=1) / 2))
    assert study(values, 0.04, nominal=50.0, limits=(-0.1, 0.1)).verdict == "not proven"
    assert study(values, 0.04, nominal=50.0, limits=(-0.1, 0.1), r=0).verdict == "conforming"
    assert study(values, 0.01, nominal=49.0, limits=(-0.1, 0.1)).verdict == "not conforming"
    assert study(values, 0.01).verdict == ""


def test_scatter_alone_proves_nothing_because_what_is_common_is_not_in_it():
    found = study([50.0, 50.001, 50.0], None, nominal=50.0, limits=(-1, 1))
    assert found.verdict == "not proven"
    assert any("nothing is proven" in str(note) for note in found.notes)


def test_what_is_common_to_all_repeats_does_not_average_out_and_their_own_noise_does():
    budget = (
        Contribution(Cause.CAMERA, 0.003),
        Contribution(Cause.POINT_NOISE, 0.02),
        Contribution(Cause.SWEEP_PLANES, 0.01),
    )
    rng = np.random.default_rng(0)
    values = rng.normal(50, math.hypot(0.02, 0.01) / 2, 100)  # no more scatter than stated
    rows = {row.source: row for row in from_budgets(values, [budget] * 100).rows}
    assert rows.keys() == {Cause.CAMERA, Cause.POINT_NOISE, Cause.SWEEP_PLANES}
    assert rows[Cause.CAMERA].u_mm == pytest.approx(0.003)
    assert rows[Cause.POINT_NOISE].u_mm == pytest.approx(0.002)
    assert rows[Cause.SWEEP_PLANES].u_mm == pytest.approx(0.001)


def test_scatter_above_the_stated_noise_takes_its_place():
    budget = (Contribution(Cause.CAMERA, 0.003), Contribution(Cause.POINT_NOISE, 0.006))
    values = 50 + 0.01 * np.array([-1, 1, -1, 1, -1, 1, -1, 1]) * math.sqrt(7 / 8)  # s is 0.01
    found = from_budgets(values, [budget] * 8)
    assert [row.source for row in found.rows] == [Cause.CAMERA, Cause.OBSERVED]
    assert (found.rows[1].point_mm, found.rows[1].dof) == (pytest.approx(0.01), 7)
    assert found.u == pytest.approx(math.sqrt(0.003**2 + 0.01**2 / 8))
    assert found.value == pytest.approx(50)


def test_budgets_that_differ_from_scan_to_scan_enter_by_their_quadratic_mean():
    found = from_budgets([1.0, 1.0], [(Contribution(Cause.CAMERA, 0.3),), (Contribution(Cause.CAMERA, 0.4, dof=5),)])
    assert found.rows[0].u_mm == pytest.approx(math.sqrt((0.09 + 0.16) / 2))
    assert found.rows[0].dof == 5


def test_one_value_of_unknown_uncertainty_has_no_budget():
    with pytest.raises(ValueError, match="one value alone"):
        from_stated([50.0], None)
    assert from_stated([50.0], 0.01).u == pytest.approx(0.01)


@pytest.mark.parametrize("actual", [0.008, 0.015])
def test_U_of_the_mean_holds_the_truth_in_95_of_100_series_whether_or_not_the_noise_is_as_stated(actual):
    rng = np.random.default_rng(4)
    budget = (Contribution(Cause.CAMERA, 0.004), Contribution(Cause.POINT_NOISE, 0.008))
    held = []
    for _ in range(2000):
        values = 50 + 0.004 * rng.normal() + actual * rng.normal(size=5)
        found = from_budgets(values, [budget] * 5)
        held.append(abs(found.value - 50) <= found.U)
    assert 0.93 < np.mean(held) < 0.98  # the larger of the stated and the observed noise counts, of five scans


@pytest.mark.parametrize("dof", [5.25, 12.5, 5000.0, math.inf])
def test_degrees_of_freedom_are_told_in_the_words_and_digits_of_a_budget(dof):
    found = study([1.0, 1.1, 1.05], None)
    of_mean = replace(found, budget=replace(found.budget, dof=dof))
    told = [(one.label, one.text(Words())) for one in study_facts(of_mean)]
    assert (EFFECTIVE, freedom_fact("ν", dof).text(Words())) in told
