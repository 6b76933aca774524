"""Interpolation between the points of a run that was traced in steps of more than a pixel."""

from __future__ import annotations

import math

from core.compiled import compiled, inlined
from core.model.arrays import Array
from core.model.small_arrays import new_table

_FILTER_PER_STEP = 1.1  # filter σ to a step, at least: a point between then errs by less than 0.001 px (measured)
_HOLE_PX = 0.6  # more than usual from one point to the next: what lies between is not known


@compiled(inline=True)
def tracing_step(filter_px: float) -> int:
    """Compute how many px apart traced points may be without loss behind a filter of σ `filter_px`; a whole number."""
    return max(1, int(filter_px / _FILTER_PER_STEP))


@compiled()
def with_points_between(run: Array, stride: int) -> Array:
    """Interpolate a run (N, 5) u, v, n_u, n_v, response, traced in steps of `stride` px, to points one px apart.

    They lie on the cubic through the two neighbours on either side, or on Hermite's along the normals where a
    neighbour is missing. What a filter of σ g leaves of noise is as smooth as g, so that for g > 1.1 `stride` a point
    between differs from one that was looked for by less than 0.001 px.
    """
    count, hole = len(run), stride + _HOLE_PX
    out, weights = new_table(stride * count, 5), cubic_weights(stride)
    number, before, chord = 0, math.inf, _chord(run, 0)
    for k in range(count):
        for a in range(5):
            out[number, a] = run[k, a]
        number += 1
        after = _chord(run, k + 1)
        if chord <= hole:
            for step in range(1, stride):
                point = out[number]
                if before <= hole and after <= hole:
                    for a in range(5):
                        point[a] = 0.0
                        for i in range(4):
                            point[a] += weights[step, i] * run[k - 1 + i, a]
                else:
                    _on_chord(run[k], run[k + 1], step / stride, chord, point)
                norm = math.sqrt(point[2] * point[2] + point[3] * point[3])
                point[2] /= norm
                point[3] /= norm
                number += 1
        before, chord = chord, after
    return out[:number]


@inlined()
def cubic_weights(stride: int) -> Array:
    """Compute Lagrange's weights (stride, 4) of four points for places k/stride between the second and the third."""
    weights = new_table(stride, 4)
    for k in range(stride):
        x = k / stride
        weights[k, 0], weights[k, 3] = -x * (1 - x) * (2 - x) / 6, -x * (1 - x) * (1 + x) / 6
        weights[k, 1], weights[k, 2] = (1 + x) * (1 - x) * (2 - x) / 2, (1 + x) * x * (2 - x) / 2
    return weights


@inlined()
def _on_chord(here: Array, behind: Array, x: float, chord: float, point: Array) -> None:
    """The `point` (5,) at the share `x` of the way, by Hermite's cubic with tangents as long as the chord."""
    y = 1 - x
    for a in range(5):
        point[a] = y * here[a] + x * behind[a]
    lean, from_here, from_behind = x * y * (y - x), chord * x * y * y, chord * x * x * y
    point[0] += lean * (here[0] - behind[0]) - from_here * here[3] + from_behind * behind[3]
    point[1] += lean * (here[1] - behind[1]) + from_here * here[2] - from_behind * behind[2]


@inlined()
def _chord(run: Array, k: int) -> float:
    """From point k to the next; infinite where there is none."""
    if k + 1 >= len(run):
        return math.inf
    du, dv = run[k + 1, 0] - run[k, 0], run[k + 1, 1] - run[k, 1]
    return math.sqrt(du * du + dv * dv)
