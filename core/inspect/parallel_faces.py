"""Two parallel planes fitted jointly with the true covariance of their points.

The robust fit of `core.inspect.plane_fit` says which points belong to the two faces, and about where these are. It
weighs points as if they were independent. Here the same model, one common normal and two distances, is fitted to
the same points again with what they have in common: the fan's own points and the sweeps' know the thickness in
different ways, and each counts for as much as it is worth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.inspect.error_sources import Sources
from core.inspect.generalised import Generalised, generalised_fit
from core.inspect.plane_fit import ParallelPlanes
from core.inspect.point_errors import PointErrors, patches
from core.model.arrays import Array
from core.model.directions import square_to
from core.scan.cloud import Cloud
from core.scan.triangulate import join

ITERATIONS = 2


@dataclass(frozen=True, eq=False, slots=True)
class FittedFaces:
    """The fit and what its uncertainty is made of.

    Parameters
    ----------
    planes
        Normal, distances, residuals and gains of the generalised fit; weights are those of the robust one.
    gains
        (J,) ∂thickness/∂(misfit of each stretch of a stripe).
    sources
        Of these points' errors.
    fit
        The generalised fit of distances and tilt.
    """

    planes: ParallelPlanes
    gains: Array
    sources: Sources
    fit: Generalised


def fit_faces(upper: Cloud, lower: Cloud, planes: ParallelPlanes, errors: PointErrors) -> FittedFaces:
    """Fit the two faces again, from the robust fit `planes` of their points.

    Raises
    ------
    ValueError
        If the covariance has no block for a sweep of the points.
    """
    points = np.vstack([upper.points, lower.points])
    face = np.repeat([0, 1], [len(upper), len(lower)])
    weights = np.concatenate(planes.weights)
    used = np.flatnonzero(weights > 0)
    normal, distances = planes.normal, np.array([planes.upper_distance, planes.lower_distance])
    cloud = join([upper, lower]).select(used)
    along = cloud.sigma * np.maximum(np.abs(points[used] @ normal / points[used, 2]), 0.1)
    robust = np.minimum(weights[used] * along**2, 1.0)  # the stated σ is the errors' business
    across = square_to(normal)
    sources = Sources.of(cloud, normal, robust, face[used], patches(points[used] @ across, face[used]), errors)
    axes = across if planes.tilt_determined else _along_the_lines(points[used], face[used], normal)
    for _ in range(ITERATIONS):
        # n·X_p − d = δd − (axes·X_p)·α + what is wrong with X_p along n, where n and d are still off by axes·α and δd.
        design = np.column_stack([face[used] == 0, face[used] == 1, -(points[used] @ axes)]).astype(np.float64)
        misfit = points[used] @ normal - distances[face[used]]
        fit = generalised_fit(sources.mean(design), sources.mean(misfit), sources)
        turned = normal + axes @ fit.estimate[2:]
        length = float(np.linalg.norm(turned))
        normal, distances = turned / length, (distances + fit.estimate[:2]) / length
        axes = axes - np.outer(normal, normal @ axes)
    of_stretches: Array = fit.gains[1] - fit.gains[0]
    gains = np.zeros(len(points))
    gains[used] = of_stretches[sources.stretch] * sources.share
    residuals = distances[face] - points @ normal
    split = len(upper)
    refined = replace(
        planes,
        normal=normal,
        upper_distance=float(distances[0]),
        lower_distance=float(distances[1]),
        residuals=(residuals[:split], residuals[split:]),
        gains=(gains[:split], gains[split:]),
    )
    return FittedFaces(refined, of_stretches, sources, fit)


def _along_the_lines(points: Array, face: NDArray[np.int64], normal: Array) -> Array:
    """The direction (3, 1) of the one line that the points of each face lie on."""
    centroids = np.array([points[face == number].mean(axis=0) for number in range(2)])
    line = np.linalg.svd(points - centroids[face], full_matrices=False)[2][0]
    line = line - normal * (normal @ line)
    return np.asarray((line / np.linalg.norm(line))[:, None])
