"""The deviation of form of a surface: the range of its residuals that holds 95 % of them, with its uncertainty.

Optical points are many and noisy: the range from the lowest to the highest grows without end with their number, so the
range of 95 % is stated. Of single points it holds their noise as well; of the means over cells of the surface, all but
the form has been filtered out. Its uncertainty: how much it depends on the stripes that happened to be scanned, by
drawing them again (the bootstrap, whole stripes at a time, for their points err together); and what calibrations do to
the highest less the lowest points after the fitted surface has taken its part.

References
----------
Efron, Bootstrap methods: another look at the jackknife, Ann. Statist. 7 (1979), doi:10.1214/aos/1176344552.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.inspect.error_sources import Sources
from core.inspect.results import Contribution
from core.inspect.uncertainty import budget_of, combined, effects
from core.model.arrays import Array
from core.scan.cloud import Cloud

TAIL = 0.025
"""Share of the residuals beyond each end of the range."""
NEAR = 0.02
"""Share of the residuals about an end that stands for it."""
DRAWS, MOST_DRAWN = 200, 50_000
SAMPLING = "which stripes were scanned (range of 95 %)"


@dataclass(frozen=True, eq=False, slots=True)
class Spread:
    """A range in mm that holds 95 % of the residuals, its uncertainty, and of how many `samples` (points or cells)."""

    value: float
    budget: tuple[Contribution, ...]
    samples: int

    @property
    def u(self) -> float:
        """Standard uncertainty in mm."""
        return combined(self.budget)


def spread(
    cloud: Cloud,
    residuals: Array,
    sources: Sources,
    fit: tuple[Array, Array],
    calibrations: Sequence[str],
    cell_mm: float = 0.0,
) -> Spread:
    """The spread of residuals (N,) of a cloud's points about a `fit` of stretches: design (J, p) and gains (p, J)."""
    cell = _cells(cloud.points, cell_mm) if cell_mm > 0 else np.arange(len(residuals), dtype=np.int64)
    share = 1.0 / np.bincount(cell)[cell]
    values = np.asarray(np.bincount(cell, share * residuals), dtype=np.float64)
    low, high = np.quantile(values, [TAIL, 1 - TAIL])
    ranks = np.argsort(np.argsort(values)) / max(len(values) - 1, 1)
    gain = np.zeros(len(sources.own))
    for sign, end in ((1.0, 1 - TAIL), (-1.0, TAIL)):
        weight = np.where((np.abs(ranks - end) <= NEAR / 2)[cell], share, 0.0)
        np.add.at(gain, sources.stretch, sign * weight / max(float(weight.sum()), 1e-12))
    design, gains = fit
    gain = gain - gain @ design @ gains  # the fitted surface follows what is common as far as it can
    acting = [one for one in effects(gain[None, :], sources, calibrations=calibrations) if one.source in calibrations]
    group = np.arange(len(values)) if cell_mm > 0 else np.unique(cloud.sweep, return_inverse=True)[1]
    sampling = Contribution(SAMPLING, u_of_quantiles(values, (TAIL, 1 - TAIL), (-1.0, 1.0), group))
    return Spread(float(high - low), (sampling, *budget_of([(np.ones(1), acting)])), len(values))


def u_of_quantiles(
    values: Array, shares: Sequence[float], signs: Sequence[float], group: NDArray[np.int64], seed: int = 0
) -> float:
    """Standard uncertainty of Σ sign · quantile of `values` (N,), by drawing their groups (N,) again, with repeats."""
    order = np.argsort(values, kind="stable")
    order = order[:: max(1, len(order) // MOST_DRAWN)]
    ranked, of = values[order], group[order]
    rng, count = np.random.default_rng(seed), int(group.max()) + 1
    found = np.empty(DRAWS)
    for draw in range(DRAWS):
        times = np.bincount(rng.integers(count, size=count), minlength=count)
        below = np.cumsum(times[of])
        at = np.searchsorted(below, np.array(shares) * below[-1])
        found[draw] = np.dot(signs, ranked[np.minimum(at, len(ranked) - 1)])
    return float(found.std(ddof=1))


def _cells(points: Array, cell_mm: float) -> NDArray[np.int64]:
    """Number, from 0, of the cube of side `cell_mm` each point lies in."""
    place = np.floor((points - points.min(axis=0)) / cell_mm).astype(np.int64)
    return np.asarray(np.unique(place, axis=0, return_inverse=True)[1], dtype=np.int64).ravel()
