"""Printed plates of the calibration targets as patterns, each in its target's own frame."""

from __future__ import annotations

import cv2
import numpy as np
from scipy.spatial.distance import cdist

from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Rectangle, Target
from core.image.targets.charuco import dictionary_of
from core.model.arrays import Array
from core.simulate.scene.patterns import Pattern

WHITE, BLACK = 0.8, 0.06
"""Albedo of paper and of printer's ink."""
MARGIN_MM = 10.0
"""White rim round a pattern, which detectors need."""
SQUARE_PLATE_MM = 160.0
"""Side of the plate that carries the black square: long stripes beside it."""


PLATES: dict[str, Target] = {
    "checkerboard": Checkerboard(17, 12, 10.0),
    "charuco": Charuco(12, 9, 15.0, 11.25, "DICT_4X4_100"),
    "circle_grid": CircleGrid(13, 10, 14.0),
    "black_square": BlackSquare(60.0),
}
"""Plates by their kind, lengths in mm: the black square is the paper's, the others are about as large together."""


def printed(target: Target) -> Pattern:
    """Make the plate with the pattern of `target` printed on it, in the target's frame."""
    if isinstance(target, Checkerboard):
        return _checkerboard(target)
    if isinstance(target, Charuco):
        return _charuco(target)
    if isinstance(target, CircleGrid):
        return _circle_grid(target)
    if isinstance(target, Rectangle):
        return _rectangle(target)
    return _black_square(target)


def _checkerboard(board: Checkerboard) -> Pattern:
    """Black above and left of the first inner corner."""
    x = board.square_mm * np.arange(-1.0, board.columns + 1)
    y = board.square_mm * np.arange(-1.0, board.rows + 1)
    black = np.add.outer(np.arange(board.rows + 1), np.arange(board.columns + 1)) % 2 == 0
    return _with_margin(x, y, np.where(black, BLACK, WHITE))


def _charuco(board: Charuco) -> Pattern:
    """As OpenCV prints it since 4.6: the first square black, markers numbered row by row in the white ones."""
    dictionary = dictionary_of(board)
    bits = dictionary.markerSize + 2
    square = board.square_mm
    within = (square - board.marker_mm) / 2 + board.marker_mm * np.arange(bits + 1) / bits
    within = np.concatenate([[0.0], within])
    x = np.append((square * np.arange(board.columns)[:, None] + within).ravel(), board.columns * square)
    y = np.append((square * np.arange(board.rows)[:, None] + within).ravel(), board.rows * square)
    cells = np.full((len(y) - 1, len(x) - 1), WHITE)
    size = bits + 2
    number = board.first_id
    for row, column in np.ndindex(board.rows, board.columns):
        inside = cells[row * size : (row + 1) * size, column * size : (column + 1) * size]
        if (row + column) % 2 == 0:
            inside[:] = BLACK
            continue
        marker = cv2.aruco.generateImageMarker(dictionary, number, bits)
        inside[1:-1, 1:-1] = np.where(marker > 127, WHITE, BLACK)
        number += 1
    return _with_margin(x, y, cells)


def _circle_grid(grid: CircleGrid) -> Pattern:
    """Dots of a radius a quarter of the way to their nearest neighbour."""
    dots = grid.points[:, :2]
    nearest = float(np.sort(cdist(dots[:1], dots)[0])[1])
    rim = max(MARGIN_MM, nearest)
    (x0, y0), (x1, y1) = dots.min(axis=0) - rim, dots.max(axis=0) + rim
    plain = np.array([[WHITE]])
    return Pattern(np.array([x0, x1]), np.array([y0, y1]), plain, dots=dots, dot_radius=nearest / 4, dot_albedo=BLACK)


def _black_square(square: BlackSquare) -> Pattern:
    """The square in the middle of a light plate large enough for long stripes beside it."""
    rim = max((SQUARE_PLATE_MM - square.side_mm) / 2, MARGIN_MM)
    edges = np.array([-rim, 0.0, square.side_mm, square.side_mm + rim])
    cells = np.full((3, 3), WHITE)
    cells[1, 1] = BLACK
    return Pattern(edges, edges, cells)


def _rectangle(rectangle: Rectangle) -> Pattern:
    """Ink within the outer edges, white again within the outline if it is one."""
    line = rectangle.line_mm
    x, y = (np.array(sorted({0.0, line, side - line, side})) for side in (rectangle.width_mm, rectangle.height_mm))
    cells = np.full((len(y) - 1, len(x) - 1), BLACK)
    if line:
        cells[1, 1] = WHITE
    return _with_margin(x, y, cells)


def _with_margin(x: Array, y: Array, cells: Array) -> Pattern:
    x = np.concatenate([[x[0] - MARGIN_MM], x, [x[-1] + MARGIN_MM]])
    y = np.concatenate([[y[0] - MARGIN_MM], y, [y[-1] + MARGIN_MM]])
    return Pattern(x, y, np.pad(cells, 1, constant_values=WHITE))
