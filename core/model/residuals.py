"""Judgement of what a fit leaves over, in one way for every fit of the program.

Three questions are asked of residuals. Are they as large as their stated uncertainty (χ²)? Do neighbours along a line
or in a picture err together (runs of one sign)? And have all groups that err on their own (stripes, views, sweeps) one
pattern in common, along the line or over the picture, which no noise has? The last is what a model that is wrong leaves
and what more of the same pictures never averages out.

Whether a pattern is there is tested by turning the signs of whole groups round: without one, each group might as well
have come out the other way. That asks for no law of the noise, and neighbours within a group may err together.

References
----------
Winkler, A. M. et al., Permutation inference for the general linear model, NeuroImage 92 (2014) 381–397,
doi:10.1016/j.neuroimage.2014.01.060 (sign flipping).
Satterthwaite, F. E., An approximate distribution of estimates of variance components, Biometrics Bull. 2 (1946)
110–114, doi:10.2307/3002019.
Wald, A. & Wolfowitz, J., Ann. Math. Statist. 11 (1940) 147–162, doi:10.1214/aoms/1177731909 (runs).
Searle, S. R., Casella, G., McCulloch, C. E., Variance Components (1992), §7.4 (best linear unbiased prediction), §8.3
(its variance by iteration).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.special import chdtrc, fdtrc

from core.model.arrays import Array

SIGNIFICANT = 0.01
"""A pattern that turned signs show more often than this is chance."""
ENOUGH_GROUPS = 1 + math.ceil(-math.log2(SIGNIFICANT))
"""So many have turns of signs enough to tell."""
_FLIPS = 1999
"""Random turns of the groups' signs; with few groups there are no more than 2^(groups − 1)."""
_INDEPENDENT_RUN = 2.0
"""Mean number of independent residuals in a row that have one sign."""
_ROUNDS = 20
"""Of the pattern's variance: it settles within a tenth, which is better than a few dozen cells tell it."""
_ALONE = 1e-6
"""Share of the largest information on a pattern below which model and shared errors leave nothing of it."""


@dataclass(frozen=True, eq=False, slots=True)
class Residuals:
    """N residuals of one fit, observed − predicted, in any one unit.

    Parameters
    ----------
    values
        (N,) signed.
    expected
        (N,) their standard uncertainty as stated.
    group
        (N,) number of the stripe, view or sweep each is of: what errs on its own. Rows of a group stand in their order
        along it.
    cell
        (N,) number of the place along the line or in the picture, from 0.
    cells
        How many places there are, seen or not.
    """

    values: Array
    expected: Array
    group: NDArray[np.intp]
    cell: NDArray[np.intp]
    cells: int


@dataclass(frozen=True, eq=False, slots=True)
class Judgement:
    """Judgement of residuals against their stated uncertainty.

    Parameters
    ----------
    rms, expected
        Root mean squares of the residuals and of their stated uncertainty, in their unit.
    run_length
        Mean number in a row of one sign, 2 where neighbours err on their own.
    profile
        (C,) mean of all groups in each cell, NaN where nothing is.
    count
        (C,) residuals in each cell.
    p
        Probability of so strong a pattern by chance alone; 1 with too few groups to tell.
    systematic
        RMS of the pattern that groups have in common, less what chance adds to it, in the residuals' unit; 0 where
        chance explains it.
    undecided
        Whether groups too few to tell it from chance have a pattern in common: no turn of their signs shows a stronger.
    alone
        How many times as large as stated is what errs in each residual alone; NaN where shared errors are not known.
    freedom
        Degrees of freedom that `alone` is known by.
    whole
        How many times as large as stated residuals are on the whole, shared errors included and what the fit has taken
        out of them excepted; NaN where shared errors are not known.
    whole_freedom
        Degrees of freedom that `whole` is known by (a real number): few where most of it is of few shared errors.
    """

    rms: float
    expected: float
    run_length: float
    profile: Array
    count: NDArray[np.intp]
    p: float
    systematic: float
    undecided: bool = False
    alone: float = np.nan
    freedom: int = 0
    whole: float = np.nan
    whole_freedom: float = 0.0

    @property
    def times(self) -> float:
        """Ratio of the RMS of the residuals to the RMS of their stated uncertainties."""
        return self.rms / max(self.expected, 1e-300)

    @property
    def strongest(self) -> int:
        """Index of the cell whose mean is farthest from zero in units of what chance makes of so many residuals."""
        return int(np.nanargmax(np.abs(self.profile) * np.sqrt(self.count)))

    @property
    def together(self) -> float:
        """Number of neighbouring residuals that err together; 1 where each errs on its own."""
        return self.run_length / _INDEPENDENT_RUN


def judge_residuals(residuals: Residuals) -> Judgement:
    """Judge residuals by their stated uncertainty, by runs of one sign and by a pattern common to all groups."""
    values, group = residuals.values, np.unique(residuals.group, return_inverse=True)[1]
    if not len(values):
        return Judgement(np.nan, np.nan, np.nan, np.zeros(0), np.zeros(0, np.intp), 1.0, 0.0)
    groups, cells = int(group.max()) + 1, residuals.cells
    sums = np.zeros((groups, cells))
    np.add.at(sums, (group, residuals.cell), values)
    count = np.bincount(residuals.cell, minlength=cells)
    scaled = sums / np.sqrt(np.maximum(count, 1))
    seen = float((scaled.sum(axis=0) ** 2).sum())
    p, few = _chance(scaled, seen, np.random.default_rng(0)), groups < ENOUGH_GROUPS
    undecided = few and p <= 2.0 ** (1 - groups)
    p = 1.0 if few else p
    by_chance = float((scaled**2).sum())
    square = (seen - by_chance) / len(values) / (1 - 1 / max(groups, 2))
    return Judgement(
        rms=_rms(values),
        expected=_rms(residuals.expected),
        run_length=_run_length(values, group),
        profile=np.where(count > 0, sums.sum(axis=0) / np.maximum(count, 1), np.nan),
        count=count,
        p=p,
        systematic=float(np.sqrt(max(square, 0.0))) if p < SIGNIFICANT else 0.0,
        undecided=undecided,
    )


def of_vectors(
    values: Array, expected: Array, group: NDArray[np.intp], cell: NDArray[np.intp], cells: int
) -> Residuals:
    """Make residuals for judging from vectors `values` (N, 2), each coordinate with `cells` cells of its own.

    `expected` (N,) is the standard uncertainty of each coordinate; else as :class:`Residuals`.
    """
    return Residuals(
        values.T.ravel(), np.tile(expected, 2), np.tile(group, 2), np.concatenate([cell, cell + cells]), 2 * cells
    )


@dataclass(frozen=True, eq=False, slots=True)
class SharedErrors:
    """Errors that N residuals share, and the unknowns that the fit has taken out of them.

    Parameters
    ----------
    own
        (N,) standard deviation of what errs in each alone.
    shared
        (N, S) effect of S independent errors of unit variance.
    design
        (N, P) effect of the fitted parameters.
    information_of
        Gives of others (N, q) and weights W (N,) the Aᵀ W A of A = [others, `shared`], where that is known in less time
        than by multiplying all of it.
    """

    own: Array
    shared: Array
    design: Array
    information_of: Callable[[Array, Array], Array] | None = None

    def information(self, others: Array, weight: Array) -> Array:
        """Compute Aᵀ W A (q + S, q + S) of A = [`others` (N, q), `shared` (N, S)] and W = diag(`weight`)."""
        if self.information_of is not None:
            return self.information_of(others, weight)
        columns = np.hstack([others, self.shared])
        return np.asarray((columns * weight[:, None]).T @ columns)


def judge_with_shared(residuals: Residuals, errors: SharedErrors) -> Judgement:
    """Judge residuals with known shared `errors` by their stated uncertainty, and look for a pattern over the cells.

    `residuals.expected` is the whole of what is stated, shared errors included; of the judgement, `profile` is the
    likeliest pattern in the residuals' unit, drawn towards zero as far as it is unsure, and `systematic` its standard
    deviation over the cells. Where `own` is stated too small by one factor for all, the pattern is no surer for it.
    """
    values, cells = residuals.values, residuals.cell
    count = np.bincount(cells, minlength=residuals.cells)
    seen = np.flatnonzero(count)
    weight = errors.own**-2.0
    design = _independent(errors.design, errors.own)
    columns = np.hstack([design, errors.shared])
    information, free = errors.information(design, weight), design.shape[1]
    information[np.diag_indices(len(information))] += np.repeat([0.0, 1.0], [free, len(information) - free])
    factor = cho_factor(information)
    left = weight * (values - columns @ cho_solve(factor, columns.T @ (weight * values)))
    number = np.searchsorted(seen, cells)
    of_cells = np.zeros((len(columns.T), len(seen)))
    np.add.at(of_cells.T, number, columns * weight[:, None])
    of_each = np.asarray(np.bincount(number, left, minlength=len(seen)), dtype=np.float64)
    within = np.diag(np.bincount(number, weight, minlength=len(seen))) - of_cells.T @ cho_solve(factor, of_cells)
    sizes, axes = np.linalg.eigh((within + within.T) / 2)
    known = sizes > _ALONE * sizes.max(initial=1e-300)
    size, score = sizes[known], axes[:, known].T @ of_each
    rank, freedom = len(size), len(values) - free - len(size)
    of_pattern = float((score**2 / size).sum())
    alone = float(np.sqrt(max(float(values @ left) - of_pattern, 0.0) / max(freedom, 1)))
    scatter = max(alone, 1.0) ** 2
    p = float(fdtrc(rank, max(freedom, 1), of_pattern / max(rank, 1) / scatter)) if rank else 1.0
    size, score = size / scatter, score / scatter
    variance = float(np.mean(score**2 / size**2)) if rank else 0.0
    for _ in range(_ROUNDS if rank else 0):
        likeliest = score / (size + 1 / max(variance, 1e-300))
        variance = float(np.mean(likeliest**2 + 1 / (size + 1 / max(variance, 1e-300))))
    whole, whole_freedom = _whole(residuals, errors)
    profile = np.full(residuals.cells, np.nan)
    profile[seen] = axes[:, known] @ (score / (size + 1 / max(variance, 1e-300))) if rank else 0.0
    return Judgement(
        rms=_rms(values),
        expected=_rms(residuals.expected),
        run_length=_run_length(values, residuals.group),
        profile=profile,
        count=count,
        p=p,
        systematic=float(np.sqrt(variance)) if p < SIGNIFICANT else 0.0,
        alone=alone,
        freedom=max(freedom, 0),
        whole=whole,
        whole_freedom=whole_freedom,
    )


def _whole(residuals: Residuals, errors: SharedErrors) -> tuple[float, float]:
    """How many times as large as stated the residuals are on the whole, and the degrees of freedom it is known by.

    In units of what is stated of each, y = ε + S ζ has the covariance V; of it the fit leaves M y, M the projector off
    its parameters. The sum of squares has the mean tr MV and the variance 2 tr (MV)², as a χ² of (tr MV)² / tr (MV)²
    degrees of freedom has, times a factor.
    """
    unit = residuals.expected
    fitted = np.linalg.qr(_independent(errors.design / unit[:, None], errors.own / unit))[0]

    def left(values: Array) -> Array:
        return np.asarray(values - fitted @ (fitted.T @ values))

    own, shared = (errors.own / unit) ** 2, errors.shared / unit[:, None]
    of_fit = fitted.T @ shared
    shared -= fitted @ of_fit
    together = errors.information(np.zeros((len(unit), 0)), unit**-2.0) - of_fit.T @ of_fit
    mean = float(own.sum() - own @ (fitted**2).sum(axis=1) + together.trace())
    crossed = (fitted * own[:, None]).T @ fitted
    square = float(own @ own - 2 * (own**2) @ (fitted**2).sum(axis=1) + (crossed**2).sum())
    square += float(2 * own @ (shared**2).sum(axis=1) + (together**2).sum())
    if mean <= 0 or square <= 0:
        return np.nan, 0.0
    return float(np.sqrt((left(residuals.values / unit) ** 2).sum() / mean)), mean**2 / square


def _independent(design: Array, own: Array) -> Array:
    """(N, at most P) directions that span the effect (N, P) of fitted parameters, of unit size in terms of `own` (N,).

    Few residuals, or all of one line, may leave parameters undetermined.
    """
    relative = design / own[:, None]
    directions, sizes, _ = np.linalg.svd(
        relative / np.maximum(np.linalg.norm(relative, axis=0), 1e-300), full_matrices=False
    )
    return np.asarray(directions[:, sizes > _ALONE * sizes.max(initial=1e-300)] * own[:, None])


def judge_with_covariance(residuals: Residuals, covariance: Array) -> Judgement:
    """Judge residuals by their `covariance` (N, N), and look for a pattern over the cells beyond it.

    For few residuals which hang together in any way, such as what a fit has estimated of errors with a prior.
    `residuals.expected` is not asked for anything that `covariance` says.
    """
    values, cells = residuals.values, residuals.cell
    count = np.bincount(cells, minlength=residuals.cells)
    seen = np.flatnonzero(count)
    means = (cells == seen[:, None]) / count[seen, None]
    profile, noise = means @ values, means @ covariance @ means.T
    size, axes = np.linalg.eigh((noise + noise.T) / 2)
    known = size > _ALONE * size.max(initial=1e-300)
    of_pattern = float(((axes[:, known].T @ profile) ** 2 / size[known]).sum())
    p = float(chdtrc(np.count_nonzero(known), of_pattern)) if known.any() else 1.0
    square = float(np.mean(profile**2) - np.trace(noise) / len(seen)) if len(seen) else 0.0
    of_all = np.full(residuals.cells, np.nan)
    of_all[seen] = profile
    return Judgement(
        rms=_rms(values),
        expected=float(np.sqrt(np.trace(covariance) / max(len(values), 1))),
        run_length=_run_length(values, residuals.group),
        profile=of_all,
        count=count,
        p=p,
        systematic=float(np.sqrt(max(square, 0.0))) if p < SIGNIFICANT else 0.0,
    )


def along_line(place: Array, cells: int) -> NDArray[np.intp]:
    """Number places (N,) along a line by equal parts of it: 0 … `cells` − 1 from first to last place."""
    low, high = float(place.min()), float(place.max())
    return _cell((place - low) / max(high - low, 1e-300), cells)


def without_line(place: Array, values: Array) -> Array:
    """Subtract from `values` (N,) the straight line fitted to them over `place` (N,)."""
    off = place - place.mean()
    slope = float(off @ values) / max(float(off @ off), 1e-300)
    return np.asarray(values - values.mean() - slope * off, dtype=np.float64)


def over_picture(uv: Array, size: tuple[int, int], grid: tuple[int, int]) -> NDArray[np.intp]:
    """Find the index (N,) of the cell, in a `grid` (columns, rows) over the picture, that each `uv` (N, 2) is in."""
    columns = _cell((uv[:, 0] + 0.5) / size[0], grid[0])
    return columns + grid[0] * _cell((uv[:, 1] + 0.5) / size[1], grid[1])


def _cell(share: Array, cells: int) -> NDArray[np.intp]:
    return np.asarray(np.clip(np.floor(share * cells), 0, cells - 1), dtype=np.intp)


def _chance(scaled: Array, seen: float, rng: np.random.Generator) -> float:
    """Share of turned signs of the groups (G, C) that show as strong a pattern as was seen."""
    groups = len(scaled)
    if 2 ** (groups - 1) <= _FLIPS:
        signs = 1.0 - 2.0 * ((np.arange(2 ** (groups - 1))[:, None] >> np.arange(groups)) & 1)
        extra = 0
    else:
        signs = rng.choice([-1.0, 1.0], (_FLIPS, groups))
        extra = 1  # the signs as they were seen
    strength = ((signs @ scaled) ** 2).sum(axis=1)
    return float((np.count_nonzero(strength >= seen * (1 - 1e-9)) + extra) / (len(signs) + extra))


def _run_length(values: Array, group: NDArray[np.intp]) -> float:
    positive = values > 0
    breaks = (positive[1:] != positive[:-1]) | (group[1:] != group[:-1])
    return len(values) / (1 + int(np.count_nonzero(breaks)))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
