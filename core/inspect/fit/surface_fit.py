"""A surface fitted to points of a cloud: robustly at first, then with the true covariance of the points.

The same for every shape. Tukey's biweight, with the stated σ across the surface, says which points belong to it, as if
they were independent; the generalised fit of `core.inspect.fit.generalised` to these points follows, and what acts on
its parameters is kept cause by cause, so that whatever is derived from several surfaces has its true uncertainty.

Its deviation of form, free of the points' noise, is found where it is asked for (`core.inspect.fit.form_zone`). Beside
that, `range_of` is the range that holds 95 % of points or of their means over cells, their noise included.

References
----------
Holland, Welsch, Robust regression using iteratively reweighted least squares, Comm. Stat. A6 (1977),
doi:10.1080/03610927708827533.
Efron, Bootstrap methods: another look at the jackknife, Ann. Statist. 7 (1979), doi:10.1214/aos/1176344552.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.causes import Cause
from core.inspect.fit.form_zone import FormZone, form_zone
from core.inspect.fit.generalised import generalised_fit
from core.inspect.fit.plane_fit import LARGEST_WEIGHT
from core.inspect.fit.shapes import Parts, Shape
from core.inspect.fit.simpler_shape import flat_points
from core.inspect.fit.spanned import spanned
from core.inspect.results import Contribution
from core.inspect.uncertainty.budget import Effect, budget_of, effects
from core.inspect.uncertainty.error_sources import GRAZING, Sources
from core.inspect.uncertainty.point_errors import PointErrors, patches
from core.messages import Message
from core.model.arrays import Array
from core.model.robust import TUKEY, Schedule, Weigh, irls, mad_sd
from core.scan.surface.cloud import Cloud

S = TypeVar("S", bound=Shape)

MORE_SWEEPS = Message("feature.advice_more_sweeps", "scan it with more sweeps")

CURVED = Message("surface.advice_curved", "draw a region on the curved surface")

FEWEST = 12
"""Points on each face of a surface: more than twice the parameters of any shape here."""
ROUNDS = 40
"""Of robust weights, at most; it ends when no parameter moves by more than 1e-8 mm or rad."""
HUBER_ROUNDS = 8
"""First rounds, with Huber's weights: they have one solution, near which Tukey's then start."""
STEPS = 3
"""Steps of the generalised fit, at most; shapes are all but linear so near to their place."""
AT_REST = 1e-6
"""In mm or rad: a step that moves no parameter by more is the last one, as the next moves it by its square."""


@dataclass(frozen=True, eq=False, slots=True)
class SurfaceFit(Generic[S]):
    """Surface fitted to points of a cloud, with what acts on its parameters.

    Parameters
    ----------
    shape
        The surface fitted.
    effects
        What acts on its parameters.
    indices
        (M,) into the cloud: the points used.
    part
        (M,) which face each is on.
    residuals
        (M,) in mm, outwards positive.
    form
        The zone of its form; None where it was not asked for.
    faces_spanned
        (faces,) whether the points of each face alone span it; together they do.
    """

    shape: S
    effects: tuple[Effect, ...]
    indices: NDArray[np.int64]
    part: Parts
    residuals: Array
    form: FormZone | None
    faces_spanned: NDArray[np.bool_]

    def budget(self, gradient: Array) -> tuple[Contribution, ...]:
        """Compute the uncertainty budget of a quantity with derivatives `gradient` (p,) by the fitted parameters."""
        return budget_of([(gradient, self.effects)])

    @property
    def parameters(self) -> int:
        """Number of parameters of the shape."""
        return len(self.effects[0].factor)

    @property
    def rms_mm(self) -> float:
        """Root mean square of the residuals, in mm."""
        return float(np.sqrt(np.mean(self.residuals**2)))


def fit_surface(
    cloud: Cloud,
    indices: NDArray[np.int64],
    start: S,
    errors: PointErrors,
    *,
    part: Parts | None = None,
    tukey: float = TUKEY,
    form_mm: float | None = None,
) -> SurfaceFit[S]:
    """Fit a shape to the points `indices` of a cloud, robustly at first, then with the covariance of their errors.

    Parameters
    ----------
    cloud, indices
        The points, and which of them (N,) are on the surface, but for some wrong ones.
    start
        About where it lies.
    errors
        How the points' errors hang together.
    part
        (N,) which face each of the indices is on; None: all on one.
    tukey
        Points this many robust standard deviations off are left out.
    form_mm
        Forms shorter than this are taken for noise; 0: than a fifth of the surface's side. None: no form is asked for.

    Raises
    ------
    InputError
        If a face has too few points for its shape, or all its points together do not span it, or a plane
        explains those of a sphere or a cylinder.
    """
    part = np.zeros(len(indices), dtype=np.int64) if part is None else part
    points, sigma = cloud.points[indices], cloud.sigma[indices]
    shape, robust = _robust(points, sigma, start, part, tukey)
    kept = robust > 0
    if np.bincount(part[kept], minlength=int(part.max(initial=0)) + 1).min() < FEWEST:
        raise too_few(int(np.count_nonzero(kept)))
    used, mine, points = cloud.select(indices[kept]), part[kept], points[kept]
    patch = patches(used.uv, mine)
    sources = Sources.of(used, shape.outward(points, mine), robust[kept], mine, patch, errors)
    try:
        for _ in range(STEPS):
            design = sources.mean(shape.design(points, mine))
            fit = generalised_fit(design, sources.mean(shape.misfit(points, mine)), sources)
            shape = shape.moved(fit.estimate)
            if np.abs(fit.estimate).max() < AT_REST:
                break
    except np.linalg.LinAlgError as error:
        raise _not_fixed(shape, used, errors) from error
    if not spanned(shape, points, used.sigma, mine):
        raise _not_fixed(shape, used, errors)
    if flat := flat_points(shape, used, errors):
        raise InputError(flat, todo=CURVED)
    faces = [np.flatnonzero(mine == face) for face in np.unique(mine)]
    by_face = [spanned(shape, points[face], used.sigma[face], mine[face]) for face in faces]
    calibrations = errors.calibrations
    acting = effects(fit.gains, sources, own=fit.own, form_mm=fit.form_mm, calibrations=calibrations)
    residuals = shape.misfit(points, mine)
    outward = np.asarray(shape.outward(points, mine), dtype=np.float64)
    form = None if form_mm is None else form_zone(residuals, points, outward, sources, fit, design, form_mm)
    return SurfaceFit(shape, acting, indices[kept], mine, residuals, form, np.array(by_face, dtype=np.bool_))


def too_few(count: int) -> InputError:
    """Make the error that `count` points are too few to fit a surface."""
    return InputError(Message("surface.too_few_points", "{n} points are too few for it", n=count), todo=MORE_SWEEPS)


def _not_fixed(shape: Shape, used: Cloud, errors: PointErrors) -> InputError:
    """Why points do not fix a shape; those of one stripe are flat on any surface."""
    flat = flat_points(shape, used, errors) if len(np.unique(used.sweep)) > 1 else None
    if flat is not None:
        return InputError(flat, todo=CURVED)
    return InputError(
        Message(
            "surface.points_do_not_span",
            "its points do not fix it: they lie on one stripe, or too near to each other for their noise",
        ),
        todo=MORE_SWEEPS,
    )


def _robust(points: Array, sigma: Array, shape: S, part: Parts, tukey: float) -> tuple[S, Array]:
    """Iteratively reweighted Gauss–Newton: the shape, and robust weights (0 … 1), zero for points left out."""
    parameters = shape.design(points[:1], part[:1]).shape[1] if len(points) else 0
    if len(points) < max(FEWEST, parameters):
        raise too_few(len(points))

    def improve(found: tuple[S, Array, float], weigh: Weigh) -> tuple[S, Array, float]:
        shape = found[0]
        outward = shape.outward(points, part)
        slant = np.maximum(np.abs((outward * points).sum(axis=1)) / points[:, 2], GRAZING)
        base = np.maximum(sigma * slant, 1e-6) ** -2.0
        base = np.minimum(base, LARGEST_WEIGHT * float(np.median(base)))
        misfit = shape.misfit(points, part)
        relative = np.abs(misfit) * np.sqrt(base)
        relative /= max(mad_sd(relative), 1e-9)
        robust = weigh(relative)
        design = shape.design(points, part)
        scaled = design * (base * robust)[:, None]
        step = np.linalg.lstsq(scaled.T @ design, scaled.T @ misfit, rcond=None)[0]
        return shape.moved(step), robust, float(np.abs(step).max())

    schedule = Schedule(ROUNDS, HUBER_ROUNDS, tukey_at=tukey, counts_from=HUBER_ROUNDS + 1)
    shape, robust, _ = irls((shape, np.ones(len(points)), np.inf), improve, schedule, lambda _, now: now[2] < 1e-8)
    return shape, robust


TAIL = 0.025
"""Share of the residuals beyond each end of the range."""
NEAR = 0.02
"""Share of the residuals about an end that stands for it."""
DRAWS, MOST_DRAWN = 200, 50_000
"""Drawings of the bootstrap, which give its standard deviation to 5 %, and residuals that take part in one."""


class Range(NamedTuple):
    """Range that holds 95 % of N values, of `samples` points or cells, with the weight (N,) of each value in it."""

    value: float
    weight: Array
    sampling: Contribution
    samples: int


def range_of(cloud: Cloud, heights: Array, cell_mm: float = 0.0) -> Range:
    """Compute the 95 % range in mm of points' heights (N,), or of their means over cells if `cell_mm` is above 0."""
    cell = _cells(cloud.points, cell_mm) if cell_mm > 0 else np.arange(len(heights), dtype=np.int64)
    share = 1.0 / np.bincount(cell)[cell]
    values = np.asarray(np.bincount(cell, share * heights), dtype=np.float64)
    low, high = np.quantile(values, [TAIL, 1 - TAIL])
    ranks = np.argsort(np.argsort(values)) / max(len(values) - 1, 1)
    weight = np.zeros(len(heights))
    for sign, end in ((1.0, 1 - TAIL), (-1.0, TAIL)):
        near = np.where((np.abs(ranks - end) <= NEAR / 2)[cell], share, 0.0)
        weight += sign * near / max(float(near.sum()), 1e-12)
    group = np.arange(len(values)) if cell_mm > 0 else np.unique(cloud.sweep, return_inverse=True)[1]
    sampling = Contribution(Cause.SAMPLING, u_of_quantiles(values, (TAIL, 1 - TAIL), (-1.0, 1.0), group))
    return Range(float(high - low), weight, sampling, len(values))


def u_of_quantiles(values: Array, shares: Sequence[float], signs: Sequence[float], group: NDArray[np.int64]) -> float:
    """Compute the standard uncertainty of a signed sum of quantiles of `values` (N,), by bootstrap over groups."""
    order = np.argsort(values, kind="stable")
    order = order[:: max(1, len(order) // MOST_DRAWN)]
    ranked, of = values[order], group[order]
    rng, count = np.random.default_rng(0), int(group.max()) + 1
    found = np.empty(DRAWS)
    for draw in range(DRAWS):
        times = np.bincount(rng.integers(count, size=count), minlength=count)
        below = np.cumsum(times[of])
        at = np.searchsorted(below, np.array(shares) * below[-1])
        found[draw] = np.dot(signs, ranked[np.minimum(at, len(ranked) - 1)])
    return float(found.std(ddof=1))


def _cells(points: Array, cell_mm: float) -> NDArray[np.int64]:
    """Number, from 0, of the cube of side `cell_mm` each point lies in."""
    place = np.floor((points - points.min(axis=0)) / cell_mm).astype(np.int64)
    return np.asarray(np.unique(place, axis=0, return_inverse=True)[1], dtype=np.int64).ravel()
