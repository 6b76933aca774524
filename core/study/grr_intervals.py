"""Variance components of a gauge R&R study and how surely they are known: generalised confidence intervals.

Each mean square is its expectation times χ²_ν/ν. So a draw θ* = ν MS / χ²_ν of each, put into the formulas of the
components, is a generalised pivotal quantity of any function of them (%GRR, ndc); the 2.5 % and 97.5 % quantiles of
many draws bound it. For the repeatability that is the exact χ² interval. The draws are seeded: the same study, the same
bounds.

References
----------
Hamada, Weerahandi, Measurement system assessment via generalized inference, Journal of Quality Technology 32 (2000)
241.
Burdick, Borror, Montgomery, Design and analysis of gauge R&R studies, SIAM 2005, chapter 3 and appendix B,
doi:10.1137/1.9780898718379.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from core.model.arrays import Array

Interval: TypeAlias = tuple[float, float]

DRAWS = 40_000
TAIL = 0.025


@dataclass(frozen=True, eq=False, slots=True)
class GrrIntervals:
    """Variances by source, and their 95 % intervals; those of %GRR of total and of T (fractions); ndc and its own."""

    estimates: Mapping[str, float]
    variances: Mapping[str, Interval]
    of_total: Interval
    of_tolerance: Interval | None
    ndc: float
    categories: Interval


def intervals(
    squares: Mapping[str, tuple[float, int]], shape: tuple[int, ...], tolerance: float | None, seed: int = 0
) -> GrrIntervals:
    """Components and intervals from mean squares.

    Parameters
    ----------
    squares
        Mean square and degrees of freedom of "parts", "error", and, where they are in the model, "operators" and
        "interaction".
    shape
        (p, o, r): parts, operators, repeats.
    tolerance
        Its full width T; None if there is none.
    seed
        Of the draws.
    """
    rng = np.random.default_rng(seed)
    estimates = {
        source: float(value[0])
        for source, value in components({k: np.array([v[0]]) for k, v in squares.items()}, shape).items()
    }
    drawn = components({source: ms * dof / rng.chisquare(dof, DRAWS) for source, (ms, dof) in squares.items()}, shape)
    grr, part = estimates["gauge R&R"], estimates["parts"]
    with np.errstate(divide="ignore"):
        ratio = np.sqrt(drawn["gauge R&R"] / drawn["total"])
        categories = np.sqrt(2 * drawn["parts"] / drawn["gauge R&R"])
    return GrrIntervals(
        estimates,
        {source: _bounds(values) for source, values in drawn.items()},
        _bounds(ratio),
        None if tolerance is None else _bounds(6 * np.sqrt(drawn["gauge R&R"]) / tolerance),
        math.sqrt(2 * part / grr) if grr else math.inf,
        _bounds(categories),
    )


def components(squares: Mapping[str, Array], shape: tuple[int, ...]) -> dict[str, Array]:
    """Variances by source, each (n,), none below 0, from mean squares (n,); see `core.study.grr` for the formulas."""
    _, operators, repeats = shape
    error = squares["error"]
    both = squares.get("interaction", error)
    interaction = np.maximum(both - error, 0) / repeats
    operator = np.maximum(squares.get("operators", both) - both, 0) / (shape[0] * repeats)
    part = np.maximum(squares["parts"] - both, 0) / (operators * repeats)
    grr = error + operator + interaction
    return {
        "gauge R&R": grr,
        "repeatability": error,
        "reproducibility": operator + interaction,
        "operators": operator,
        "interaction": interaction,
        "parts": part,
        "total": grr + part,
    }


def _bounds(values: Array) -> Interval:
    low, high = np.quantile(values, [TAIL, 1 - TAIL])
    return float(low), float(high)
