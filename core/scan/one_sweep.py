"""One more sweep, tied to the fan and to sweeps that are located already.

The equations are the network's, π·r = π_b·r at each crossing, but only the new sweep's π is unknown. The planes of the
others are known with a joint covariance Σ, which makes the crossings' right-hand sides correlated::

    cov(observed) = R Σ Rᵀ + diag(σ²)        R: the rays, each in the columns of its own sweep

With the fan alone this is the paper's method (`core.scan.sweep_plane`); where the fan leaves a direction of π free, as
on a flat face, the other sweeps fix it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.scan.crossings import CrossingTable
from core.scan.geometry import CrossingRays, floored, inverse_depth_gradient, noise_gains
from core.scan.network import GRADIENT_FLOOR, REJECT_AT, SIGMA_FLOOR_PX
from core.scan.sweep_plane import PRIOR_SD, plane_condition

ROUNDS = 5
_REJECT_FROM = 3  # the round from which on outliers lose all their weight
_HUBER = 2.0
_LEAST_WEIGHT = 1e-4


@dataclass(frozen=True, eq=False, slots=True)
class KnownPlanes:
    """The planes that M crossings are with: `pis` (M, 3) in 1/mm, of which those with other sweeps are correlated.

    `sweep` (M,) says in which block of `covariance` (3K, 3K) each of them is; −1 for the fan, which counts as known.
    """

    pis: Array
    sweep: NDArray[np.int64]
    covariance: Array


@dataclass(frozen=True, eq=False, slots=True)
class OneSweep:
    """The plane `pi` (3,) in 1/mm with `covariance` (3, 3).

    `weights` (M,) of the crossings, 0 (left out) to 1; `residuals` (M,) in standard deviations; `condition` of the
    crossings with the fan that count.
    """

    pi: Array
    covariance: Array
    weights: Array
    residuals: Array
    condition: float


def locate_one(crossings: CrossingTable, geometry: CrossingRays, known: KnownPlanes) -> OneSweep:
    """The plane of the sweep that all `crossings` have as their a.

    Raises
    ------
    ValueError
        With fewer than three crossings.
    """
    if len(crossings) < 3:
        raise ValueError(f"{len(crossings)} crossings cannot determine a plane")
    rays = geometry.rays
    observed = np.einsum("mi,mi->m", rays, known.pis)
    shared = _shared(rays, known)
    typical = float(np.median(np.linalg.norm(known.pis[:, :2], axis=1)))
    typical *= float(np.sqrt(np.abs(np.linalg.det(geometry.jacobians)).mean()))
    sigma_a = np.maximum(crossings.sigma_a, SIGMA_FLOOR_PX)
    sigma_b = np.maximum(crossings.sigma_b, SIGMA_FLOOR_PX)
    own = typical**2 * (sigma_a**2 + sigma_b**2)
    weights, pi = np.ones(len(rays)), np.zeros(3)
    for step in range(ROUNDS):
        weight = np.linalg.inv(shared + np.diag(own / np.maximum(weights, _LEAST_WEIGHT)))
        information = rays.T @ weight @ rays + np.eye(3) / PRIOR_SD**2
        covariance = np.linalg.inv(information)
        pi = covariance @ (rays.T @ (weight @ observed))
        gradient = inverse_depth_gradient(pi - known.pis, geometry.jacobians)
        gain_a, gain_b = noise_gains(crossings, floored(gradient, GRADIENT_FLOOR * typical))
        own = (gain_a * sigma_a) ** 2 + (gain_b * sigma_b) ** 2
        residuals = (observed - rays @ pi) / np.sqrt(own + np.diag(shared))
        if step < ROUNDS - 1:
            weights = _weights(residuals, reject=step >= _REJECT_FROM - 1)
    used = (known.sweep < 0) & (weights > _LEAST_WEIGHT)
    return OneSweep(pi, np.asarray(covariance, dtype=np.float64), weights, residuals, plane_condition(rays[used]))


def _shared(rays: Array, known: KnownPlanes) -> Array:
    """(M, M): what the uncertain planes of the other sweeps do to the crossings, R Σ Rᵀ."""
    rows = np.flatnonzero(known.sweep >= 0)
    shared = np.zeros((len(rays), len(rays)))
    columns = (3 * known.sweep[rows, None] + np.arange(3)).ravel()
    among = known.covariance[np.ix_(columns, columns)].reshape(len(rows), 3, len(rows), 3)
    shared[np.ix_(rows, rows)] = np.einsum("mi,minj,nj->mn", rays[rows], among, rays[rows], optimize=True)
    return shared


def _weights(residuals: Array, *, reject: bool) -> Array:
    """Huber's weights first, Tukey's from when the plane is about right."""
    size = np.abs(residuals)
    if reject:
        return np.asarray(np.clip(1 - (size / REJECT_AT) ** 2, 0, None) ** 2)
    return np.asarray(np.minimum(1.0, _HUBER / np.maximum(size, 1e-9)))
