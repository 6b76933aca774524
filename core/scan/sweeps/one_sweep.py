"""Location of one more sweep by the fan and by sweeps that are located already.

The equations are the network's, π·r = π_b·r at each crossing, but only the new sweep's π is unknown. The planes of the
others are known with a joint covariance Σ, which makes the crossings' right-hand sides correlated::

    cov(observed) = R Σ Rᵀ + diag(σ²)        R: the rays, each in the columns of its own sweep

With the fan alone this is the paper's method (`core.scan.network.sweep_plane`); where the fan leaves a direction of π
free, as on a flat face, the other sweeps fix it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.model.robust import Schedule, irls, tukey_weights
from core.scan.features.crossings import CrossingTable
from core.scan.network.adjustment import HUBER_AT, REJECT_AT
from core.scan.network.equations import GRADIENT_FLOOR
from core.scan.network.geometry import CrossingRays, floored, inverse_depth_gradient, noise_gains
from core.scan.network.line_errors import SIGMA_FLOOR_PX
from core.scan.network.sweep_plane import PRIOR_SD, plane_condition

_WEIGHTS = Schedule(4, 2, HUBER_AT, REJECT_AT)
"""Of reweighting: by Huber first, by Tukey when the plane is about right; tests/scan/sweeps/test_one_sweep.py holds
it."""
_LEAST_WEIGHT = 1e-4
"""Weight that a crossing keeps at least, so that its variance stays finite."""


@dataclass(frozen=True, eq=False, slots=True)
class KnownPlanes:
    """Planes, of the fan or of other sweeps, that one sweep meets at its M crossings: `pis` (M, 3) in 1/mm.

    Those of other sweeps are correlated: `sweep` (M,) says in which block of `covariance` (3K, 3K) each of them is; −1
    for the fan, which counts as known.
    """

    pis: Array
    sweep: NDArray[np.int64]
    covariance: Array


@dataclass(frozen=True, eq=False, slots=True)
class OneSweep:
    """Located sweep: its plane `pi` (3,) in 1/mm with `covariance` (3, 3), and how its crossings agree with it.

    `weights` (M,) of the crossings, 0 (left out) to 1; `residuals` (M,) in standard deviations; `condition` of the
    crossings with the fan that count.
    """

    pi: Array
    covariance: Array
    weights: Array
    residuals: Array
    condition: float


def locate_one(crossings: CrossingTable, geometry: CrossingRays, known: KnownPlanes) -> OneSweep:
    """Locate the sweep that is a in all `crossings`, by the `known` planes of the fan and of sweeps that it meets.

    Raises
    ------
    ValueError
        With fewer than three crossings.
    """
    if len(crossings) < 3:
        raise ValueError(f"{len(crossings)} crossings cannot determine a plane")
    equations = _Equations(crossings, geometry, known)
    first = equations.found(equations.variances(None), np.ones(len(crossings)))
    found = irls(first, lambda one, weigh: equations.found(one.own, weigh(one.residuals)), _WEIGHTS)
    condition = _condition(geometry, known, found.weights)
    return OneSweep(found.pi, found.covariance, found.weights, found.residuals, condition)


def judge_plane(
    pi: Array, covariance: Array, crossings: CrossingTable, geometry: CrossingRays, known: KnownPlanes
) -> OneSweep:
    """Compute the weights and residuals of a sweep's `crossings` with its plane `pi` (3,) from the network."""
    equations = _Equations(crossings, geometry, known)
    residuals = equations.residuals(pi, equations.variances(pi))
    weights = tukey_weights(residuals, REJECT_AT)
    return OneSweep(pi, covariance, weights, residuals, _condition(geometry, known, weights))


class _Found(NamedTuple):
    """A plane by the `weights` (M,) of its crossings; their variances and residuals (M,) from it."""

    pi: Array
    covariance: Array
    weights: Array
    own: Array
    residuals: Array


class _Equations:
    """π·r = π_b·r at M crossings, with what makes them uncertain."""

    def __init__(self, crossings: CrossingTable, geometry: CrossingRays, known: KnownPlanes) -> None:
        self._crossings, self._jacobians, self._pis = crossings, geometry.jacobians, known.pis
        self._rays = geometry.rays
        self._observed = np.einsum("mi,mi->m", geometry.rays, known.pis)
        self._shared = _shared(geometry.rays, known)
        typical = float(np.median(np.linalg.norm(known.pis[:, :2], axis=1)))
        self._typical = typical * float(np.sqrt(np.abs(np.linalg.det(geometry.jacobians)).mean()))
        self._sigma_a = np.maximum(crossings.sigma_a, SIGMA_FLOOR_PX)
        self._sigma_b = np.maximum(crossings.sigma_b, SIGMA_FLOOR_PX)

    def variances(self, pi: Array | None) -> Array:
        """Variance (M,) in 1/mm² from the centrelines' noise; without a plane yet, the rig's geometry stands for it."""
        if pi is None:
            return np.asarray(self._typical**2 * (self._sigma_a**2 + self._sigma_b**2))
        gradient = inverse_depth_gradient(pi - self._pis, self._jacobians)
        gain_a, gain_b = noise_gains(self._crossings, floored(gradient, GRADIENT_FLOOR * self._typical))
        return np.asarray((gain_a * self._sigma_a) ** 2 + (gain_b * self._sigma_b) ** 2)

    def found(self, variances: Array, weights: Array) -> _Found:
        """Solve by the variances and weights (M,) of the crossings."""
        pi, covariance = self.solve(variances / np.maximum(weights, _LEAST_WEIGHT))
        own = self.variances(pi)
        return _Found(pi, covariance, weights, own, self.residuals(pi, own))

    def solve(self, variances: Array) -> tuple[Array, Array]:
        """π (3,) and its covariance (3, 3)."""
        weight = np.linalg.inv(self._shared + np.diag(variances))
        information = self._rays.T @ weight @ self._rays + np.eye(3) / PRIOR_SD**2
        covariance = np.asarray(np.linalg.inv(information), dtype=np.float64)
        return covariance @ (self._rays.T @ (weight @ self._observed)), covariance

    def residuals(self, pi: Array, variances: Array) -> Array:
        """Observed − adjusted (M,) in standard deviations."""
        return np.asarray((self._observed - self._rays @ pi) / np.sqrt(variances + np.diag(self._shared)))


def _condition(geometry: CrossingRays, known: KnownPlanes, weights: Array) -> float:
    return plane_condition(geometry.rays[(known.sweep < 0) & (weights > _LEAST_WEIGHT)])


def _shared(rays: Array, known: KnownPlanes) -> Array:
    """(M, M): what the uncertain planes of the other sweeps do to the crossings, R Σ Rᵀ."""
    rows = np.flatnonzero(known.sweep >= 0)
    shared = np.zeros((len(rays), len(rays)))
    columns = (3 * known.sweep[rows, None] + np.arange(3)).ravel()
    among = known.covariance[np.ix_(columns, columns)].reshape(len(rows), 3, len(rows), 3)
    shared[np.ix_(rows, rows)] = np.einsum("mnj,nj->mn", np.einsum("mi,minj->mnj", rays[rows], among), rays[rows])
    return shared
