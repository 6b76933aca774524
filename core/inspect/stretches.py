"""Where in a cross-section a new measurement begins: on its two longest pieces without a step. Light to import."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from core.model.arrays import Array

Stretch: TypeAlias = tuple[float, float]

JUMP = 6.0
"""Neighbouring means that differ by this many times the median difference lie on either side of a step."""
SMALLEST_JUMP_MM = 0.1
GAP = 3.0
"""Positions farther apart than this many usual steps are not neighbours: a shadow lies between."""
MARGIN = 0.2
"""Share of a piece that is left out at either end: stripes are biased at edges."""
FEWEST = 4
"""Means in a piece."""


def usual_stretches(position: Array, height: Array) -> tuple[Stretch, Stretch]:
    """Two stretches, from and to in mm, of a profile averaged over steps: the lower one first.

    Parameters
    ----------
    position, height
        (K,) in mm, positions ascending.

    Returns
    -------
    Stretch, Stretch
        On the two longest pieces between steps and shadows; of a profile in one piece near its two ends.

    Raises
    ------
    ValueError
        If the profile has fewer than two means.

    Examples
    --------
    >>> position = np.arange(0.5, 100.0)
    >>> usual_stretches(position, np.where(position < 40, 0.0, 10.0))
    ((8.3, 31.7), (52.3, 87.7))
    """
    if len(position) < 2:
        raise ValueError("a profile of fewer than two means has no stretches")
    apart, jump = np.diff(position), np.abs(np.diff(height))
    edge = (jump > max(JUMP * float(np.median(jump)), SMALLEST_JUMP_MM)) | (apart > GAP * float(np.median(apart)))
    pieces = [one for one in np.split(np.arange(len(position)), np.flatnonzero(edge) + 1) if len(one) >= FEWEST]
    longest = sorted(pieces, key=lambda one: -float(np.ptp(position[one])))[:2]
    if len(longest) < 2:
        first, last = float(position[0]), float(position[-1])
        width = last - first
        return _rounded(first + 0.1 * width, first + 0.3 * width), _rounded(last - 0.3 * width, last - 0.1 * width)
    low, high = sorted(longest, key=lambda one: float(np.median(height[one])))
    return _inside(position[low]), _inside(position[high])


def _inside(position: Array) -> Stretch:
    margin = MARGIN * float(np.ptp(position))
    return _rounded(float(position[0]) + margin, float(position[-1]) - margin)


def _rounded(first: float, last: float) -> Stretch:
    """To a tenth of a millimetre, as somebody would type it."""
    return round(first, 1), round(last, 1)
