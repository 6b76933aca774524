"""Covariance of a calibrated camera, widened for errors that corners share, and its principal deviations.

References
----------
Liang, K.-Y. & Zeger, S., Biometrika 73 (1986) 13–22, doi:10.1093/biomet/73.1.13 (errors correlated in clusters).
Cameron, A. C., Gelbach, J. & Miller, D., J. Business & Economic Statistics 29 (2011) 238–249,
doi:10.1198/jbes.2010.07136 (clusters in two ways).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.bundle import Normal
from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.results import CameraCalibration
from core.model import Camera
from core.model.arrays import Array

MUCH_WIDER = 1.5
"""Factor on the standard deviations for errors that corners share, from which on it is worth a note,"""
_CHANCE_SDS = 3.0
"""unless chance alone may make more of a few views, which is so many of its standard deviations."""
_SINGULAR = 1e-13
"""Smallest eigenvalue over the largest, of the scaled information, below which views do not determine the parameters:
some hundred units of rounding."""


@dataclass(frozen=True)
class SharedErrorFactors:
    """Factors on the standard deviations for errors that corners share.

    Parameters
    ----------
    within_views
        For errors common to the corners of one view: blur, a detector's bias, a target that is not flat.
    across_views
        For errors that a corner of the target repeats in every view: a print that is not true.
    over_picture
        For errors that a part of the picture repeats in every view: a lens that the model does not have.
    chance
        How far above 1 `within_views` comes by chance, as a standard deviation. The others have many clusters, and
        hardly do.
    """

    within_views: float
    across_views: float
    over_picture: float
    chance: float

    @property
    def err_together(self) -> bool:
        """Whether corners of a view surely share so much of their errors that it is worth a note."""
        return self.within_views > max(MUCH_WIDER, 1 + _CHANCE_SDS * self.chance)

    @property
    def total(self) -> float:
        """Factor on the standard deviations for all shared errors together, whose variances add up."""
        return float(np.sqrt(self.within_views**2 + self.across_views**2 + self.over_picture**2 - 2))


def free_covariance(
    normal: Normal,
    points: Sequence[Array],
    cells: Sequence[NDArray[np.intp]],
    degrees_of_freedom: int,
    precision: Array | None = None,
) -> tuple[Array, SharedErrorFactors]:
    """Compute the covariance (F, F) of the camera's free parameters, and the factors of widening for shared errors.

    The scale of the residuals is measured, not assumed. Where corners of a view err together, the views' gradients g
    scatter more than independent corners would make them: for these E[Σ gᵀ S⁻¹ g] = σ² (F − Σ tr(S⁻¹ S_v S⁻¹ S_v)).
    The ratio of both, where above 1, widens the covariance. The same is done over the target's corners, known by
    their `points` (N, 3) in each view, and over parts of the picture, their `cells` (N,) in each view, less what they
    have of the views' (clusters in three ways). `precision` (F,) is what is known of the parameters
    beforehand, as in the information's diagonal.

    Raises
    ------
    numpy.linalg.LinAlgError
        When the views do not determine the parameters.
    """
    information = normal.information.sum(axis=0)
    prior = np.zeros(len(information)) if precision is None else precision
    information = information + np.diag(prior)
    scale = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
    eigenvalues, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    if eigenvalues[0] < _SINGULAR * eigenvalues[-1]:
        raise np.linalg.LinAlgError("the views do not determine the camera")
    inverse = (vectors / eigenvalues) @ vectors.T * np.outer(scale, scale)
    variance = normal.cost / max(degrees_of_freedom, 1)

    free = len(inverse) - float(np.diag(inverse) @ prior)  # parameters that the views, not the prior, tell
    views = len(normal.information)
    of_views = np.array([gradients.sum(axis=0) for gradients in normal.gradients])
    expected, freedom = _of_independent(inverse @ normal.information)
    within = _scatter(of_views, inverse) / max(variance * expected, 1e-300)

    corner = np.unique(np.round(np.concatenate(points), 6), axis=0, return_inverse=True)[1].ravel()
    joined = np.concatenate(normal.gradients)
    across = _excess(joined, corner, inverse, variance * free)
    cell = np.concatenate(cells)
    view = np.repeat(np.arange(views), [len(own) for own in cells])
    in_views = _excess(joined, cell + (cell.max() + 1) * view, inverse, variance * free)
    over_picture = _excess(joined, cell, inverse, variance * free) - in_views + 1
    widening = SharedErrorFactors(
        float(np.sqrt(max(1.0, within))),
        float(np.sqrt(max(1.0, across))),
        float(np.sqrt(max(1.0, over_picture))),
        float(np.sqrt(0.5 / freedom)),
    )
    return variance * widening.total**2 * inverse, widening


def _of_independent(shares: Array) -> tuple[float, float]:
    """What Σ gᵀ S⁻¹ g over the views is in the mean in σ², if all corners are independent, and its freedom.

    With the views' `shares` A = S⁻¹ S_v (V, F, F) of the information the gradients' covariance is δ S_v − S_v S⁻¹ S_w
    in σ²: the sum is of squares in unequal parts, χ² of E²/Σ(parts²) degrees of freedom in Satterthwaite's manner. A
    view sees some parameters much better than others, so that these are far fewer than F (V − 1).
    """
    squares = shares @ shares
    expected = float(np.einsum("vii->", shares) - np.einsum("vii->", squares))
    together = squares.sum(axis=0)
    parts = np.einsum("vii->", squares) - 2 * np.einsum("vij,vji->", shares, squares) + np.trace(together @ together)
    return expected, max(1.0, expected**2 / max(float(parts), 1e-300))


def _excess(gradients: Array, cluster: NDArray[np.intp], inverse: Array, independent: float) -> float:
    """Σ gᵀ S⁻¹ g over sums of corners' `gradients` (N, F) in each `cluster` (N,), over what it is if independent."""
    names, own = np.unique(cluster, return_inverse=True)
    sums = np.zeros((len(names), len(inverse)))
    np.add.at(sums, own.ravel(), gradients)
    return _scatter(sums, inverse) / max(independent * (1 - 1 / len(names)), 1e-300)


def _scatter(gradients: Array, inverse: Array) -> float:
    """Σ gᵀ S⁻¹ g over clusters' gradients (C, F)."""
    return float(np.einsum("ci,ij,cj->", gradients, inverse, gradients))


def principal_deviations(calibration: CameraCalibration) -> tuple[Camera, ...]:
    """Make cameras displaced from a calibration by one standard deviation along each principal axis of its covariance.

    For any quantity f of the camera, Σ (f(deviated) − f(camera))² over them is its variance from the calibration, to
    first order. Axes are those of the correlation matrix, so that they do not depend on units; a fixed parameter
    stays what it is.
    """
    deviation = np.sqrt(np.maximum(np.diag(calibration.covariance), 0))
    free = np.flatnonzero(deviation)
    if not len(free):
        return ()
    scale = deviation[free]
    eigenvalues, vectors = np.linalg.eigh(calibration.covariance[np.ix_(free, free)] / np.outer(scale, scale))
    parameters = parameters_of(calibration.camera)
    cameras = []
    for eigenvalue, vector in zip(eigenvalues, vectors.T, strict=True):
        if eigenvalue > 0:
            shifted = parameters.copy()
            shifted[free] += scale * vector * np.sqrt(eigenvalue)
            cameras.append(camera_of(shifted, calibration.camera.image_size))
    return tuple(cameras)
