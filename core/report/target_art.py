"""What is black on a printed target: rectangles and discs in millimetres."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from core.errors import InputError
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Target
from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class TargetArt:
    """The black of a target, in mm from its upper left corner, x to the right and y down.

    Parameters
    ----------
    width_mm, height_mm
        The smallest upright rectangle around everything black.
    rectangles
        (N, 4) left, top, width, height; they may touch, and do not overlap.
    discs
        (M, 3) centre x, centre y, radius.
    """

    width_mm: float
    height_mm: float
    rectangles: Array
    discs: Array

    def __post_init__(self) -> None:
        set_field(self, "rectangles", frozen_array(self.rectangles, (None, 4), "rectangles"))
        set_field(self, "discs", frozen_array(self.discs, (None, 3), "discs"))


def target_art(target: Target) -> TargetArt:
    """The black of `target`, at its true size.

    Raises
    ------
    InputError
        If a ChArUco board needs more markers than its dictionary has.
    """
    match target:
        case Checkerboard():
            columns, rows = target.columns + 1, target.rows + 1
            return _of_rectangles(_black_squares(columns, rows, target.square_mm), columns, rows, target.square_mm)
        case Charuco():
            return _charuco(target)
        case CircleGrid():
            return _circle_grid(target)
        case BlackSquare():
            return _of_rectangles(np.array([[0.0, 0.0, target.side_mm, target.side_mm]]), 1, 1, target.side_mm)


def _of_rectangles(rectangles: Array, columns: int, rows: int, square: float) -> TargetArt:
    return TargetArt(columns * square, rows * square, rectangles, np.zeros((0, 3)))


def _black_squares(columns: int, rows: int, square: float) -> Array:
    """Every second square, the first one black, as rectangles (N, 4)."""
    row, column = np.nonzero(np.add.outer(np.arange(rows), np.arange(columns)) % 2 == 0)
    side = np.full(len(row), square)
    return np.column_stack([column * square, row * square, side, side])


def _charuco(board: Charuco) -> TargetArt:
    """OpenCV's pattern since 4.6: the first square black, markers numbered row by row in the white ones."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary_id))
    square, marker = board.square_mm, board.marker_mm
    row, column = np.nonzero(np.add.outer(np.arange(board.rows), np.arange(board.columns)) % 2 == 1)
    available = len(dictionary.bytesList)
    if len(row) > available:
        raise InputError(
            f"the board has {len(row)} markers, but {board.dictionary_id} only {available}",
            where="dictionary",
            todo="choose a dictionary with more markers, or fewer squares",
        )
    cells = dictionary.markerSize + 2  # with the black rim
    cell, rim = marker / cells, (square - marker) / 2
    rectangles = [_black_squares(board.columns, board.rows, square)]
    for number, (j, i) in enumerate(zip(row, column, strict=True)):
        black = cv2.aruco.generateImageMarker(dictionary, number, cells) < 128
        y, x = np.nonzero(black)
        side = np.full(len(x), cell)
        rectangles.append(np.column_stack([i * square + rim + x * cell, j * square + rim + y * cell, side, side]))
    return _of_rectangles(np.concatenate(rectangles), board.columns, board.rows, square)


def _circle_grid(grid: CircleGrid) -> TargetArt:
    """Discs half as wide as they are apart."""
    centres = grid.points[:, :2]
    nearest = float(np.sort(np.linalg.norm(centres - centres[0], axis=1))[1])
    radius = nearest / 4
    width, height = np.ptp(centres, axis=0) + 2 * radius
    discs = np.column_stack([centres + radius, np.full(len(centres), radius)])
    return TargetArt(float(width), float(height), np.zeros((0, 4)), discs)
