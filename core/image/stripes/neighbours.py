"""Distance of each stripe point from the nearest other stripe."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled, inlined
from core.model.arrays import Array

NEIGHBOUR_DISTANCE = 3.5
"""In filtered widths √(s² + g²): lines nearer than that bias each other by more than 0.003 px (measured on rendered
stripes; tests/image/stripes/test_extraction.py, parallel neighbours, holds it)."""
_BOXED = 32  # points that share a bounding box; chosen by speed


def distances_to_neighbours(runs: list[Array], bridges: list[Array], touching: float, reach: float) -> list[Array]:
    """Distance in px (N,) of each point of each run from another run beside or across it; infinite beyond `reach`.

    Another run that goes on where this one ends (ahead of it, not beside it) does not count, unless it is nearer than
    `touching` px: so near, no direction can be told. `bridges` are the curves across the gaps of each run (M, 4), empty
    without one: they count whatever their direction, for another run is bent where they cross it.
    """
    apart_px = [np.full(len(run), np.inf) for run in runs]
    chunks = [_boxes(run) for run in runs]
    boxes = np.array([_box(run) for run in runs]).reshape(-1, 4)
    first, last = boxes[:, None, :2] - reach, boxes[:, None, 2:] + reach
    for i, j in np.argwhere(((first <= boxes[:, 2:]) & (boxes[:, :2] <= last)).all(axis=2)):
        if i != j:
            _add_nearest(runs[i], chunks[i], runs[j], chunks[j], touching, reach, apart_px[i])
            _add_nearest(runs[i], chunks[i], bridges[j], _boxes(bridges[j]), reach, reach, apart_px[i])
    return apart_px


@compiled()
def _boxes(run: Array) -> Array:
    """Bounding boxes (K, 4) from u, v to u, v of _BOXED points each."""
    boxes = np.empty(((len(run) + _BOXED - 1) // _BOXED, 4))
    for k in range(len(boxes)):
        boxes[k] = _box(run[k * _BOXED : (k + 1) * _BOXED])
    return boxes


@inlined()
def _box(points: Array) -> Array:
    """Bounding box (4,) from u, v to u, v of points (N, ≥ 2), N ≥ 1."""
    u, v = points[:, 0], points[:, 1]
    return np.array([u.min(), v.min(), u.max(), v.max()])


@compiled()
def _add_nearest(
    run: Array, boxes: Array, other: Array, others: Array, touching: float, reach: float, apart_px: Array
) -> None:
    """Lower `apart_px` (N,) to the distance of the nearest point of the `other` run lying beside it or touching."""
    square, nearest = np.empty(_BOXED), np.empty(_BOXED, dtype=np.int64)
    for k in range(len(boxes)):
        square[:] = reach * reach
        nearest[:] = -1
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
