"""Light plane of one frame from its crossings with the fan: the paper's method.

Each crossing at ray r with fan plane k says π·r = π_k·r. The paper (§4, step 3) takes three of these; here all of them
enter by weighted least squares and one bad one is found by leaving each out in turn. Crossings that are collinear in
the picture, as on a flat face, leave one direction of π free: the covariance says so.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array

PRIOR_SD = 0.05
"""Standard deviation in 1/mm of a weak prior on π about 0: planes within 20 mm of the camera's centre. It keeps the
equations solvable; a direction that only the prior holds comes out with a useless, and so harmless, σ."""
LEFT_OUT_AT = 5.0
"""Standard deviations from the plane of the others at which the worst crossing is left out, as in the network."""


@dataclass(frozen=True, eq=False, slots=True)
class SweepPlane:
    """Light plane of one sweep, fitted to its crossings with the fan.

    `pi` (3,) in 1/mm with `covariance` (3, 3); `used` (M,) which crossings it rests on; `condition` is the ratio of the
    largest to the smallest singular value of the used rays: how near to collinear the crossings are.
    """

    pi: Array
    covariance: Array
    used: NDArray[np.bool_]
    condition: float


def solve_sweep_plane(rays: Array, inverse_depths: Array, sigmas: Array) -> SweepPlane:
    """Fit a light plane to crossings at `rays` (M, 3) of known `inverse_depths` (M,) with `sigmas` (M,), in 1/mm.

    With four or more crossings the one whose residual from the plane of the others is largest is left out if it exceeds
    `LEFT_OUT_AT` standard deviations.

    Raises
    ------
    ValueError
        With fewer than three crossings.
    """
    if len(rays) < 3:
        raise ValueError(f"{len(rays)} crossings cannot determine a plane")
    used = np.ones(len(rays), dtype=np.bool_)
    if len(rays) > 3:
        worst, size = _worst_left_out(rays, inverse_depths, sigmas)
        if size > LEFT_OUT_AT:
            used[worst] = False
    pi, covariance = _solve(rays[used], inverse_depths[used], sigmas[used])
    return SweepPlane(pi, covariance, used, plane_condition(rays[used]))


def plane_condition(rays: Array) -> float:
    """Compute the ratio of the largest to the smallest singular value of `rays` (M, 3): how near they are to one plane.

    Infinite when they are coplanar.
    """
    if len(rays) < 3:
        return float("inf")
    values = np.linalg.svd(rays, compute_uv=False)
    return float(values[0] / values[2]) if values[2] > 0 else float("inf")


def _solve(rays: Array, inverse_depths: Array, sigmas: Array) -> tuple[Array, Array]:
    weighted = rays / sigmas[:, None]
    information = weighted.T @ weighted + np.eye(3) / PRIOR_SD**2
    covariance = np.asarray(np.linalg.inv(information), dtype=np.float64)
    return covariance @ (weighted.T @ (inverse_depths / sigmas)), covariance


def _worst_left_out(rays: Array, inverse_depths: Array, sigmas: Array) -> tuple[int, float]:
    """Index and normalised residual of the crossing that agrees least with the plane of the others."""
    sizes = np.empty(len(rays))
    for index in range(len(rays)):
        others = np.arange(len(rays)) != index
        pi, covariance = _solve(rays[others], inverse_depths[others], sigmas[others])
        spread = np.sqrt(sigmas[index] ** 2 + rays[index] @ covariance @ rays[index])
        sizes[index] = abs(rays[index] @ pi - inverse_depths[index]) / spread
    worst = int(np.argmax(sizes))
    return worst, float(sizes[worst])
