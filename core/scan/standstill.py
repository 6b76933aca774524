"""Test whether object and camera stood still during a scan, and choice of the part that can be measured if not.

If something moved before frame k, later sweeps saw the surface elsewhere than earlier ones and the fan, whose lines
are those of the reference. On a surface with normal n at X a shift t and a turn ω change the inverse depth of the ray
through X by −w·(n·t + (X × n)·ω)/(n·X), so all crossings between an earlier and a later sweep, and of a later sweep
with the fan, are out by that. The main plane (the table) and everything else may each have moved by themselves: twelve
numbers. Whether they differ from 0 for a given k is a score test on the network as it is, without solving it again:
g = Bᵀ W r with B the derivatives of the crossings by the twelve numbers, r the residuals and W their weights;
T = gᵀ cov(g)⁻¹ g is χ² distributed if nothing has moved.

What cannot be seen does no harm: a shift of two parallel planes along their normal changes all later sweeps by
π → s π + c, and they give the surface as it was in the reference.

References
----------
Rao, C. R., Large sample tests of statistical hypotheses concerning several parameters, Math. Proc. Cambridge Philos.
Soc. 44 (1948), doi:10.1017/S0305004100023987.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve
from scipy.sparse import csr_array, diags_array
from scipy.spatial import cKDTree

from core.errors import OwnCause
from core.findings.table import note_of
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.model.robust import Schedule
from core.progress import Progress, silent
from core.scan.between_frames import Between, between
from core.scan.features.crossings import CrossingTable, Index
from core.scan.known_planes.known_plane import Control
from core.scan.network.adjustment import HUBER_AT
from core.scan.network.datum import main_plane
from core.scan.network.equations import Adjustment, Solution
from core.scan.network.geometry import CrossingRays
from core.scan.network.line_errors import LineErrors
from core.scan.network.read_out import AT_ONCE, ReadOut
from core.scan.sweeps.locate import by_sweep, locate_together, sweeping_frames

# The test for a movement. Held by tests/scan/test_standstill.py on scans in which nothing moved and in which something
# did.
SCORE_LIMIT = 40.0
"""T above which something has moved. Scans in which nothing did reach 20 at most over all k."""
SWEEPS_ASIDE, CROSSINGS_ACROSS = 5, 20
"""Sweeps on either side of a place where a movement is looked for, and crossings between them, at least."""
LEAST_SEEN_SHARE = 1e-3
"""A movement of whose effect on the crossings less than this share (of the squares) is left by the sweeps' planes,
which follow it as far as they can, is not to be seen."""
_NEIGHBOURS = 12
"""Points from which a surface normal is taken."""
_WEIGHTS = Schedule(5, huber_at=HUBER_AT)
"""Of reweighting before the test."""
_PLACES = 40
"""Places tried, about, in a long scan; then those about the best. Chosen by the time it takes."""

# What is measured of a scan in which something moved; held by the same tests.
LEAST_SWEEPS = 12
"""A part of a scan with fewer sweeps, or fewer of their crossings with the fan, is not measured."""
CLEARLY_WORSE = 1.5
"""The larger part is not taken if it disagrees with the fan so many times more than the smaller."""


HOLD_STILL = Message("scan.advice_hold_still", "hold both still and scan again")


@dataclass(frozen=True, slots=True)
class Movement:
    """Movement of part or rig, between two frames that other frames cross, and the score that shows it.

    The score is T, about 10 where nothing moved.
    """

    when: Between
    score: float


def find_movement(
    crossings: CrossingTable, line: Index, camera: Camera, fan: Fan | Control, read_out: ReadOut = AT_ONCE
) -> Movement | None:
    """Find the most noticeable movement of part or rig during a scan; None where none shows.

    `line` (M,) is the fan's line of each crossing, −1 between sweeps.
    """
    frames = sweeping_frames(crossings)
    if len(frames) < 2 * SWEEPS_ASIDE:
        return None
    table = by_sweep(crossings, frames)
    geometry = CrossingRays.of(crossings, camera)
    equations = Adjustment(table, geometry, line, fan, len(frames), LineErrors.of(crossings), read_out)
    solution = equations.weighted(_WEIGHTS)
    scores = _Scores.of(equations, solution)
    first, last = SWEEPS_ASIDE, len(frames) - SWEEPS_ASIDE
    stride = max(1, len(frames) // _PLACES)
    _, about = max((scores.at(k), k) for k in range(first, last + 1, stride))
    near = range(max(first, about - stride + 1), min(last, about + stride - 1) + 1)
    score, k = max((scores.at(k), k) for k in near)
    return Movement(Between(int(frames[k - 1]), int(frames[k])), score) if score > SCORE_LIMIT else None


@dataclass(frozen=True, eq=False, slots=True)
class _Scores:
    """All that does not depend on k.

    `earlier` and `later` (M,) sweep of each crossing, −1 for the fan; `pattern` (M, ≤ 12) what a movement between them
    does to its equation; `weighted` and `noise` are W A and the crossings' noise; `scale` the variance of unit weight
    where above 1.
    """

    equations: Adjustment
    solution: Solution
    weighted: csr_array
    noise: csr_array
    earlier: Index
    later: Index
    pattern: Array
    scale: float

    @classmethod
    def of(cls, equations: Adjustment, solution: Solution) -> _Scores:
        scale = max(1.0, solution.misfit / max(equations.expected(solution), 1.0))
        weighted = csr_array(diags_array(solution.weights / solution.sigma**2) @ solution.design)
        earlier, later, pattern = movements_of(equations, solution)
        return cls(equations, solution, weighted, equations.noise(solution), earlier, later, pattern, scale)

    def at(self, k: int) -> float:
        """T for a movement before sweep k; 0 with too few crossings."""
        across = (self.earlier < k) & (self.later >= k)
        if np.count_nonzero(across) < CROSSINGS_ACROSS:
            return 0.0
        solution, equations = self.solution, self.equations
        weight = solution.weights / solution.sigma**2
        moved = np.where(across[:, None], self.pattern, 0.0)
        pulled = cho_solve(solution.factor, self.weighted.T @ moved, check_finite=False)
        score = moved.T @ (weight * solution.residuals * solution.sigma)
        gain = weight[:, None] * moved - self.weighted @ pulled
        of_noise = self.noise.T @ gain
        of_cells = pulled[equations.unknowns :]
        own = np.sqrt(np.maximum(np.sum(weight[:, None] * moved**2, axis=0), 1e-300))
        return (
            _chi_square(score / own, (of_noise.T @ of_noise + of_cells.T @ of_cells) / np.outer(own, own)) / self.scale
        )


def movements_of(equations: Adjustment, solution: Solution) -> tuple[Index, Index, Array]:
    """Compute how each of M crossings changes with a movement between two sweeps, as a pattern (M, ≤ 12) in 1/mm.

    Returns the earlier and the later sweep (M,) of each crossing, −1 for the fan, and the pattern, as of `_Scores`.
    """
    table = equations.crossings
    b, rays = np.where(table.with_fan, -1, table.b), equations.geometry.rays
    planes = equations.read_out.planes(solution.pis[table.a], table.uv[:, 1])
    inverse = np.einsum("mi,mi->m", rays, planes) - 0.5 * np.einsum(
        "mi,mi->m", rays, equations.differences(solution.pis)
    )
    sign = np.where(table.a > b, 1.0, -1.0)
    return np.minimum(table.a, b), np.maximum(table.a, b), sign[:, None] * _movements(rays, inverse)


def _chi_square(score: Array, covariance: Array) -> float:
    """gᵀ C⁻¹ g over the directions that the sweeps' planes do not take up all but wholly."""
    values, vectors = np.linalg.eigh(covariance)
    known = values > LEAST_SEEN_SHARE
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


@dataclass(frozen=True, eq=False, slots=True)
class RigidInterval:
    """Part of a scan in which nothing moved: the mask (M,) of its crossings, and all movements of the scan.

    `known` is whether the scan has sweeps enough to show a movement.
    """

    kept: NDArray[np.bool_]
    movements: tuple[Between, ...]
    known: bool

    def note(self, names: Sequence[str], frames: int) -> tuple[Message, ...]:
        """Make a note for the technician if part or rig moved, with when; () if not.

        `names` are those of all frames, `frames` is how many of them are used.
        """
        if not self.movements:
            return ()
        return (note_of("scan.moved", when=between(names, self.movements), n=frames),)


def largest_rigid_interval(
    crossings: CrossingTable,
    line: Index,
    camera: Camera,
    fan: Fan | Control,
    names: Sequence[str],
    progress: Progress = silent,
    read_out: ReadOut = AT_ONCE,
) -> RigidInterval:
    """Select the crossings of the largest part of a scan in which nothing moved, splitting it at each movement found.

    The second largest is taken if the largest agrees with itself and with the fan clearly worse. `line` (M,) is the
    fan's line of each crossing, −1 between sweeps; `names` are the frames'.

    Raises
    ------
    InputError
        If too little is left.
    """
    kept, movements = np.ones(len(crossings), dtype=np.bool_), []
    while movement := find_movement(crossings.select(kept), line[kept], camera, fan, read_out):
        movements.append(movement.when)
        later_a, later_b = crossings.a >= movement.when.first_after, crossings.b >= movement.when.first_after
        parts = [
            kept & ~later_a & (crossings.with_fan | ~later_b),
            kept & later_a & (crossings.with_fan | later_b),
        ]
        solved = []
        for part in parts:
            count = _sweeps(crossings, part)
            if count >= LEAST_SWEEPS and np.count_nonzero(crossings.with_fan & part) >= LEAST_SWEEPS:
                scale = locate_together(crossings.select(part), line[part], camera, fan, progress, read_out).scale
                solved.append((count, scale, part))
        if not solved:
            raise OwnCause(
                Message(
                    "scan.moved_too_much",
                    "object or camera moved {when:and}, and too few frames are left between which nothing did",
                    when=between(names, movements),
                ),
                where="scan",
                todo=HOLD_STILL,
            )
        solved.sort(key=lambda one: -one[0])
        worse = len(solved) > 1 and solved[0][1] > CLEARLY_WORSE * max(solved[1][1], 1.0)
        kept = solved[int(worse)][2]
    return RigidInterval(kept, tuple(movements), len(sweeping_frames(crossings)) >= 2 * SWEEPS_ASIDE)


def _sweeps(crossings: CrossingTable, rows: NDArray[np.bool_]) -> int:
    return len(np.unique(np.concatenate([crossings.a[rows], crossings.b[rows & ~crossings.with_fan]])))
