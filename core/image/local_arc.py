"""How long a window a parabola may have on an arc.

A circle of curvature κ departs from its parabola by κ³x⁴/8; fitted over ± h, the parabola takes up all of that but 3/35
of its value at the ends, so in the middle it is off by 3 κ³h⁴/280.
"""

from __future__ import annotations

from numba import njit

from core.model.arrays import Array

BIAS_ALLOWED = 0.1
"""Largest bias of a local fit, in its standard uncertainties."""


@njit(cache=True, nogil=True)
def arc_bias(curvature: float, half_length: float) -> float:
    """Error in pixels of a parabola fitted to ± `half_length` px of an arc of `curvature` 1/px; for compiled loops."""
    return 3.0 / 280.0 * curvature**3 * half_length**4


def arc_bias_at(curvature: Array, half_length: float) -> Array:
    """The same for many curvatures (N,)."""
    return 3.0 / 280.0 * curvature**3 * half_length**4
