"""How far the parameters of a calibrated camera can be trusted, and how to carry that on.

References
----------
Liang, K.-Y. & Zeger, S., Biometrika 73 (1986) 13–22, doi:10.1093/biomet/73.1.13 (errors correlated in clusters).
"""

from __future__ import annotations

import numpy as np

from core.calibrate.bundle import Normal
from core.calibrate.reprojection import camera_of, parameters_of
from core.calibrate.results import CameraCalibration
from core.model import Camera
from core.model.arrays import Array

_SINGULAR = 1e-13


def free_covariance(normal: Normal, degrees_of_freedom: int) -> tuple[Array, float]:
    """Covariance (F, F) of the free parameters, and the factor that its deviations were widened by.

    The scale of the residuals is measured, not assumed. Where corners of a view err together (a bent target, a blurred
    view, a detector with a bias) the views' gradients scatter more than independent corners would make them:
    for these E[Σ gᵀ S⁻¹ g] = σ² (F − Σ tr(S⁻¹ S_v S⁻¹ S_v)). The ratio of both, if above 1, widens the covariance.

    Raises
    ------
    numpy.linalg.LinAlgError
        When the views do not determine the parameters.
    """
    information = normal.information.sum(axis=0)
    scale = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
    eigenvalues, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    if eigenvalues[0] < _SINGULAR * eigenvalues[-1]:
        raise np.linalg.LinAlgError("the views do not determine the camera")
    inverse = (vectors / eigenvalues) @ vectors.T * np.outer(scale, scale)
    variance = normal.cost / max(degrees_of_freedom, 1)
    shares = inverse @ normal.information
    expected = variance * (len(inverse) - np.einsum("vij,vji->", shares, shares))
    scatter = float(np.einsum("vi,ij,vj->", normal.gradients, inverse, normal.gradients))
    widening = max(1.0, scatter / expected) if expected > 0 else 1.0
    return variance * widening * inverse, float(np.sqrt(widening))


def widening_spread(free: int, views: int) -> float:
    """Standard deviation of the widening of deviations when there is nothing to widen."""
    return float(np.sqrt(1 / (2 * free * max(views - 1, 1))))


def principal_deviations(calibration: CameraCalibration) -> tuple[Camera, ...]:
    """Cameras one standard deviation off along each principal axis of the covariance.

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
