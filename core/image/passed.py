"""Where in a picture lines have been traced already: points in lists, one list a cell of the picture.

A map with a mark at every pixel near a line would be as large as the picture; touching its memory alone took longer
than half of all tracing.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.model.arrays import Array

Passed = tuple[NDArray[np.int32], NDArray[np.int32]]
"""Of each cell (rows, columns) its last point, of each point (N,) the one before in its cell; counted from 1 on."""


@njit(cache=True, nogil=True)
def nothing_passed(shape: tuple[int, int], reach: int, count: int) -> Passed:
    """Empty lists for a picture of (height, width) px and `count` points that are passed at `reach` px or less."""
    cell = _cell(reach)
    return np.zeros((shape[0] // cell + 1, shape[1] // cell + 1), np.int32), np.empty(count, np.int32)


@njit(cache=True, nogil=True)
def room_for(passed: Passed, count: int) -> Passed:
    """The same lists, for `count` points."""
    before = np.empty(count, np.int32)
    before[: len(passed[1])] = passed[1]
    return passed[0], before


@njit(cache=True, nogil=True)
def put_down(passed: Passed, points: Array, number: int, reach: int) -> None:
    """Add the point of this `number` among the `points` (N, ≥ 2)."""
    last, before = passed
    cell = _cell(reach)
    row, column = int(points[number, 1] + 0.5) // cell, int(points[number, 0] + 0.5) // cell
    before[number] = last[row, column]
    last[row, column] = number + 1


@njit(cache=True, nogil=True)
def was_passed(passed: Passed, points: Array, u: float, v: float, reach: int) -> bool:
    """Whether the pixel of (u, v) in the picture is within `reach` of the pixel of a point that was put down."""
    last, before = passed
    cell, column, row = _cell(reach), int(u + 0.5), int(v + 0.5)
    rows, columns = last.shape
    for j in range(max(row - reach, 0) // cell, min((row + reach) // cell, rows - 1) + 1):
        for i in range(max(column - reach, 0) // cell, min((column + reach) // cell, columns - 1) + 1):
            number = last[j, i]
            while number > 0:
                du, dv = int(points[number - 1, 0] + 0.5) - column, int(points[number - 1, 1] + 0.5) - row
                if du * du + dv * dv <= reach * reach:
                    return True
                number = before[number - 1]
    return False


@njit(cache=True, nogil=True)
def _cell(reach: int) -> int:
    """Side of a cell in px: whatever is within `reach` of a place lies in four of them at most."""
    return 2 * reach + 1
