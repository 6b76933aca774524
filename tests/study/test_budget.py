"""Budgets against the examples H.1 and H.2 of the GUM (JCGM 100:2008)."""

import math

import numpy as np
import pytest

from core.inspect.results import Contribution
from core.inspect.uncertainty.causes import cause_named
from core.study.budget import Input, add_up, combine, covariance_of, dof_of_doubt, of_observations, within

LENGTH, ALPHA, OFF = 50.000623e6, 11.5e-6, -0.1
"""Of the standard in nm, its expansion in 1/K, and the temperature's deviation from 20 °C."""


def end_gauge():
    """H.1: l = l_S + d − l_S (δα θ + α_S δθ), all in nm; each u from what H.1.3 says of its origin."""
    comparison = combine([
        Input("repeatability of 5 readings, s pooled of 25", 215.0, 13 / math.sqrt(5), dof=24, unit="nm"),
        Input("random effects of the comparator, ±0.01 µm at 95 %, 6 readings", 0.0, 10 / 2.57, dof=5, unit="nm"),
        Input("systematic effects of the comparator, 0.02 µm at 3σ", 0.0, 20 / 3, dof=dof_of_doubt(0.25), unit="nm"),
    ], unit="nm")  # fmt: skip
    d = Input("difference d", 215.0, comparison.u, dof=comparison.dof, unit="nm")
    swing = within("swing of the temperature", 0.0, 0.5, "arcsine", unit="°C")
    temperature = combine([Input("mean temperature", OFF, 0.2, unit="°C"), swing], unit="°C")
    inputs = [
        Input("standard l_S, U = 0.075 µm at 3σ", LENGTH, 75 / 3, dof=18, unit="nm"),
        d,
        within("expansion α_S", ALPHA, 2e-6, sensitivity=0.0, unit="1/K"),
        Input("temperature θ", OFF, temperature.u, sensitivity=0.0, unit="°C"),
        within("difference of expansions δα", 0.0, 1e-6, sensitivity=-LENGTH * OFF, dof=dof_of_doubt(0.1), unit="1/K"),
        within(
            "difference of temperatures δθ", 0.0, 0.05, sensitivity=-LENGTH * ALPHA, dof=dof_of_doubt(0.5), unit="°C"
        ),
    ]
    return comparison, temperature, inputs


def test_the_parts_of_the_end_gauge_are_those_printed_in_table_H_1():
    comparison, temperature, inputs = end_gauge()
    assert [round(row.u_mm, 1) for row in comparison.rows] == [5.8, 3.9, 6.7]
    assert (comparison.u, comparison.dof) == (pytest.approx(9.7, abs=0.05), pytest.approx(25.6, abs=0.1))
    assert temperature.u == pytest.approx(0.41, abs=0.005)
    assert inputs[2].u == pytest.approx(1.2e-6, abs=5e-8)
    assert inputs[4].u == pytest.approx(0.58e-6, abs=5e-9)
    assert inputs[5].u == pytest.approx(0.029, abs=5e-4)
    assert [round(abs(one.contribution), 1) for one in inputs] == [25, 9.7, 0, 0, 2.9, 16.6]


def test_the_end_gauge_has_the_printed_uncertainty_freedom_and_expanded_uncertainty():
    found = combine(end_gauge()[2], coverage=0.99, unit="nm")
    assert round(found.u) == 32
    assert found.u**2 == pytest.approx(1002, abs=2)
    assert found.dof == pytest.approx(16.7, abs=0.1)
    assert found.k == pytest.approx(2.92, abs=0.005)  # t_99(16)
    assert (found.U, found.unit) == (pytest.approx(92.5, abs=0.05), "nm")
    assert round(found.k * round(found.u)) == 93  # the GUM multiplies the rounded 32 nm
    assert sum(found.share(row) for row in found.rows) == pytest.approx(1)


VOLTS = (5.007, 4.994, 5.005, 4.990, 4.999)
AMPERES = (0.019663, 0.019639, 0.019640, 0.019685, 0.019678)
RADIANS = (1.0456, 1.0438, 1.0468, 1.0428, 1.0433)


def impedance():
    """H.2: R, X and Z from five simultaneous observations of V, I and φ: inputs, their correlation, sensitivities."""
    observed = (VOLTS, AMPERES, RADIANS)
    inputs = [of_observations(name, values) for name, values in zip(("V", "I", "φ"), observed, strict=True)]
    v, i, phi = (one.value for one in inputs)
    z, cos, sin = v / i, math.cos(phi), math.sin(phi)
    jacobian = np.array([[cos / i, -z * cos / i, -z * sin], [sin / i, -z * sin / i, z * cos], [1 / i, -z / i, 0]])
    return inputs, np.corrcoef(observed), jacobian, (z * cos, z * sin, z)


def test_correlated_observations_give_the_printed_means_and_correlations_of_table_H_2():
    inputs, r, _, values = impedance()
    assert [one.value for one in inputs] == pytest.approx([4.9990, 0.0196610, 1.04446], abs=5e-6)
    assert [one.u for one in inputs] == [
        pytest.approx(0.0032, abs=5e-5),
        pytest.approx(0.0095e-3, abs=5e-8),
        pytest.approx(0.00075, abs=5e-6),
    ]
    assert (r[0, 1], r[0, 2], r[1, 2]) == pytest.approx((-0.36, 0.86, -0.65), abs=0.005)
    assert values == pytest.approx((127.732, 219.847, 254.260), abs=5e-4)


@pytest.mark.parametrize(("row", "printed"), [(0, 0.071), (1, 0.295), (2, 0.236)])
def test_resistance_reactance_and_impedance_have_the_uncertainty_printed_in_table_H_3(row, printed):
    inputs, r, jacobian, values = impedance()
    weighted = [
        Input(one.name, one.value, one.u, c, one.distribution, one.dof)
        for one, c in zip(inputs, jacobian[row], strict=True)
    ]
    found = combine(weighted, correlation=r, value=values[row])
    assert found.u == pytest.approx(printed, abs=7e-4)  # 0.2956 is printed as 0.295
    assert found.dof == pytest.approx(4)  # five observations of each, taken together
    assert combine(weighted).u != pytest.approx(printed, abs=5e-3)  # left out, the correlations are missed


def test_results_of_the_same_inputs_have_the_correlations_printed_in_table_H_3():
    inputs, r, jacobian, _ = impedance()
    v = covariance_of(inputs, jacobian, r)
    u = np.sqrt(np.diag(v))
    of_results = v / u[:, None] / u
    assert (of_results[0, 1], of_results[0, 2], of_results[1, 2]) == pytest.approx((-0.588, -0.485, 0.993), abs=5e-4)


def test_freedom_of_correlated_inputs_is_that_of_the_least_known_and_of_independent_ones_adds_up():
    pair = [Input("a", 0, 1.0, dof=4), Input("b", 0, 1.0, dof=9), Input("c", 0, 1.0, dof=5)]
    r = np.array([[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]])
    found = combine(pair, correlation=r)
    assert found.u == pytest.approx(2)  # √(1 + 1 + 2·0.5 + 1)
    assert found.dof == pytest.approx(16 / (9 / 4 + 1 / 5))


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


@pytest.mark.parametrize(
    "r", [np.eye(2), np.array([[1, 0.5, 0], [0.4, 1, 0], [0, 0, 1]]), np.full((3, 3), -0.9) + 1.9 * np.eye(3)]
)
def test_what_is_no_correlation_matrix_is_refused(r):
    with pytest.raises(ValueError, match="no correlation matrix"):
        combine([Input(name, 0, 1.0) for name in "abc"], correlation=r)


def test_one_observation_has_no_scatter_to_evaluate():
    with pytest.raises(ValueError, match="two finite observations"):
        of_observations("alone", [1.0])
