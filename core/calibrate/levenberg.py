"""Levenberg–Marquardt for unknowns that are not a vector: planes, pencils, poses.

The state may be anything. `linearise` gives residuals and their derivatives by a small local step, `move` takes the
step; so rotations need no special parametrisation and never meet a singularity.

References
----------
Marquardt, D. W., J. SIAM 11 (1963) 431, doi:10.1137/0111030.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from core.model.arrays import Array

State = TypeVar("State")


@dataclass(frozen=True, eq=False, slots=True)
class Solution(Generic[State]):
    """A minimum: the state, residuals (M,) and Jacobian (M, P) there, and whether it converged."""

    state: State
    residuals: Array
    jacobian: Array
    converged: bool

    @property
    def covariance(self) -> Array:
        """(P, P) of the local step, for residuals of unit variance; infinite variance along undetermined directions."""
        return inverse_normal_matrix(self.jacobian)


def inverse_normal_matrix(jacobian: Array) -> Array:
    """(JᵀJ)⁻¹, with columns scaled to unit length first so that mm, rad and 1/mm do not upset it."""
    scale = np.linalg.norm(jacobian, axis=0)
    scale[scale == 0] = 1.0
    scaled = jacobian / scale
    values, vectors = np.linalg.eigh(scaled.T @ scaled)
    values = np.maximum(values, 1e-15 * values[-1])
    inverse: Array = (vectors / values) @ vectors.T / np.outer(scale, scale)
    return inverse


def minimise(
    state: State,
    linearise: Callable[[State], tuple[Array, Array]],
    move: Callable[[State, Array], State],
    *,
    iterations: int = 50,
    tolerance: float = 1e-9,
) -> Solution[State]:
    """Minimise the sum of squared residuals.

    Parameters
    ----------
    state
        Where to start.
    linearise
        Gives residuals (M,) and their derivatives (M, P) by the local step at a state.
    move
        Takes a local step (P,) from a state.
    iterations, tolerance
        Stops when a step lowers the sum by less than `tolerance` of itself.
    """
    residuals, jacobian = linearise(state)
    cost = float(residuals @ residuals)
    damping = 1e-6
    for _ in range(iterations):
        scale = np.linalg.norm(jacobian, axis=0)
        scale[scale == 0] = 1.0
        scaled = jacobian / scale
        normal, gradient = scaled.T @ scaled, scaled.T @ residuals
        while True:
            damped = normal + damping * np.eye(len(gradient))
            trial = move(state, -np.linalg.solve(damped, gradient) / scale)
            trial_residuals, trial_jacobian = linearise(trial)
            trial_cost = float(trial_residuals @ trial_residuals)
            if trial_cost <= cost:
                break
            damping *= 10
            if damping > 1e8:  # no step lowers the sum any more: the minimum to the last digit
                return Solution(state, residuals, jacobian, converged=True)
        gain = cost - trial_cost
        state, residuals, jacobian, cost = trial, trial_residuals, trial_jacobian, trial_cost
        damping = max(damping / 10, 1e-12)
        if gain <= tolerance * cost:
            return Solution(state, residuals, jacobian, converged=True)
    return Solution(state, residuals, jacobian, converged=False)
