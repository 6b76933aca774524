"""A cross-section of a cloud: positions, heights, the mean line, and where measurements begin. Light to import."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array

Stretch: TypeAlias = tuple[float, float]

JUMP = 6.0
"""Neighbours whose heights differ by this many times the median difference lie on either side of a step."""
SMALLEST_JUMP_MM = 0.1
"""No step is smaller, however smooth the profile."""
NEIGHBOURS = 3
"""Means whose median is the height on one side of a place: one that is off makes no step."""
MARGIN = 0.2
"""Share of a piece that is left out at either end: stripes are biased at edges."""
FEWEST_MEANS = 4
"""Means in a piece."""


@dataclass(frozen=True, eq=False, slots=True)
class Profile:
    """Points of a cloud near a plane, laid out in it.

    Parameters
    ----------
    origin
        (3,) in mm, camera frame: position 0, height 0.
    along, up
        (3,) unit vectors in the section's plane; `up` is square to `along` and points to the camera's side.
    indices
        (N,) into the cloud.
    position, height
        (N,) in mm of each point.
    sigma
        (N,) standard uncertainty in mm of the height, without what is common to the whole scan.
    mean_position, mean_height
        (M,) of the profile averaged over steps.
    """

    origin: Array
    along: Array
    up: Array
    indices: NDArray[np.int64]
    position: Array
    height: Array
    sigma: Array
    mean_position: Array
    mean_height: Array

    @property
    def normal(self) -> Array:
        """Unit normal (3,) of the section's plane."""
        return np.asarray(np.cross(self.along, self.up))

    def between(self, ends: tuple[float, float]) -> NDArray[np.int64]:
        """Select the profile's points between two positions in mm; return their places (m,) in the profile's arrays."""
        return np.flatnonzero((self.position >= min(ends)) & (self.position <= max(ends)))


def averaged(position: Array, height: Array, step_mm: float) -> tuple[Array, Array]:
    """Average a profile over steps of `step_mm`: mean positions and median heights in mm; empty steps are left out."""
    if not len(position):
        return np.zeros(0), np.zeros(0)
    step = np.floor((position - position.min()) / step_mm).astype(np.int64)
    order = np.lexsort((height, step))
    _, first, count = np.unique(step[order], return_index=True, return_counts=True)
    sums = np.add.reduceat(position[order], first)
    low, high = height[order][first + (count - 1) // 2], height[order][first + count // 2]
    return sums / count, (low + high) / 2


def usual_stretches(position: Array, height: Array) -> tuple[Stretch, Stretch]:
    """Propose two stretches (from, to) in mm of an averaged profile to measure a step between, the lower first.

    Parameters
    ----------
    position, height
        (K,) in mm, positions ascending.

    Returns
    -------
    Stretch, Stretch
        On the longest pieces between steps of the two levels that are longest in all; of a profile of one level near
        its two ends. Shadows end no piece: its points tell whether the level goes on behind.

    Raises
    ------
    ValueError
        If the profile has fewer than two means.

    Examples
    --------
    >>> position = np.arange(0.5, 100.0)
    >>> usual_stretches(position, np.where(position < 40, 0.0, 10.0))
    ((8.1, 30.9), (53.1, 87.9))
    """
    if len(position) < 2:
        raise ValueError("a profile of fewer than two means has no stretches")
    pieces, jump = _pieces(height - float(np.median(np.diff(height) / np.diff(position))) * position)
    level = height - _slope(position, height, pieces) * position
    levels = _levels([float(np.median(level[one])) for one in pieces], jump)
    longest = sorted(levels, key=lambda one: -sum(float(np.ptp(position[pieces[number]])) for number in one))[:2]
    if len(longest) < 2:
        first, last = float(position[0]), float(position[-1])
        width = last - first
        return _rounded(first + 0.1 * width, first + 0.3 * width), _rounded(last - 0.3 * width, last - 0.1 * width)
    chosen = [
        max((pieces[number] for number in one), key=lambda piece: float(np.ptp(position[piece]))) for one in longest
    ]
    low, high = sorted(chosen, key=lambda one: float(np.median(level[one])))
    return _less_margin(position[low]), _less_margin(position[high])


def _pieces(level: Array) -> tuple[list[NDArray[np.intp]], float]:
    """Neighbouring means (numbers) without a step among them, and the least step, in mm."""
    if len(level) < 2 * NEIGHBOURS:
        return [], SMALLEST_JUMP_MM
    medians = np.median(np.lib.stride_tricks.sliding_window_view(level, NEIGHBOURS), axis=1)
    rise = np.abs(medians[NEIGHBOURS:] - medians[:-NEIGHBOURS])
    jump = max(JUMP * float(np.median(rise)), SMALLEST_JUMP_MM)
    steps = NEIGHBOURS + np.flatnonzero(rise > jump)
    return [one for one in np.split(np.arange(len(level)), steps) if len(one) >= FEWEST_MEANS], jump


def _slope(position: Array, height: Array, pieces: list[NDArray[np.intp]]) -> float:
    """Of parallel lines, one through each piece, by least squares."""
    away = [(position[one] - position[one].mean(), height[one]) for one in pieces]
    squares = sum(float(across @ across) for across, _ in away)
    return sum(float(across @ up) for across, up in away) / squares if squares > 0 else 0.0


def _levels(heights: list[float], jump: float) -> list[list[int]]:
    """Numbers of the heights, together where no step lies between."""
    order = np.argsort(heights)
    ends = np.flatnonzero(np.diff(np.asarray(heights)[order]) > jump) + 1
    return [one.tolist() for one in np.split(order, ends) if len(one)]


def _less_margin(position: Array) -> Stretch:
    margin = MARGIN * float(np.ptp(position))
    return _rounded(float(position[0]) + margin, float(position[-1]) - margin)


def _rounded(first: float, last: float) -> Stretch:
    """Rounded to a tenth of a millimetre, as one would type it."""
    return round(first, 1), round(last, 1)
