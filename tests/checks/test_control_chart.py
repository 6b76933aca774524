"""Limits of a control chart: by the history once it is long enough, by what is stated before."""

import numpy as np
import pytest

from core.checks.control_chart import FEWEST, control_chart


def test_few_checks_are_held_to_what_is_stated():
    chart = control_chart(np.full(FEWEST - 1, 0.2), 0.01)
    assert not chart.own
    assert (chart.lower, chart.centre, chart.upper) == pytest.approx((-0.03, 0.0, 0.03))


def test_eight_checks_have_limits_of_their_own_three_standard_deviations_wide():
    values = np.random.default_rng(1).normal(0.2, 0.01, 4000)
    chart = control_chart(values, 1.0)
    assert chart.own and chart.n == 4000
    assert (chart.lower, chart.centre, chart.upper) == pytest.approx((0.17, 0.2, 0.23), abs=0.002)
    inside = np.mean([chart.contains(value) for value in values])
    assert inside == pytest.approx(0.9973, abs=0.002)


def test_checks_without_a_figure_do_not_count():
    assert control_chart(np.array([np.nan] * 3 + [0.1] * (FEWEST - 1)), 0.01).n == FEWEST - 1
    assert not control_chart(np.zeros(0), 0.01).contains(float("nan"))
