"""Saddle points of a picture that are a grid of 3 × 3 corners, as a compiled loop."""

from __future__ import annotations

import math

from core.compiled import compiled, inlined
from core.model.arrays import Array
from core.model.small_arrays import Index, new_indices, new_row, new_table, smallest

NEIGHBOURS = 200
"""Saddle points about one of them among which its neighbours in the grid must be."""

ALIKE = 0.1
"""Strength of a corner's neighbours, as a share of its own, at least (it goes with the square of the contrast)."""

LIKE_ITSELF = -0.3
"""Cosine of twice the angle between the light squares of two saddles, from which on they are no neighbours in a grid:
+1 where they lie alike, −1 at a right angle."""

FARTHEST_ASIDE = 0.27
"""Of how far a neighbour in the grid is: how far it may be beside its edge, 15°."""

ROUGHLY = 0.35
"""Of the shortest step in a grid of nine: how far a corner may be from where its neighbours put it."""


@compiled()
def nine_about(points: Array, edges: Array, strength: Array, turn: Array, k: int, nine: Index) -> float:
    """Find the saddle `points` (N, 2) of a grid of 3 × 3 about the one with index `k`: `nine` indices, row by row.

    Returns the shortest step from the middle to another one in px, 0 where there is no such grid. Neighbours along an
    edge are sought among those whose light squares do not lie like those of the middle one.
    """
    near = _neighbours(points, k)
    count = 0
    for i in near:
        if strength[i] >= ALIKE * strength[k]:
            near[count] = i
            count += 1
    if count < len(nine):
        return 0.0
    near = near[:count]
    along, down = new_table(3, 2), new_table(3, 2)
    for steps, edge in ((along, edges[k, 0]), (down, edges[k, 1])):
        steps[1, 0] = steps[1, 1] = 0.0
        for side in (0, 2):
            found = _next_along(points, turn, near, k, (side - 1) * edge[0], (side - 1) * edge[1])
            if found < 0:
                return 0.0
            for axis in range(2):
                steps[side, axis] = points[found, axis] - points[k, axis]
    reach = math.inf
    for row in range(3):
        for one in range(3):
            step = math.hypot(along[one, 0] + down[row, 0], along[one, 1] + down[row, 1])
            if 0 < step < reach:
                reach = step
    for place in range(len(nine)):
        u = points[k, 0] + along[place % 3, 0] + down[place // 3, 0]
        v = points[k, 1] + along[place % 3, 1] + down[place // 3, 1]
        found = _nearest(points, near, u, v)
        away = math.hypot(u - points[found, 0], v - points[found, 1])
        if away > ROUGHLY * reach:
            return 0.0
        for other in nine[:place]:
            if other == found:
                return 0.0
        nine[place] = found
    return reach


@inlined()
def _neighbours(points: Array, k: int) -> Index:
    """The NEIGHBOURS of `points` (N, 2) that are nearest to the one with index `k`, and those as near as the last."""
    wanted = min(NEIGHBOURS, len(points))
    square = new_row(len(points))
    for i in range(len(points)):
        u, v = points[i, 0] - points[k, 0], points[i, 1] - points[k, 1]
        square[i] = u * u + v * v
    limit, count = float(NEIGHBOURS), 0
    while count < wanted:  # the few within a circle are sooner put in order than all
        limit *= 4
        count = 0
        for i in range(len(points)):
            count += square[i] <= limit
    within = new_row(count)
    count = 0
    for i in range(len(points)):
        if square[i] <= limit:
            within[count] = square[i]
            count += 1
    limit = smallest(within, wanted - 1)
    near = new_indices(count)
    count = 0
    for i in range(len(points)):
        if square[i] <= limit:
            near[count] = i
            count += 1
    return near[:count]


@inlined()
def _next_along(points: Array, turn: Array, near: Index, k: int, way_u: float, way_v: float) -> int:
    """Which of the points `near` (K,) comes next from the one with index `k` within 15° of a way; −1 if none."""
    found, least = -1, math.inf
    for i in near:
        u, v = points[i, 0] - points[k, 0], points[i, 1] - points[k, 1]
        along = u * way_u + v * way_v
        ahead = 0 < along < least and abs(v * way_u - u * way_v) < FARTHEST_ASIDE * along
        if ahead and not math.cos(2 * (turn[i] - turn[k])) > LIKE_ITSELF:  # NaN: not known
            found, least = i, along
    return found


@inlined()
def _nearest(points: Array, near: Index, u: float, v: float) -> int:
    """Which of the points `near` (K,) is nearest to a place."""
    found, least = -1, math.inf
    for i in near:
        square = (points[i, 0] - u) ** 2 + (points[i, 1] - v) ** 2
        if square < least:
            found, least = i, square
    return found
