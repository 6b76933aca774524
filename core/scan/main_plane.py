"""The plane that most of a scene lies on: usually the table."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array

_TRIALS = 100


def main_plane(rays: Array, inverse_depths: Array, tolerance_mm: float = 1.0) -> tuple[Array, NDArray[np.bool_]]:
    """π (3,) of the plane that holds most of the points at `inverse_depths` (M,) on `rays` (M, 3), and which those are.

    The best of many through three of the points, then fitted to all within `tolerance_mm` of depth.
    """
    rng = np.random.default_rng(0)
    tolerance = tolerance_mm * inverse_depths**2
    best = np.zeros(len(rays), dtype=np.bool_)
    for _ in range(_TRIALS):
        chosen = rng.choice(len(rays), 3, replace=False)
        plane = np.linalg.lstsq(rays[chosen], inverse_depths[chosen], rcond=None)[0]
        near = np.abs(rays @ plane - inverse_depths) < tolerance
        if np.count_nonzero(near) > np.count_nonzero(best):
            best = near
    pi = np.asarray(np.linalg.lstsq(rays[best], inverse_depths[best], rcond=None)[0], dtype=np.float64)
    return pi, np.abs(rays @ pi - inverse_depths) < tolerance
