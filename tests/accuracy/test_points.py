"""What is said of points measured with many calibrations."""

import numpy as np
import pytest

from tests.accuracy.points import Points, shown


def test_errors_as_large_as_stated_show_as_such():
    sigma = np.random.default_rng(1).uniform(0.01, 0.05, 40_000)
    errors = sigma * np.random.default_rng(2).normal(size=len(sigma))
    assert shown(errors, sigma) == pytest.approx((0.9545, 1.0), abs=0.01)
    assert shown(errors, 2 * sigma)[1] == pytest.approx(0.5, abs=0.01)


def test_a_mistaken_point_counts_against_the_share_alone_and_an_unknown_one_not_at_all():
    sigma = np.full(5, 0.02)
    assert shown(np.array([0.02, -0.02, 0.02, 4.0, np.nan]), sigma) == (0.75, pytest.approx(1.0))


def test_how_sure_a_share_is_follows_from_how_much_calibrations_differ():
    found = Points(np.array([1.0, 1.0, 1.0, 0.6]), np.array([1.0, 0.5, 0.5, 1.5]))
    assert found.share == pytest.approx(0.9)
    assert found.share_sd == pytest.approx(0.1)
    assert found.normalised == pytest.approx(np.sqrt(3.75 / 4))
