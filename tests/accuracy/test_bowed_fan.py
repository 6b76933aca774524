"""A fan whose lens bends its lines: the whole job from pictures says so, and U holds the error."""

import pytest

from core.simulate.scenario import Scenario
from tests.accuracy.twin import measure


@pytest.mark.accuracy
def test_a_thickness_by_bowed_lines_is_within_its_uncertainty(tmp_path):
    """Lines bent by 0.06 mm: the thickness was 0.4 mm off at U = 0.1 mm, and nothing was said of the lines."""
    measured = measure(Scenario(scale=0.3, frames=40, fan_bow=0.01), tmp_path)
    error = abs(measured.gauge.thickness_mm - 50.0)
    assert 0.1 < error < measured.gauge.U_mm < 4 * error
    assert any(row.words.code == "inspection.cause_bent_light" for row in measured.gauge.budget)
