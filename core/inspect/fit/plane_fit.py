"""Orthogonal, robust fits of one plane and of two parallel planes, with the sensitivity of their distance.

The baseline rule. The height of a block over its table depends on what is called the table's height under the block:
the mean of points beside it, a line extrapolated from them, or a plane. Here it is one thing only: **the distance of
two parallel planes fitted jointly**, one common normal and two distances, to the points of both faces.

For given weights the common normal is the eigenvector of the smallest eigenvalue of the pooled scatter of both faces
about their own centroids, so the fit is exact and needs no start; robust weights are found by iterating it (Huber, then
Tukey's biweight). A point of depth uncertainty σ_z on ray r = X/z moves along its ray, so its distance from a plane
with normal n has the standard uncertainty σ_z |n·r|: weights are the inverse square of that.

A single light profile. Its points lie on one line on each face, so the scatter has one direction of size only, and the
tilt about that line is not determined by the data. The normal is then the reference normal (the table's, known from
elsewhere) turned as little as possible to stand on the lines; without a reference it is taken in the profile's own
plane. `ParallelPlaneFit.tilt_determined` says which of the two happened.

`fit_parallel_planes` says which points belong to the two faces, and about where these are; it weighs points as if they
were independent. `fit_faces` fits the same model to the same points again with what they have in common: the fan's own
points and the sweeps' know the thickness in different ways, and each counts for as much as it is worth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.inspect.fit.generalised import Generalised, generalised_fit
from core.inspect.fit.shapes import ParallelPlanes
from core.inspect.uncertainty.error_sources import Sources
from core.inspect.uncertainty.point_errors import PointErrors, patches
from core.model.arrays import Array
from core.model.directions import square_to
from core.model.robust import Schedule, Weigh, irls, mad_sd
from core.scan.surface.cloud import Cloud
from core.scan.surface.triangulate import join

LINE_LIKE = 0.03
"""Faces whose points spread across less than this share of their spread along are taken for lines."""
INNER = 0.8
"""Spreads are judged by this share of the points, so that wrong points do not make a plane of a line."""
_WEIGHTS = Schedule(40, huber=8, counts_from=9)
"""Of reweighting: Huber's weights have one solution, near which Tukey's then start."""
LARGEST_WEIGHT = 16.0
"""No point weighs more than this many times the median one: stated σ are not known better than to a factor 4."""


@dataclass(frozen=True, eq=False, slots=True)
class PlaneFit:
    """Plane normal·X = distance; `normal` (3,) is unit and points away from the camera, `distance` in mm.

    `weights` (N,) hold 1/σ² times the robust weight, zero for points left out; `residuals` (N,) in mm are positive
    towards the camera; `scale` is their robust scale in units of the stated uncertainty (1 when that is true; in mm
    when none was given).
    """

    normal: Array
    distance: float
    weights: Array
    residuals: Array
    scale: float


@dataclass(frozen=True, eq=False, slots=True)
class ParallelPlaneFit:
    """Two parallel planes: normal·X = upper_distance and normal·X = lower_distance, in mm.

    The first index of every pair is the upper face, nearer to the camera. `normal` (3,) is unit and points away from
    the camera. `weights` and `residuals` as in `PlaneFit`. `gains[f]` (N_f,) is the sensitivity of the thickness to a
    shift of each point along the normal: ∂thickness/∂X_p = gain_p · normal. `tilt_determined` is False when the points
    lie on one line a face, so that the tilt about it came from the reference normal.
    """

    normal: Array
    upper_distance: float
    lower_distance: float
    weights: tuple[Array, Array]
    residuals: tuple[Array, Array]
    gains: tuple[Array, Array]
    scale: float
    tilt_determined: bool

    @property
    def thickness(self) -> float:
        """Distance between the two planes, in mm."""
        return self.lower_distance - self.upper_distance

    def shape(self, points: Array, face: NDArray[np.int64]) -> ParallelPlanes:
        """Make `ParallelPlanes` amid `points` (N, 3) in mm of the upper and lower face, 0 and 1 in `face` (N,)."""
        centres = []
        for number, distance in enumerate((self.upper_distance, self.lower_distance)):
            middle = points[face == number].mean(axis=0)
            centres.append(middle - self.normal * (self.normal @ middle - distance))
        return ParallelPlanes.through(-self.normal, np.array(centres))


@dataclass(frozen=True, eq=False, slots=True)
class _Solution:
    """One exact weighted fit of parallel planes to stacked points."""

    normal: Array
    distances: Array
    axes: Array  # (3, k): directions in which the data determine the tilt
    spreads: Array  # (k,): eigenvalues of these directions less that of the normal
    centroids: Array


def fit_plane(points: Array, sigma: Array | None = None, *, reference_normal: Array | None = None) -> PlaneFit:
    """Fit one plane robustly, by orthogonal distances.

    Parameters
    ----------
    points
        (N, 3) in mm in the camera frame, N ≥ 3.
    sigma
        (N,) standard uncertainty of the depth in mm; None: all alike.
    reference_normal
        (3,) used for the tilt that points on one line leave open.

    Raises
    ------
    ValueError
        If there are fewer than 3 points.
    """
    face = np.zeros(len(points), dtype=np.int64)
    solution, weights, scale = _robust(points, sigma, face, 1, reference_normal)
    distance = float(solution.distances[0])
    return PlaneFit(solution.normal, distance, weights, distance - points @ solution.normal, scale)


def fit_parallel_planes(
    upper: Array,
    lower: Array,
    upper_sigma: Array | None = None,
    lower_sigma: Array | None = None,
    *,
    reference_normal: Array | None = None,
) -> ParallelPlaneFit:
    """Fit two parallel planes jointly and robustly: one common normal, two distances.

    Parameters
    ----------
    upper, lower
        (N, 3) and (M, 3) points in mm in the camera frame on the face nearer to the camera and on the other.
    upper_sigma, lower_sigma
        (N,) and (M,) standard uncertainties of the depth in mm; None: all alike.
    reference_normal
        (3,) used for the tilt that points on one line a face leave open (a single light profile); not used otherwise.

    Raises
    ------
    ValueError
        If a face has fewer than 2 points, or both together fewer than 5.
    """
    if min(len(upper), len(lower)) < 2 or len(upper) + len(lower) < 5:
        raise ValueError("two parallel planes need at least 2 points each and 5 together")
    points = np.vstack([upper, lower])
    face = np.repeat([0, 1], [len(upper), len(lower)])
    sigma = None
    if upper_sigma is not None and lower_sigma is not None:
        sigma = np.concatenate([upper_sigma, lower_sigma])
    solution, weights, scale = _robust(points, sigma, face, 2, reference_normal)
    residuals = solution.distances[face] - points @ solution.normal
    gains = _gains(points, face, weights, solution)
    split = len(upper)
    return ParallelPlaneFit(
        solution.normal,
        float(solution.distances[0]),
        float(solution.distances[1]),
        (weights[:split], weights[split:]),
        (residuals[:split], residuals[split:]),
        (gains[:split], gains[split:]),
        scale,
        len(solution.spreads) == 2,
    )


def _robust(
    points: Array, sigma: Array | None, face: NDArray[np.int64], faces: int, reference: Array | None
) -> tuple[_Solution, Array, float]:
    """Iteratively reweighted fit: the solution, its weights (0 for points left out) and the residuals' scale."""
    if len(points) < 3:
        raise ValueError(f"a plane needs at least 3 points, not {len(points)}")
    noise = np.ones(len(points)) if sigma is None else np.asarray(sigma, dtype=np.float64)
    line_like = _line_like(points, face, faces)

    def improve(found: tuple[_Solution, Array, float], weigh: Weigh) -> tuple[_Solution, Array, float]:
        solution = found[0]
        along = noise if sigma is None else noise * np.maximum(np.abs(points @ solution.normal / points[:, 2]), 0.1)
        base = _capped(along)
        residual = (points @ solution.normal - solution.distances[face]) * np.sqrt(base)
        scale = mad_sd(residual)
        weights = base * weigh(np.abs(residual) / max(scale, 1e-9))
        return _solve(points, weights, face, faces, reference, line_like), weights, scale

    weights = _capped(noise)
    start = _solve(points, weights, face, faces, reference, line_like), weights, 1.0
    return irls(start, improve, _WEIGHTS, lambda before, now: _settled(before[0], now[0]))


def _settled(before: _Solution, now: _Solution) -> bool:
    moved = np.abs(now.distances - before.distances).max()
    return bool(moved < 1e-7 and np.abs(now.normal - before.normal).max() < 1e-9)


def _capped(sigma: Array) -> Array:
    """1/σ², no weight more than LARGEST_WEIGHT times the median one."""
    weights = np.maximum(sigma, 1e-6) ** -2.0
    return np.minimum(weights, LARGEST_WEIGHT * float(np.median(weights)))


def _line_like(points: Array, face: NDArray[np.int64], faces: int) -> bool:
    """Whether the points of each face lie on one line, all faces' lines parallel."""
    centred = points - np.array([np.median(points[face == number], axis=0) for number in range(faces)])[face]
    vectors = np.linalg.eigh(centred.T @ centred)[1]
    across, along = np.quantile(np.abs(centred @ vectors[:, 1:]), INNER, axis=0)
    return bool(across <= LINE_LIKE * along)


def _solve(
    points: Array,
    weights: Array,
    face: NDArray[np.int64],
    faces: int,
    reference: Array | None,
    line_like: bool,
) -> _Solution:
    """Exact weighted orthogonal fit of `faces` parallel planes."""
    total = np.bincount(face, weights, minlength=faces)
    sums = [np.bincount(face, weights * points[:, axis], minlength=faces) for axis in range(3)]
    centroids: Array = np.column_stack(sums) / total[:, None]
    centred = points - centroids[face]
    values, vectors = np.linalg.eigh((centred * weights[:, None]).T @ centred)
    if not line_like:
        normal, axes, spreads = vectors[:, 0], vectors[:, 1:], values[1:] - values[0]
    else:
        line = vectors[:, 2]
        hint = centroids[-1] - centroids[0] if reference is None and faces == 2 else reference
        normal = _standing_on(line, vectors[:, 0] if hint is None else hint)
        axes, spreads = line[:, None], values[2:] - values[0]
    if normal @ centroids.mean(axis=0) < 0:
        normal = -normal
    return _Solution(normal, centroids @ normal, axes, spreads, centroids)


def _standing_on(line: Array, hint: Array) -> Array:
    """The unit vector perpendicular to `line` that is nearest to `hint`."""
    across = hint - line * (line @ hint)
    unit: Array = across / np.linalg.norm(across)
    return unit


def _gains(points: Array, face: NDArray[np.int64], weights: Array, solution: _Solution) -> Array:
    """∂(thickness)/∂(shift of each point along the normal): its share of the centroid, and of the common tilt."""
    side = np.where(face == 1, 1.0, -1.0)
    total = np.bincount(face, weights)
    gains = side * weights / total[face]
    lever = (solution.centroids[1] - solution.centroids[0]) @ solution.axes
    arms = (points - solution.centroids[face]) @ solution.axes
    tilt: Array = weights * (arms @ (lever / solution.spreads))
    return np.asarray(gains - tilt, dtype=np.float64)


ITERATIONS = 2
"""Of the generalised fit: the robust one is so near that the second changes the normal by its square only."""


@dataclass(frozen=True, eq=False, slots=True)
class FittedFaces:
    """Joint fit of two parallel faces and what its uncertainty is made of.

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

    planes: ParallelPlaneFit
    gains: Array
    sources: Sources
    fit: Generalised


def fit_faces(upper: Cloud, lower: Cloud, planes: ParallelPlaneFit, errors: PointErrors) -> FittedFaces:
    """Fit two parallel faces by generalised least squares, starting from the robust fit `planes` of the same points.

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
        thickness = np.concatenate([[-1.0, 1.0], np.zeros(axes.shape[1])])
        fit = generalised_fit(sources.mean(design), sources.mean(misfit), sources, thickness[None, :])
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
