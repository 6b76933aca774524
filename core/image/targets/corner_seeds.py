"""First corners of a checkerboard: nine saddle points that lie like its corners do."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.image.targets.grid import is_checkered, refined
from core.model.arrays import Array

MOST_SADDLES = 1500
"""Saddle points looked at, the strongest ones of the picture."""

MOST_TRIES = 500
"""Saddle points tried in vain before the search ends."""

NEIGHBOURS = 200
"""Saddle points about one of them among which its neighbours in the grid must be."""

ALIKE = 0.1
"""Strength of a corner's neighbours, as a share of its own, at least (it goes with the square of the contrast)."""

BLUR = 1.5
"""σ in pixels at which saddles are sought: squares from about 7 pixels on."""


def seed_grids(picture: NDArray[np.uint8], known: list[Array]) -> Iterator[Array]:
    """Grids (3, 3, 2) of refined corners at which black and white alternate, strongest saddles first.

    A saddle's two edges run where its second derivative vanishes; its neighbours in the grid are the next saddles
    along them. Seeds within the grids of `known`, to which the caller may add between two seeds, are left out.
    """
    points, edges, strength = _saddles(picture)
    if len(points) < 9:
        return
    near = np.asarray(cKDTree(points).query(points, k=min(NEIGHBOURS, len(points)))[1], dtype=np.intp)
    tries = 0
    for k, point in enumerate(points):
        if any(_within(grid, point) for grid in known):
            continue
        seed = _seed(picture, points[near[k][strength[near[k]] >= ALIKE * strength[k]]], edges[k])
        if seed is not None:
            yield seed
        tries += seed is None
        if tries > MOST_TRIES:
            return


def _within(grid: Array, point: Array) -> bool:
    outline = cv2.convexHull(grid.reshape(-1, 2).astype(np.float32))
    return cv2.pointPolygonTest(outline, (float(point[0]), float(point[1])), False) >= 0


def _saddles(picture: NDArray[np.uint8]) -> tuple[Array, Array, Array]:
    """Saddle points (N, 2), the unit directions (N, 2, 2) of the two edges through each, and their falling strength."""
    smooth = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), BLUR)
    xx, yy, xy = (cv2.Sobel(smooth, -1, *order, ksize=3) for order in ((2, 0), (0, 2), (1, 1)))
    strength = xy * xy - xx * yy
    peak = (strength >= cv2.dilate(strength, np.ones((5, 5), dtype=np.uint8))) & (strength > 1.0)
    v, u = np.nonzero(peak)
    order = np.argsort(-strength[v, u], kind="stable")[:MOST_SADDLES]
    u, v = u[order], v[order]
    a, b, c = (part[v, u].astype(np.float64) for part in (xx, xy, yy))
    # the second derivative along θ is mean + swing cos 2(θ − axis); along the edges it is zero
    mean, swing, axis = (a + c) / 2, np.hypot((a - c) / 2, b), np.arctan2(b, (a - c) / 2) / 2
    apart = np.arccos(np.clip(-mean / np.maximum(swing, 1e-12), -1, 1)) / 2
    angles = np.column_stack([axis - apart, axis + apart])
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=2)
    return np.column_stack([u, v]).astype(np.float64), directions, strength[v, u].astype(np.float64)


def _seed(picture: NDArray[np.uint8], points: Array, edges: Array) -> Array | None:
    """The grid (3, 3, 2) about the first of `points`, if its neighbours are there and black and white alternate."""
    if len(points) < 9:
        return None
    offsets = points - points[0]
    steps = [_next_along(offsets, sign * edge) for edge in edges for sign in (-1, 1)]
    before, after, above, below = steps
    if before is None or after is None or above is None or below is None:
        return None
    rough = np.array(
        [
            [before + above, above, after + above],
            [before, np.zeros(2), after],
            [before + below, below, after + below],
        ]
    )
    spread = np.linalg.norm(rough, axis=2)
    reach = float(spread[spread > 0].min())
    distance = np.linalg.norm((points[0] + rough).reshape(-1, 1, 2) - points, axis=2)
    index = distance.argmin(axis=1)
    if distance.min(axis=1).max() > 0.35 * reach or len(set(index)) < 9:
        return None
    height, width = picture.shape
    grid = refined(picture, points[index], int(np.clip(0.3 * reach, 2, 8))).reshape(3, 3, 2)
    if not ((grid > 0) & (grid < [width, height])).all() or np.linalg.norm(grid[1, 1] - points[0]) > 0.3 * reach:
        return None
    return grid if is_checkered(picture, grid) else None


def _next_along(offsets: Array, direction: Array) -> Array | None:
    """The nearest of `offsets` (N, 2) within 15° of `direction` (2,)."""
    along = offsets @ direction
    across = np.abs(offsets @ np.array([-direction[1], direction[0]]))
    ahead = np.flatnonzero((along > 0) & (across < 0.27 * along))
    return offsets[ahead[np.argmin(along[ahead])]] if len(ahead) else None
