"""Undistorted ray coordinates by Newton's method: a compiled loop, for many points are asked for many times."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled, inlined
from core.model.arrays import Array

_ROUNDS = 20  # at most; a usual lens takes four
_SETTLED = 1e-12  # step that ends it: rounding
_CONVERGED = 1e-9  # misfit with which a point counts as converged after all rounds, 5e-6 px


@compiled()
def undistorted(distorted: Array, distortion: Array) -> Array:
    """Find the coordinates (N, 2) that distortion maps to the `distorted` ones (N, 2); NaN where there are none.

    The coefficients `distortion` are k1, k2, p1, p2, k3.
    """
    k1, k2, p1, p2, k3 = distortion[0], distortion[1], distortion[2], distortion[3], distortion[4]
    found = np.empty((len(distorted), 2))
    for i in range(len(distorted)):
        x, y = distorted[i, 0], distorted[i, 1]
        moving = True
        for _ in range(_ROUNDS):
            p, q = _misfit(x, y, distorted, distortion, i)
            r2 = x * x + y * y
            radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
            slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3))
            a = radial + slope * x * x + 2 * p1 * y + 6 * p2 * x
            b = slope * x * y + 2 * p1 * x + 2 * p2 * y
            d = radial + slope * y * y + 6 * p1 * y + 2 * p2 * x
            determinant = a * d - b * b
            u, v = (d * p - b * q) / determinant, (a * q - b * p) / determinant
            x -= u
            y -= v
            moving = abs(u) > _SETTLED or abs(v) > _SETTLED
            if not moving:
                break
        if moving:
            p, q = _misfit(x, y, distorted, distortion, i)
            if abs(p) > _CONVERGED or abs(q) > _CONVERGED:
                x = y = math.nan
        found[i, 0] = x
        found[i, 1] = y
    return found


@inlined()
def _misfit(x: float, y: float, distorted: Array, distortion: Array, i: int) -> tuple[float, float]:
    """By how much (x, y), distorted, misses point i."""
    k1, k2, p1, p2, k3 = distortion[0], distortion[1], distortion[2], distortion[3], distortion[4]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) - distorted[i, 0],
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y - distorted[i, 1],
    )
