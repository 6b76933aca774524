"""Did object and camera stand still during the scan? What crossings between early and late frames say of it.

If something moved before frame k, later sweeps saw the surface elsewhere than earlier ones and the fan, whose lines
are those of the reference. On a surface with normal n at X a shift t and a turn ω change the inverse depth of the ray
through X by −w·(n·t + (X × n)·ω)/(n·X), so all crossings between an earlier and a later sweep, and of a later sweep
with the fan, are out by that. The main plane (the table) and everything else may each have moved by themselves: twelve
numbers. Whether they differ from 0 for a given k is a score test on the network as it is, without solving it again:
g = Bᵀ W r with B the derivatives of the crossings by the twelve numbers, r the residuals and W their weights;
T = gᵀ cov(g)⁻¹ g is χ² distributed if nothing has moved.

What can not be seen does no harm: a shift of two parallel planes along their normal changes all later sweeps by
π → s π + c, and they give the surface as it was in the reference.

References
----------
Rao, C. R., Large sample tests of statistical hypotheses concerning several parameters, Math. Proc. Cambridge Philos.
Soc. 44 (1948), doi:10.1017/S0305004100023987.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve
from scipy.sparse import diags_array
from scipy.spatial import cKDTree

from core.model import Camera, Fan
from core.model.arrays import Array
from core.scan.adjustment import Adjustment, Solution
from core.scan.crossings import CrossingTable, Index
from core.scan.geometry import CrossingRays
from core.scan.line_errors import LineErrors
from core.scan.locate import by_sweep, sweeping_frames
from core.scan.main_plane import main_plane
from core.scan.network import huber_weights

SURE = 40.0
"""T above which something has moved. Scans in which nothing did reach 20 at most over all k (see the tests)."""

FEWEST_SWEEPS, FEWEST_ACROSS = 5, 20
"""A movement is looked for between so many sweeps on either side that have so many crossings."""

_ROUNDS = 5
_TRIED = 40
"""About so many places are tried in a long scan, and then those about the best."""

_NEIGHBOURS = 12
TAKEN_UP = 1e-3
"""A movement of whose effect on the crossings less than this share (of the squares) is left by the sweeps' planes,
which follow it as far as they can, is not to be seen."""


@dataclass(frozen=True, slots=True)
class Movement:
    """Something moved between frame `last_before` and frame `first_after`, both crossed by others.

    `score` is T, about 10 where nothing moved.
    """

    last_before: int
    first_after: int
    score: float


def find_movement(crossings: CrossingTable, line: Index, camera: Camera, fan: Fan) -> Movement | None:
    """When something moved most noticeably during the scan; None if nothing did.

    `line` (M,) is the fan's line of each crossing, −1 between sweeps.
    """
    frames = sweeping_frames(crossings)
    if len(frames) < 2 * FEWEST_SWEEPS:
        return None
    table = by_sweep(crossings, frames)
    geometry = CrossingRays.of(crossings, camera)
    equations = Adjustment(table, geometry, line, fan, len(frames), LineErrors.of(crossings))
    solution = equations.start()
    for _ in range(_ROUNDS):
        solution = equations.improve(solution, huber_weights(solution.residuals))
    scores = _Scores.of(equations, solution)
    first, last = FEWEST_SWEEPS, len(frames) - FEWEST_SWEEPS
    stride = max(1, len(frames) // _TRIED)
    _, about = max((scores.at(k), k) for k in range(first, last + 1, stride))
    near = range(max(first, about - stride + 1), min(last, about + stride - 1) + 1)
    score, k = max((scores.at(k), k) for k in near)
    return Movement(int(frames[k - 1]), int(frames[k]), score) if score > SURE else None


@dataclass(frozen=True, eq=False, slots=True)
class _Scores:
    """All that does not depend on k.

    `earlier` and `later` (M,) sweep of each crossing, −1 for the fan; `pattern` (M, ≤ 12) what a movement between them
    does to its equation; `scale` the variance of unit weight where above 1.
    """

    equations: Adjustment
    solution: Solution
    earlier: Index
    later: Index
    pattern: Array
    scale: float

    @classmethod
    def of(cls, equations: Adjustment, solution: Solution) -> _Scores:
        table = equations.crossings
        b = np.where(table.with_fan, -1, table.b)
        rays = equations.geometry.rays
        inverse = np.einsum("mi,mi->m", rays, solution.pis[table.a]) - 0.5 * np.einsum(
            "mi,mi->m", rays, equations.differences(solution.pis)
        )
        pattern = _movements(rays, inverse)
        _, expected = equations.covariance(solution)
        scale = max(1.0, solution.misfit / max(expected, 1.0))
        sign = np.where(table.a > b, 1.0, -1.0)
        return cls(equations, solution, np.minimum(table.a, b), np.maximum(table.a, b), sign[:, None] * pattern, scale)

    def at(self, k: int) -> float:
        """T for a movement before sweep k; 0 with too few crossings."""
        across = (self.earlier < k) & (self.later >= k)
        if np.count_nonzero(across) < FEWEST_ACROSS:
            return 0.0
        solution, equations = self.solution, self.equations
        weight = solution.weights / solution.sigma**2
        moved = np.where(across[:, None], self.pattern, 0.0)
        weighted = diags_array(weight) @ solution.design
        pulled = cho_solve(solution.factor, weighted.T @ moved, check_finite=False)
        score = moved.T @ (weight * solution.residuals * solution.sigma)
        gain = weight[:, None] * moved - weighted @ pulled
        of_noise = equations.noise(solution).T @ gain
        of_cells = pulled[3 * equations.sweeps :]
        own = np.sqrt(np.maximum(np.sum(weight[:, None] * moved**2, axis=0), 1e-300))
        return (
            _chi_square(score / own, (of_noise.T @ of_noise + of_cells.T @ of_cells) / np.outer(own, own)) / self.scale
        )


def _chi_square(score: Array, covariance: Array) -> float:
    """gᵀ C⁻¹ g over the directions that the sweeps' planes do not take up all but wholly."""
    values, vectors = np.linalg.eigh(covariance)
    known = values > TAKEN_UP
    return float(np.sum((vectors.T @ score)[known] ** 2 / values[known]))


def _movements(rays: Array, inverse_depths: Array) -> Array:
    """(M, ≤ 12): change of each inverse depth by a shift (mm) and a turn (mm at the rim) of main plane and the rest."""
    points = rays / inverse_depths[:, None]
    plane, on_plane = main_plane(rays, inverse_depths)
    normals = np.tile(plane / np.linalg.norm(plane), (len(rays), 1))
    off = np.flatnonzero(~on_plane)
    if len(off) > _NEIGHBOURS:
        near = points[off][cKDTree(points[off]).query(points[off], k=_NEIGHBOURS)[1]]
        near = near - near.mean(axis=1, keepdims=True)
        normals[off] = np.linalg.eigh(np.einsum("mki,mkj->mij", near, near))[1][:, :, 0]
    gain = -inverse_depths / np.einsum("mi,mi->m", normals, points)
    columns = []
    for body in (on_plane, ~on_plane):
        if np.count_nonzero(body) <= _NEIGHBOURS:
            continue
        arm = points - points[body].mean(axis=0)
        arm /= np.sqrt(np.mean(np.sum(arm[body] ** 2, axis=1)))
        columns += [np.where(body[:, None], gain[:, None] * way, 0.0) for way in (normals, np.cross(arm, normals))]
    return np.hstack(columns)
