"""Capability indices against published examples, and whether their intervals hold the truth as often as they say."""

import math

import numpy as np
import pytest

from core.wings.studies.kinds.capability import Scatter, indices, looks_normal


def test_montgomerys_cp_has_his_interval():
    """6th ed., 8.3.4: limits 38 and 62, s = 1.75 of 20: Cp 2.29, 1.57 to 3.01."""
    found = indices(Scatter(50.0, 1.75, 19, 20), 38.0, 62.0).p
    assert (found.value, *found.interval) == pytest.approx((2.29, 1.57, 3.01), abs=0.006)


def test_cpk_has_bissells_interval():
    """Montgomery, 6th ed., 8.3.4: Cpk (1 ± 1.96 √(1/(9 n Cpk²) + 1/(2 (n − 1))))."""
    found = indices(Scatter(3.99, 1.0, 19, 20), 0.0, math.inf)
    assert found.p is None, "with one limit there is no Cp"
    half = 1.96 * math.sqrt(1 / (9 * 20 * 1.33**2) + 1 / (2 * 19))
    assert found.pk.interval == pytest.approx((1.33 * (1 - half), 1.33 * (1 + half)), abs=1e-4)


def test_nists_example_has_its_indices():
    """E-Handbook 6.1.6: limits 8 and 20, mean 16, s 2: Cp 1.0, Cpk 0.6667."""
    found = indices(Scatter(16.0, 2.0, 49, 50), 8.0, 20.0)
    assert (found.p.value, found.pk.value) == pytest.approx((1.0, 0.6667), abs=5e-5)


@pytest.mark.parametrize(("n", "u_common"), [(20, 0.0), (50, 0.3)])
def test_the_intervals_hold_the_truth_in_19_of_20_cases(n, u_common):
    rng = np.random.default_rng(5)
    values = rng.standard_normal((3000, n)) + u_common * rng.standard_normal((3000, 1))
    found = [indices(Scatter(r.mean(), r.std(ddof=1), n - 1, n, u_common), -4.5, 4.0) for r in values]
    for truth, intervals in ((8.5 / 6, [one.p.interval for one in found]), (4 / 3, [one.pk.interval for one in found])):
        held = np.mean([low <= truth <= high for low, high in intervals])
        assert 0.94 <= held <= 0.98


def test_what_moves_all_values_alike_widens_the_interval_of_cpk_and_not_of_cp():
    without, with_u = (indices(Scatter(0.0, 1.0, 49, 50, u), -4.0, 4.0) for u in (0.0, 0.5))
    assert with_u.p == without.p and with_u.pk.value == without.pk.value
    assert with_u.pk.interval[0] < without.pk.interval[0] - 0.1


def test_normal_values_look_normal_in_19_of_20_cases_and_lognormal_ones_do_not():
    values = np.random.default_rng(3).standard_normal((2000, 25))
    assert np.mean([looks_normal(one) for one in values]) == pytest.approx(0.95, abs=0.015)
    assert np.mean([looks_normal(np.exp(one)) for one in values]) < 0.1
