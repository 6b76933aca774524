"""Equations of the network: one round of the adjustment, and the covariance of its solution.

A crossing says (π_a − π_b)·r = gain_a·ε_a + gain_b·ε_b with ε the errors of the two centrelines across themselves:

- those of the fan come from one picture and meet every sweep again, so their cells z
  (`core.scan.network.line_errors`) are unknowns with the prior N(0, 1);
- those of a sweep are met by few crossings each. Taken as independent they cost 1–3 % of σ in the answer (measured
  against generalised least squares on scans of 60 sweeps), so weights do not know of them, but the covariance does::

      x̂ = H⁻¹ Aᵀ W y,   cov = H⁻¹ (Aᵀ W V W A + P) H⁻¹,   H = Aᵀ W A + P

  with V the whole covariance of the crossings and P the prior's weight;
- a point on a known plane (`core.scan.known_planes`) is a crossing with a line that is exact and lies square to a;
  what is uncertain is the plane: three more unknowns with the prior N(0, 1). Its part of the covariance is left out
  here, as that of the fan is: whoever displaces the planes sees it (`core.scan.common_errors`);
- a plane that changes while rows are read out is linear in more than three numbers (`core.scan.network.read_out`);
- the crossings' rays are noisy too, so the equations are taken at adjusted crossings (Gauss–Helmert).

References
----------
Koch, K.-R., Parameter Estimation and Hypothesis Testing in Linear Models (1999), 3.2 and 3.4.3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_array, diags_array, hstack

from core.model import Fan
from core.model.arrays import Array, set_field
from core.model.positive_definite import inverse_by
from core.model.robust import Schedule, Weigh, irls, mad_sd
from core.scan.features.crossings import CrossingTable, Index
from core.scan.known_planes.known_plane import FREEDOMS, Control
from core.scan.network.geometry import CrossingRays, floored, inverse_depth_gradient, noise_gains
from core.scan.network.line_errors import LineErrors
from core.scan.network.normal_matrix import normal_matrix
from core.scan.network.read_out import AT_ONCE, ReadOut
from core.scan.network.sweep_plane import PRIOR_SD

GRADIENT_FLOOR = 0.1
"""Smallest ‖D‖ taken, as a share of the fan's own, which no solution can change: weights cannot run away to planes that
have fallen together. Held by tests/scan/network/test_adjustment_traps.py."""

RIDGE = 1e-13
"""Added to the diagonal of the equations relative to it: a direction that nothing determines stays solvable."""

MOST_OFFSET = 3.0
"""Standard deviations by which a crossing's ray is moved at most: an outlier must not move its own ray far."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Solution of one weighted linear round of the network, with the factor of its normal matrix.

    Parameters
    ----------
    pis
        (S, 3) in 1/mm, or (S, 3·(1 + K)) where rows are read one after another (`core.scan.network.read_out`).
    cells
        (F + 3K,) errors of the fan's cells, in standard deviations, and of the K known planes.
    residuals
        (M,) of each crossing in standard deviations, observed − adjusted.
    weights
        (M,) robust weights it was found with.
    gains
        (M, 2) how an error of a's and of b's centreline moves the misclosure, in 1/(mm px).
    sigma
        (M,) standard deviation of the misclosure without the fan's cells, in 1/mm.
    design
        Derivatives (M, N) of the equations by the unknowns: those of the sweeps, then the `cells`.
    factor
        The Cholesky factor of H.
    motion
        Sum of the squares of what planes change with the rows, in standard deviations before anything is measured.
    """

    pis: Array
    cells: Array
    residuals: Array
    weights: Array
    gains: Array
    sigma: Array
    design: csr_array
    factor: tuple[Array, bool]
    motion: float

    @cached_property
    def inverse(self) -> Array:
        """Inverse H⁻¹ (N, N) of the normal matrix of all unknowns."""
        return inverse_by(self.factor[0])

    @property
    def misfit(self) -> float:
        """Sum of the weighted squares of all residuals, with those of the priors on cells, planes and hand's motion."""
        return float(self.weights @ self.residuals**2 + self.cells @ self.cells + self.motion)


@dataclass(frozen=True, eq=False, slots=True)
class Adjustment:
    """Equations of the `crossings` that the planes of `sweeps` sweeps have with each other and with the `fan`.

    `line` (M,) is the fan's line from 0, −1 for crossings between sweeps. With a `Control` in place of the fan, points
    on its known planes are numbered after the fan's lines.
    """

    crossings: CrossingTable
    geometry: CrossingRays
    line: Index
    fan: Fan | Control
    sweeps: int
    errors: LineErrors
    read_out: ReadOut = AT_ONCE
    typical_gradient: float = field(init=False)
    """‖D‖ of a plane that differs from the fan's by as much as the fan's from none, in 1/(mm px)."""
    _fan_pis: Array = field(init=False)
    _plane: Index = field(init=False)
    _factors: Array = field(init=False)
    _motion: csr_array | None = field(init=False)
    _pattern: csr_array = field(init=False)

    def __post_init__(self) -> None:
        """Reckon what is the same in all rounds; `_pattern` says where the design's numbers stand."""
        control = Control.of(self.fan)
        area = np.abs(np.linalg.det(self.geometry.jacobians)).mean() if len(self.crossings) else 0.0
        set_field(self, "typical_gradient", float(control.gradient * np.sqrt(area)))
        set_field(self, "_fan_pis", control.pis_at(np.maximum(self.line, 0), self.geometry.rays))
        set_field(self, "_plane", self.line[self.crossings.on_plane] - control.fan.lines)
        set_field(self, "_factors", control.factors)
        set_field(self, "_motion", self.read_out.weight(self.sweeps) if self.read_out.moves else None)
        set_field(self, "_pattern", self._places())

    @property
    def unknowns(self) -> int:
        """Number of unknowns of all sweeps together, without the fan's cells."""
        return self.read_out.size * self.sweeps

    @property
    def before_planes(self) -> int:
        """Number of unknowns of sweeps and fan's cells, after which those of the known planes come."""
        return self.unknowns + self.errors.fan.shape[1]

    def start(self) -> Solution:
        """Solve the first round, without an earlier solution: every difference of planes counts as the typical one.

        Each of them lies across the fan.
        """
        count = len(self.crossings)
        gains = np.full((count, 2), self.typical_gradient)
        return self._solve(np.ones(count), gains, self.geometry.rays, np.zeros(count))

    def weighted(
        self,
        schedule: Schedule,
        start: Solution | None = None,
        *,
        kept: NDArray[np.bool_] | None = None,
        scaled: bool = False,
        settled: Callable[[Solution, Solution], bool] | None = None,
        watched: Callable[[range], Iterable[int]] = iter,
    ) -> Solution:
        """Solve by iteratively re-weighted least squares (`irls`), with robust weights of the residuals by `schedule`.

        Crossings not `kept` (M,) have no weight. `scaled`: residuals count in their own standard deviation where that
        is above 1, so that noise larger than stated silences none.
        """

        def improve(found: Solution, weigh: Weigh) -> Solution:
            size = np.abs(found.residuals) / max(1.0, mad_sd(found.residuals)) if scaled else found.residuals
            weights = weigh(size)
            return self.improve(found, weights if kept is None else weights * kept)

        return irls(self.start() if start is None else start, improve, schedule, settled, watched)

    def improve(self, before: Solution, weights: Array) -> Solution:
        """Solve one more Gauss–Helmert round with `weights` (M,), linearised at the crossings adjusted by `before`.

        With gains at the observed crossings all planes would be pulled together, because noise in the rays costs less
        the less the planes differ.
        """
        difference = self.differences(before.pis)
        gradient = floored(
            inverse_depth_gradient(difference, self.geometry.jacobians), GRADIENT_FLOOR * self.typical_gradient
        )
        gains = np.column_stack(noise_gains(self.crossings, gradient))
        adjusted = self.geometry.rays - self._noise_of_rays(before, gains, difference)
        moved = np.einsum("mi,mi->m", self.geometry.rays - adjusted, difference)
        return self._solve(weights, gains, adjusted, moved)

    def covariance(self, solution: Solution) -> tuple[Array, float]:
        """Compute the planes' covariance (3S, 3S) from that of the crossings, and the `Solution.misfit` to expect.

        What known planes add is not in it.
        """
        middle, of_planes = self._middle(solution), solution.inverse[: self.unknowns]
        covariance = of_planes @ middle @ of_planes.T
        if len(self._factors):
            known = solution.inverse[: self.unknowns, self.before_planes :]
            covariance -= known @ known.T  # by planes that are off, which is common to all points
        return np.asarray((covariance + covariance.T) / 2), self._expected(solution, middle)

    def expected(self, solution: Solution) -> float:
        """Compute the `Solution.misfit` to expect if noise is as stated, without the planes' covariance."""
        return self._expected(solution, self._middle(solution))

    def _expected(self, solution: Solution, middle: Array) -> float:
        numbers = len(solution.cells) + self.unknowns - 3 * self.sweeps
        return float(np.sum(solution.weights) + numbers - np.sum(solution.inverse * middle))

    def _middle(self, solution: Solution) -> Array:
        """Aᵀ W V W A + P (N, N)."""
        felt, weight = self._felt(solution), solution.weights / solution.sigma**2
        lower = normal_matrix(felt, np.ones(felt.shape[0]))
        lower += normal_matrix(solution.design, weight**2 * self._rest(solution))
        middle = lower + np.tril(lower, -1).T
        middle[np.diag_indices(len(middle))] += self._prior()
        self._add_motion(middle)
        return np.asarray(middle)

    def shared_with_fan(self, solution: Solution) -> Array:
        """Compute the covariance (3S, F) of the planes' errors π̂ − π with the errors z of the fan's F cells.

        x̂ − x = H⁻¹(Aᵀ W e − P x) for unknowns x with the prior P and noise e that is none of theirs, and z is one of
        them with P = 1: so it is minus the block of H⁻¹.
        """
        return -solution.inverse[: self.unknowns, self.unknowns : self.before_planes]

    def shared_with_own_lines(self, solution: Solution) -> Array:
        """Compute the covariance (Q, 3) of each sweep's π̂ − π with the errors z of the Q cells of its own centrelines.

        The crossings say A x = y + noise, so x̂ − x is −H⁻¹ Aᵀ W noise, prior aside.
        """
        felt = self._felt(solution)
        size, moved = self.read_out.size, np.zeros((felt.shape[0], self.read_out.size))
        for sweep in range(self.sweeps):  # its cells stand together, in order
            first, last = np.searchsorted(self.errors.sweep_cells[:, 0], [sweep, sweep + 1])
            moved[first:last] = -felt[first:last] @ solution.inverse[:, size * sweep : size * sweep + size]
        return moved

    def noise(self, solution: Solution) -> csr_array:
        """Make the matrix (M, …) from independent normal numbers of σ 1 to misclosures in 1/mm, cells aside."""
        return csr_array(hstack([self._shared(solution), diags_array(np.sqrt(self._rest(solution)))], format="csr"))

    def _shared(self, solution: Solution) -> csr_array:
        """(M, Q) what the errors of the cells of the sweeps' own centrelines add to the misclosures, in 1/mm."""
        gain_a, gain_b = solution.gains.T
        return csr_array(diags_array(gain_a) @ self.errors.sweep_a + diags_array(gain_b) @ self.errors.sweep_b)

    def _rest(self, solution: Solution) -> Array:
        """(M,) variance of what is each misclosure's own, in 1/mm²."""
        gain_a, gain_b = solution.gains.T
        return np.asarray(gain_a**2 * self.errors.rest_a + gain_b**2 * self.errors.rest_b)

    def _felt(self, solution: Solution) -> csr_array:
        """(Q, N) what those cells add to the right side Aᵀ W y of the normal equations, with sorted rows."""
        felt = csr_array(
            (diags_array(solution.weights / solution.sigma**2) @ self._shared(solution)).T @ solution.design
        )
        felt.sort_indices()
        return felt

    def gradient(self, pis: Array) -> Array:
        """Compute the gradient D (M, 2) in 1/(mm px) of the misclosure at every crossing of sweeps `pis` (S, 3)."""
        return inverse_depth_gradient(self.differences(pis), self.geometry.jacobians)

    def _noise_of_rays(self, before: Solution, gains: Array, difference: Array) -> Array:
        """Shift (M, 3) of each crossing's ray by the noise estimated in the last round."""
        table, errors = self.crossings, self.errors
        gain_a, gain_b = gains.T
        of_fan = errors.fan @ before.cells[: errors.fan.shape[1]]
        own_a, own_b = errors.sigma_a**2, np.where(table.with_fan, errors.rest_b, errors.sigma_b**2)
        misclosure = np.einsum("mi,mi->m", difference, self.geometry.rays) - gain_b * of_fan
        if len(self._factors):
            off = before.cells[errors.fan.shape[1] :].reshape(-1, FREEDOMS)[self._plane]
            misclosure[table.on_plane] -= np.einsum("mi,mi->m", self._felt_of_planes(self.geometry.rays), off)
        per_variance = misclosure / self._sigma(gains) ** 2
        offset_a = _within(gain_a * own_a * per_variance, own_a)
        offset_b = _within(gain_b * own_b * per_variance, own_b) + of_fan
        t_a, t_b = table.tangent_a, table.tangent_b
        sine = t_a[:, 0] * t_b[:, 1] - t_a[:, 1] * t_b[:, 0]
        in_picture = t_b * (offset_a / -sine)[:, None] + t_a * (offset_b / sine)[:, None]
        moved = np.einsum("mij,mj->mi", self.geometry.jacobians, in_picture)
        return np.column_stack([moved, np.zeros(len(moved))])

    def _sigma(self, gains: Array) -> Array:
        errors = self.errors
        of_b = np.where(self.crossings.with_fan, errors.rest_b, errors.sigma_b**2)
        return np.asarray(np.sqrt(gains[:, 0] ** 2 * errors.sigma_a**2 + gains[:, 1] ** 2 * of_b))

    def _solve(self, weights: Array, gains: Array, rays: Array, moved: Array) -> Solution:
        """One weighted linear solution of (π_a − π_b)·`rays` + `moved` = noise."""
        sigma, forms = self._sigma(gains), self.read_out.forms(rays, self.crossings.uv[:, 1])
        between, of_fan = ~self.crossings.with_fan, -np.repeat(gains[:, 1], np.diff(self.errors.fan.indptr))
        of_planes = -self._felt_of_planes(rays).ravel()
        values = np.concatenate([forms.ravel(), -forms[between].ravel(), of_fan * self.errors.fan.data, of_planes])
        design = csr_array(
            (values[self._pattern.data], self._pattern.indices, self._pattern.indptr), self._pattern.shape
        )
        observed = np.where(between, 0.0, np.einsum("mi,mi->m", rays, self._fan_pis)) - moved
        weight = weights / sigma**2
        information = normal_matrix(design, weight)
        information[np.diag_indices(len(information))] += self._prior() + RIDGE * information.diagonal()
        self._add_motion(information)
        factor = cho_factor(information, lower=True, overwrite_a=True, check_finite=False)
        solution = cho_solve(factor, design.T @ (weight * observed), check_finite=False)
        residuals = (observed - design @ solution) / sigma
        pis, cells = solution[: self.unknowns].reshape(self.sweeps, -1), solution[self.unknowns :]
        motion = 0.0 if self._motion is None else float(pis.ravel() @ (self._motion @ pis.ravel()))
        return Solution(pis, cells, residuals, weights, gains, sigma, design, factor, motion)

    def _places(self) -> csr_array:
        """Where in the design (M, N) the forms of a, of b, the shares of cells and those of planes stand, from 0."""
        table, size, fan = self.crossings, self.read_out.size, self.errors.fan
        between, on_plane = np.flatnonzero(~table.with_fan), np.flatnonzero(table.on_plane)
        every, numbers = np.arange(len(table)), np.arange(size)
        rows = [np.repeat(every, size), np.repeat(between, size), np.repeat(every, np.diff(fan.indptr))]
        of_a, of_b = size * table.a[:, None] + numbers, size * table.b[between, None] + numbers
        rows.append(np.repeat(on_plane, FREEDOMS))
        of_planes = self.before_planes + FREEDOMS * self._plane[:, None] + np.arange(FREEDOMS)
        columns = np.concatenate([of_a.ravel(), of_b.ravel(), self.unknowns + fan.indices, of_planes.ravel()])
        shape = len(table), self.before_planes + FREEDOMS * len(self._factors)
        places = csr_array((np.arange(len(columns)), (np.concatenate(rows), columns)), shape=shape)
        places.sort_indices()
        return places

    def _prior(self) -> Array:
        """Weight of the prior on each unknown but the hand's motion."""
        of_sweep = np.repeat([1 / PRIOR_SD**2, 0.0], [3, self.read_out.size - 3])
        others = self.errors.fan.shape[1] + FREEDOMS * len(self._factors)
        return np.concatenate([np.tile(of_sweep, self.sweeps), np.ones(others)])

    def _felt_of_planes(self, rays: Array) -> Array:
        """(P, 3) how the errors of the known planes change the inverse depth of the P points on them, in 1/mm."""
        there = rays[self.crossings.on_plane]
        return np.asarray(np.einsum("mi,mij->mj", there, self._factors[self._plane]), dtype=np.float64)

    def _add_motion(self, matrix: Array) -> None:
        """Add the weight of the prior on the hand's motion to the upper left of `matrix`."""
        if self._motion is not None:
            weight = self._motion.tocoo()
            matrix[weight.coords] += weight.data

    def differences(self, pis: Array) -> Array:
        """Compute the differences π_a − π_b (M, 3) in 1/mm at every crossing, in the picture row it is seen in."""
        table, v = self.crossings, self.crossings.uv[:, 1]
        other = np.where(table.with_fan[:, None], self._fan_pis, self.read_out.planes(pis[table.b], v))
        return np.asarray(self.read_out.planes(pis[table.a], v) - other)


def _within(offsets: Array, variances: Array) -> Array:
    """Clip offsets (M,) to MOST_OFFSET standard deviations."""
    limit = MOST_OFFSET * np.sqrt(variances)
    return np.clip(offsets, -limit, limit)
