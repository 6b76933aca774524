"""Distance of each stripe point from the nearest other stripe."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled
from core.model.arrays import Array
from core.model.small_arrays import new_indices, new_row, new_table

NEIGHBOUR_DISTANCE = 3.5
"""In filtered widths √(s² + g²): lines nearer than that bias each other by more than 0.003 px (measured on rendered
stripes; tests/image/stripes/test_extraction.py, parallel neighbours, holds it)."""
_BOXED = 32  # points that share a bounding box; chosen by speed


def distances_to_neighbours(runs: list[Array], bridges: list[Array], touching: float, reach: float) -> list[Array]:
    """Compute for each point of each run (N, ≥ 4) its distance (N,) in px to the nearest other run beside or across it.

    Infinite beyond `reach`.

    Another run that goes on where this one ends (ahead of it, not beside it) does not count, unless it is nearer than
    `touching` px: so near, no direction can be told. `bridges` are the curves across the gaps of each run (M, 4), empty
    without one: they count whatever their direction, for another run is bent where they cross it.
    """
    apart_px = [np.full(len(run), np.inf) for run in runs]
    chunks = [_boxes(run) for run in runs]
    boxes = np.array([_around(chunk) for chunk in chunks]).reshape(-1, 4)
    first, last = boxes[:, None, :2] - reach, boxes[:, None, 2:] + reach
    for i, j in np.argwhere(((first <= boxes[:, 2:]) & (boxes[:, :2] <= last)).all(axis=2)):
        if i != j:
            _add_nearest(runs[i], chunks[i], runs[j], chunks[j], touching, reach, apart_px[i])
            _add_nearest(runs[i], chunks[i], bridges[j], _boxes(bridges[j]), reach, reach, apart_px[i])
    return apart_px


@compiled()
def _boxes(run: Array) -> Array:
    """Bounding boxes (K, 4) from u, v to u, v of _BOXED points each."""
    boxes = new_table((len(run) + _BOXED - 1) // _BOXED, 4)
    for k in range(len(run)):
        box = k // _BOXED
        for axis in range(2):
            first, here = k % _BOXED == 0, run[k, axis]
            boxes[box, axis] = here if first else min(boxes[box, axis], here)
            boxes[box, 2 + axis] = here if first else max(boxes[box, 2 + axis], here)
    return boxes


def _around(boxes: Array) -> Array:
    """The box (4,) around some boxes (K, 4)."""
    return np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)])


@compiled()
def _add_nearest(
    run: Array, boxes: Array, other: Array, others: Array, touching: float, reach: float, apart_px: Array
) -> None:
    """Lower `apart_px` (N,) to the distance of the nearest point of the `other` run lying beside it or touching."""
    square, nearest = new_row(_BOXED), new_indices(_BOXED)
    for k in range(len(boxes)):
        for i in range(_BOXED):
            square[i], nearest[i] = reach * reach, -1
        part = run[k * _BOXED : (k + 1) * _BOXED]
        for m in range(len(others)):
            if (
                others[m, 0] - reach > boxes[k, 2]
                or others[m, 2] + reach < boxes[k, 0]
                or others[m, 1] - reach > boxes[k, 3]
                or others[m, 3] + reach < boxes[k, 1]
            ):
                continue
            for q in range(m * _BOXED, min((m + 1) * _BOXED, len(other))):
                for p in range(len(part)):
                    du, dv = other[q, 0] - part[p, 0], other[q, 1] - part[p, 1]
                    if du * du + dv * dv < square[p]:
                        square[p], nearest[p] = du * du + dv * dv, q
        for p in range(len(part)):
            if nearest[p] >= 0:
                du, dv = other[nearest[p], 0] - part[p, 0], other[nearest[p], 1] - part[p, 1]
                nu, nv = part[p, 2], part[p, 3]
                if square[p] < touching * touching or abs(du * nu + dv * nv) > abs(dv * nu - du * nv):
                    apart_px[k * _BOXED + p] = min(apart_px[k * _BOXED + p], math.sqrt(square[p]))
