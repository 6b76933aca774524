"""Runs of line points: their length, and their ends cut.

Everything here works on the order of the points along the stripe; the picture is not looked at again.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from core.model.arrays import Array

END_TRIM_PX = 4.0
"""Left out at the ends of a stripe, at least: the filter sees only half of it there."""
_END_TRIM = 2.5  # the same in filter σ
_FADE_REACH = 20.0  # filter σ from an end that a fading shadow is looked for
_FADED = 0.8  # less than this share of what is further in


@njit(cache=True, nogil=True)
def arc_length(run: Array) -> Array:
    """Length along a run (N, ≥ 2) up to each point, in pixels."""
    arc = np.zeros(len(run))
    for k in range(1, len(run)):
        arc[k] = arc[k - 1] + math.hypot(run[k, 0] - run[k - 1, 0], run[k, 1] - run[k - 1, 1])
    return arc


def correlation_length(filter_px: float) -> float:
    """Length along the stripe over which the noise of its points is one and the same, 2√π·g, in pixels."""
    return 2 * math.sqrt(math.pi) * filter_px


def cut_ends(run: Array, filter_px: float) -> Array:
    """Cut a run (N, 5) where its response falls to half at an end, and END_TRIM_PX more."""
    arc = arc_length(run)
    trim = max(END_TRIM_PX, _END_TRIM * filter_px)
    start = _real_end(arc, run[:, 4], filter_px) + trim
    end = float(arc[-1]) - _real_end(arc[-1] - arc[::-1], run[::-1, 4], filter_px) - trim
    inside: Array = run[(arc >= start) & (arc <= end)]
    return inside


def _real_end(arc: Array, response: Array, filter_px: float) -> float:
    """Where the response first reaches half of what it is further in."""
    inner = response[(arc >= 3 * filter_px) & (arc <= 9 * filter_px)]
    if len(inner) == 0:
        return 0.0
    return float(arc[np.argmax(response >= 0.5 * np.median(inner))])


def fully_lit(arc: Array, height: Array, width: Array, filter_px: float) -> slice:
    """The part of a run between its fading ends, from the height and width (N,) of its cross-section.

    An oblique shadow cuts the stripe on one side first and pulls the line to the other while its crest is still as
    bright as before. What gives it away is height · width², which speckle hardly changes: its grains make the stripe
    dimmer and wider, or brighter and narrower.
    """
    spread = height * width**2
    first = _fading(arc, spread, filter_px)
    last = len(arc) - _fading(arc[-1] - arc[::-1], spread[::-1], filter_px)
    return slice(first, max(first, last))


def _fading(arc: Array, spread: Array, filter_px: float) -> int:
    """How many points at the start have less light than the stretch behind them."""
    reach = min(_FADE_REACH * filter_px, 0.2 * float(arc[-1]))
    inner = spread[(arc >= reach) & (arc <= 2.5 * reach)]
    if len(inner) == 0:
        return 0
    return int(np.argmax((spread >= _FADED * np.median(inner)) | (arc >= reach)))
