"""How much a rig changes between its checks, by what these have shown: a factor on its stability by default.

Each check gives normal equations N x = g of x = (z, m), the calibrations' errors and the changes since then
(`core.calibrate.change`). If the rig changes t times as much as by default, with S = diag(1, t² s²), the logarithm of
their likelihood is, but for a constant::

    l(t) = ½ gᵀ (N + S⁻¹)⁻¹ g − ½ ln det(1 + N S)

Those of checks on different days add up, and with a prior about t = 1 give t. One factor is common to turn, shift,
drift of the picture and focal length, whose proportions stay as by default: few checks could not tell them apart. The
calibrations' errors, the same in each check, are looked for anew in each: that leaves a little more to t.

References
----------
Rasmussen, C. E., Williams, C. K. I., Gaussian Processes for Machine Learning (2006), 5.4.1 (marginal likelihood).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.calibrate.change import DEFAULT_STABILITY, Evidence, Stability
from core.calibrate.deviations import UNEXPLAINED, Deviation
from core.model.arrays import Array

FACTORS = 2.0 ** (0.5 * np.arange(-8, 9))
"""(F,) Factors t that are looked at."""


def log_likelihoods(deviations: Sequence[Deviation], evidence: Evidence) -> Array:
    """Compute the log-likelihood (F,) of a check for each of FACTORS on the default stability."""
    of_change = np.array([one.source == "change" for one in deviations], dtype=np.bool_)
    sd = np.array([one.source != UNEXPLAINED for one in deviations], dtype=np.float64)
    likelihoods = []
    for factor in FACTORS:
        sd[of_change] = factor * DEFAULT_STABILITY.over_default
        scaled = sd * evidence.gradient
        square = np.eye(len(sd)) + evidence.information * np.outer(sd, sd)
        likelihoods.append(0.5 * (scaled @ np.linalg.solve(square, scaled) - np.linalg.slogdet(square)[1]))
    return np.array(likelihoods)


def stability_by_pictures(
    deviations: Sequence[Deviation], evidence: Evidence, guess: Stability = DEFAULT_STABILITY
) -> Stability:
    """Estimate the stability of a rig from its scan's pictures, where none is stated and no check has passed.

    The default is known to a factor of two only, and a rig that has changed more than most shows a little of it in each
    scan. It is the default times the root of the mean square of t, given the pictures, and no less than the default:
    they may not see what changed. Where they say nothing it is the default. Another `guess` grows by the same.
    """
    if not evidence.information.any():
        return guess
    weight = _weights(log_likelihoods(deviations, evidence), 1.0)
    return guess.times(*[max(1.0, float(np.sqrt(weight @ FACTORS**2)))] * 4)


def most_likely_factor(likelihoods: Array, about: float = 1.0) -> float:
    """Estimate a rig's factor on the default stability from the log-likelihoods (n, F) of n checks.

    `about` is the guess before any check.

    Before any check it is within a factor of two of that (one standard deviation): default and statement are honest
    guesses.
    """
    return float(np.exp(_weights(np.sum(likelihoods, axis=0), about) @ np.log(FACTORS)))


def _weights(likelihoods: Array, about: float) -> Array:
    """Probability (F,) of each factor by the logarithms (F,) of their likelihoods and the prior `about` one."""
    log = likelihoods - 0.5 * np.log2(FACTORS / about) ** 2
    weight = np.exp(log - log.max())
    return np.asarray(weight / weight.sum())
