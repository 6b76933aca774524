"""The network: all sweeps of a scan in one adjustment, tied to the fan and to each other by their crossings.

In inverse depth every crossing is linear in the unknown planes π_1 … π_S: with fan plane k it says π_i·r = π_k·r, with
another sweep π_i·r = π_j·r. Sweep–sweep crossings alone leave scale and a plane free, π → s π + c; the fan, where it
meets relief, gives the metric.

What the adjustment knows about its noise:

- The fan's centreline comes from one picture, so its errors are shared by all crossings on one stretch of it. Each
  stretch carries its own offset as an unknown with a prior; else a hundred crossings would pretend to average it.
- Crossings of one sweep that lie within one fit window share that window's error; their variance is raised by how much
  the windows overlap.
- The crossings' rays are noisy too, so the equations are taken at adjusted crossings (Gauss–Helmert).
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
from core.progress import Progress, silent, steps
from core.scan.crossings import CrossingTable, Index
from core.scan.geometry import CrossingRays, floored, inverse_depth_gradient, noise_gains
from core.scan.sweep_plane import PRIOR_SD

GRADIENT_FLOOR = 0.1
"""Smallest ‖D‖ believed, as a share of the fan's own, which no solution can change."""

SIGMA_FLOOR_PX = 0.01
"""No centreline is known better than this: what a filter's phase error leaves."""

REJECT_AT = 5.0
"""Residual in standard deviations at which a crossing has no weight left (Tukey's biweight)."""

MOST_FAN_REJECTED = 0.25
"""If more of the fan's crossings than this would be silenced, the adjustment is not robust but wrong: none is."""

SILENCED = 0.05
"""A crossing with less weight than this counts as left out."""

ROUNDS = 12

RIDGE = 1e-13
"""Added to the diagonal of the equations relative to it: what keeps a direction that nothing determines solvable."""


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
    crossings: CrossingTable,
    geometry: CrossingRays,
    stretches: FanStretches,
    fan: Fan,
    sweeps: int,
    progress: Progress = silent,
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
    solution, silenced = _adjust(problem, progress, redescend=True), False
    if _share_silenced(crossings, solution.weights) > MOST_FAN_REJECTED:
        solution, silenced = _adjust(problem, progress, redescend=False), True
    return Network(
        solution.pis, problem.covariance(solution), solution.residuals, solution.weights, solution.scale, silenced
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Solution:
    pis: Array
    offsets: Array
    residuals: Array
    weights: Array
    scale: float
    information: Array


@dataclass(frozen=True, eq=False, slots=True)
class _Noise:
    """What an equation's misclosure is made of: gain × offset of each centreline; the fan's offset is an unknown.

    `gain_a`, `gain_b` in 1/(mm px), `variance_a`, `variance_b` of the offsets in px², the latter 0 for the fan, whose
    stretch has the prior `stretch_sigma` in px instead.
    """

    gain_a: Array
    gain_b: Array
    variance_a: Array
    variance_b: Array
    stretch_sigma: Array

    @property
    def sigma(self) -> Array:
        """Standard deviation (M,) of the independent part, in 1/mm."""
        return np.asarray(np.sqrt(self.gain_a**2 * self.variance_a + self.gain_b**2 * self.variance_b))


@dataclass(frozen=True, eq=False, slots=True)
class _Problem:
    """The equations; weights, gains and adjusted rays change from round to round."""

    crossings: CrossingTable
    geometry: CrossingRays
    stretches: FanStretches
    fan: Fan
    sweeps: int
    overlap: Array

    def start(self) -> _Solution:
        """Without a solution every difference of planes counts as long as the typical one and lies across the fan."""
        gain = np.full(len(self.crossings), self._typical_gradient())
        return self._solve(np.ones(len(gain)), self._noise(gain, gain), self.geometry.rays, np.zeros(len(gain)))

    def improve(self, before: _Solution, weights: Array) -> _Solution:
        """One round of the Gauss–Helmert model: gains from `before`, equations taken at the adjusted crossings.

        Taken at the observed crossings they would pull all planes together, because noise in the rays costs less the
        less the planes differ.
        """
        difference = self._differences(before.pis)
        gradient = inverse_depth_gradient(difference, self.geometry.jacobians)
        gains = noise_gains(self.crossings, floored(gradient, GRADIENT_FLOOR * self._typical_gradient()))
        noise = self._noise(*gains)
        adjusted = self.geometry.rays - self._noise_of_rays(before, noise, difference)
        moved = np.einsum("mi,mi->m", self.geometry.rays - adjusted, difference)
        return self._solve(weights, noise, adjusted, moved)

    def _noise(self, gain_a: Array, gain_b: Array) -> _Noise:
        table = self.crossings
        sigma_a, sigma_b = np.maximum(table.sigma_a, SIGMA_FLOOR_PX), np.maximum(table.sigma_b, SIGMA_FLOOR_PX)
        of_fan = table.with_fan
        return _Noise(
            gain_a,
            gain_b,
            sigma_a**2 * self.overlap[:, 0],
            np.where(of_fan, 0.0, sigma_b**2 * self.overlap[:, 1]),
            np.where(of_fan, sigma_b, 0.0),
        )

    def _noise_of_rays(self, before: _Solution, noise: _Noise, difference: Array) -> Array:
        """How far the noise found in the last round has moved each crossing's ray, (M, 3)."""
        table = self.crossings
        of_fan = np.where(table.with_fan, before.offsets[self.stretches.stretch], 0.0) * noise.stretch_sigma
        misclosure = np.einsum("mi,mi->m", difference, self.geometry.rays) - noise.gain_b * of_fan
        per_variance = misclosure / noise.sigma**2
        offset_a = _within(noise.gain_a * noise.variance_a * per_variance, noise.variance_a)
        offset_b = _within(noise.gain_b * noise.variance_b * per_variance, noise.variance_b) + of_fan
        t_a, t_b = table.tangent_a, table.tangent_b
        sine = t_a[:, 0] * t_b[:, 1] - t_a[:, 1] * t_b[:, 0]
        in_picture = t_b * (offset_a / -sine)[:, None] + t_a * (offset_b / sine)[:, None]
        moved = np.einsum("mij,mj->mi", self.geometry.jacobians, in_picture)
        return np.column_stack([moved, np.zeros(len(moved))])

    def _solve(self, weights: Array, noise: _Noise, rays: Array, moved: Array) -> _Solution:
        """One weighted linear solution of (π_a − π_b)·`rays` + `moved` = noise."""
        table, with_fan, sigma = self.crossings, self.crossings.with_fan, noise.sigma
        between, fan_rows = np.flatnonzero(~with_fan), np.flatnonzero(with_fan)
        unknowns = 3 * self.sweeps + int(self.stretches.stretch.max()) + 1
        rows = np.concatenate([np.repeat(np.arange(len(table)), 3), np.repeat(between, 3), fan_rows])
        columns = np.concatenate(
            [
                (3 * table.a[:, None] + np.arange(3)).ravel(),
                (3 * table.b[between, None] + np.arange(3)).ravel(),
                3 * self.sweeps + self.stretches.stretch[fan_rows],
            ]
        )
        shared = (noise.gain_b * noise.stretch_sigma)[fan_rows]
        values = np.concatenate([rays.ravel(), -rays[between].ravel(), -shared])
        design = csr_array((values, (rows, columns)), shape=(len(table), unknowns))
        observed = np.where(with_fan, np.einsum("mi,mi->m", rays, self._fan_pis()), 0.0) - moved
        root = np.sqrt(weights) / sigma
        weighted = diags_array(root) @ design
        information = (weighted.T @ weighted).toarray()
        prior = np.ones(unknowns)  # the offset of a stretch is in units of its own σ
        prior[: 3 * self.sweeps] = 1 / PRIOR_SD**2
        information[np.diag_indices(unknowns)] += prior + RIDGE * information.diagonal()
        solution = cho_solve(cho_factor(information), weighted.T @ (root * observed))
        residuals = (observed - design @ solution) / sigma
        degrees = max(int(np.count_nonzero(weights > 0.1)) - 3 * self.sweeps, 1)
        scale = float(np.sqrt(np.sum(weights * residuals**2) / degrees))
        pis, offsets = solution[: 3 * self.sweeps].reshape(-1, 3), solution[3 * self.sweeps :]
        return _Solution(pis, offsets, residuals, weights, scale, information)

    def covariance(self, solution: _Solution) -> Array:
        """(3S, 3S) of the planes, scaled up where the residuals are larger than the noise model says."""
        unknowns = len(solution.information)
        planes = np.zeros((unknowns, 3 * self.sweeps))
        planes[np.diag_indices(3 * self.sweeps)] = 1.0
        covariance: Array = cho_solve(cho_factor(solution.information), planes)[: 3 * self.sweeps]
        return (covariance + covariance.T) * (0.5 * max(1.0, solution.scale) ** 2)

    def _differences(self, pis: Array) -> Array:
        """π_a − π_b (M, 3) of every crossing."""
        table = self.crossings
        other = np.where(table.with_fan[:, None], self._fan_pis(), pis[table.b])
        return np.asarray(pis[table.a] - other)

    def _fan_pis(self) -> Array:
        return self.fan.pis[np.maximum(self.stretches.line, 0)]

    def _typical_gradient(self) -> float:
        """‖D‖ of a plane that differs from the fan's by as much as the fan's from none, in 1/(mm px)."""
        typical = np.median(np.linalg.norm(self.fan.pis[:, :2], axis=1))
        return float(typical * np.sqrt(np.abs(np.linalg.det(self.geometry.jacobians)).mean()))


def _within(offsets: Array, variances: Array) -> Array:
    """Offsets no larger than three of their standard deviations: an outlier must not move its own ray far."""
    limit = 3 * np.sqrt(variances)
    return np.clip(offsets, -limit, limit)


def _adjust(problem: _Problem, progress: Progress, *, redescend: bool) -> _Solution:
    """Iterate: the rig's geometry first, then Huber's weights, and only then, if at all, rejection."""
    solution = problem.start()
    for step in steps(range(ROUNDS), progress, "adjustment", ROUNDS):
        size = np.abs(solution.residuals) / max(1.0, _robust_scale(solution.residuals))
        if redescend and step >= ROUNDS // 2:
            weights = np.clip(1 - (size / REJECT_AT) ** 2, 0, None) ** 2
        else:
            weights = np.minimum(1.0, 2.0 / np.maximum(size, 1e-9))
        solution = problem.improve(solution, weights)
    return solution


def _robust_scale(residuals: Array) -> float:
    return float(1.4826 * np.median(np.abs(residuals)))


def _share_silenced(crossings: CrossingTable, weights: Array) -> float:
    return float(np.mean(weights[crossings.with_fan] < SILENCED))


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
