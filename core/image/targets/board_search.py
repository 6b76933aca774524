"""Search for a checkerboard's corners, to the pixel: saddle points that lie like its corners, grown until it ends.

First the way that suffices for most pictures: two reduced pictures, with and without laser stripes. Where that finds no
board of the size sought, a pyramid of scales, at each of which only saddles that look like corners count, and OpenCV's
two detectors. Whatever finds it, the board's own squares and ends decide whether it is one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from core.image.targets.corners import grow, is_checkered, is_even, refined, spacing
from core.image.targets.picture import enlarged, reduced, resized, without_stripes
from core.model.arrays import Array

MOST_BOARDS = 12
"""Seeds followed in one picture."""

MOST_SADDLES = 1500
"""Saddle points looked at in the first, quick search: the strongest ones of the picture."""

MOST_CORNERS = 4000
"""Saddle points that look like corners looked at in one picture of the pyramid: more than any board has."""

MOST_TRIES = 500
"""Saddle points tried in vain before the search ends."""

BLUR = 1.5
"""σ in pixels at which saddles are sought: squares from about 7 pixels on."""

PYRAMID = (1000, 640, 1800, 450, 2800)
"""Longer sides in pixels of the pictures searched thoroughly; a smaller one is doubled once, for its small squares."""

LARGEST_OF_OPENCV = 1400
"""Longer side in pixels of the largest picture given to OpenCV's detectors, which take seconds over larger ones."""

RING = 4.0
"""Radius in pixels of the ring on which a saddle must look like a corner: inside squares from 6 pixels on."""

LEAST_EVEN = 0.75
"""Share of a corner's brightness on the ring that is the same on opposite sides; clutter has about half."""

LEAST_TWOFOLD = 0.4
"""Share of it that rises and falls twice around; edges at 35° to each other still have half."""

QUICK_CHECK = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_FAST_CHECK
"""Of OpenCV's older detector: as usual, but it gives up where no squares of one size are seen, in a fiftieth of the
time that it takes over a picture in which there is no board."""


@dataclass(frozen=True, eq=False, slots=True)
class Found:
    """Corners `grid` (R, C, 2) of a board or a part of it in full pixels, and whether the picture's border cuts it off.

    `factor`: full pixels in one of the picture it was found in, and so about its error.
    """

    grid: Array
    cut_off: bool
    factor: float


def quick_search(picture: NDArray[np.uint8]) -> Iterator[Found]:
    """Yield boards found in the picture reduced to 1000 and 2000 px, with and without laser stripes."""
    for longest in (1000, 2000):
        small, factor = reduced(picture, longest)
        for candidate in (small, without_stripes(small, 9)):
            for grid, cut_off in _boards(candidate, _strongest_saddles(candidate)):
                yield Found(enlarged(grid, factor), cut_off, factor)
        if factor == 1:
            break


def thorough_search(picture: NDArray[np.uint8], columns: int, rows: int) -> Iterator[Found]:
    """Yield boards found at several scales, then those OpenCV finds of `columns` × `rows` corners."""
    scales = _pyramid(picture)
    for small, factor in scales:
        for grid, cut_off in _boards(small, _corner_like(small)):
            yield Found(enlarged(grid, factor), cut_off, factor)
    for small, factor in _for_opencv(picture):
        for grid in _of_opencv(small, columns, rows):
            yield Found(enlarged(grid, factor), False, factor)


def _for_opencv(picture: NDArray[np.uint8]) -> list[tuple[NDArray[np.uint8], float]]:
    """Where OpenCV's detectors look: in the picture, reduced where it is large, and at half that size."""
    longest = max(picture.shape)
    scale = max(1.0, longest / LARGEST_OF_OPENCV)
    return [resized(picture, scale), resized(picture, 2 * scale)] if longest > 800 else [resized(picture, 1.0)]


def _pyramid(picture: NDArray[np.uint8]) -> list[tuple[NDArray[np.uint8], float]]:
    """The picture at the scales to be searched, and how many full pixels are in one of each."""
    longest = max(picture.shape)
    sides = [side for side in PYRAMID if side < 0.85 * longest]
    if longest < 0.85 * max(PYRAMID):
        sides.append(longest if longest > 1000 else 2 * longest)
    if longest <= 1000:
        sides.insert(0, longest)
    return [resized(picture, longest / side) for side in sides]


def _boards(picture: NDArray[np.uint8], saddles: _Saddles) -> Iterator[tuple[Array, bool]]:
    """Corners (R, C, 2) of boards or parts of them, to the pixel, and whether the picture's border cuts them off."""
    known: list[Array] = []
    for seed in _seed_grids(picture, saddles, known):
        grid, cut_off = grow(picture, seed)
        known.append(grid)
        if min(grid.shape[:2]) > 3 or max(grid.shape[:2]) > 4:
            yield grid, cut_off
        if len(known) >= MOST_BOARDS:
            return


@dataclass(frozen=True, eq=False, slots=True)
class _Saddles:
    """Saddle points (N, 2), the unit directions (N, 2, 2) of the two edges through each, their falling strength (N,).

    `turn` (N,): the angle of the line through a saddle's light squares; neighbours in a grid are a right angle apart.
    """

    points: Array
    edges: Array
    strength: Array
    turn: Array

    def select(self, index: NDArray[np.intp]) -> _Saddles:
        return _Saddles(self.points[index], self.edges[index], self.strength[index], self.turn[index])


def _saddles(picture: NDArray[np.uint8], most: int | None = None) -> _Saddles:
    """All saddle points of a picture, or the `most` strongest ones."""
    smooth = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), BLUR)
    xx, yy, xy = (cv2.Sobel(smooth, -1, *order, ksize=3) for order in ((2, 0), (0, 2), (1, 1)))
    strength = xy * xy - xx * yy
    peak = (strength >= cv2.dilate(strength, np.ones((5, 5), dtype=np.uint8))) & (strength > 1.0)
    v, u = np.nonzero(peak)
    order = np.argsort(-strength[v, u], kind="stable")[:most]
    u, v = u[order], v[order]
    a, b, c = (part[v, u].astype(np.float64) for part in (xx, xy, yy))
    # the second derivative along θ is mean + swing cos 2(θ − axis); along the edges it is zero
    mean, swing, axis = (a + c) / 2, np.hypot((a - c) / 2, b), np.arctan2(b, (a - c) / 2) / 2
    apart = np.arccos(np.clip(-mean / np.maximum(swing, 1e-12), -1, 1)) / 2
    angles = np.column_stack([axis - apart, axis + apart])
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=2)
    points = np.column_stack([u, v]).astype(np.float64)
    return _Saddles(points, directions, strength[v, u].astype(np.float64), axis)


def _strongest_saddles(picture: NDArray[np.uint8]) -> _Saddles:
    saddles = _saddles(picture, MOST_SADDLES)
    return _Saddles(saddles.points, saddles.edges, saddles.strength, np.full(len(saddles.turn), np.nan))


def _corner_like(picture: NDArray[np.uint8]) -> _Saddles:
    """The saddles on a ring about which light and dark alternate twice, the same on opposite sides."""
    saddles = _saddles(picture)
    if not len(saddles.points):
        return saddles
    smooth = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), 1.0)
    angle = np.arange(16) * (np.pi / 8)
    around = RING * np.column_stack([np.cos(angle), np.sin(angle)])
    good: list[NDArray[np.intp]] = []
    for first in range(0, len(saddles.points), MOST_CORNERS):  # strongest first; where all are noise there are many
        ring = saddles.points[first : first + MOST_CORNERS, None, :] + around
        levels = np.asarray(map_coordinates(smooth, ring.reshape(-1, 2).T[::-1], order=1, mode="nearest"))
        good.append(first + np.flatnonzero(_alternate(levels.reshape(-1, len(around)))))
        if sum(map(len, good)) >= MOST_CORNERS:
            break
    return saddles.select(np.concatenate(good)[:MOST_CORNERS])


def _alternate(levels: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether the levels (N, 16) on rings about saddles rise and fall twice, the same on opposite sides."""
    waves = np.abs(np.fft.rfft(levels.astype(np.float64), axis=1)) ** 2
    waves[:, -1] /= 2  # the only one that the transform has once
    total = np.maximum(waves[:, 1:].sum(axis=1), 1e-12)
    alternate: NDArray[np.bool_] = waves[:, 2::2].sum(axis=1) > LEAST_EVEN * total
    alternate &= waves[:, 2] > LEAST_TWOFOLD * total
    return alternate


def _seed_grids(picture: NDArray[np.uint8], saddles: _Saddles, known: list[Array]) -> Iterator[Array]:
    """Grids (3, 3, 2) of refined corners at which black and white alternate, strongest saddles first.

    A saddle's two edges run where its second derivative vanishes; its neighbours in the grid are the next saddles
    along them. Seeds within the grids of `known`, to which the caller may add between two seeds, are left out.
    """
    from core.image.targets.grid_of_nine import nine_about  # what is compiled takes time to import that most never need

    points = saddles.points
    nine = np.empty(9, dtype=np.int64)
    if len(points) < len(nine):
        return
    tries = 0
    for k, point in enumerate(points):
        if any(_within(grid, point) for grid in known):
            continue
        reach = nine_about(points, saddles.edges, saddles.strength, saddles.turn, k, nine)
        seed = _seed(picture, points[nine], reach) if reach > 0 else None
        if seed is not None:
            yield seed
        tries += seed is None
        if tries > MOST_TRIES:
            return


def _within(grid: Array, point: Array) -> bool:
    outline = cv2.convexHull(grid.reshape(-1, 2).astype(np.float32))
    return cv2.pointPolygonTest(outline, (float(point[0]), float(point[1])), False) >= 0


def _seed(picture: NDArray[np.uint8], corners: Array, reach: float) -> Array | None:
    """The `corners` (9, 2) refined as a grid (3, 3, 2), if black and white alternate there.

    None if the middle one moves by more than a part of `reach`, the shortest way to another one.
    """
    height, width = picture.shape
    grid = refined(picture, corners, int(np.clip(0.3 * reach, 2, 8))).reshape(3, 3, 2)
    if not ((grid > 0) & (grid < [width, height])).all() or np.linalg.norm(grid[1, 1] - corners[4]) > 0.3 * reach:
        return None
    return grid if is_checkered(picture, grid) else None


def _of_opencv(picture: NDArray[np.uint8], columns: int, rows: int) -> Iterator[Array]:
    """Grids (rows, columns, 2) that OpenCV's detectors find and that stand up to our own look at their corners.

    Duda, A. & Frese, U., Accurate detection and localization of checkerboard corners for calibration, BMVC 2018, is the
    first of them; it leaves corners out of their place now and then, and either may take a part of a larger board.
    """
    for detector in (cv2.findChessboardCornersSB, partial(cv2.findChessboardCorners, flags=QUICK_CHECK)):
        there, corners = detector(picture, (columns, rows))
        if not there:
            continue
        grid = np.asarray(corners, dtype=np.float64).reshape(rows, columns, 2)
        half = int(np.clip(0.3 * spacing(grid).min(), 2, 8))
        grid = refined(picture, grid.reshape(-1, 2), half).reshape(grid.shape)
        if is_even(grid) and is_checkered(picture, grid):
            yield grow(picture, grid)[0]
