"""The light's mean cross-section as a picture shows it, for stripes whose section is no Gaussian.

With d the distance across in stripe σ from the curve through a stripe's points, and r what the Gaussian model leaves of
a pixel, its departure at d is the mean of r over the height A, weighted by A²: what all stripes of the picture share,
for they come from one laser through one lens. A smooth spline through it, added to exp(−d²/2), is the measured section
f(d), of any shape: flat, with a halo, one-sided.

The optimal weight of each pixel for the place then is

    ψ = cov⁻¹ ∂m/∂t,    cov(d, d') = (read² + k·(B + A·f))·δ(d − d') + C²·A²·f(d)·f(d')·R(d − d')

freed of what it has in common with an offset and a slope of the background, with the stripe's height and with its
width, as `core.image.stripes.likelihood.influence` has it for a Gaussian, where height, offset and width are even and
do not disturb.

A section that is not symmetric has no middle of its own: where the Gaussian likelihood and Steger's points disagree,
none is measured. On photographs of one line, kept as JPEG without saying so, one-sided sections made the points scatter
by 0.10 mm about their plane instead of 0.08.

References
----------
Eilers, P. H. C., Marx, B. D., Flexible smoothing with B-splines and penalties, Statistical Science 11 (1996),
doi:10.1214/ss/1038425655: the spline.
Kay, S. M., Fundamentals of Statistical Signal Processing: Estimation Theory (1993), §6: the weights.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, CubicSpline

from core.compiled import compiled
from core.image.stripes.likelihood.cut_model import TAIL, Light, cut_model
from core.image.stripes.likelihood.influence import REACH
from core.image.stripes.noise import NoiseModel
from core.image.stripes.section_fit import exp_negative
from core.image.stripes.speckle import Speckle
from core.image.stripes.tracing.pixel_state import IGNORED, SATURATED
from core.image.stripes.tracing.seeds import Picture
from core.model.arrays import Array

PLACES_PER_SIGMA = 32
"""Of the tables that a section and its weights are read from, on straight lines between them: errs by 1e-4."""
PLACES = 2 * round(REACH * PLACES_PER_SIGMA) + 1
"""Of these tables, from −REACH to REACH."""
GROUPS = 16
"""Stretches of the stripes that are averaged apart: their scatter tells how well a section is known."""

# Held by tests/image/stripes/likelihood/test_measured_section.py.
_SEEN = 5.0  # stripe σ on either side that are averaged: more than is used, for the spline's sake
_BINS_PER_SIGMA = 5
BINS = 2 * round(_SEEN * _BINS_PER_SIGMA)
"""Of the distance across, that pixels are averaged in."""
_KNOTS_PER_SIGMA = 2.5  # of the spline; a pixel blurs what is finer
_PENALTY = 1e-2  # of third differences of its coefficients, over the mean weight of a bin
_ROUGH = 0.2
"""Of speckle's contrast, that pixels have each its own: finer than speckle's grains nothing of a section is known so
well as weights would believe it. Without it, super-Gaussian sections under speckle scatter by 1.25 of the bound instead
of 1.06; at twice as much nothing changes."""
_SOLVED_EVERY = 4  # place of the tables: weights are solved for there, on cubics between
_HEIGHT_CLASS = 0.3  # logarithm of the height: the weights of sections within this step are the same
_JUDGED = 3.5  # stripe σ within which a departure is looked for
_LEAST_DEPARTURE, _SURELY = 0.004, 5.0  # of the height, in a bin; and in standard errors
_LEAST_BINS = 2  # that depart so
_LEAST_SEEN = 0.7  # of the bins there must have pixels


@compiled(fastmath=True)
def add_departures(
    picture: Picture,
    state: NDArray[np.uint8],
    run: Array,
    cuts: Array,
    clear: NDArray[np.bool_],
    light: Light,
    part: tuple[int, int, int],
    sums: Array,
) -> None:
    """Add to `sums` (GROUPS, 3, BINS) what a Gaussian section leaves of a stripe's grey levels: Σ A·r, Σ A², Σ A²·d.

    Parameters
    ----------
    picture, state, run, cuts, clear, light
        As `core.image.stripes.likelihood.scores.score_cuts` has them.
    part
        Number of the first cut among those of all stripes, how many these have, and of how many one is looked at.
    """
    first, total, every = part
    rows, columns = picture.shape
    for c in range(0, len(cuts), every):
        line, place, near, upright = int(cuts[c, 1]), cuts[c, 2], int(cuts[c, 3]), cuts[c, 4] > 0
        if not clear[near] or light.sections[near, 0] <= 0:
            continue
        model = cut_model(run, light, near, upright)
        lines, length = (rows, columns) if upright else (columns, rows)
        half = _SEEN * model.width / abs(model.across)
        begin, end = math.ceil(place - half), math.floor(place + half)
        if line < 0 or line >= lines or begin < 0 or end >= length:
            continue
        group = sums[min((first + c) * GROUPS // total, GROUPS - 1)]
        square = model.height * model.height
        for i in range(begin, end + 1):
            mark = state[line, i] if upright else state[i, line]
            if mark & (SATURATED | IGNORED):
                continue
            grey = picture[line, i] if upright else picture[i, line]
            along = i - place
            power = along * (2 * model.across - model.bend * along)
            turn = model.bend * power
            x = power * (0.5 + turn * (0.125 + 0.0625 * turn))
            d = x / model.width * (1 - model.widening * along)
            if abs(d) >= _SEEN:
                continue
            bright = exp_negative(0.5 * d * d) * (1 + model.fade * along)
            left = grey - model.background - model.slope * x - model.height * bright
            if abs(d) > TAIL and left * left > model.other + model.per_light * bright:
                continue
            k = min(int((d + _SEEN) * _BINS_PER_SIGMA), BINS - 1)
            group[0, k] += model.height * left
            group[1, k] += square
            group[2, k] += square * d


@compiled()
def departs(sums: Array) -> bool:
    """Whether the mean section of stripes surely is no Gaussian, by the `sums` of `add_departures`."""
    found = 0
    for k in range(round((_SEEN - _JUDGED) * _BINS_PER_SIGMA), BINS // 2):
        light, weight = 0.0, 0.0
        for g in range(GROUPS):
            light += sums[g, 0, k] + sums[g, 0, BINS - 1 - k]
            weight += sums[g, 1, k] + sums[g, 1, BINS - 1 - k]
        if weight <= 0:
            continue
        mean, scatter = light / weight, 0.0
        if abs(mean) < _LEAST_DEPARTURE:
            continue
        for g in range(GROUPS):
            own = sums[g, 0, k] + sums[g, 0, BINS - 1 - k] - mean * (sums[g, 1, k] + sums[g, 1, BINS - 1 - k])
            scatter += own * own
        found += abs(light) > _SURELY * math.sqrt(scatter * GROUPS / (GROUPS - 1))
    return found >= _LEAST_BINS


class Surroundings(NamedTuple):
    """Surroundings of a section: background in grey levels, σ of the stripe in px, noise, speckle, filter σ in px."""

    background: float
    width_px: float
    noise: NoiseModel
    speckle: Speckle
    filter_px: float


@dataclass(frozen=True, eq=False, slots=True)
class Weights:
    """Optimal weights ψ at the places of the tables (PLACES,), and at those that were solved for (S,).

    `speckle_share` is that of speckle in the variance, `variance` that of the place, in px² for 1 px of stripe.
    """

    table: Array
    solved: Array
    speckle_share: float
    variance: float


@dataclass(frozen=True, eq=False)
class Section:
    """Section f(d) of a stripe and its push −f'(d) at the places of the tables (PLACES,), seen in these `surroundings`.

    It is the mean of both sides: d = 0 is its middle.
    """

    value: Array
    push: Array
    surroundings: Surroundings
    _known: dict[int, Weights] = field(default_factory=dict)

    def weights(self, height: float) -> Weights:
        """Compute the optimal weights of pixels across a stripe of about this height in grey levels."""
        return self._of_level(round(math.log(max(height, 1e-3)) / _HEIGHT_CLASS))

    def weights_along(self, height: Array) -> tuple[NDArray[np.int64], list[Weights]]:
        """Compute optimal pixel weights for stripe heights (N,): index (N,) into a list of weights, and that list."""
        levels, kind = np.unique(np.round(np.log(np.maximum(height, 1e-3)) / _HEIGHT_CLASS), return_inverse=True)
        return kind.astype(np.int64), [self._of_level(int(level)) for level in levels]

    def _of_level(self, level: int) -> Weights:
        if level not in self._known:
            self._known[level] = self._solve(math.exp(_HEIGHT_CLASS * level))
        return self._known[level]

    def variance_by(self, psi: Array, height: float) -> float:
        """Compute the variance in px² of a stripe's place by 1 px of its length, pixels weighted by `psi` (S,)."""
        derivative, covariance, strip = self._model(height)
        return float(psi @ covariance @ psi) / (strip * float(psi @ derivative)) ** 2

    @property
    def tables(self) -> NDArray[np.float32]:
        """Tables (2, PLACES) of the section f(d) and of its negative derivative −f'(d) across the stripe."""
        return np.stack([self.value, self.push]).astype(np.float32)

    def _model(self, height: float) -> tuple[Array, Array, float]:
        """Derivative (S,) by the place, per px; covariance (S, S) of strips across, times their width², and that."""
        _, width, _, speckle, _ = self.surroundings
        d, strip = _solved_places(), width * _SOLVED_EVERY / PLACES_PER_SIGMA
        light = height * np.maximum(self.value[::_SOLVED_EVERY] - self._level, 0.0)
        rough = (_ROUGH * speckle.contrast * light) ** 2
        covariance = np.diag(strip * (self._white(height) + rough))
        if speckle.contrast > 0:
            apart = (d[:, None] - d) * (width / speckle.grain_px)
            grains = math.sqrt(math.pi) * speckle.grain_px * np.exp(-(apart**2))
            covariance += (speckle.contrast * strip) ** 2 * np.outer(light, light) * grains
        return height / width * self.push[::_SOLVED_EVERY], covariance, strip

    def _solve(self, height: float) -> Weights:
        derivative, covariance, strip = self._model(height)
        d = _solved_places()
        unwanted = [np.ones_like(d), d, self.value[::_SOLVED_EVERY], d * self.push[::_SOLVED_EVERY]]
        unknowns = strip * np.column_stack([derivative, *unwanted])
        solved = np.linalg.solve(covariance, unknowns)
        information = unknowns.T @ solved
        best = solved[:, 0] - solved[:, 1:] @ np.linalg.solve(information[1:, 1:], information[1:, 0])
        told = float(best @ unknowns[:, 0])
        white = strip * float(best**2 @ self._white(height))
        return Weights(np.asarray(CubicSpline(d, best)(_places())), best, 1 - white / told, 1 / told)

    @cached_property
    def _level(self) -> float:
        """What the section ends in on either side: a Gaussian's fit took the background for so much darker."""
        return float(np.mean(self.value[[0, -1]]))

    def _white(self, height: float) -> Array:
        """Variance (S,) of read and shot noise."""
        return self.surroundings.noise.variance(self.surroundings.background + height * self.value[::_SOLVED_EVERY])


def gaussian_section(surroundings: Surroundings) -> Section:
    """Make the Gaussian section exp(−d²/2), with which measured sections are compared."""
    d = _places()
    value = np.exp(-0.5 * d * d)
    return Section(value, d * value, surroundings)


def section_from(sums: Array, surroundings: Surroundings) -> Section | None:
    """Fit the mean section of stripes to the `sums` (3, BINS) of `add_departures`; None if too little of it is seen."""
    light, weight, moment = sums
    judged = np.abs(np.arange(BINS) + 0.5 - BINS / 2) < _JUDGED * _BINS_PER_SIGMA
    if np.count_nonzero(weight[judged]) < _LEAST_SEEN * np.count_nonzero(judged):
        return None
    seen = weight > 0
    knots, penalty = _spline()
    basis = BSpline.design_matrix(np.clip(moment[seen] / weight[seen], -_SEEN, _SEEN), knots, 3).toarray()
    share = weight[seen] / weight[seen].mean()
    normal = basis.T @ (share[:, None] * basis) + _PENALTY * penalty
    coefficients = np.linalg.solve(normal, basis.T @ (share * light[seen] / weight[seen]))
    departure, d = BSpline(knots, (coefficients + coefficients[::-1]) / 2, 3), _places()
    gaussian = np.exp(-0.5 * d * d)
    return Section(gaussian + departure(d), d * gaussian - departure(d, 1), surroundings)


@lru_cache(maxsize=1)
def _places() -> Array:
    """The places of the tables (PLACES,), in stripe σ."""
    return np.linspace(-REACH, REACH, PLACES)


@lru_cache(maxsize=1)
def _solved_places() -> Array:
    """Those of them that weights are solved for (S,)."""
    return _places()[::_SOLVED_EVERY]


@lru_cache(maxsize=1)
def _spline() -> tuple[Array, Array]:
    """Knots of the spline, and the penalty (K, K) on its coefficients."""
    step, count = 1 / _KNOTS_PER_SIGMA, round(2 * _SEEN * _KNOTS_PER_SIGMA)
    knots = np.asarray(-_SEEN + step * np.arange(-3, count + 4), dtype=np.float64)
    third = np.diff(np.eye(count + 3), 3, axis=0)
    return knots, third.T @ third
