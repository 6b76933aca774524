"""Least squares with the true covariance of the points: what they share is known, not averaged away.

With the errors of `core.inspect.uncertainty.error_sources` everything but a stretch's own noise is common to many
stretches and few in number, so the generalised least-squares estimate of β comes from one small system in which the
common errors are unknowns with a prior (the same as inverting the full covariance, by Woodbury's identity). The light
planes of the sweeps, the most of them, are taken out beforehand (`error_sources.Precision`).

What nothing has measured, such as the change of the rig since its calibration, is no error that the points may be
asked for at the price of their noise: a fit that makes up for an assumed error follows the noise of whatever shows it.
So the robust weights, the own noise and the form come from what is measured. Then what is assumed takes part with the
largest share of its assumed size, 0 to 1, with which noise acts at most NOISE_FOR_ASSUMED times as much on what is
wanted as without it. All of its size counts in the uncertainty.

How large the form is, and whether own noise is larger than stated, is found from the residuals: variance components,
each by its sum of squares over its redundancy.

References
----------
Henderson, C. R., Best linear unbiased estimation and prediction under a selection model, Biometrics 31 (1975),
doi:10.2307/2529430.
Förstner, W., Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten, AVN 86 (1979) 446.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from core.inspect.uncertainty.error_sources import Sources
from core.model.arrays import Array
from core.model.positive_definite import inverse_root

SILENT_SD = 6.0
"""Limit of Tukey's biweight: a stretch this many of its own standard deviations off has no weight left, but 1e-6.

Wider than `core.model.robust.TUKEY`, as the weights also serve to find how large own noise is: of normal residuals
their mean square comes out 11 % too small with 6, and 17 % with 4.685 (by integration). The estimate is 98 % efficient.
"""
NOISE_FOR_ASSUMED = 1.2
"""So many times as much as without it noise may act on the result where the fit makes up for what is only assumed."""
HALVINGS = 8
"""Of the interval in which the share of what is assumed is looked for, from LEAST_SHARE to 1 by its logarithm."""
LEAST_SHARE = 1e-3
"""Of its assumed size: with less it takes no part."""
ROUNDS = 10
"""Of weights and variance components, at most; it ends as soon as the form changes by less than a twentieth."""
PRIOR_FREEDOM = 10.0
"""Belief in the stated noise, counted in stretches: few of them cannot overthrow it."""
SMALLEST_FORM_MM, LARGEST_FORM_MM = 1e-4, 0.5
"""Standard deviation of a patch: never zero, which could not grow again; above, it is no face that is fitted."""


@dataclass(frozen=True, eq=False, slots=True)
class Generalised:
    """Solution of a generalised least-squares fit: the estimate of β and the standard deviations found with it.

    Parameters
    ----------
    estimate
        (p,) of β.
    gains
        (p, J) by which β follows the stretches' misfits.
    own
        (J,) standard deviations in mm of the stretches' own noise, as large as the residuals show.
    form_mm
        Standard deviation of a patch beyond all that is named.
    residuals
        (J,) misfits less model and measured common errors, in their own standard deviations.
    """

    estimate: Array
    gains: Array
    own: Array
    form_mm: float
    residuals: Array


def generalised_fit(design: Array, misfit: Array, sources: Sources, wanted: Array | None = None) -> Generalised:
    """Fit parameters β to `misfit` (J,) in mm = `design` (J, p) · β by robust generalised least squares.

    The noise of `wanted` (q, p) · β limits how far what is only assumed takes part; None: that of each of β.
    """
    others = np.hstack([design, sources.measured, sources.speckle, sources.form])
    fixed, forms = design.shape[1], slice(others.shape[1] - sources.form.shape[1], others.shape[1])
    prior = np.repeat([0.0, 1.0], [fixed, others.shape[1] - fixed])
    weights, factor, scale = np.ones(len(misfit)), np.ones(2), np.ones(others.shape[1])
    group = sources.of_fan.astype(np.int64)
    form = float(np.clip(np.median(sources.own), SMALLEST_FORM_MM, LARGEST_FORM_MM))
    for _ in range(ROUNDS):
        own = sources.own * np.sqrt(factor[group])
        weight, scale[forms] = weights / own**2, form
        columns, precision = others * scale, sources.precision(weight)
        acting = precision.times(columns).T
        root = inverse_root(acting @ columns + np.diag(prior))
        solution = root.T @ (root @ (acting @ misfit))
        residuals = precision.times((misfit - columns @ solution)[:, None])[:, 0] / (weight * own)
        variances = (root**2).sum(axis=0)
        form_before, form = form, _form(form, solution[forms], variances[forms])
        left = (precision.diagonal - ((root @ acting) ** 2).sum(axis=0)) / weight  # redundancy of each stretch
        for number in range(2):
            mine = group == number
            spent = float((1 - left[mine]).sum())
            factor[number] = max(1.0, factor[number] * _variance_factor(weights[mine], residuals[mine], spent))
        weights = np.clip(1 - (residuals / SILENT_SD) ** 2, 1e-3, None) ** 2
        if abs(form - form_before) < 0.05 * form + SMALLEST_FORM_MM:
            break
    gains = (root.T @ root[:, :fixed]).T @ acting
    assumed = sources.common[:, sources.assumed & ~sources.unexplained]
    if not assumed.shape[1]:
        return Generalised(solution[:fixed], gains, own, form_before, residuals)
    wanted = np.eye(fixed) if wanted is None else wanted

    def noise(gains: Array) -> Array:
        of_wanted = wanted @ gains
        of_fan, of_planes = of_wanted @ sources.speckle, (of_wanted @ sources.on_planes) @ sources.by_own_noise
        acting = np.hstack([of_wanted * own, of_fan, of_planes])
        return np.asarray(np.linalg.norm(acting, axis=1), dtype=np.float64)

    columns = np.hstack([design, assumed, columns[:, fixed:]])
    acting = precision.times(columns).T
    gains = _with_assumed(acting @ columns, acting, gains, assumed.shape[1], noise)
    return Generalised(gains @ misfit, gains, own, form_before, residuals)


def _with_assumed(
    information: Array, acting: Array, gains: Array, assumed: int, noise: Callable[[Array], Array]
) -> Array:
    """`gains` (p, J) where what is `assumed`, after the p estimates, takes part as far as `noise` of gains (q,) allows.

    `acting` (n, J) is Dᵀ M of all unknowns, `information` (n, n) is Dᵀ M D.
    """
    fixed = len(gains)
    of_estimate = np.eye(len(information))[:, :fixed]
    prior = np.repeat([0.0, 1.0], [fixed, len(information) - fixed])

    def with_share(share: float) -> Array:
        prior[fixed : fixed + assumed] = share**-2.0
        return np.asarray(cho_solve(cho_factor(information + np.diag(prior)), of_estimate).T @ acting)

    most, low, high = NOISE_FOR_ASSUMED * noise(gains), math.log(LEAST_SHARE), 0.0
    share = high
    for _ in range(HALVINGS):
        found = with_share(math.exp(share))
        if (noise(found) <= most).all():
            low, gains = share, found
        else:
            high = share
        if low == high:
            break
        share = (low + high) / 2
    return gains


def _form(form: float, solution: Array, variances: Array) -> float:
    """The form's standard deviation again, from what the patches (in units of it) came out as and their redundancy."""
    patches = len(solution)
    known = patches - float(variances.sum())
    grown = float(solution @ solution) / max(known, 1e-3)
    return float(np.clip(form * np.sqrt(grown), SMALLEST_FORM_MM, LARGEST_FORM_MM))


def _variance_factor(weights: Array, residuals: Array, spent: float) -> float:
    """Sum of squares over redundancy, held to 1 by PRIOR_FREEDOM further residuals of expected size."""
    freedom = max(float(weights.sum()) - spent, 0.0)
    return (float(weights @ residuals**2) + PRIOR_FREEDOM) / (freedom + PRIOR_FREEDOM)
