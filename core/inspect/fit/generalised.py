"""Least squares with the true covariance of the points: what they share is known, not averaged away.

With the errors of `core.inspect.uncertainty.error_sources` everything but a stretch's own noise is common to many
stretches and
few in number, so the generalised least-squares estimate of β comes from one small system in which the common errors are
unknowns with a prior (the same as inverting the full covariance, by Woodbury's identity).

How large the form is, and whether own noise is larger than stated, is found from the residuals: variance components,
each by its sum of squares over its redundancy.

References
----------
Henderson, C. R., Best linear unbiased estimation and prediction under a selection model, Biometrics 31 (1975),
doi:10.2307/2529430.
Förstner, W., Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten, AVN 86 (1979) 446.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from core.inspect.uncertainty.error_sources import Sources
from core.model.arrays import Array

SILENT_SD = 6.0
"""Limit of Tukey's biweight: a stretch this many of its own standard deviations off has no weight left, but 1e-6.

Wider than `core.model.robust.TUKEY`, as the weights also serve to find how large own noise is: of normal residuals
their mean square comes out 11 % too small with 6, and 17 % with 4.685 (by integration). The estimate is 98 % efficient.
"""
ROUNDS = 10
"""Of weights and variance components, at most; it ends as soon as the form changes by less than a twentieth."""
PRIOR_FREEDOM = 10.0
"""Belief in the stated noise, counted in stretches: few of them cannot overthrow it."""
SMALLEST_FORM_MM, LARGEST_FORM_MM = 1e-4, 0.5
"""Standard deviation of a patch: never zero, which could not grow again; above, it is no face that is fitted."""


@dataclass(frozen=True, eq=False, slots=True)
class Generalised:
    """The solution.

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
        (J,) misfits less model and common errors, in their own standard deviations.
    """

    estimate: Array
    gains: Array
    own: Array
    form_mm: float
    residuals: Array


def generalised_fit(design: Array, misfit: Array, sources: Sources) -> Generalised:
    """Robust generalised least squares of `misfit` (J,) = `design` (J, p) · β with the errors of `sources`."""
    effects = np.hstack([sources.speckle, sources.sweeps, sources.explained, sources.form])
    fixed, first_form = design.shape[1], effects.shape[1] - sources.form.shape[1]
    weights, factor = np.ones(len(misfit)), np.ones(2)
    group = sources.of_fan.astype(np.int64)
    form = float(np.clip(np.median(sources.own), SMALLEST_FORM_MM, LARGEST_FORM_MM))
    for _ in range(ROUNDS):
        own = sources.own * np.sqrt(factor[group])
        root = np.sqrt(weights) / own
        effects[:, first_form:] = form * sources.form
        columns = np.hstack([design, effects]) * root[:, None]
        of_group = [columns[group == number].T @ columns[group == number] for number in range(2)]
        information = of_group[0] + of_group[1]
        information[np.diag_indices(len(information))] += np.repeat([0.0, 1.0], [fixed, effects.shape[1]])
        inverse = cho_solve(cho_factor(information), np.eye(len(information)))
        solution = inverse @ (columns.T @ (misfit * root))
        residuals = (misfit - design @ solution[:fixed] - effects @ solution[fixed:]) / own
        form_before, form = form, _form(form, solution[fixed + first_form :], inverse[fixed + first_form :])
        for number in range(2):
            mine = group == number
            spent = float(np.sum(inverse * of_group[number]))
            factor[number] = max(1.0, factor[number] * _variance_factor(weights[mine], residuals[mine], spent))
        weights = np.clip(1 - (residuals / SILENT_SD) ** 2, 1e-3, None) ** 2
        if abs(form - form_before) < 0.05 * form + SMALLEST_FORM_MM:
            break
    gains = inverse[:fixed] @ (columns * root[:, None]).T
    return Generalised(solution[:fixed], gains, own, form_before, residuals)


def _form(form: float, solution: Array, inverse: Array) -> float:
    """The form's standard deviation again, from what the patches (in units of it) came out as and their redundancy."""
    patches = len(solution)
    known = patches - float(inverse[:, -patches:].trace())
    grown = float(solution @ solution) / max(known, 1e-3)
    return float(np.clip(form * np.sqrt(grown), SMALLEST_FORM_MM, LARGEST_FORM_MM))


def _variance_factor(weights: Array, residuals: Array, spent: float) -> float:
    """Sum of squares over redundancy, held to 1 by PRIOR_FREEDOM further residuals of expected size."""
    freedom = max(float(weights.sum()) - spent, 0.0)
    return (float(weights @ residuals**2) + PRIOR_FREEDOM) / (freedom + PRIOR_FREEDOM)
