"""Targets drawn through the full camera model, each pixel integrated over its area: the analytic truth of the tests."""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np

from core.model import Camera, Pose

Pattern = Callable[[np.ndarray, np.ndarray], np.ndarray]


class Noise(NamedTuple):
    """Of a sensor: standard deviation in grey levels, and what it is drawn from."""

    grey: float
    seed: int = 0


NO_NOISE = Noise(0)


def rig(factor: float = 0.25) -> Camera:
    """A camera like the paper's at a fraction of its picture size, with skew and distortion."""
    matrix = np.array([[4990, 0.78, 1915], [0, 4990, 1380], [0, 0, 1]])
    return Camera((3840, 2748), matrix, np.array([-0.08, 0.1, 0.0004, -0.0003])).scaled(factor)


def pose(tilt_x: float, tilt_y: float, roll: float, centre, distance: float, shift=(0.0, 0.0)) -> Pose:
    """A target turned by degrees about its `centre` (x, y in mm), which lies at `distance` mm before the camera."""
    turn, _ = cv2.Rodrigues(np.radians([tilt_x, 0, 0]))
    turn = turn @ cv2.Rodrigues(np.radians([0, tilt_y, 0]))[0] @ cv2.Rodrigues(np.radians([0, 0, roll]))[0]
    return Pose(turn, np.array([*shift, distance]) - turn @ np.array([*centre, 0.0]))


@lru_cache(maxsize=4)
def _pixels(size, matrix: bytes, distortion: bytes):
    """Pixel coordinates u, v, their rays (N, 2), and the rays' Jacobian (N, 2, 2)."""
    camera = Camera(size, np.frombuffer(matrix).reshape(3, 3), np.frombuffer(distortion))
    v, u = np.mgrid[0 : size[1], 0 : size[0]].astype(float)
    xy = camera.undistort(np.column_stack([u.ravel(), v.ravel()]))
    return u, v, xy, camera.ray_jacobian(np.column_stack([xy, np.ones(len(xy))]))


def render(
    camera: Camera,
    where: Pose,
    pattern: Pattern,
    *,
    blur: float = 0.7,
    grey: tuple[float, float] = (30, 200),
    noise: Noise = NO_NOISE,
    stripes=(),
    samples: int = 6,
) -> np.ndarray:
    """The picture of `pattern` (1 light, 0 dark, of target x, y in mm) at pose `where`.

    `grey` are the levels of dark and light.
    `stripes` are (a, b, c, width, height): Gaussian lines a·u + b·v = c of light added in the picture.
    """
    u, v, xy, jacobian = _pixels(camera.image_size, camera.matrix.tobytes(), camera.distortion.tobytes())
    back = np.linalg.inv(np.column_stack([where.rotation[:, :2], where.translation]))

    def seen(rays):
        on = np.column_stack([rays, np.ones(len(rays))]) @ back.T
        return pattern(on[:, 0] / on[:, 2], on[:, 1] / on[:, 2])

    share = seen(xy)
    grid = share.reshape(u.shape)
    around = np.ones((3, 3), np.uint8)
    edge = np.flatnonzero(cv2.dilate(grid, around) != cv2.erode(grid, around))
    # samples² points spread evenly over the pixel, no two in one row or column: edges along the rows stay smooth
    spread = (0.5 + np.arange(samples**2)[:, None] * [0.7548776662466927, 0.5698402909980532]) % 1 - 0.5
    offsets = spread - spread.mean(axis=0)
    share[edge] = np.mean([seen(xy[edge] + jacobian[edge] @ offset) for offset in offsets], axis=0)
    share = share.reshape(u.shape)
    dark, light = grey
    picture = cv2.GaussianBlur(dark + (light - dark) * share, (0, 0), blur)
    for a, b, c, sigma, peak in stripes:
        picture = picture + peak * np.exp(-0.5 * ((a * u + b * v - c) / sigma) ** 2)
    picture = picture + np.random.default_rng(noise.seed).normal(0, noise.grey, picture.shape)
    return np.rint(np.clip(picture, 0, 255)).astype(np.uint8)


def checkers(columns: int, rows: int, square: float) -> Pattern:
    """columns × rows inner corners, the first at (0, 0); the square diagonally outside it is black."""

    def pattern(x, y):
        i, j = np.floor(x / square).astype(int), np.floor(y / square).astype(int)
        inside = (i >= -1) & (i < columns) & (j >= -1) & (j < rows)
        return np.where(inside & ((i + j) % 2 == 0), 0.0, 1.0)

    return pattern


def square(side: float) -> Pattern:
    def pattern(x, y):
        return np.where((x >= 0) & (x < side) & (y >= 0) & (y < side), 0.0, 1.0)

    return pattern


def rectangle(width: float, height: float, line: float = 0.0) -> Pattern:
    """Dark throughout, or an outline of `line`."""

    def pattern(x, y):
        dark = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        if line:
            dark &= (x < line) | (x >= width - line) | (y < line) | (y >= height - line)
        return np.where(dark, 0.0, 1.0)

    return pattern


def circles(points: np.ndarray, radius: float) -> Pattern:
    def pattern(x, y):
        light = np.ones(len(x))
        for px, py, _ in points:
            light[(x - px) ** 2 + (y - py) ** 2 < radius**2] = 0.0
        return light

    return pattern


def board_picture(picture: np.ndarray, pixel_mm: float) -> Pattern:
    """A printed picture (0 … 255) whose first pixel's outer corner is (0, 0)."""

    def pattern(x, y):
        i, j = np.floor(x / pixel_mm).astype(int), np.floor(y / pixel_mm).astype(int)
        inside = (i >= 0) & (i < picture.shape[1]) & (j >= 0) & (j < picture.shape[0])
        return np.where(inside, picture[j.clip(0, picture.shape[0] - 1), i.clip(0, picture.shape[1] - 1)] / 255, 1.0)

    return pattern
