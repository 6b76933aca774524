"""A surface fitted to points of a cloud: robustly at first, then with the true covariance of the points.

The same for every shape. Tukey's biweight, with the stated σ across the surface, says which points belong to it, as if
they were independent; the generalised fit of `core.inspect.generalised` to these points follows, and what acts on its
parameters is kept cause by cause, so that whatever is derived from several surfaces has its true uncertainty.

References
----------
Holland, Welsch, Robust regression using iteratively reweighted least squares, Comm. Stat. A6 (1977),
doi:10.1080/03610927708827533.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.error_sources import GRAZING, Sources
from core.inspect.generalised import generalised_fit
from core.inspect.plane_fit import HUBER, LARGEST_WEIGHT, TUKEY
from core.inspect.point_errors import PointErrors, patches
from core.inspect.results import Contribution
from core.inspect.shapes import Parts, Shape
from core.inspect.spread import Spread, spread
from core.inspect.uncertainty import Effect, budget_of, effects
from core.model.arrays import Array
from core.scan.cloud import Cloud

S = TypeVar("S", bound=Shape)

FEWEST = 12
ROUNDS = 40
HUBER_ROUNDS = 8
STEPS = 3
"""Steps of the generalised fit; shapes are all but linear so near to their place."""


@dataclass(frozen=True, eq=False, slots=True)
class SurfaceFit(Generic[S]):
    """A surface and what it rests on.

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
        The spread of the residuals.
    """

    shape: S
    effects: tuple[Effect, ...]
    indices: NDArray[np.int64]
    part: Parts
    residuals: Array
    form: Spread

    def budget(self, gradient: Array) -> tuple[Contribution, ...]:
        """What makes a quantity that follows the parameters with `gradient` (p,) uncertain."""
        return budget_of([(gradient, self.effects)])

    @property
    def parameters(self) -> int:
        """How many parameters the shape has."""
        return len(self.effects[0].factor)

    @property
    def rms_mm(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(np.mean(self.residuals**2)))


def fit_surface(
    cloud: Cloud,
    indices: NDArray[np.int64],
    start: S,
    errors: PointErrors,
    *,
    part: Parts | None = None,
    tukey: float = TUKEY,
    cell_mm: float = 0.0,
) -> SurfaceFit[S]:
    """Fit a shape to points of a cloud.

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
    cell_mm
        Side of the cells whose means `form` is the spread of; 0: of single points.

    Raises
    ------
    InputError
        If a face has too few points for its shape.
    """
    part = np.zeros(len(indices), dtype=np.int64) if part is None else part
    points, sigma = cloud.points[indices], cloud.sigma[indices]
    shape, robust = _robust(points, sigma, start, part, tukey)
    kept = robust > 0
    if np.bincount(part[kept], minlength=int(part.max(initial=0)) + 1).min() < FEWEST:
        raise InputError(f"{np.count_nonzero(kept)} points are too few for it", todo="scan it with more sweeps")
    used, mine, points = cloud.select(indices[kept]), part[kept], points[kept]
    patch = patches(used.uv, mine)
    sources = Sources.of(used, shape.outward(points, mine), robust[kept], mine, patch, errors)
    try:
        for _ in range(STEPS):
            design = sources.mean(shape.design(points, mine))
            fit = generalised_fit(design, sources.mean(shape.misfit(points, mine)), sources)
            shape = shape.moved(fit.estimate)
    except np.linalg.LinAlgError as error:
        raise InputError("its points do not fix it: they lie on one line", todo="scan it with more sweeps") from error
    calibrations = () if errors.common is None else errors.common.sources
    acting = effects(fit.gains, sources, own=fit.own, form_mm=fit.form_mm, calibrations=calibrations)
    residuals = shape.misfit(points, mine)
    form = spread(used, residuals, sources, (design, fit.gains), calibrations, cell_mm)
    return SurfaceFit(shape, acting, indices[kept], mine, residuals, form)


def _robust(points: Array, sigma: Array, shape: S, part: Parts, tukey: float) -> tuple[S, Array]:
    """Iteratively reweighted Gauss–Newton: the shape, and robust weights (0 … 1), zero for points left out."""
    parameters = shape.design(points[:1], part[:1]).shape[1] if len(points) else 0
    if len(points) < max(FEWEST, parameters):
        raise InputError(f"{len(points)} points are too few for it", todo="scan it with more sweeps")
    robust = np.ones(len(points))
    for round_ in range(ROUNDS):
        outward = shape.outward(points, part)
        slant = np.maximum(np.abs((outward * points).sum(axis=1)) / points[:, 2], GRAZING)
        base = np.maximum(sigma * slant, 1e-6) ** -2.0
        base = np.minimum(base, LARGEST_WEIGHT * float(np.median(base)))
        misfit = shape.misfit(points, part)
        relative = np.abs(misfit) * np.sqrt(base)
        relative /= max(1.4826 * float(np.median(relative)), 1e-9)
        if round_ < HUBER_ROUNDS:
            robust = np.minimum(1.0, HUBER / np.maximum(relative, 1e-12))
        else:
            robust = np.clip(1 - (relative / tukey) ** 2, 0.0, None) ** 2
        design = shape.design(points, part)
        scaled = design * (base * robust)[:, None]
        step = np.linalg.lstsq(scaled.T @ design, scaled.T @ misfit, rcond=None)[0]
        shape = shape.moved(step)
        if round_ > HUBER_ROUNDS and np.abs(step).max() < 1e-8:
            break
    return shape, robust
