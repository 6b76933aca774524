"""The distance of two measured points, with its uncertainty."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from core.model.arrays import Array, frozen_array


@dataclass(frozen=True, slots=True)
class PointDistance:
    """Distance of two points and its standard uncertainty, in mm."""

    distance_mm: float
    u_mm: float


def point_distance(a: ArrayLike, b: ArrayLike, sigma_a: float, sigma_b: float) -> PointDistance:
    """Compute the distance in mm of two points of a cloud, and its uncertainty by the noise of the two.

    A point of depth uncertainty σ moves along its ray r = X / z, so along the unit vector n between the two points it
    moves by σ n·r. The two are taken as independent: u² = (σ_a n·r_a)² + (σ_b n·r_b)².

    Parameters
    ----------
    a, b
        (3,) points in mm in the camera frame, in front of the camera.
    sigma_a, sigma_b
        Standard uncertainty of their depths in mm, as the cloud states it.

    Raises
    ------
    ValueError
        If the two points are one, one is not in front of the camera, or a σ is not a number ≥ 0.

    Notes
    -----
    Left out: camera and fan calibration, which are common to the whole scan and scale all distances alike; the error
    that two points of one sweep share through its light plane (it cancels in part, so u is rather too large there); the
    pixel noise across the ray; and that a picked point is not the edge, corner or mean of anything. A thickness over
    two fitted faces (`core.inspect.gauge`) holds all of these and is many times surer.

    Examples
    --------
    >>> along_the_ray = point_distance([0, 0, 500], [0, 0, 510], 0.03, 0.04)
    >>> along_the_ray.distance_mm, round(along_the_ray.u_mm, 6)
    (10.0, 0.05)
    >>> across = point_distance([-5, 0, 500], [5, 0, 500], 0.03, 0.04)
    >>> across.distance_mm, round(across.u_mm, 6)
    (10.0, 0.0005)
    """
    first, second = frozen_array(a, (3,), "a"), frozen_array(b, (3,), "b")
    if not (first[2] > 0 and second[2] > 0):
        raise ValueError("points have a depth above 0")
    if not (0 <= sigma_a < np.inf and 0 <= sigma_b < np.inf):
        raise ValueError(f"no distance with σ = {sigma_a} and {sigma_b}")
    between: Array = second - first
    length = float(np.linalg.norm(between))
    if not length > 0:
        raise ValueError("a distance needs two different points")
    along = between / length
    shares = [sigma * float(along @ (point / point[2])) for point, sigma in ((first, sigma_a), (second, sigma_b))]
    return PointDistance(length, math.hypot(*shares))
