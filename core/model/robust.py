"""Robust statistics: weights that limit the influence of outliers, fits by them, and a scale that they cannot spoil.

References
----------
Huber, P. J., Robust estimation of a location parameter, Ann. Math. Statist. 35 (1964), doi:10.1214/aoms/1177703732.
Beaton, A. E., Tukey, J. W., The fitting of power series, meaning polynomials, illustrated on band-spectroscopic data,
Technometrics 16 (1974), doi:10.1080/00401706.1974.10489171.
Holland, P. W., Welsch, R. E., Robust regression using iteratively reweighted least-squares, Commun. Statist. A 6
(1977), doi:10.1080/03610927708827533.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from core.model.arrays import Array

HUBER = 1.345
"""Huber's limit in standard deviations: 95 % efficient for normal residuals."""
TUKEY = 4.685
"""Limit of Tukey's biweight in standard deviations: 95 % efficient for normal residuals."""
T = TypeVar("T")
MAD_TO_SD = 1.4826
"""Standard deviation over median absolute deviation of a normal distribution: 1 / 0.6745."""


def huber_weights(residuals: Array, limit: float = HUBER) -> Array:
    """Compute Huber's weights of residuals of any shape: 1 up to `limit`, limit / |residual| beyond.

    Parameters
    ----------
    residuals
        Any shape; signed or absolute.
    limit
        In the unit of the residuals.
    """
    return np.asarray(np.minimum(1.0, limit / np.maximum(np.abs(residuals), 1e-12)))


def tukey_weights(residuals: Array, limit: float | Array = TUKEY) -> Array:
    """Compute Tukey's biweights (1 − (residual / limit)²)² up to `limit`, 0 beyond, for `residuals` of any shape."""
    return np.asarray(np.clip(1 - (residuals / limit) ** 2, 0.0, None) ** 2)


@dataclass(frozen=True, slots=True)
class Schedule:
    """Schedule of iterative reweighting: the kinds of weights, the number of rounds, and the stop.

    Parameters
    ----------
    rounds
        At most so many.
    huber
        The first so many of them by Huber's weights, the others by Tukey's, which reject; None: all by Huber's.
    huber_at, tukey_at
        The limits of both in the unit of the residuals.
    early
        Whether rejection begins as soon as a round has settled, if that is before.
    settles
        So many rounds that have settled are the end.
    counts_from
        The first round, from 0, that counts as settled.
    """

    rounds: int
    huber: int | None = None
    huber_at: float = HUBER
    tukey_at: float = TUKEY
    early: bool = False
    settles: int = 1
    counts_from: int = 0

    def rejects(self, round_: int, settled: int) -> bool:
        """Whether round number `round_` uses Tukey's weights, which reject, with `settled` rounds settled before it."""
        by_huber = self.rounds if self.huber is None else self.huber
        return round_ >= by_huber or (self.early and settled > 0)


@dataclass(frozen=True, slots=True)
class Weigh:
    """Weights of one `round` of a schedule, counted from 0; `rejects`: by Tukey's biweight."""

    schedule: Schedule
    round: int
    rejects: bool

    def __call__(self, residuals: Array, unit: float = 1.0) -> Array:
        """Return the weights of residuals of any shape; the schedule's limits are multiples of `unit`."""
        if self.rejects:
            return tukey_weights(residuals, self.schedule.tukey_at * unit)
        return huber_weights(residuals, self.schedule.huber_at * unit)


def irls(
    start: T,
    improve: Callable[[T, Weigh], T],
    schedule: Schedule,
    settled: Callable[[T, T], bool] | None = None,
    watched: Callable[[range], Iterable[int]] = iter,
) -> T:
    """Fit by iteratively reweighted least squares, with Huber's or Tukey's weights, until it has settled.

    Parameters
    ----------
    start
        What the first residuals are of.
    improve
        Weights the residuals of what was found by the function it is given, and solves once.
    schedule
        The rounds, their weights, and the end.
    settled
        Whether a round has changed nothing that matters, from what was before it and after it; None: all are done.
    watched
        Passes the rounds on and reports them.

    Examples
    --------
    The mean of values of which one is an outlier:

    >>> values = np.array([1.0, 2.0, 3.0, 100.0])
    >>> def mean(found: float, weigh: Weigh) -> float:
    ...     weights = weigh(values - found)
    ...     return float(weights @ values / weights.sum())
    >>> round(irls(2.5, mean, Schedule(20, huber=10)), 3)
    2.0
    """
    found, quiet = start, 0
    for round_ in watched(range(schedule.rounds)):
        if quiet >= schedule.settles:
            continue  # what watches sees every round
        before, found = found, improve(found, Weigh(schedule, round_, schedule.rejects(round_, quiet)))
        if settled is not None and round_ >= schedule.counts_from:
            quiet += settled(before, found)
    return found


def mad_sd(residuals: Array) -> float:
    """Estimate the standard deviation about zero of residuals of any shape by their median absolute value.

    Up to half may be outliers.
    """
    return MAD_TO_SD * median(np.abs(residuals))


def median(values: Array) -> float:
    """Compute the median of values of any shape, NaN if one is or there are none.

    That of NumPy to the last bit, which takes 30 µs to begin. Compiled loops have `core.model.small_arrays.median_of`.
    """
    ordered = np.array(values, dtype=np.float64).ravel()
    count = len(ordered)
    if not count:
        return float("nan")
    low, high = (count - 1) // 2, count // 2
    ordered.partition((low, high, count - 1))  # NaN is last
    if np.isnan(ordered[-1]):
        return float("nan")
    return float(ordered[high] if low == high else (ordered[low] + ordered[high]) / 2)
