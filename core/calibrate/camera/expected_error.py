"""Expected error of a calibrated camera over the picture, and its residuals.

References
----------
mrcal's projection uncertainty: the cameras that the calibration's noise allows are compared after the best common
motion has been taken out, for each of them has a frame of its own (https://mrcal.secretsauce.net/uncertainty.html).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay

from core.calibrate.camera.reprojection import linearise
from core.calibrate.results import CameraCalibration
from core.model import Camera, Pose
from core.model.arrays import Array

_VOLUME = (24, 18, 3)
"""Points across, down and deep that stand for the work volume: errors are smooth, more change nothing."""
GRID = (24, 18)
"""Columns and rows of the map over the picture."""


@dataclass(frozen=True, eq=False, slots=True)
class ExpectedError:
    """Standard uncertainty of where points lie, from the camera's calibration alone.

    Parameters
    ----------
    uv
        (rows, cols, 2) pixels, from the first to the last of the picture.
    error_mm
        (rows, cols) root mean square distance, across the ray, of where a point seen at that pixel and known to lie at
        depth `depth_mm` is from where it is said to lie. NaN where the camera has no ray.
    covered
        (rows, cols) whether corners of the views lie around that pixel; elsewhere the camera is extrapolated.
    depth_mm
        Depth z of the points.
    worst_mm, median_mm
        Of `error_mm` over the whole picture.
    """

    uv: Array
    error_mm: Array
    covered: NDArray[np.bool_]
    depth_mm: float
    worst_mm: float
    median_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class ResidualField:
    """Corners used for the fit and their residuals, of all used views together.

    `uv` (N, 2) where they were found, `residual` (N, 2) observed − predicted, both in pixels; `view` (N,) the index of
    each corner's view in the calibration's `views`.
    """

    uv: Array
    residual: Array
    view: NDArray[np.intp]


def expected_error(
    calibration: CameraCalibration, depth_mm: float | None = None, grid: tuple[int, int] = GRID
) -> ExpectedError:
    """Compute the standard uncertainty of points by the camera's covariance at `depth_mm` (None: mid-depth of corners).

    The covariance's cameras are compared in the work volume: the pixels that corners lie around, between the nearest
    and the farthest corner. There a small rigid motion of the frame, fitted by least squares, takes out of every
    change of the camera what a calibration cannot tell from a motion of all views, and what nobody measures by. What
    is left, here and over the whole `grid` (columns, rows) of the picture, is the error to be expected.

    Raises
    ------
    ValueError
        If no view was used, the grid has fewer than 2 × 2 points, or the depth is not positive.
    """
    field, depths = residual_field(calibration), corner_depths(calibration)
    if not len(field.uv):
        raise ValueError("no view was used")
    if min(grid) < 2 or (depth_mm is not None and not depth_mm > 0):
        raise ValueError(f"a grid of {grid[0]} × {grid[1]} at depth {depth_mm} is none")
    depth = float(depths.min() + depths.max()) / 2 if depth_mm is None else float(depth_mm)
    camera, (columns, rows) = calibration.camera, grid
    width, height = camera.image_size
    uv = np.stack(np.meshgrid(np.linspace(0, width - 1, columns), np.linspace(0, height - 1, rows)), axis=-1)
    flat = uv.reshape(-1, 2)
    hull = field.uv[ConvexHull(field.uv).vertices]
    covered = _inside(flat, hull)
    volume = _volume(camera, hull, (float(depths.min()), float(depths.max())))
    motion = _common_motion(camera, *volume)

    seen = np.isfinite(camera.undistort(flat)).all(axis=1)
    error = np.full(len(flat), np.nan)
    by_camera, by_motion = _across(camera, flat[seen], np.full(seen.sum(), depth))
    left = by_camera - by_motion @ motion
    variance = np.einsum("nij,jk,nik->n", left, calibration.covariance, left)
    error[seen] = np.sqrt(np.maximum(variance, 0.0))
    return ExpectedError(
        uv,
        error.reshape(rows, columns),
        covered.reshape(rows, columns),
        depth,
        float(np.nanmax(error)),
        float(np.nanmedian(error)),
    )


def residual_field(calibration: CameraCalibration) -> ResidualField:
    """Collect places, residuals and views of all corners that the calibration uses."""
    used = [(index, view) for index, view in enumerate(calibration.views) if view.used]
    if not used:
        return ResidualField(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, np.intp))
    return ResidualField(
        np.concatenate([view.view.uv[view.counted] for _, view in used]),
        np.concatenate([view.residuals[view.counted] for _, view in used]),
        np.concatenate([np.full(np.count_nonzero(view.counted), index, np.intp) for index, view in used]),
    )


def corner_depths(calibration: CameraCalibration) -> Array:
    """Compute the depths z in mm, in the camera frame, of all corners that the calibration uses."""
    depths = [view.pose.apply(view.view.points[view.counted])[:, 2] for view in calibration.views if view.used]
    return np.concatenate(depths) if depths else np.zeros(0)


def _volume(camera: Camera, corners: Array, depths: tuple[float, float]) -> tuple[Array, Array]:
    """Pixels (N, 2) and depths (N,) spread over what the `corners`' part of the picture sees between two depths."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes = [np.linspace(low[i], high[i], _VOLUME[i]) for i in range(2)]
    uv = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    inside = uv[_inside(uv, corners)]
    inside = inside[np.isfinite(camera.undistort(inside)).all(axis=1)]
    return np.tile(inside, (_VOLUME[2], 1)), np.repeat(np.linspace(*depths, _VOLUME[2]), len(inside))


def _inside(uv: Array, corners: Array) -> NDArray[np.bool_]:
    """Which of `uv` (N, 2) lie within the convex hull of `corners`."""
    return np.asarray(Delaunay(corners).find_simplex(uv) >= 0)


def _across(camera: Camera, uv: Array, depths: Array) -> tuple[Array, Array]:
    """Derivatives of points at pixels `uv` (N, 2) and `depths` (N,) across their rays, in mm.

    Returns
    -------
    (N, 2, 10) per unit of each camera parameter and (N, 2, 6) per rad and mm of a motion of the camera's frame, both as
    what the pixel sees less.
    """
    rays = camera.rays(uv)
    _, by_camera, by_motion = linearise(camera, Pose.identity(), rays * depths[:, None])
    to_mm = camera.ray_jacobian(rays) * depths[:, None, None]
    return to_mm @ by_camera, to_mm @ by_motion


def _common_motion(camera: Camera, uv: Array, depths: Array) -> Array:
    """The rigid motion (6, 10) that best imitates a change of each camera parameter in the work volume."""
    by_camera, by_motion = _across(camera, uv, depths)
    return np.asarray(np.linalg.lstsq(by_motion.reshape(-1, 6), by_camera.reshape(-1, 10), rcond=None)[0])
