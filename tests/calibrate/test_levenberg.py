"""Levenberg–Marquardt: whether it has come to a minimum is told."""

import numpy as np

from core.calibrate.levenberg import DenseProblem, minimise


def test_a_minimum_that_is_reached_is_told():
    def linearise(x: np.ndarray) -> DenseProblem:
        return DenseProblem(np.array([x[0] ** 2 - 2.0, 0.5]), np.array([[2 * x[0]], [0.0]]))

    found = minimise(np.array([1.0]), linearise, np.add)
    assert found.converged and abs(found.state[0] - np.sqrt(2)) < 1e-6


def test_a_sum_that_becomes_smaller_and_smaller_has_not_converged():
    def linearise(x: np.ndarray) -> DenseProblem:
        return DenseProblem(np.exp(-x), -np.exp(-x)[:, None])

    found = minimise(np.array([0.0]), linearise, np.add)
    assert not found.converged, "each step takes it one further"
    assert found.linear.cost < 1e-40, "it stops where it is"
