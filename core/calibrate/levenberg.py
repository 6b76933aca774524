"""Levenberg–Marquardt for unknowns that are not a vector: planes, pencils, poses.

The state may be anything. `linearise` gives the residuals near it as normal equations of a small local step,
`move` takes the step; so rotations need no special parametrisation and never meet a singularity.

References
----------
Marquardt, D. W., J. SIAM 11 (1963) 431, doi:10.1137/0111030.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from core.model.arrays import Array

State = TypeVar("State")

# Damping relative to the scaled normal matrix, whose diagonal is 1; Marquardt's factor 10 up and down.
FIRST_DAMPING, DAMPING_FACTOR = 1e-6, 10
"""Starts are near: at first nearly Gauss–Newton."""
LEAST_DAMPING, MOST_DAMPING = 1e-12, 1e8
"""Beyond the largest no step lowers the sum any more: the minimum to the last digit."""


class Linearised(Protocol):
    """Normal equations of a sum of squared residuals near a state."""

    @property
    def cost(self) -> float:
        """Sum of squared residuals at the state that the equations are linearised about."""

    def step(self, damping: float) -> Array:
        """Compute the step (P,) to the linearised minimum, the diagonal raised by `damping` of itself."""


class DenseProblem:
    """Residuals (M,) with their full Jacobian (M, P)."""

    def __init__(self, residuals: Array, jacobian: Array) -> None:
        self.residuals, self.jacobian = residuals, jacobian
        self.cost = float(residuals @ residuals)
        self._scale = np.linalg.norm(jacobian, axis=0)
        self._scale[self._scale == 0] = 1.0
        scaled = jacobian / self._scale
        self._normal, self._gradient = scaled.T @ scaled, scaled.T @ residuals

    def step(self, damping: float) -> Array:
        damped = self._normal + damping * np.eye(len(self._gradient))
        return np.asarray(-np.linalg.solve(damped, self._gradient) / self._scale, dtype=np.float64)


Model = TypeVar("Model", bound=Linearised)


@dataclass(frozen=True, eq=False, slots=True)
class Solution(Generic[State, Model]):
    """Result of a minimisation.

    A minimum if it has `converged`. `linear` are the residuals with their derivatives there.
    """

    state: State
    linear: Model
    converged: bool


MOST_STEPS = 50
"""After so many steps it stops where it is: it has not converged."""
LEAST_GAIN = 1e-9
"""It has converged when a step lowers the sum by no more than this share of it."""


def minimise(
    state: State,
    linearise: Callable[[State], Model],
    move: Callable[[State, Array], State],
) -> Solution[State, Model]:
    """Minimise a sum of squared residuals by Levenberg and Marquardt's method, from `state`.

    Parameters
    ----------
    state
        Where to start.
    linearise
        Gives the residuals near a state.
    move
        Takes a local step (P,) from a state.
    """
    linear = linearise(state)
    damping: float = FIRST_DAMPING
    for _ in range(MOST_STEPS):
        while True:
            trial = move(state, linear.step(damping))
            trial_linear = linearise(trial)
            if trial_linear.cost <= linear.cost:
                break
            damping *= DAMPING_FACTOR
            if damping > MOST_DAMPING:
                return Solution(state, linear, converged=True)
        gain = linear.cost - trial_linear.cost
        state, linear = trial, trial_linear
        damping = max(damping / DAMPING_FACTOR, LEAST_DAMPING)
        if gain <= LEAST_GAIN * linear.cost:
            return Solution(state, linear, converged=True)
    return Solution(state, linear, converged=False)
