"""How long a window a parabola may have on an arc.

A circle of curvature κ departs from its parabola by κ³x⁴/8; fitted over ± h, the parabola takes up all of that but 3/35
of its value at the ends, so in the middle it is off by 3 κ³h⁴/280.
"""

from __future__ import annotations

from core.model.arrays import Array

BIAS_ALLOWED = 0.1
"""Largest bias of a local fit, in its standard uncertainties."""


def arc_bias(curvature: Array, half_length: float) -> Array:
    """Errors (N,) in pixels of parabolas fitted to ± `half_length` px of arcs of `curvature` (N,) in 1/px."""
    return 3.0 / 280.0 * curvature**3 * half_length**4
