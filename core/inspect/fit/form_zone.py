"""The deviation of form of a surface, free of its points' noise: how wide its zone is, and between what it may be.

The residuals of a fitted surface hold its form, and the noise of points, light planes and calibrations. The form is a
smooth random field here, as large as the residuals at most, and is predicted at places all over the surface together
with the surface's parameters and all that the points' errors have in common: what a light plane that is a little off
explains as well is no form for sure. The range R of the predicted form f still holds what noise leaves of itself. How
much that is is known: the causes are drawn at random as large as they are (`core.inspect.uncertainty`) and go the way
of the residuals. With a form of the zone z and the pattern f/R that was seen, and P the prediction::

    R(z) = range of P (z f/R + noise)

The estimate is the z whose R(z) is as often above R as below, 0 where noise alone makes more; the interval of 95 % are
the z whose 95 % of R(z) hold R. A perfect surface so has the estimate 0, or one that 0 is within U of.

References
----------
Henderson, C. R., Best linear unbiased estimation and prediction under a selection model, Biometrics 31 (1975),
doi:10.2307/2529430.
Efron, Tibshirani, An introduction to the bootstrap (1993), chapter 6 (the parametric bootstrap).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial.distance import cdist

from core.inspect.causes import Cause
from core.inspect.fit.generalised import SILENT_SD, SMALLEST_FORM_MM, Generalised
from core.inspect.results import Contribution
from core.inspect.uncertainty.budget import combined
from core.inspect.uncertainty.error_sources import Sources
from core.model.arrays import Array
from core.model.directions import square_to

SPAN = 0.2
"""Length of the field over the side of a square as large as the face: what is narrower is taken for noise."""
CLOSER = 1.5
"""Its bumps are so many times closer to each other than that length."""
PRIOR = 10.0
"""Standard deviation of the field before the points are seen, over the rms of all residuals: it holds no form down."""
SMOOTHED = 0.12
"""Share of a form that smoothing may take at the rim and of its peaks, as a standard uncertainty: a fifth at most."""
DRAWS = 400
"""Of the noise: they give the ends of an interval of 95 % to 4 % of its half width."""
COVERED = 0.95
"""Of what may be, by the interval."""


@dataclass(frozen=True, eq=False, slots=True)
class FormZone:
    """Zone that holds a surface's form: its width in mm, its uncertainty, and the length in mm of the field.

    U = 2 u reaches to the farther end of the interval of 95 %.
    """

    value: float
    budget: tuple[Contribution, ...]
    length_mm: float

    @property
    def u(self) -> float:
        """Standard uncertainty in mm of the zone's width."""
        return combined(self.budget)


def form_zone(
    residuals: Array, points: Array, outward: Array, sources: Sources, fit: Generalised, design: Array, cell_mm: float
) -> FormZone:
    """Estimate from a fit's residuals the width in mm of the zone that holds the surface's form, free of noise.

    Parameters
    ----------
    residuals, points, outward
        (N,) in mm, (N, 3) in mm and unit normals (N, 3) of the points used.
    sources, fit, design
        What acts on their J stretches; the generalised fit to them, and its design (J, p).
    cell_mm
        Length of the field: narrower forms are taken for noise; 0: by the size of the face.
    """
    at = sources.mean(points)
    length = cell_mm or SPAN * _side(at, outward)
    bumps, place = _bumps(at, length)
    misfit = sources.mean(residuals)
    field = PRIOR * max(float(np.sqrt(np.mean(misfit**2))), SMALLEST_FORM_MM) * bumps
    weights = np.clip(1 - (fit.residuals / SILENT_SD) ** 2, 1e-3, None) ** 2 / fit.own**2
    others = np.hstack([field, design, sources.explained, sources.speckle])
    acting = sources.precision(weights).times(others).T
    known = np.ones(len(acting))
    known[field.shape[1] : field.shape[1] + design.shape[1]] = 0.0
    wanted = np.eye(len(known))[:, : field.shape[1]]
    of_field = cho_solve(cho_factor(acting @ others + np.diag(known)), wanted).T @ acting
    aside = design[place] @ np.linalg.pinv(design[place])  # the surface itself is no form
    to_places = (np.eye(len(place)) - aside) @ field[place]
    predict = to_places @ of_field
    pattern = to_places @ (of_field @ misfit)
    seen = max(float(np.ptp(pattern)), 1e-12)
    value, farthest = _zone(seen, predict @ (field @ (of_field @ misfit)) / seen, _drawn(predict, sources, fit))
    rows = Contribution(Cause.FORM_NOISE, farthest / 2), Contribution(Cause.FORM_SMOOTHED, SMOOTHED * value)
    return FormZone(value, rows, length)


def _bumps(at: Array, length: float) -> tuple[Array, NDArray[np.intp]]:
    """(J, C) how far each of C bumps reaches to the stretches `at` (J, 3), their squares summing to 1; (C,) where."""
    cell = np.floor((at - at.min(axis=0)) * CLOSER / length).astype(np.int64)
    place = np.unique(cell, axis=0, return_index=True)[1]
    bumps = np.exp(-0.5 * (cdist(at, at[place]) / length) ** 2)
    return bumps / np.linalg.norm(bumps, axis=1)[:, None], place


def _side(at: Array, outward: Array) -> float:
    """Side in mm of a square as large as the surface that the stretches (J, 3) cover, seen along its mean normal."""
    flat = at @ square_to(outward.mean(axis=0) / np.linalg.norm(outward.mean(axis=0)))
    spreads = np.sqrt(np.maximum(np.linalg.eigvalsh(np.cov(flat.T)), 1e-12))
    return float(np.sqrt(12.0 * spreads[0] * spreads[1]))


def _drawn(predict: Array, sources: Sources, fit: Generalised) -> Array:
    """(C, DRAWS) what `predict` (C, J) makes of errors of the stretches, drawn from all causes."""
    rng = np.random.default_rng(0)
    shared = np.hstack([sources.speckle, sources.sweeps, sources.common, sources.below])
    alone = fit.own[:, None] * rng.normal(size=(len(fit.own), DRAWS))
    return np.asarray(predict @ alone + (predict @ shared) @ rng.normal(size=(shared.shape[1], DRAWS)))


def _zone(seen: float, pattern: Array, noise: Array) -> tuple[float, float]:
    """The estimate of the zone's width, and how far the farther end of its interval is from it.

    `seen` is the range of the predicted form; `pattern` (C,) is what is predicted of it again at a width of 1 mm, and
    `noise` (C, DRAWS) what is predicted of noise alone.
    """

    def at_quantile(share: float, seen: float = seen) -> float:
        """The width z with which this share of R(z) is below the observed range; 0 where it is for no z ≥ 0."""
        low, high = 0.0, 4 * seen + float(np.ptp(noise, axis=0).max())
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            ranges = np.ptp(middle * pattern[:, None] + noise, axis=0)
            low, high = (middle, high) if float(np.quantile(ranges, share)) < seen else (low, middle)
        return (low + high) / 2 if low > 0 else 0.0

    value = at_quantile(0.5)
    # A range that is below what noise makes of itself in the middle is chance, and says no more than that one does.
    typical = max(seen, float(np.median(np.ptp(noise, axis=0))))
    ends = at_quantile((1 + COVERED) / 2), at_quantile((1 - COVERED) / 2, typical)
    return value, max(ends[1] - value, value - ends[0])


_HALVINGS = 20
"""They tell the width to a millionth of the range."""
