"""The printed plates of the calibration targets as patterns, each in its target's own frame."""

from __future__ import annotations

import cv2
import numpy as np

from core.simulate.patterns import Pattern

WHITE = 0.8
BLACK = 0.06
MARGIN_MM = 10.0


def checkerboard(columns: int, rows: int, square_mm: float) -> Pattern:
    """A checkerboard of `columns` × `rows` inner corners; the first is the origin, black above and left of it."""
    x = square_mm * np.arange(-1, columns + 1)
    y = square_mm * np.arange(-1, rows + 1)
    black = np.add.outer(np.arange(rows + 1), np.arange(columns + 1)) % 2 == 0
    return _with_margin(x, y, np.where(black, BLACK, WHITE))


def charuco(columns: int, rows: int, square_mm: float, marker_mm: float, dictionary: str) -> Pattern:
    """A ChArUco board of `columns` × `rows` squares, as OpenCV prints it; its upper left corner is the origin."""
    name = getattr(cv2.aruco, dictionary)
    printed = cv2.aruco.getPredefinedDictionary(name)
    bits = printed.markerSize + 2
    inset = (square_mm - marker_mm) / 2
    within = np.concatenate([[0.0], inset + marker_mm * np.arange(bits + 1) / bits])
    x = np.append((square_mm * np.arange(columns)[:, None] + within).ravel(), columns * square_mm)
    y = np.append((square_mm * np.arange(rows)[:, None] + within).ravel(), rows * square_mm)
    cells = np.full((len(y) - 1, len(x) - 1), WHITE)
    size = bits + 2
    number = 0
    for row in range(rows):
        for column in range(columns):
            square = cells[row * size : (row + 1) * size, column * size : (column + 1) * size]
            if (row + column) % 2 == 0:
                square[:] = BLACK
                continue
            marker = cv2.aruco.generateImageMarker(printed, number, bits)
            square[1:-1, 1:-1] = np.where(marker > 127, WHITE, BLACK)
            number += 1
    return _with_margin(x, y, cells)


def circle_grid(columns: int, rows: int, pitch_mm: float, *, asymmetric: bool = False) -> Pattern:
    """A grid of black dots, radius a quarter of the pitch; the first dot's centre is the origin.

    In the asymmetric grid every second row is shifted by half of `pitch_mm` and rows are half of it apart, as OpenCV
    has it: dot (i, j) is at ((2 i + j mod 2), j) · pitch / 2.
    """
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    x, y = ((2 * i + j % 2) / 2, j / 2) if asymmetric else (i, j)
    dots = pitch_mm * np.column_stack([x.ravel(), y.ravel()]).astype(np.float64)
    radius = pitch_mm / 4 if not asymmetric else pitch_mm / 5
    rim = max(MARGIN_MM, pitch_mm)
    (x0, y0), (x1, y1) = dots.min(axis=0) - rim, dots.max(axis=0) + rim
    return Pattern(
        np.array([x0, x1]), np.array([y0, y1]), np.array([[WHITE]]), dots=dots, dot_radius=radius, dot_albedo=BLACK
    )


def black_square(side_mm: float, plate_mm: float = 160.0) -> Pattern:
    """The paper's target: one black square in the middle of a light plate; the square's centre is the origin."""
    edges = np.array([-plate_mm, -side_mm, side_mm, plate_mm]) / 2
    cells = np.full((3, 3), WHITE)
    cells[1, 1] = BLACK
    return Pattern(edges, edges, cells)


def _with_margin(x: np.ndarray, y: np.ndarray, cells: np.ndarray) -> Pattern:
    x = np.concatenate([[x[0] - MARGIN_MM], x, [x[-1] + MARGIN_MM]])
    y = np.concatenate([[y[0] - MARGIN_MM], y, [y[-1] + MARGIN_MM]])
    return Pattern(x, y, np.pad(cells, 1, constant_values=WHITE))
