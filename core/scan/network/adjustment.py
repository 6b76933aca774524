"""The network: all sweeps of a scan in one adjustment, tied to the fan and to each other by their crossings.

In inverse depth every crossing is linear in the unknown planes π_1 … π_S: with fan plane k it says π_i·r = π_k·r, with
another sweep π_i·r = π_j·r. Sweep–sweep crossings alone leave scale and a plane free, π → s π + c; the fan, where it
meets relief, gives the metric.

The equations and the model of their noise are in `core.scan.network.equations`; here they are solved in spite of wrong
crossings. Weights depend on how much the two planes differ. If they are taken from a solution that has collapsed
onto the table (which satisfies every crossing on the table), they run away to it. So the first solution uses weights of
the rig's geometry alone, later ones are floored by it, outliers are rejected only at the end, and not where that would
silence the fan.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.model import Fan
from core.model.arrays import Array
from core.model.robust import Schedule
from core.progress import Progress, silent, steps
from core.scan.features.crossings import CrossingTable, Index
from core.scan.known_planes.known_plane import Control
from core.scan.network.equations import GRADIENT_FLOOR, Adjustment, Solution
from core.scan.network.fan_residuals import CellErrors
from core.scan.network.geometry import CrossingRays
from core.scan.network.line_errors import LineErrors
from core.scan.network.read_out import AT_ONCE, ReadOut

# Residuals in standard deviations. The limits are wider than those of full efficiency (1.345 and 4.685,
# `core.model.robust`), so that crossings of a still-wrong solution are not rejected. Held by tests/scan/network/
# test_adjustment.py and, against collapse, test_adjustment_traps.py.
HUBER_AT = 2.0
"""From which on a crossing loses weight before anything is rejected."""
REJECT_AT = 5.0
"""At which a crossing has no weight left (Tukey's biweight)."""
_SETTLED = 0.02
"""Change from one round to the next below which residuals will change no more."""
ROUNDS = 12
"""Rounds of reweighting at most: half of them by Huber, half by Tukey, unless they settle sooner."""
_HUBER_ONLY = Schedule(ROUNDS, huber_at=HUBER_AT)
_REDESCENDING = Schedule(ROUNDS, ROUNDS // 2, HUBER_AT, REJECT_AT, early=True, settles=2)

# Shares, held by the same tests.
SILENCED = 0.05
"""Weight below which a crossing counts as left out."""
MOST_FAN_REJECTED = 0.25
"""If more of the fan's crossings than this would be silenced, the adjustment is not robust but wrong: none is."""
COLLAPSED = 0.5
"""All planes have fallen together if more of the crossings than this are between planes that hardly differ."""

_TUKEY_OF_NORMAL = (1 - 6 / REJECT_AT**2 + 15 / REJECT_AT**4) / (1 - 2 / REJECT_AT**2 + 3 / REJECT_AT**4)
"""Mean of w·r² over mean of w for Tukey's weights w and normal residuals r, by their moments 1, 3, 15."""


@dataclass(frozen=True, eq=False, slots=True)
class Network:
    """Result of adjusting all sweeps together: their light planes with covariance, and how well crossings agree.

    Parameters
    ----------
    pis
        (S, 3) in 1/mm, or (S, 3·(1 + K)) where rows are read one after another (`core.scan.network.read_out`).
    covariance
        Of the stacked `pis`; without the camera's and the fan's own.
    residuals
        (M,) of each crossing in standard deviations, observed − adjusted.
    weights
        (M,) robust weights, 0 (left out) to 1.
    scale
        Standard deviation of unit weight: 1 where the noise model is true. The covariance is scaled by it when above 1.
    fan_silenced
        True if rejecting outliers would have silenced the fan and was not done.
    collapsed
        True if the sweeps' planes have fallen together: crossings that say nothing but that the world is flat.
    fan_cells
        (F, 2) centreline and cell along it of each of the fan's cells, see `core.scan.network.line_errors`.
    fan_covariance
        (3S, F) of the errors of the stacked π with those of the cells, of which each has unit variance.
    line_cells
        (Q, 3) sweep, centreline and cell along it of each cell of the sweeps' own centrelines.
    line_covariance
        (Q, 3) of the error of the sweep's π with that of the cell; with K as many as a sweep has numbers.
    fan_off
        What the sweeps say of the fan's cells.
    """

    pis: Array
    covariance: Array
    residuals: Array
    weights: Array
    scale: float
    fan_silenced: bool
    collapsed: bool
    fan_cells: Index
    fan_covariance: Array
    line_cells: Index
    line_covariance: Array
    fan_off: CellErrors


def solve_network(
    crossings: CrossingTable,
    geometry: CrossingRays,
    line: Index,
    fan: Fan | Control,
    sweeps: int,
    progress: Progress = silent,
    read_out: ReadOut = AT_ONCE,
) -> Network:
    """Adjust the planes of `sweeps` sweeps to all `crossings`; `line` (M,) is the fan's from 0, −1 between sweeps.

    With a `Control` there may be points on known planes among them, as of `Adjustment`. Where a `read_out` says that
    rows see different planes, these follow the hand.

    Raises
    ------
    ValueError
        If there is no crossing with the fan and no point on a known plane: nothing fixes the scale.
    """
    equations = Adjustment(crossings, geometry, line, fan, sweeps, LineErrors.of(crossings), read_out)
    solution, silenced = solve_planes(equations, progress)
    covariance, expected = equations.covariance(solution)
    scale = float(np.sqrt(solution.misfit / max(expected * (1.0 if silenced else _TUKEY_OF_NORMAL), 1.0)))
    return Network(
        solution.pis,
        covariance * max(1.0, scale) ** 2,
        solution.residuals,
        solution.weights,
        scale,
        silenced,
        has_collapsed(equations, solution.pis),
        equations.errors.fan_cells,
        equations.shared_with_fan(solution),
        equations.errors.sweep_cells,
        equations.shared_with_own_lines(solution),
        CellErrors.of(equations, solution),
    )


def solve_planes(equations: Adjustment, progress: Progress = silent) -> tuple[Solution, bool]:
    """Solve for the sweeps' planes without covariance; the flag is True if no outlier was rejected, to keep the fan.

    Raises
    ------
    ValueError
        If there is no crossing with the fan: nothing fixes the scale.
    """
    crossings = equations.crossings
    if not np.any(crossings.with_fan):
        raise ValueError("no sweep crosses the fan")
    solution = _adjust(equations, progress, redescend=True)
    if _share_silenced(crossings, solution.weights) > MOST_FAN_REJECTED:
        return _adjust(equations, progress, redescend=False), True
    return solution, False


def _adjust(equations: Adjustment, progress: Progress, *, redescend: bool) -> Solution:
    """Iterate: the rig's geometry first, then Huber's weights, and only then, if at all, rejection."""
    return equations.weighted(
        _REDESCENDING if redescend else _HUBER_ONLY,
        scaled=True,
        settled=lambda before, now: bool(np.abs(now.residuals - before.residuals).max() < _SETTLED),
        watched=lambda rounds: steps(rounds, progress, "adjustment", ROUNDS),
    )


def _share_silenced(crossings: CrossingTable, weights: Array) -> float:
    """Share of the crossings with the fan without weight; where there is no fan, of the points on known planes."""
    fan = crossings.with_fan & ~crossings.on_plane
    return float(np.mean(weights[fan if fan.any() else crossings.with_fan] < SILENCED))


def has_collapsed(equations: Adjustment, pis: Array) -> bool:
    """Whether sweeps `pis` (S, 3) have fallen together on one plane, so that their crossings carry no information."""
    between = ~equations.crossings.with_fan
    if not np.any(between):
        return False
    length = np.linalg.norm(equations.gradient(pis)[between], axis=1)
    return float(np.mean(length < GRADIENT_FLOOR * equations.typical_gradient)) > COLLAPSED
