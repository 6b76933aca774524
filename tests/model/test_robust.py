"""Robust weights and scale: what far residuals may do."""

from __future__ import annotations

import numpy as np
import pytest

from core.model.robust import TUKEY, huber_weights, mad_sd, median, tukey_weights


def test_far_residuals_pull_no_harder_than_near_ones():
    weights = huber_weights(np.array([0.5, -2.0, 20.0, -200.0]), 2.0)
    assert weights * [0.5, 2, 20, 200] == pytest.approx([0.5, 2, 2, 2])


def test_far_residuals_pull_not_at_all():
    weights = tukey_weights(np.array([0.0, 0.5 * TUKEY, -TUKEY, 200.0]))
    assert weights == pytest.approx([1.0, 0.5625, 0.0, 0.0])


def test_the_scale_of_normal_residuals_is_found_among_outliers():
    residuals = np.random.default_rng(5).normal(0, 3.0, 20_001)
    assert mad_sd(residuals) == pytest.approx(3.0, rel=0.03)
    assert mad_sd(np.where(np.arange(20_001) % 20 == 0, 1e6, residuals)) == pytest.approx(3.0, rel=0.12)


@pytest.mark.parametrize("count", [1, 2, 3, 8, 301, 302])
def test_the_median_is_that_of_numpy_to_the_last_bit_and_not_known_where_a_value_is_not(count: int) -> None:
    values = np.random.default_rng(count).normal(0, 3.0, (count, 2))[:, :1]
    before = values.copy()
    assert median(values) == np.median(values)
    assert np.array_equal(values, before)
    values[count // 2] = np.nan
    assert np.isnan(median(values))


def test_no_values_have_no_median() -> None:
    assert np.isnan(median(np.zeros(0)))
