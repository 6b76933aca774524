"""Whether a target moved between two pictures."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from core.image.target_view import TargetView


def camera_shift(view_a: TargetView, view_b: TargetView) -> float:
    """How far, in pixels, the target moved from one view to the other: the median length of its points' displacements.

    The median forgives points that a laser stripe disturbs in one of the pictures. A target that looks the same turned
    round (:class:`BlackSquare`, :class:`CircleGrid`) may be numbered differently in the two views, so points are paired
    by their places in the picture where that gives less.

    Raises
    ------
    ValueError
        If the views share no point of the target.
    """
    found = cKDTree(view_a.points).query(view_b.points)
    index = np.asarray(found[1], dtype=np.intp)
    same = np.asarray(found[0], dtype=np.float64) < 1e-6
    if not same.any():
        raise ValueError("the two views show no point of the target in common")
    by_number = float(np.median(np.linalg.norm(view_b.uv[same] - view_a.uv[index[same]], axis=1)))
    by_place = float(np.median(cKDTree(view_a.uv).query(view_b.uv)[0]))
    renumbered = len(view_a.uv) == len(view_b.uv) and by_place < 0.5 * by_number
    return by_place if renumbered else by_number
