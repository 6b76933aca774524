"""Checkerboard corners, found on a reduced picture and refined at full resolution."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.target_view import TargetView
from core.image.targets.corner_noise import corner_sigma
from core.image.targets.corner_seeds import seed_grids
from core.image.targets.grid import grow, oriented, refined, spacing
from core.image.targets.kinds import Checkerboard
from core.image.targets.not_found import TargetNotFound
from core.image.targets.picture import Picture, as_8bit, as_refinable, enlarged, noise_of, reduced, without_stripes
from core.model.arrays import Array

LARGEST_HALF_WINDOW = 11
"""Half the window of the corner refinement in pixels, where the squares are large enough for it."""

SMOOTHED_FROM = 40.0
"""Spacing of the corners in pixels from which on the picture is smoothed by σ = 1 px before the refinement."""

MOST_BOARDS = 12
"""Seeds followed in one picture."""


def detect_checkerboard(board: Checkerboard, picture: Picture, name: str = "") -> TargetView:
    """The inner corners of `board` in `picture`, in the order of `board.points`.

    Nine corners are found on a picture reduced to about 1000 pixels, with laser stripes removed if need be, and grown
    until the board ends: so a board of another size, and a part of the board, are told from no board.

    The corners are refined at full size by cornerSubPix, in windows of up to 23 × 23 pixels. Where the squares are
    large enough to spare the detail, the picture is smoothed first: that halves the error from the pixels' phase,
    which cornerSubPix's central differences leave on sharp pictures (from 0.025 to 0.015 px RMS).

    Raises
    ------
    TargetNotFound
        If the picture shows no checkerboard, one of another size, or a part of it.
    """
    full = as_8bit(picture)
    seen: list[tuple[Array, bool]] = []
    for longest in (1000, 2000):
        small, factor = reduced(full, longest)
        for candidate in (small, without_stripes(small, 9)):
            found = _boards(candidate)
            for grid, _ in found:
                if sorted(grid.shape[:2]) == sorted((board.columns, board.rows)):
                    return _view(board, picture, enlarged(grid, factor), factor, name)
            seen.extend(found)
        if factor == 1:
            break
    raise _failure(board, seen, name)


def _boards(picture: NDArray[np.uint8]) -> list[tuple[Array, bool]]:
    """Corners (R, C, 2) of boards or parts of them, to the pixel, and whether the picture's border cuts them off."""
    known: list[Array] = []
    boards: list[tuple[Array, bool]] = []
    for seed in seed_grids(picture, known):
        grid, cut_off = grow(picture, seed)
        known.append(grid)
        if min(grid.shape[:2]) > 3 or max(grid.shape[:2]) > 4:
            boards.append((grid, cut_off))
        if len(known) >= MOST_BOARDS:
            break
    return boards


def _view(board: Checkerboard, picture: Picture, grid: Array, factor: int, name: str) -> TargetView:
    """Refine a whole grid of corners at full size."""
    pixels = as_refinable(picture)
    nearest = float(spacing(grid).min())
    smoothing = 1.0 if nearest >= SMOOTHED_FROM else 0.0
    if smoothing:
        pixels = cv2.GaussianBlur(pixels.astype(np.float32), (0, 0), smoothing)
    room = 0.5 * nearest
    if factor > 1:  # the reduced picture's corners are out by its pixels: come closer before the last, wide window
        grid = refined(pixels, grid.reshape(-1, 2), int(np.clip(room, 3, 2 * factor + 1))).reshape(grid.shape)
    grid = oriented(picture, grid, board.columns, board.rows)
    half = int(np.clip(round(room), 2, LARGEST_HALF_WINDOW))
    corners = refined(pixels, grid.reshape(-1, 2), half)
    sigma = corner_sigma(pixels, corners, half, noise_of(picture, corners), smoothing)
    return TargetView(board.points, corners, sigma, name)


def _failure(board: Checkerboard, seen: list[tuple[Array, bool]], name: str) -> TargetNotFound:
    """The sentence for a picture without the whole board."""
    if not seen:
        return TargetNotFound(
            "no checkerboard is seen in the picture", where=name, todo="leave the picture out or take it again"
        )
    grid, cut_off = max(seen, key=lambda found: found[0].shape[0] * found[0].shape[1])
    wanted = f"{board.columns} × {board.rows}"
    rows, columns = grid.shape[:2]
    longer, shorter = max(rows, columns), min(rows, columns)
    shown = f"{longer} × {shorter}" if board.columns >= board.rows else f"{shorter} × {longer}"
    fits = longer <= max(board.columns, board.rows) and shorter <= min(board.columns, board.rows)
    if fits and cut_off:
        return TargetNotFound(
            f"only a part of the board is in the picture: {shown} of its {wanted} inner corners",
            where=name,
            todo="move the board so that the whole of it is seen, with its margin",
        )
    return TargetNotFound(
        f"the board shows {shown} inner corners, not {wanted}",
        where=name,
        todo="check inner_corners in rig.toml" + (", or whether a part of the board is covered" if fits else ""),
    )
