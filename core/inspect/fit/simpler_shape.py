"""Whether a simpler shape explains the points of a round one: what is flat is no sphere and no cylinder.

A plane is a sphere without curvature, with fewer parameters. Both are fitted to the same points by generalised least
squares, with what the points' errors have in common (light planes, speckle, calibrations) as unknowns of known
variance; D is what is left then, minus twice the logarithm of the likelihood. The richer shape is taken only if its
further parameters are worth their price by the Bayesian information criterion::

    (D_plane − D_round) / s² > (p_round − p_plane) · ln J,      s² = max(1, D_round / (J − p_round))

over J stretches of stripes: where points scatter more than stated about the round shape, so they may about the plane.
Stretches far off count for less, by Huber's loss.

References
----------
Schwarz, Estimating the dimension of a model, Ann. Statist. 6 (1978), doi:10.1214/aos/1176344136.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from core.inspect.fit.plane_fit import fit_plane
from core.inspect.fit.shapes import Cylinder, ParallelPlanes, Shape, Sphere
from core.inspect.uncertainty.error_sources import Sources
from core.inspect.uncertainty.point_errors import PointErrors, patches
from core.messages import Message
from core.model.arrays import Array
from core.model.robust import Schedule, irls
from core.scan.surface.cloud import Cloud

_FLAT: Mapping[type[Sphere | Cylinder], Message] = {
    Sphere: Message(
        "surface.flat_no_sphere", "these points are flat within their noise: no sphere can be told from them"
    ),
    Cylinder: Message(
        "surface.flat_no_cylinder", "these points are flat within their noise: no cylinder can be told from them"
    ),
}
_BEYOND = 3.0
"""Standard deviations from which on a stretch counts for less."""
_WEIGHTS = Schedule(5, huber_at=_BEYOND)
"""Of the fits after the first: shapes are all but linear so near to their place."""
_FREE = 1e-12
"""Share of a parameter's information that is added to it, so that those which nothing fixes stay where they are."""


def flat_points(shape: Shape, cloud: Cloud, errors: PointErrors) -> Message | None:
    """Check whether a plane or line explains the points of a fitted sphere or cylinder; return a message, else None.

    Parameters
    ----------
    shape
        As fitted to all points of `cloud`; a circle of a section, whose direction is kept, is told from a line.
    errors
        How the points' errors hang together.
    """
    if not isinstance(shape, Sphere | Cylinder):
        return None
    round_, plane = (_explained(one, cloud, errors) for one in (shape, _flat(shape, cloud)))
    scale = max(1.0, round_.left / max(round_.stretches - round_.parameters, 1))
    price = (round_.parameters - plane.parameters) * np.log(round_.stretches)
    return _FLAT[type(shape)] if (plane.left - round_.left) / scale <= price else None


def _flat(shape: Sphere | Cylinder, cloud: Cloud) -> ParallelPlanes:
    """The plane near all points, or the line in the plane of a section."""
    middle = cloud.points.mean(axis=0)
    normal = -fit_plane(cloud.points, cloud.sigma).normal
    if isinstance(shape, Cylinder) and not shape.turns:
        normal = normal - shape.direction * (shape.direction @ normal)
        normal /= np.linalg.norm(normal)
        return ParallelPlanes(normal, middle[None], np.cross(shape.direction, normal)[:, None])
    return ParallelPlanes.through(normal, middle[None])


class _Explained(NamedTuple):
    """Minus twice the logarithm of the likelihood, but for what all shapes have alike; numbers that it rests on."""

    left: float
    parameters: int
    stretches: int


def _explained(shape: Shape, cloud: Cloud, errors: PointErrors) -> _Explained:
    """What a shape, fitted again from where it is, leaves of the points."""
    part = np.zeros(len(cloud), dtype=np.int64)
    outward = shape.outward(cloud.points, part)
    sources = Sources.of(cloud, outward, np.ones(len(cloud)), part, patches(cloud.uv, part), errors)
    shared = sources.effects(sources.explained)

    def solved(shape: Shape, weights: Array) -> tuple[Shape, Array, float]:
        """The shape moved, and residuals and what is left before that."""
        design = sources.mean(shape.design(cloud.points, part))
        misfit = sources.mean(shape.misfit(cloud.points, part)) / sources.own
        columns = np.hstack([design, shared]) / sources.own[:, None]
        information = sources.information(np.hstack([design, sources.explained]), weights / sources.own**2)
        known = np.ones(len(information))
        known[: design.shape[1]] = _FREE * information.diagonal()[: design.shape[1]]
        information[np.diag_indices(len(information))] += known
        solution = cho_solve(cho_factor(information), columns.T @ (weights * misfit))
        residuals = misfit - columns @ solution
        of_shared = solution[design.shape[1] :]
        left = float(np.sum(_loss(residuals)) + of_shared @ of_shared)
        return shape.moved(solution[: design.shape[1]]), residuals, left

    start = solved(shape, np.ones(len(sources.own)))
    moved, _, left = irls(start, lambda found, weigh: solved(found[0], weigh(found[1])), _WEIGHTS)
    parameters = moved.design(cloud.points[:1], part[:1]).shape[1]
    return _Explained(left, parameters, len(sources.own))


def _loss(residuals: Array) -> Array:
    """Huber's: squares up to the limit, and straight beyond."""
    size = np.abs(residuals)
    return np.where(size <= _BEYOND, size**2, 2 * _BEYOND * size - _BEYOND**2)
