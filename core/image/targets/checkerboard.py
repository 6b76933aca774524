"""Checkerboard corners: the whole board, or a part of it whose place is known, refined at full resolution."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.targets.board_part import (
    Place,
    ends_all_round,
    nearest_to_middle,
    on_board,
    places,
    right_handed_grid,
    within_dark_ground,
)
from core.image.targets.board_search import Found, quick_search, thorough_search
from core.image.targets.corners import corner_sigma, is_even, oriented, refined, spacing
from core.image.targets.kinds import Checkerboard
from core.image.targets.picture import Picture, as_8bit, as_refinable, noise_of
from core.image.targets.pose import estimate_pose
from core.image.targets.target_view import LEAVE_OUT_OR_RETAKE, OtherBoard, TargetNotFound, TargetView
from core.messages import Field, Message
from core.model import Camera
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

_CORNERS = Field("target.inner_corners")


def detect_checkerboard(
    board: Checkerboard, picture: Picture, name: str = "", camera: Camera | None = None, *, thorough: bool = True
) -> TargetView:
    """Find the inner corners of `board` in `picture` (H, W), in the order of `board.points`.

    Nine corners are found on a reduced picture and grown until the board ends: so a board of another size, and a part
    of the board, are told from no board. Where the quick search does not find it, a `thorough` one goes through more
    scales and detectors (:mod:`core.image.targets.board_search`).

    On dark ground, without a light margin, the outer black squares are lost to the eye: a board counted without their
    corners, as OpenCV does, is found, too.

    A part that the picture's border cuts off will do where its ends and colours tell which corners it shows; with a
    `camera` any part will do that has one pose only, for its plane (`TargetView.placed` is then False).

    The corners are refined at full size by cornerSubPix, in windows of 23 × 23 pixels or, where the lens leaves edges
    straight, half way to the next corner, for edges hold their corner all along. Where the squares are large enough to
    spare the detail, the picture is smoothed first, for cornerSubPix's central differences leave an error from the
    pixels' phase on sharp pictures. On rendered pictures of the paper's camera the larger windows bring the error from
    0.020 to 0.011 px (full) and from 0.022 to 0.014 px (half resolution).

    Raises
    ------
    TargetNotFound
        If the picture shows no checkerboard, one of another size, or a part of it that may be any.
    """
    full = as_8bit(picture)
    seen: list[Found] = []
    for found in quick_search(full):
        if _whole(board, found):
            return _refined_view(board, picture, found, name)
        seen.append(found)
    for found in seen:
        inner = within_dark_ground(full, found.grid)
        if inner is not None and _whole(board, replace(found, grid=inner)):
            return _refined_view(board, picture, replace(found, grid=inner), name)
    part = _part(board, picture, full, seen, name, camera)
    if part is not None:
        return part
    if thorough:
        further: list[Found] = []
        for found in thorough_search(full, board.columns, board.rows):
            if _whole(board, found):
                view = _refined_view(board, picture, found, name)
                if _settled(board, view, found):
                    return view
            else:
                further.append(found)
        part = _part(board, picture, full, further, name, camera)
        if part is not None:
            return part
        seen.extend(further)
    raise _failure(board, full, seen, name)


def _whole(board: Checkerboard, found: Found) -> bool:
    return sorted(found.grid.shape[:2]) == sorted((board.columns, board.rows))


def _settled(board: Checkerboard, view: TargetView, found: Found) -> bool:
    """Whether the corners of a whole board, refined, are where they were found, and as even as a grid is."""
    before = found.grid.reshape(-1, 2)
    nearest = np.linalg.norm(view.uv[:, None, :] - before, axis=2).min(axis=1)
    reach = 0.4 * float(spacing(found.grid).min())
    return bool((nearest < reach).all()) and is_even(view.uv.reshape(board.rows, board.columns, 2))


def _part(
    board: Checkerboard,
    picture: Picture,
    full: NDArray[np.uint8],
    seen: list[Found],
    name: str,
    camera: Camera | None,
) -> TargetView | None:
    """The largest part of the board that was `seen`, if its place on the board is known or need not be."""
    for found in sorted(seen, key=lambda one: -one.grid.size):
        part = replace(found, grid=right_handed_grid(found.grid))
        choices = places(full, part.grid, board)
        if not choices:
            continue
        if len(choices) == 1:
            return _refined_view(board, picture, part, name, choices[0])
        if camera is not None:
            place = nearest_to_middle(choices, part.grid, board)
            view = _refined_view(board, picture, part, name, place, placed=False)
            if not estimate_pose(view, camera).ambiguous:
                return view
    return None


def _refined_view(
    board: Checkerboard,
    picture: Picture,
    found: Found,
    name: str,
    place: Place | None = None,
    *,
    placed: bool = True,
) -> TargetView:
    """Refine the corners of the whole board, or those of a part at its `place`, at full size."""
    grid, pixels = found.grid, as_refinable(picture)
    nearest = float(spacing(grid).min())
    if found.factor > 1:  # a reduced picture's corners are out by its pixels: come closer before the last, wide window
        coarse = int(np.clip(0.5 * nearest, 3, 2 * found.factor + 1))
        grid = refined(pixels, grid.reshape(-1, 2), coarse).reshape(grid.shape)
    half = half_window(grid)
    smoothing = min(0.1 * half, MOST_SMOOTHED) if half > HALF_WINDOW else float(nearest >= SMOOTHED_FROM)
    if smoothing:
        pixels = cv2.GaussianBlur(pixels.astype(np.float32), (0, 0), smoothing)
    if place is None:
        grid, points = oriented(picture, grid, board.columns, board.rows), board.points
    else:
        grid, points = on_board(place, grid, board)
    corners = refined(pixels, grid.reshape(-1, 2), half)
    sigma = corner_sigma(pixels, corners, half, noise_of(picture, corners), smoothing)
    return TargetView(points, corners, sigma, name, placed=placed)


def half_window(grid: Array) -> int:
    """Compute half the width in px of a window that suits the refinement of corners `grid` (R, C, 2)."""
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


def _failure(board: Checkerboard, full: NDArray[np.uint8], seen: list[Found], name: str) -> TargetNotFound:
    """The sentence for a picture without the board."""
    if not seen:
        return TargetNotFound(
            Message("target.no_checkerboard", "no checkerboard is seen in the picture"),
            where=name,
            todo=LEAVE_OUT_OR_RETAKE,
        )
    largest = max(seen, key=lambda found: found.grid.size)
    wanted = f"{board.columns} × {board.rows}"
    rows, columns = largest.grid.shape[:2]
    longer, shorter = max(rows, columns), min(rows, columns)
    counted = (longer, shorter) if board.columns >= board.rows else (shorter, longer)
    shown = f"{counted[0]} × {counted[1]}"
    fits = longer <= max(board.columns, board.rows) and shorter <= min(board.columns, board.rows)
    if fits and len(places(full, right_handed_grid(largest.grid), board)) > 1:
        return TargetNotFound(
            Message(
                "target.part_anywhere",
                "only a part of the board is in the picture: {n} of its {all} inner corners, and nothing tells which",
                n=shown,
                all=wanted,
            ),
            where=name,
            todo=Message(
                "advice.show_ends_of_board",
                "show one end of the board in each direction, with its margin, or use a ChArUco board",
            ),
        )
    if fits and largest.cut_off:
        return TargetNotFound(
            Message(
                "target.board_cut_off",
                "only a part of the board is in the picture: {n} of its {all} inner corners",
                n=shown,
                all=wanted,
            ),
            where=name,
            todo=Message("advice.show_whole_board", "move the board so that the whole of it is seen, with its margin"),
        )
    what = Message("target.other_board", "the board shows {n} inner corners, not {all}", n=shown, all=wanted)
    todo = (
        Message(
            "advice.check_corners_or_cover", "check {field}, or whether a part of the board is covered", field=_CORNERS
        )
        if fits
        else Message("advice.check_corners", "check {field}", field=_CORNERS)
    )
    if ends_all_round(full, largest.grid):
        return OtherBoard(what, where=name, todo=todo, counted=counted)
    return TargetNotFound(what, where=name, todo=todo)
