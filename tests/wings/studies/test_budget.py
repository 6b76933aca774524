"""Budgets against example H.1 of the GUM (JCGM 100:2008)."""

import math

import pytest

from core.inspect.causes import cause_named
from core.inspect.results import Contribution
from core.messages import plain
from core.wings.studies.kinds.budget import add_up

LENGTH, ALPHA, OFF = 50.000623e6, 11.5e-6, -0.1
"""Of the standard in nm, its expansion in 1/K, and the temperature's deviation from 20 °C."""


def row(name, u_nm, dof=math.inf):
    return Contribution(plain(name), abs(u_nm), dof=dof)


def doubted(share):
    """Degrees of freedom of a u that is itself uncertain by a share, G.4.2."""
    return 0.5 / share**2


def comparison():
    """The difference d of H.1, from what H.1.3.2 says of its origin."""
    return add_up([
        row("repeatability of 5 readings, s pooled of 25", 13 / math.sqrt(5), 24),
        row("random effects of the comparator, ±0.01 µm at 95 %, 6 readings", 10 / 2.57, 5),
        row("systematic effects of the comparator, 0.02 µm at 3σ", 20 / 3, doubted(0.25)),
    ], unit="nm")  # fmt: skip


def test_the_difference_of_the_end_gauge_has_the_uncertainty_and_freedom_printed_in_table_H_1():
    found = comparison()
    assert [round(row.u_mm, 1) for row in found.rows] == [5.8, 3.9, 6.7]
    assert (found.u, found.dof) == (pytest.approx(9.7, abs=0.05), pytest.approx(25.6, abs=0.1))


def test_the_end_gauge_has_the_printed_uncertainty_freedom_and_expanded_uncertainty():
    """H.1: l = l_S + d − l_S (δα θ + α_S δθ), all in nm."""
    d = comparison()
    found = add_up([
        row("standard l_S, U = 0.075 µm at 3σ", 75 / 3, 18),
        row("difference d", d.u, d.dof),
        row("difference of expansions δα, ±1e-6", LENGTH * OFF * 1e-6 / math.sqrt(3), doubted(0.1)),
        row("difference of temperatures δθ, ±0.05 °C", LENGTH * ALPHA * 0.05 / math.sqrt(3), doubted(0.5)),
    ], coverage=0.99, unit="nm")  # fmt: skip
    assert [round(row.u_mm, 1) for row in found.rows] == [25, 9.7, 2.9, 16.6]
    assert round(found.u) == 32
    assert found.u**2 == pytest.approx(1002, abs=2)
    assert found.dof == pytest.approx(16.7, abs=0.1)
    assert found.k == pytest.approx(2.92, abs=0.005)  # t_99(16)
    assert (found.U, found.unit) == (pytest.approx(92.5, abs=0.05), "nm")
    assert round(found.k * round(found.u)) == 93  # the GUM multiplies the rounded 32 nm
    assert sum(found.share(row) for row in found.rows) == pytest.approx(1)


@pytest.mark.parametrize("size", [1e-150, 1e-3, 1e150])
def test_freedom_does_not_depend_on_the_size_of_the_contributions(size):
    rows = [Contribution(cause_named("camera"), size * u, dof=dof) for u, dof in ((1.0, 4.0), (2.0, math.inf))]
    assert add_up(rows).dof == pytest.approx(25 * 4)


def test_known_contributions_give_k_of_two_and_guessed_ones_more():
    known, few = Contribution(cause_named("camera"), 0.003), Contribution(cause_named("form"), 0.004, dof=4)
    assert add_up([known]).k == pytest.approx(2)
    found = add_up([known, few])
    assert (found.u, found.dof) == (pytest.approx(0.005), pytest.approx(0.005**4 / (0.004**4 / 4)))
    assert found.k == pytest.approx(2.32, abs=0.005)  # t_95.45(9), table G.2
    assert add_up([Contribution(cause_named("nothing"), 0.0)]).U == 0
