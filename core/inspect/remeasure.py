"""What a calibration's uncertainty does to a measured quantity: measure again with displaced calibrations.

A covariance is the sum of the outer products of its principal deviations. To first order the variance of any quantity
is then the sum of the squares of its changes, one for each deviation: as many measurements as parameters, no derivative
of the pipeline, all correlations kept.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array
from core.progress import Progress, silent

NEGLIGIBLE = 1e-9
"""Directions with less than this share of the largest variance (in units of each parameter's own) are left out."""


def principal_deviations(covariance: Array) -> Array:
    """Deviations (R, n), R ≤ n, whose outer products add up to `covariance` (n, n).

    Parameters are scaled by their own standard deviations first, so that pixels and distortion coefficients can share
    one covariance; fixed ones (zero rows) stay zero.
    """
    sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    free = sd > 0
    if not free.any():
        return np.zeros((0, len(sd)))
    correlation = covariance[np.ix_(free, free)] / np.outer(sd[free], sd[free])
    values, vectors = np.linalg.eigh((correlation + correlation.T) / 2)
    kept = values > NEGLIGIBLE * values[-1]
    deviations = np.zeros((int(kept.sum()), len(sd)))
    deviations[:, free] = (vectors[:, kept] * np.sqrt(values[kept])).T * sd[free]
    return deviations[::-1]


def displaced_camera(camera: Camera, deviation: Array) -> Camera:
    """`camera` with `deviation` (10,), in the order of `core.calibrate.results.CAMERA_PARAMETERS`, added."""
    alpha, beta, gamma, u0, v0 = deviation[:5]
    step = np.array([[alpha, gamma, u0], [0.0, beta, v0], [0.0, 0.0, 0.0]])
    return Camera(camera.image_size, camera.matrix + step, camera.distortion + deviation[5:])


def displaced_fan(fan: Fan, deviation: Array) -> Fan:
    """`fan` with `deviation` (3N,) in 1/mm added to its stacked π."""
    return Fan(tuple(LightPlane(pi) for pi in fan.pis + deviation.reshape(-1, 3)), fan.covariance)


def calibration_changes(
    measure: Callable[[Camera, Fan], float],
    camera: Camera,
    camera_covariance: Array,
    fan: Fan,
    *,
    progress: Progress = silent,
) -> tuple[Array, Array]:
    """Changes of a quantity for each principal one-σ deviation of the camera and of the fan.

    Parameters
    ----------
    measure
        Measures the quantity again with another camera and fan, everything else (points, faces, weights) the same. It
        is the caller's choice whether it also calibrates the fan again with a displaced camera, as it should when the
        fan was calibrated with that camera.
    camera, camera_covariance
        The calibrated camera and its (10, 10) covariance in the order of CAMERA_PARAMETERS.
    fan
        The calibrated fan with its covariance.
    progress
        Told how many measurements are done.

    Returns
    -------
    tuple of Array
        (R,) changes for the camera and (Q,) for the fan, in the quantity's unit.
    """
    of_camera = principal_deviations(camera_covariance)
    assert fan.covariance is not None  # Fan fills it in
    of_fan = principal_deviations(fan.covariance)
    total = 1 + len(of_camera) + len(of_fan)
    progress("calibration uncertainty", 0, total)
    here = measure(camera, fan)
    changes: list[float] = []
    for deviation in of_camera:
        progress("calibration uncertainty", 1 + len(changes), total)
        changes.append(measure(displaced_camera(camera, deviation), fan) - here)
    for deviation in of_fan:
        progress("calibration uncertainty", 1 + len(changes), total)
        changes.append(measure(camera, displaced_fan(fan, deviation)) - here)
    progress("calibration uncertainty", total, total)
    return np.array(changes[: len(of_camera)]), np.array(changes[len(of_camera) :])
