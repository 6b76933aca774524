"""Capability of a process: how often its scatter fits between the limits, and how surely.

References
----------
Montgomery, Introduction to statistical quality control, 6th ed., 8.3 (the interval of Cpk is Bissell's, Applied
Statistics 39 (1990) 331–340). ISO 22514-2 (Pp, Ppk: of the whole scatter). NIST/SEMATECH e-Handbook of statistical
methods, 6.1.6.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, ndtr, ndtri

from core.model.arrays import Array

LIMIT = 1.33
"""What Cpk and Ppk must reach."""
RISK = 0.05
"""Intervals hold the true value in all but this share of cases; half of it lies on either side."""
LARGEST_A2 = 0.752
"""Anderson–Darling statistic that normal values of unknown mean and σ exceed in 5 % of cases (Stephens 1986)."""


@dataclass(frozen=True, slots=True)
class Index:
    """Capability index and its 95 % confidence interval."""

    value: float
    interval: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Indices:
    """Capability indices Cp and Cpk, or Pp and Ppk.

    `p` is the width of the tolerance over 6 σ, None with one limit alone; `pk` the room from the mean to the nearer
    limit over 3 σ.
    """

    p: Index | None
    pk: Index


@dataclass(frozen=True, slots=True)
class Scatter:
    """Mean and standard deviation `sigma` > 0 of `n` values, sigma with `dof` degrees of freedom.

    `u_common`: the standard uncertainty of what moves all values alike, and so the mean.
    """

    mean: float
    sigma: float
    dof: float
    n: int
    u_common: float = 0.0


def indices(scatter: Scatter, lower: float, upper: float) -> Indices:
    """Compute two capability indices with 95 % intervals for limits `lower` < `upper`, one of which may be infinite.

    The interval of p is that of σ by χ². That of pk adds, in squares, how well the mean is known: from n values, and
    from what moves all of them alike. σ holds the scatter of the measurement too, so an index is too small rather than
    too large.
    """
    sigma, dof = scatter.sigma, scatter.dof
    pk = min(upper - scatter.mean, scatter.mean - lower) / (3 * sigma)
    of_mean = 1 / (9 * scatter.n) + (scatter.u_common / (3 * sigma)) ** 2
    half = float(ndtri(1 - RISK / 2)) * math.sqrt(of_mean + pk**2 / (2 * dof))
    nearer = Index(pk, (pk - half, pk + half))
    if math.isinf(upper - lower):
        return Indices(None, nearer)
    p = (upper - lower) / (6 * sigma)
    low, high = (p * math.sqrt(chdtri(dof, tail) / dof) for tail in (1 - RISK / 2, RISK / 2))
    return Indices(Index(p, (low, high)), nearer)


def looks_normal(values: Array) -> bool:
    """Whether the Anderson–Darling test at 5 % allows that values (n,), n ≥ 8, are normally distributed."""
    n = len(values)
    z = np.sort((values - values.mean()) / values.std(ddof=1))
    below, above = np.log(np.maximum(ndtr(z), 1e-300)), np.log(np.maximum(ndtr(-z[::-1]), 1e-300))
    a2 = -n - float(np.mean((2 * np.arange(1, n + 1) - 1) * (below + above)))
    return a2 * (1 + 0.75 / n + 2.25 / n**2) <= LARGEST_A2
