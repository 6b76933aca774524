"""Control charts against published ones; how often a steady process breaks the rules."""

import numpy as np
import pytest

from core.wings.studies.kinds.series_chart import (
    D2,
    POINTS_A_BREAK,
    Break,
    c4,
    single_values,
    subgroups,
    western_electric,
)
from tests.wings.studies.spc_tables import FLOW_RATES, PISTON_RINGS


def test_montgomerys_piston_rings_give_his_limits():
    """Example 6.3: x̄ = 74.001, s̄ = 0.0094; limits 73.988 and 74.014 (from rounded figures), 0 and 0.0196."""
    charts = subgroups(PISTON_RINGS)
    assert charts.location.centre == pytest.approx(74.001, abs=5e-4)
    assert charts.spread.centre == pytest.approx(0.0094, abs=5e-5)
    assert (charts.location.lower, charts.location.upper) == pytest.approx((73.988, 74.014), abs=7e-4)
    assert charts.spread.lower == 0 and charts.spread.upper == pytest.approx(0.0196, abs=5e-5)
    assert charts.sigma == pytest.approx(0.01, abs=5e-5), "his σ, s̄/c₄"
    assert not charts.location.breaks and not charts.spread.breaks, "he finds it in control"


def test_nists_flow_rates_give_its_limits():
    """E-Handbook 6.3.2.2: centre 50.81, mean moving range 1.8778, limits 45.8159 and 55.8041."""
    charts = single_values(FLOW_RATES)
    assert charts.location.centre == pytest.approx(50.81)
    assert charts.spread.centre == pytest.approx(1.8778, abs=5e-5)
    assert (charts.location.lower, charts.location.upper) == pytest.approx((45.8159, 55.8041), abs=6e-5)
    assert charts.spread.upper / charts.spread.centre == pytest.approx(3.267, abs=5e-4), "D₄ of two values"


@pytest.mark.parametrize(("n", "factor"), [(2, 0.7979), (5, 0.9400), (10, 0.9727), (25, 0.9896)])
def test_c4_is_that_of_the_tables(n, factor):
    """Montgomery, appendix VI."""
    assert c4(n) == pytest.approx(factor, abs=5e-5)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("points", "breaks"),
    [
        ([0, 3.1, 0], [(1, 1)]),
        ([0, 2.9, 0], []),
        ([2.1, 0, 2.2], [(2, 2)]),
        ([2.1, 0, 0, 2.2], []),
        ([2.1, 0, -2.2], []),
        ([2.1, 2.2, 0], [(2, 1)]),
        ([1.1, 1.2, 0, 1.1, 1.3], [(3, 4)]),
        ([1.1, 1.2, 0, 0, 1.1, 1.3], []),
        ([0.1] * 7, []),
        ([0.1] * 9, [(4, 7), (4, 8)]),
        ([0.1] * 4 + [-0.1] + [0.1] * 4, []),
        ([0] * 12, []),
    ],
)
def test_a_rule_is_broken_by_the_point_that_completes_its_pattern(points, breaks, side):
    found = western_electric(10 + side * 0.5 * np.array(points, dtype=float), 10.0, 0.5)
    assert found == tuple(Break(rule, place) for rule, place in breaks)


def test_a_steady_process_breaks_a_rule_as_often_as_published():
    """Champ and Woodall 1987: an average run length of 91.75."""
    rng = np.random.default_rng(11)
    runs = [western_electric(rng.standard_normal(1500), 0.0, 1.0)[0].place + 1 for _ in range(4000)]
    assert np.mean(runs) == pytest.approx(POINTS_A_BREAK, abs=3 * np.std(runs) / np.sqrt(len(runs)))


def test_the_degrees_of_freedom_are_those_of_the_scatter_of_sigma():
    rng = np.random.default_rng(2)
    single = rng.standard_normal((4000, 30))
    sigmas = np.abs(np.diff(single)).mean(axis=1) / D2
    assert 0.5 * (sigmas.mean() / sigmas.std()) ** 2 == pytest.approx(single_values(single[0]).dof, rel=0.1)
    grouped = rng.standard_normal((4000, 20, 5))
    sigmas = grouped.std(axis=2, ddof=1).mean(axis=1) / c4(5)
    assert 0.5 * (sigmas.mean() / sigmas.std()) ** 2 == pytest.approx(subgroups(grouped[0]).dof, rel=0.1)
