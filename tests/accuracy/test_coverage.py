"""The truth lies within what is stated: Monte Carlo at the level of centrelines, calibrations drawn anew each time."""

import pytest

from tests.accuracy.coverage import run

pytestmark = pytest.mark.accuracy


def test_the_truth_lies_within_what_is_stated():
    result = run(scans=8, seed=1, blocks=2)
    print(result)  # pytest -rP shows the figures
    assert result.within_U >= 0.75  # of 8 scans; `run` has the long form
    assert result.normalised < 1.6
    assert result.points_within > 0.9
