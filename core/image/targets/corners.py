"""Checkerboard corners: their grid, how far the board goes on beyond it, their refinement and its uncertainty.

cornerSubPix solves Σ w g gᵀ (p − q) = 0 for the corner q, with g the central-difference gradient at pixel p and w a
Gaussian weight. To first order noise n in the pixels moves q by M⁻¹ Σ w [g δg·(p − q) + δg g·(p − q)], M = Σ w g gᵀ,
and δg is a difference of pixels: so every pixel of the window has a known influence on q.
"""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from core.image.targets.picture import Picture
from core.model.arrays import Array

LEAST_STEP = 0.3
"""Share of the board's contrast by which black and white squares at a corner must differ."""

LEAST_GOOD = 0.65
"""Share of a further row's corners that must look like corners."""

MOST_UNEVEN = 0.35
"""Share of a square by which its sides may differ from the next one's: perspective and lens stay below it."""

SYSTEMATIC_PX = 0.025
"""As below, of pictures as they were taken."""
SYSTEMATIC_SMOOTHED_PX = 0.015
"""What the pixels' phase leaves on perfect, sharp pictures, RMS per coordinate in windows of 23 pixels: as taken, and
smoothed by 1 px. It grows with the root of a smaller window."""

AT_A_TIME = 16
"""Corners whose windows are looked at together: those of all of them would be many times the picture."""

_ACROSS, _DOWN = np.mgrid[-1:2, -1:2].reshape(2, 9, 1)
"""From a pixel to itself and its eight neighbours."""


def spacing(grid: Array) -> Array:
    """Compute the distance (R, C) in px from each corner of `grid` (R, C, 2) to its nearest neighbour."""
    nearest = np.full(grid.shape[:2], np.inf)
    along = np.linalg.norm(np.diff(grid, axis=1), axis=2)
    down = np.linalg.norm(np.diff(grid, axis=0), axis=2)
    nearest[:, :-1] = np.minimum(nearest[:, :-1], along)
    nearest[:, 1:] = np.minimum(nearest[:, 1:], along)
    nearest[:-1] = np.minimum(nearest[:-1], down)
    nearest[1:] = np.minimum(nearest[1:], down)
    return nearest


def squares_around(picture: Picture, corner: Array, along: Array, down: Array, share: float = 0.4) -> Array:
    """Sample grey levels (N, 4) in the four squares that meet at each `corner` (N, 2); NaN outside the picture.

    `along` and `down` (N, 2) lead to the next corners, `share` tells how far into the squares to look (0.5: their
    middles); order: before-above, after-above, after-below, before-below.
    """
    height, width = picture.shape
    levels = np.full((len(corner), 4), np.nan)
    for k, (a, b) in enumerate([(-1, -1), (1, -1), (1, 1), (-1, 1)]):
        u, v = np.rint(corner + share * (a * along + b * down)).astype(int).T
        inside = (u >= 1) & (v >= 1) & (u < width - 1) & (v < height - 1)
        u, v = u[inside], v[inside]
        levels[inside, k] = picture[v + _DOWN, u + _ACROSS].mean(axis=0)
    return levels


def blackness(picture: Picture, corner: Array, along: Array, down: Array, contrast: float) -> NDArray[np.int_]:
    """Compute for each `corner` (N,) +1 if first and third square around it are black, −1 if the other two are, else 0.

    Looked at in the squares, each for itself, and close to the corner, where round spots leave a gap and blur a smear.
    """
    levels = squares_around(picture, corner, along, down)
    diagonal, other = levels[:, 0::2], levels[:, 1::2]
    with np.errstate(invalid="ignore"):
        first = other.min(axis=1) - diagonal.max(axis=1) > LEAST_STEP * contrast
        second = diagonal.min(axis=1) - other.max(axis=1) > LEAST_STEP * contrast
        close = squares_around(picture, corner, along, down, 0.15)
        lighter = (close[:, 1::2] - close[:, 0::2]).mean(axis=1)
        first &= lighter > LEAST_STEP / 3 * contrast
        second &= lighter < -LEAST_STEP / 3 * contrast
    sign: NDArray[np.int_] = first.astype(np.int_) - second.astype(np.int_)
    return sign


def is_checkered(picture: Picture, grid: Array) -> bool:
    """Whether black and white alternate at the corners of `grid` (R, C, 2), nine in ten of them at least."""
    along, down = (step.reshape(-1, 2) for step in steps_of(grid))
    seen = blackness(picture, grid.reshape(-1, 2), along, down, contrast_of(picture, grid))
    return bool(abs((seen.reshape(grid.shape[:2]) * _parity(grid)).sum()) >= 0.9 * len(seen))


def is_even(grid: Array) -> bool:
    """Whether steps next to each other along rows and columns of `grid` (R, C, 2) are nearly equal."""
    limit = MOST_UNEVEN * spacing(grid)
    across = np.linalg.norm(np.diff(grid, 2, axis=1), axis=2) < limit[:, 1:-1]
    down = np.linalg.norm(np.diff(grid, 2, axis=0), axis=2) < limit[1:-1]
    return bool(across.all() and down.all())


def steps_of(grid: Array) -> tuple[Array, Array]:
    """Compute the steps in px to the next corner along rows and down columns of `grid` (R, C, 2), (R, C, 2) each."""
    return np.gradient(grid, axis=1), np.gradient(grid, axis=0)


def contrast_of(picture: Picture, grid: Array) -> float:
    """Compute the median difference in grey levels of white and black squares around the corners `grid` (R, C, 2)."""
    along, down = steps_of(grid)
    levels = squares_around(picture, grid.reshape(-1, 2), along.reshape(-1, 2), down.reshape(-1, 2))
    return float(np.nanmedian(np.abs(levels[:, 0] + levels[:, 2] - levels[:, 1] - levels[:, 3])) / 2)


def grow(picture: NDArray[np.uint8], grid: Array, most: int = 60) -> tuple[Array, bool]:
    """Extend corners `grid` (R, C, 2) by rows and columns while the board goes on; also tell if it is cut off.

    Returns
    -------
    The larger grid, and whether the board goes on where the picture ends.
    """
    contrast = contrast_of(picture, grid)
    cut_off = False
    for turn in range(4):
        grid = np.rot90(grid, turn)
        while len(grid) < most:
            row, outside = _next_row(picture, grid, contrast)
            if row is None:
                cut_off |= outside
                break
            grid = np.concatenate([row[None], grid])
        grid = np.rot90(grid, -turn)
    return grid, cut_off


def _next_row(picture: NDArray[np.uint8], grid: Array, contrast: float) -> tuple[Array | None, bool]:
    """The row of corners above the first row of `grid`, if the picture shows it; and whether it ends at the border."""
    guess = 3 * grid[0] - 3 * grid[1] + grid[2]
    down = grid[0] - guess
    along = np.gradient(guess, axis=0)
    reach = 0.5 * np.minimum(np.linalg.norm(down, axis=1), np.linalg.norm(along, axis=1))
    u, v = guess.T
    inside = (u > reach) & (v > reach) & (u < picture.shape[1] - reach) & (v < picture.shape[0] - reach)
    if not inside.all():
        return None, _board_reaches_out(picture, grid, contrast)
    half = int(max(2, 0.6 * reach.min()))
    row = refined(picture, guess, half)
    expected = -blackness(picture, grid[0], along, down, contrast)
    seen = blackness(picture, row, along, down, contrast)
    stayed = np.linalg.norm(row - guess, axis=1) < 0.6 * reach
    good = (seen == expected) & (seen != 0) & stayed
    if good.mean() < LEAST_GOOD:
        return None, False
    if not good.all():  # a stripe may hide a corner or two: put them where the others of the row say
        place = np.arange(len(row))
        curve = np.polynomial.polynomial.polyfit(place[good], row[good], min(2, int(good.sum()) - 1))
        row = np.where(good[:, None], row, np.polynomial.polynomial.polyval(place, curve).T)
    return row, False


def _board_reaches_out(picture: NDArray[np.uint8], grid: Array, contrast: float) -> bool:
    """Whether black and white still alternate half a square beyond the squares of the first row of `grid`."""
    along = np.gradient(grid[0], axis=0)
    down = grid[1] - grid[0]
    levels = squares_around(picture, grid[0] - 0.7 * down, along, 0.5 * down)[:, :2]
    steps = np.abs(levels[:, 0] - levels[:, 1])
    return bool(np.isnan(steps).mean() > 0.5 or np.nanmean(steps > LEAST_STEP * contrast) > 0.5)


def refined(picture: Picture, corners: Array, half: int) -> Array:
    """Refine `corners` (N, 2) to sub-pixel by OpenCV's cornerSubPix in windows of 2 `half` + 1 pixels."""
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 40, 0.001)
    start = np.ascontiguousarray(corners, dtype=np.float32).reshape(-1, 1, 2)
    return np.asarray(cv2.cornerSubPix(picture, start, (half, half), (-1, -1), stop), dtype=np.float64).reshape(-1, 2)


def oriented(picture: Picture, grid: Array, columns: int, rows: int) -> Array:
    """Turn corners `grid` (R, C, 2) to `rows` × `columns`, right-handed, and black square first if possible."""
    ways = [way for way in _turns(grid) if way.shape[:2] == (rows, columns) and right_handed(way)]
    black = [way for way in ways if first_is_black(picture, way)]
    return min(black or ways, key=lambda way: float(way[0, 0].sum()))


def _turns(grid: Array) -> Iterator[Array]:
    for mirrored in (grid, grid[:, ::-1]):
        for turn in range(4):
            yield np.rot90(mirrored, turn)


def right_handed(grid: Array) -> bool:
    """Whether the columns of `grid` (R, C, 2) follow its rows clockwise in the picture, as they do on a board."""
    along, down = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
    return bool(along[0] * down[1] - along[1] * down[0] > 0)


def first_is_black(picture: Picture, grid: Array) -> bool:
    """Whether the square outside the first corner of `grid` (R, C, 2) is black, by the vote of all corners."""
    along, down = steps_of(grid)
    levels = squares_around(picture, grid.reshape(-1, 2), along.reshape(-1, 2), down.reshape(-1, 2))
    signed = (levels[:, 1] + levels[:, 3] - levels[:, 0] - levels[:, 2]).reshape(grid.shape[:2])
    return bool(np.nansum(signed * _parity(grid)) > 0)


def _parity(grid: Array) -> NDArray[np.int_]:
    """+1 and −1 alternating (R, C)."""
    return 1 - 2 * (np.add.outer(np.arange(grid.shape[0]), np.arange(grid.shape[1])) % 2)


def corner_sigma(picture: Picture, corners: Array, half: int, noise: float, smoothing: float = 0.0) -> Array:
    """Compute the standard uncertainty (N,) in px of each coordinate of `corners` (N, 2).

    Parameters
    ----------
    half
        Half the refinement's window, in pixels.
    noise
        Standard deviation of the pixel noise in grey levels, before any smoothing.
    smoothing
        σ in pixels of the Gaussian that `picture` was smoothed with.
    """
    some = range(0, len(corners), AT_A_TIME)
    parts = [_corner_sigma(picture, corners[k : k + AT_A_TIME], half, noise, smoothing) for k in some]
    return np.concatenate([np.zeros(0), *parts])


def _corner_sigma(picture: Array, corners: Array, half: int, noise: float, smoothing: float) -> Array:
    margin = 2 + round(3 * smoothing)
    span = np.arange(-half - margin, half + margin + 1)
    base = np.rint(corners).astype(int)
    rows = (base[:, 1, None] + span).clip(0, picture.shape[0] - 1)
    columns = (base[:, 0, None] + span).clip(0, picture.shape[1] - 1)
    patch = picture[rows[:, :, None], columns[:, None, :]].astype(np.float64)

    gx, gy = np.zeros_like(patch), np.zeros_like(patch)
    gx[:, :, 1:-1] = (patch[:, :, 2:] - patch[:, :, :-2]) / 2
    gy[:, 1:-1] = (patch[:, 2:] - patch[:, :-2]) / 2
    x = np.broadcast_to((base[:, 0] - corners[:, 0])[:, None, None] + span[None, None, :], patch.shape)
    y = np.broadcast_to((base[:, 1] - corners[:, 1])[:, None, None] + span[None, :, None], patch.shape)
    window = np.where(np.abs(span) <= half, np.exp(-((span / half) ** 2)), 0.0)
    w = window[:, None] * window[None, :]

    normal = np.empty((len(corners), 2, 2))
    normal[:, 0, 0] = (w * gx * gx).sum((1, 2))
    normal[:, 1, 1] = (w * gy * gy).sum((1, 2))
    normal[:, 0, 1] = normal[:, 1, 0] = (w * gx * gy).sum((1, 2))
    normal += np.eye(2) * 1e-9 * (1 + np.trace(normal, axis1=1, axis2=2))[:, None, None]

    slope = gx * x + gy * y
    by_x = np.stack([w * (gx * x + slope), w * gy * x])  # ∂(sums)/∂(gx), for both components
    by_y = np.stack([w * gx * y, w * (gy * y + slope)])
    influence = np.zeros((2, *patch.shape))
    influence[:, :, :, 2:] += by_x[:, :, :, 1:-1] / 2
    influence[:, :, :, :-2] -= by_x[:, :, :, 1:-1] / 2
    influence[:, :, 2:] += by_y[:, :, 1:-1] / 2
    influence[:, :, :-2] -= by_y[:, :, 1:-1] / 2
    if smoothing:
        influence = gaussian_filter(influence, (0, 0, smoothing, smoothing), truncate=3)
    spread = np.einsum("anij,bnij->nab", influence, influence) * noise**2
    inverse = np.linalg.inv(normal)
    covariance = inverse @ spread @ inverse
    systematic = (SYSTEMATIC_SMOOTHED_PX if smoothing else SYSTEMATIC_PX) * np.sqrt(11 / half)
    sigma: Array = np.sqrt(np.trace(covariance, axis1=1, axis2=2) / 2 + systematic**2)
    return sigma
