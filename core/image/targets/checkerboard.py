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

HALF_WINDOW = 11
"""Half the window of the corner refinement in pixels, where the squares are large enough for it."""

LARGEST_HALF_WINDOW = 35
"""The same where the lens leaves the squares' edges straight."""

LARGEST_SAG_PX = 0.03
"""Edges count as straight as long as they bend by no more than this from the corner to the window's border."""

SMOOTHED_FROM = 40.0
"""Spacing of the corners in pixels from which on the picture is smoothed by σ = 1 px before the refinement."""

MOST_SMOOTHED = 2.0
"""Largest σ in pixels of that, in the largest windows."""

MOST_BOARDS = 12
"""Seeds followed in one picture."""


def detect_checkerboard(board: Checkerboard, picture: Picture, name: str = "") -> TargetView:
    """The inner corners of `board` in `picture`, in the order of `board.points`.

    Nine corners are found on a picture reduced to about 1000 pixels, with laser stripes removed if need be, and grown
    until the board ends: so a board of another size, and a part of the board, are told from no board.

    The corners are refined at full size by cornerSubPix, in windows of 23 × 23 pixels or, where the lens leaves edges
    straight, half way to the next corner, for edges hold their corner all along. Where the squares are large enough to
    spare the detail, the picture is smoothed first, for cornerSubPix's central differences leave an error from the
    pixels' phase on sharp pictures. On rendered pictures of the paper's camera the larger windows bring the error from
    0.020 to 0.011 px (full) and from 0.022 to 0.014 px (half resolution).

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
    if factor > 1:  # the reduced picture's corners are out by its pixels: come closer before the last, wide window
        coarse = int(np.clip(0.5 * nearest, 3, 2 * factor + 1))
        grid = refined(pixels, grid.reshape(-1, 2), coarse).reshape(grid.shape)
    half = half_window(grid)
    smoothing = min(0.1 * half, MOST_SMOOTHED) if half > HALF_WINDOW else float(nearest >= SMOOTHED_FROM)
    if smoothing:
        pixels = cv2.GaussianBlur(pixels.astype(np.float32), (0, 0), smoothing)
    grid = oriented(picture, grid, board.columns, board.rows)
    corners = refined(pixels, grid.reshape(-1, 2), half)
    sigma = corner_sigma(pixels, corners, half, noise_of(picture, corners), smoothing)
    return TargetView(board.points, corners, sigma, name)


def half_window(grid: Array) -> int:
    """Half the window, in pixels, for corners (R, C, 2): as large as the squares and the lens's distortion allow."""
    nearest = float(spacing(grid).min())
    room = int(np.clip(round(0.5 * nearest), 2, LARGEST_HALF_WINDOW))
    bends = np.concatenate([_bends(line) for line in (*grid, *grid.transpose(1, 0, 2))])
    straight = nearest * np.sqrt(LARGEST_SAG_PX / max(0.5 * float(np.quantile(bends, 0.95)), 1e-6))
    return min(room, max(HALF_WINDOW, int(straight)))


def _bends(line: Array) -> Array:
    """How far each inner corner of a `line` (N, 2) is off the straight one through its neighbours, twice, in pixels.

    A perspective view leaves lines straight and moves corners along them only: what is left is the lens.
    """
    along = line[2:] - line[:-2]
    second = line[2:] - 2 * line[1:-1] + line[:-2]
    return np.asarray(
        np.abs(along[:, 0] * second[:, 1] - along[:, 1] * second[:, 0]) / np.linalg.norm(along, axis=1),
        dtype=np.float64,
    )


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
