"""Control charts of a series in the order of time: X̄ and s of subgroups, or single values and their moving range.

References
----------
Montgomery, Introduction to statistical quality control, 6th ed.: 6.2.1 (20 to 25 subgroups for limits), 6.3.1 (X̄, s),
6.4 (single values). NIST/SEMATECH e-Handbook of statistical methods, 6.3.2. Western Electric, Statistical quality
control handbook (1956), part B (rules). Champ, Woodall, Technometrics 29 (1987) 393–399 (how often a steady process
breaks the rules).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from core.messages import label
from core.model.arrays import Array

FEWEST_POINTS = 20
"""So many points, subgroups or single values, have limits of their own."""
D2, D3 = 1.128, 0.8525
"""Mean and standard deviation of the range of two values over their σ, as the tables have them."""
RULES = ((1, 1, 3.0), (2, 3, 2.0), (4, 5, 1.0), (8, 8, 0.0))
"""Western Electric's rules 1 to 4: so many, of so many in a row, farther from the centre than so many standard
deviations, on one side."""
RULE_WORDS = (
    label("a point beyond 3 standard deviations"),
    label("2 of 3 points beyond 2 standard deviations, on one side"),
    label("4 of 5 points beyond 1 standard deviation, on one side"),
    label("8 points in a row on one side of the centre line"),
)
"""What breaks Western Electric's rules 1 to 4."""
POINTS_A_BREAK = 91.75
"""After so many points on average a steady process first breaks one of the four rules."""


@dataclass(frozen=True, slots=True)
class Break:
    """Break of a rule of a steady process, 1 to 4, completed at point `place`, from 0."""

    rule: int
    place: int


@dataclass(frozen=True, eq=False, slots=True)
class Chart:
    """Chart of points (k,) in the order of time, the lines they are compared with, and which of them break a rule."""

    points: Array
    centre: float
    lower: float
    upper: float
    breaks: tuple[Break, ...]

    @property
    def breaking(self) -> frozenset[int]:
        """Places (from 0) of the points that complete the break of a rule."""
        return frozenset(one.place for one in self.breaks)


@dataclass(frozen=True, eq=False, slots=True)
class SeriesCharts:
    """Pair of charts of a series: places and spreads.

    Parameters
    ----------
    size
        Values a subgroup; 1: single values.
    location
        Of the subgroups' means, or of the single values.
    spread
        Of the subgroups' standard deviations, or of the moving ranges: point i is that from value i to value i + 1.
    sigma
        Standard deviation of a single value within a short time: s̄/c₄, or the mean moving range over d₂.
    dof
        Degrees of freedom that sigma is worth: half of 1 over its relative variance.
    """

    size: int
    location: Chart
    spread: Chart
    sigma: float
    dof: float


def western_electric(points: Array, centre: float, sigma: float) -> tuple[Break, ...]:
    """Find the points (k,) that break a Western Electric rule about `centre`; `sigma` > 0 is the σ of one point.

    The point told is the last one of the pattern, and one of those that lie so far out.
    """
    away = (np.asarray(points, dtype=np.float64) - centre) / sigma
    found = []
    for rule, (needed, among, beyond) in enumerate(RULES, start=1):
        for side in (1, -1):
            out = side * away > beyond
            counted = np.convolve(out, np.ones(among))[: len(away)]
            found += [Break(rule, int(place)) for place in np.flatnonzero(out & (counted >= needed))]
    return tuple(sorted(found, key=lambda one: (one.place, one.rule)))


def single_values(values: Array) -> SeriesCharts:
    """Make the control charts of single values (n,), n ≥ 2, not all equal, and of their moving ranges.

    The mean moving range has the relative variance (0.8264 n − 1.082)/(n − 1)², neighbours sharing a value (Cryer,
    Ryan, Journal of Quality Technology 22 (1990) 187–192).
    """
    n = len(values)
    ranges = np.abs(np.diff(values))
    middle, centre = float(ranges.mean()), float(np.mean(values))
    sigma = middle / D2
    spread = _above_only(ranges, middle, D3 * sigma)
    dof = (n - 1) ** 2 / (2 * (0.8264 * n - 1.082))
    return SeriesCharts(1, _about(values, centre, sigma), spread, sigma, dof)


def subgroups(groups: Array) -> SeriesCharts:
    """Make the control charts of the means and of the standard deviations of subgroups (g, m), m ≥ 2.

    Not each of one value alone.
    """
    count, size = groups.shape
    s = groups.std(axis=1, ddof=1)
    middle, unbiased = float(s.mean()), c4(size)
    sigma, lost = middle / unbiased, 1 - unbiased**2
    spread = _above_only(s, middle, sigma * math.sqrt(lost))
    location = _about(groups.mean(axis=1), float(groups.mean()), sigma / math.sqrt(size))
    return SeriesCharts(size, location, spread, sigma, count * unbiased**2 / (2 * lost))


def c4(n: int) -> float:
    """Compute the factor c4, the expected standard deviation of n ≥ 2 normal values over σ."""
    return math.sqrt(2 / (n - 1)) * math.exp(math.lgamma(n / 2) - math.lgamma((n - 1) / 2))


def _about(points: Array, centre: float, sigma: float) -> Chart:
    return Chart(points, centre, centre - 3 * sigma, centre + 3 * sigma, western_electric(points, centre, sigma))


def _above_only(points: Array, centre: float, sigma: float) -> Chart:
    """Of spreads, which are not spread evenly about their mean: of the rules the first alone holds for them."""
    lower, upper = max(0.0, centre - 3 * sigma), centre + 3 * sigma
    out = np.flatnonzero((points < lower) | (points > upper))
    return Chart(points, centre, lower, upper, tuple(Break(1, int(place)) for place in out))
