"""Which corners of a checkerboard a part of it shows that the picture's border cuts off.

A side of the part is the board's end if even ground is seen beyond its outer squares. From the ends seen, the number of
corners between them, and the colours (columns + rows odd: the board differs from itself turned round) follows where on
the board the part may lie; if that leaves several places, its corners are not known, only its plane is.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.image.targets.corners import LEAST_STEP, contrast_of, first_is_black, right_handed
from core.image.targets.kinds import Checkerboard
from core.image.targets.pose import homography_of, map_by
from core.model.arrays import Array

LEAST_SHARE = 0.25
"""Share of the board's corners that a part must show: less may be a pattern that belongs to something else."""

OUTSIDE_SQUARE = 1.35
"""How far outside the last corners the ground is looked at, in squares: the outer square ends at 1."""

LEAST_SEEN = 0.6
"""Share of a side along which that ground must be in the picture."""

LEAST_EVEN = 0.8
"""Share of it that must be even."""


class Place(NamedTuple):
    """Place of a part on the board: its first corner after `turn` quarter turns of its grid."""

    turn: int
    row: int
    column: int


def places(picture: NDArray[np.uint8], grid: Array, board: Checkerboard) -> list[Place]:
    """List places on `board` where the corners `grid` (R, C, 2), right-handed, may lie; [] if nowhere.

    Places that the board's own symmetry makes alike count as one: that whose origin is nearest to the picture's top
    left, as for a whole board.
    """
    if grid.shape[0] * grid.shape[1] < LEAST_SHARE * board.columns * board.rows:
        return []
    groups: dict[Place, list[Place]] = {}
    for place in _possible(picture, grid, board):
        groups.setdefault(_canonical(place, grid, board), []).append(place)
    return [min(group, key=lambda place: _origin(place, grid, board)) for group in groups.values()]


def right_handed_grid(grid: Array) -> Array:
    """Mirror `grid` (R, C, 2) if it is left-handed, else return it unchanged."""
    return grid if right_handed(grid) else grid[:, ::-1]


def on_board(place: Place, grid: Array, board: Checkerboard) -> tuple[Array, Array]:
    """Turn the corners `grid` (R, C, 2) of a part to the board's order; also give their points in mm."""
    way = np.rot90(grid, place.turn)
    rows, columns = way.shape[:2]
    points = board.points.reshape(board.rows, board.columns, 3)
    block = points[place.row : place.row + rows, place.column : place.column + columns]
    return way, block.reshape(-1, 3)


def within_dark_ground(picture: NDArray[np.uint8], grid: Array) -> Array | None:
    """Drop the outermost corners of `grid` (R, C, 2) if the ground is as dark as the board's black; else None.

    None if it is not: the ground must be seen on two sides at least, and be dark on all on which it is seen.
    """
    if min(grid.shape[:2]) < 5:
        return None
    half = contrast_of(picture, grid) / 2
    dark = 0
    for turn in range(4):
        side = np.rot90(grid, turn)
        step = _outward(side)
        middle, out = (side[0, 1:] + side[0, :-1]) / 2, (step[1:] + step[:-1]) / 2
        squares, ground = (_levels(picture, middle + far * out) for far in (0.5, OUTSIDE_SQUARE))
        if np.isfinite(ground).mean() < LEAST_SEEN or np.isnan(squares).all():
            continue
        if not (_ends(picture, side, 2 * half) and np.nanmedian(ground) < np.nanmin(squares) + half):
            return None
        dark += 1
    return grid[1:-1, 1:-1] if dark >= 2 else None


def nearest_to_middle(choices: list[Place], grid: Array, board: Checkerboard) -> Place:
    """Choose of `choices` the place on the board that puts the corners `grid` (R, C, 2) nearest to its middle."""
    middle = board.points.mean(axis=0)
    return min(choices, key=lambda place: float(np.linalg.norm(on_board(place, grid, board)[1].mean(axis=0) - middle)))


def _possible(picture: NDArray[np.uint8], grid: Array, board: Checkerboard) -> Iterator[Place]:
    contrast = contrast_of(picture, grid)
    for turn in range(4):
        way = np.rot90(grid, turn)
        right, bottom, left = (np.rot90(way, quarter) for quarter in (1, 2, 3))
        rows = _offsets(picture, way, bottom, board.rows, contrast)
        columns = _offsets(picture, left, right, board.columns, contrast)
        black = first_is_black(picture, way)
        for row in rows:
            for column in columns:
                if not _first_must_be_black(board) or black == ((row + column) % 2 == 0):
                    yield Place(turn, row, column)


def _offsets(picture: NDArray[np.uint8], first: Array, last: Array, count: int, contrast: float) -> list[int]:
    """Which of the board's `count` lines the part's first one may be, its two sides being the first rows of two grids.

    A line is missing only where the border cuts.
    """
    missing = count - len(first)
    if missing <= 0:
        return [0] if missing == 0 else []
    ends = [_ends(picture, side, contrast) for side in (first, last)]
    cut = [_at_border(picture, side) for side in (first, last)]
    if all(ends) or not all(end or there for end, there in zip(ends, cut, strict=True)):
        return []
    return [0] if ends[0] else [missing] if ends[1] else list(range(missing + 1))


def _outward(side: Array) -> Array:
    """From the first row of a grid to where the row before it would be (C, 2)."""
    return np.asarray(2 * side[0] - 3 * side[1] + side[2], dtype=np.float64)


def _at_border(picture: NDArray[np.uint8], side: Array) -> bool:
    """Whether a further row before the first one of `side` would leave the picture, or come too near to its border."""
    step = _outward(side)
    further = side[0] + 1.5 * step
    height, width = picture.shape
    return bool(((further < 0) | (further > [width - 1, height - 1])).any())


def _ends(picture: NDArray[np.uint8], side: Array, contrast: float) -> bool:
    """Whether the board ends beyond the first row of `side` (R, C, 2): even ground where further squares would be."""
    step = _outward(side)
    middle, out = (side[0, 1:] + side[0, :-1]) / 2, (step[1:] + step[:-1]) / 2
    levels = _levels(picture, middle + OUTSIDE_SQUARE * out)
    known = np.isfinite(levels[1:]) & np.isfinite(levels[:-1])
    if known.sum() < 2 or known.mean() < LEAST_SEEN:
        return False
    even = np.abs(np.diff(levels))[known] < LEAST_STEP * contrast
    return bool(even.mean() >= LEAST_EVEN)


def ends_all_round(picture: NDArray[np.uint8], grid: Array) -> bool:
    """Whether the board ends on all four sides of the corners `grid` (R, C, 2), so that these are all it has."""
    contrast = contrast_of(picture, grid)
    return all(_ends(picture, np.rot90(grid, turn), contrast) for turn in range(4))


def _levels(picture: NDArray[np.uint8], uv: Array) -> Array:
    """Mean grey levels (N,) of 3 × 3 pixels around `uv` (N, 2), NaN outside the picture."""
    height, width = picture.shape
    levels = np.full(len(uv), np.nan)
    u, v = np.rint(uv).astype(int).T
    inside = (u >= 1) & (v >= 1) & (u < width - 1) & (v < height - 1)
    u, v = u[inside], v[inside]
    levels[inside] = np.mean([picture[v + j, u + i] for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0)
    return levels


def _first_must_be_black(board: Checkerboard) -> bool:
    """Whether every such board has its first corner beside a black square."""
    return (board.columns + board.rows) % 2 == 1 or (board.columns == board.rows and board.columns % 2 == 1)


def _canonical(place: Place, grid: Array, board: Checkerboard) -> Place:
    """One of the places that the board's symmetry makes alike, the same for all of them."""
    if (board.columns + board.rows) % 2:
        return place
    rows, columns = np.rot90(grid, place.turn).shape[:2]
    if place.turn >= 2:
        place = Place(place.turn - 2, board.rows - rows - place.row, board.columns - columns - place.column)
    if place.turn == 1 and board.columns == board.rows and board.columns % 2 == 0:
        # rot90 brings a corner (r, c) of the grid before to (columns − 1 − c, r)
        place = Place(0, place.column, board.rows - rows - place.row)
    return place


def _origin(place: Place, grid: Array, board: Checkerboard) -> float:
    """Sum of u and v where the board's first corner is in the picture, or would be."""
    way, points = on_board(place, grid, board)
    homography = homography_of(points[:, :2], way.reshape(-1, 2))
    return np.inf if homography is None else float(map_by(homography, np.zeros((1, 2)))[0].sum())
