"""The network: all sweeps of a scan in one adjustment, tied to the fan and to each other by their crossings.

In inverse depth every crossing is linear in the unknown planes π_1 … π_S: with fan plane k it says π_i·r = π_k·r, with
another sweep π_i·r = π_j·r. Sweep–sweep crossings alone leave scale and a plane free, π → s π + c; the fan, where it
meets relief, gives the metric.

What the adjustment knows about its noise:

- The fan's centreline comes from one picture, so its errors are shared by all crossings on one stretch of it. Each
  stretch carries its own offset as an unknown with a prior; else a hundred crossings would pretend to average it.
- Crossings of one sweep that lie within one fit window share that window's error; their variance is raised by how much
  the windows overlap.
- Weights depend on how much the two planes differ. If they are taken from a solution that has collapsed onto the table
  (which satisfies every crossing on the table), they run away to it. So the first solution uses weights of the rig's
  geometry alone, later ones are floored by it, outliers are rejected only at the end, and not where that would silence
  the fan.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_array, diags_array

from core.model import Fan
from core.model.arrays import Array
from core.scan.crossings import CrossingTable, Index
from core.scan.geometry import CrossingRays, floored, inverse_depth_gradient, noise_gains
from core.scan.sweep_plane import PRIOR_SD

GRADIENT_FLOOR = 0.1
"""Smallest ‖D‖ believed, as a share of the fan's own, which no solution can change."""

SIGMA_FLOOR_PX = 0.005
"""No centreline is known better than this: what a filter's phase error leaves."""

REJECT_AT = 5.0
"""Residual in standard deviations at which a crossing has no weight left (Tukey's biweight)."""

MOST_FAN_REJECTED = 0.25
"""If more of the fan's crossings than this would be silenced, the adjustment is not robust but wrong: none is."""

ROUNDS = 12


@dataclass(frozen=True, eq=False, slots=True)
class FanStretches:
    """On which stretch of the fan's centrelines each crossing lies.

    `stretch` (M,) is an index of a stretch, `line` (M,) the fan line from 0; both −1 for crossings between sweeps.
    """

    stretch: Index
    line: Index


@dataclass(frozen=True, eq=False, slots=True)
class Network:
    """The adjusted sweeps.

    Parameters
    ----------
    pis
        (S, 3) in 1/mm.
    covariance
        (3S, 3S) of the stacked π; without the camera's and the fan's own.
    residuals
        (M,) of each crossing in standard deviations, observed − adjusted.
    weights
        (M,) robust weights, 0 (left out) to 1.
    scale
        Standard deviation of unit weight: 1 where the noise model is true. The covariance is scaled by it when above 1.
    fan_silenced
        True if rejecting outliers would have silenced the fan and was not done.
    """

    pis: Array
    covariance: Array
    residuals: Array
    weights: Array
    scale: float
    fan_silenced: bool


def solve_network(
    crossings: CrossingTable, geometry: CrossingRays, stretches: FanStretches, fan: Fan, sweeps: int
) -> Network:
    """Adjust all `sweeps` planes to all `crossings`.

    Raises
    ------
    ValueError
        If there is no crossing with the fan: nothing fixes the scale.
    """
    if not np.any(crossings.with_fan):
        raise ValueError("no sweep crosses the fan")
    overlap = _overlap(crossings)
    problem = _Problem(crossings, geometry, stretches, fan, sweeps, overlap)
    solution, silenced = _adjust(problem, redescend=True), False
    if _share_silenced(crossings, solution.weights) > MOST_FAN_REJECTED:
        solution, silenced = _adjust(problem, redescend=False), True
    return Network(
        solution.pis, problem.covariance(solution), solution.residuals, solution.weights, solution.scale, silenced
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Solution:
    pis: Array
    residuals: Array
    weights: Array
    scale: float
    information: Array


@dataclass(frozen=True, eq=False, slots=True)
class _Problem:
    """The linear equations; only their weights change from round to round."""

    crossings: CrossingTable
    geometry: CrossingRays
    stretches: FanStretches
    fan: Fan
    sweeps: int
    overlap: Array

    def noise(self, pis: Array | None) -> tuple[Array, Array]:
        """Independent σ of each equation and its gain on the stretch's offset, (M,) each in 1/mm.

        Without a solution every difference of planes counts as long as the typical one and lies across the fan.
        """
        table = self.crossings
        with_fan = table.with_fan
        typical = float(np.median(np.linalg.norm(self.fan.pis[:, :2], axis=1)))
        typical *= float(np.sqrt(np.abs(np.linalg.det(self.geometry.jacobians)).mean()))
        if pis is None:
            gain_a = gain_b = np.full(len(table), typical)
        else:
            other = np.where(with_fan[:, None], self._fan_pis(), pis[table.b])
            gradient = inverse_depth_gradient(pis[table.a] - other, self.geometry.jacobians)
            gain_a, gain_b = noise_gains(table, floored(gradient, GRADIENT_FLOOR * typical))
        sigma_a, sigma_b = np.maximum(table.sigma_a, SIGMA_FLOOR_PX), np.maximum(table.sigma_b, SIGMA_FLOOR_PX)
        variance_a = (gain_a * sigma_a) ** 2 * self.overlap[:, 0]
        variance_b = (gain_b * sigma_b) ** 2 * self.overlap[:, 1]
        independent = np.sqrt(variance_a + np.where(with_fan, 0.0, variance_b))
        return np.maximum(independent, 0.1 * typical * SIGMA_FLOOR_PX), np.where(with_fan, gain_b * sigma_b, 0.0)

    def solve(self, weights: Array, pis: Array | None) -> _Solution:
        """One weighted linear solution."""
        table, rays = self.crossings, self.geometry.rays
        with_fan = table.with_fan
        sigma, shared = self.noise(pis)
        row = np.arange(len(table))
        between = np.flatnonzero(~with_fan)
        fan_rows = np.flatnonzero(with_fan)
        unknowns = 3 * self.sweeps + (int(self.stretches.stretch.max()) + 1)
        rows = np.concatenate([np.repeat(row, 3), np.repeat(between, 3), fan_rows])
        columns = np.concatenate(
            [
                (3 * table.a[:, None] + np.arange(3)).ravel(),
                (3 * table.b[between, None] + np.arange(3)).ravel(),
                3 * self.sweeps + self.stretches.stretch[fan_rows],
            ]
        )
        values = np.concatenate([rays.ravel(), -rays[between].ravel(), -shared[fan_rows]])
        design = csr_array((values, (rows, columns)), shape=(len(table), unknowns))
        observed = np.where(with_fan, np.einsum("mi,mi->m", rays, self._fan_pis()), 0.0)
        root = np.sqrt(weights) / sigma
        weighted = diags_array(root) @ design
        information = (weighted.T @ weighted).toarray()
        prior = np.ones(unknowns)  # the offset of a stretch is in units of its own σ
        prior[: 3 * self.sweeps] = 1 / PRIOR_SD**2
        information[np.diag_indices(unknowns)] += prior
        solution = cho_solve(cho_factor(information), weighted.T @ (root * observed))
        residuals = (observed - design @ solution) / sigma
        degrees = max(int(np.count_nonzero(weights > 0.1)) - 3 * self.sweeps, 1)
        scale = float(np.sqrt(np.sum(weights * residuals**2) / degrees))
        return _Solution(solution[: 3 * self.sweeps].reshape(-1, 3), residuals, weights, scale, information)

    def covariance(self, solution: _Solution) -> Array:
        """(3S, 3S) of the planes, scaled up where the residuals are larger than the noise model says."""
        unknowns = len(solution.information)
        planes = np.zeros((unknowns, 3 * self.sweeps))
        planes[np.diag_indices(3 * self.sweeps)] = 1.0
        covariance: Array = cho_solve(cho_factor(solution.information), planes)[: 3 * self.sweeps]
        return (covariance + covariance.T) * (0.5 * max(1.0, solution.scale) ** 2)

    def _fan_pis(self) -> Array:
        return self.fan.pis[np.maximum(self.stretches.line, 0)]


def _adjust(problem: _Problem, *, redescend: bool) -> _Solution:
    """Iterate: the rig's geometry first, then Huber's weights, and only then, if at all, rejection."""
    weights = np.ones(len(problem.crossings))
    solution = problem.solve(weights, None)
    for step in range(ROUNDS):
        size = np.abs(solution.residuals) / max(1.0, _robust_scale(solution.residuals))
        if redescend and step >= ROUNDS // 2:
            weights = np.clip(1 - (size / REJECT_AT) ** 2, 0, None) ** 2
        else:
            weights = np.minimum(1.0, 2.0 / np.maximum(size, 1e-9))
        solution = problem.solve(weights, solution.pis)
    return solution


def _robust_scale(residuals: Array) -> float:
    return float(1.4826 * np.median(np.abs(residuals)))


def _share_silenced(crossings: CrossingTable, weights: Array) -> float:
    return float(np.mean(weights[crossings.with_fan] < 0.05))


def _overlap(crossings: CrossingTable) -> Array:
    """(M, 2): how many crossings share the fit window of each one's sweep a and sweep b, itself included.

    Two windows of half length h whose centres are s apart overlap by 1 − s/2h.
    """
    ends = np.concatenate([_keys(crossings.a, crossings.piece_a), _keys(crossings.b, crossings.piece_b)])
    along = np.concatenate([crossings.along_a, crossings.along_b])
    shares = np.ones(len(ends))
    order = np.lexsort((along, ends))
    starts = np.flatnonzero(np.diff(ends[order], prepend=ends[order[0]] - 1))
    window = 2 * crossings.half_length_px
    for group in np.split(order, starts[1:]):
        distance = np.abs(along[group, None] - along[None, group])
        shares[group] = np.clip(1 - distance / window, 0, None).sum(axis=1)
    return shares.reshape(2, -1).T


def _keys(frame: Index, piece: Index) -> NDArray[np.int64]:
    return frame * 100_000 + piece
