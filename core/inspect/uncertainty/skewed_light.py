"""Light that does not come from the surface alone: seen by the skewness of the stripes' sections in depth.

On a matt part a section is as symmetric as the laser's beam. Plastic, wax, paper or skin send part of the light back
from below, always away from the camera, wherever the laser stands; so the skewness of all sweeps over a face has one
sign, counted along the depth. That of a beam which is itself skewed has it as well if the laser stays on one side, but
then on all faces alike, and a distance of two faces does not follow it.

Light that comes from depths x ≥ 0, less of it the deeper, moves the centre of a section by its mean m, and the section
has its third cumulant c₃ = κ s³, with κ the skewness and s the σ of the section in depth. For a share f of the light
evenly from 0 to D, m = fD/2 and c₃ = D³ (f/4 − f²/2 + f³/4); for one that falls exponentially, m = fτ and c₃ = τ³ (6f −
6f² + 2f³). So m/∛c₃ is 0.18, 0.53, 0.79 for f = 0.1, 0.35, 0.5 evenly, and up to 0.79 for all exponentials: the mean
is at most 0.8·∛κ·s unless most of the light comes evenly from below.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.inspect.results import Contribution
from core.inspect.uncertainty.causes import SKEWED_LIGHT
from core.messages import Message
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud

MEAN_OF_CUMULANT = 0.8
"""Mean depth of the light over the cube root of its third cumulant, at most; see above."""
SURELY = 4.0
"""Standard errors by which sections are surely skewed. Held by tests/accuracy/test_matter.py on matt parts."""
LEAST_SKEWNESS = 0.015
"""Skewness from which on it counts: what lens, pixels and slanted faces may do is less."""
LEAST_SWEEPS = 10.0
"""Sweeps, as many as weigh alike, whose scatter tells how sure their mean is."""
SHARE_THAT_MATTERS = 0.25
"""Share of all other uncertainty from which on it is told."""


def mean_skewness(skewness: Array, sweep: NDArray[np.int64]) -> tuple[float, float]:
    """Mean of points' skewness (N,) and its standard error, by the scatter between their sweeps (N,).

    The error is infinite where the sweeps are too few to tell.
    """
    number = np.bincount(sweep).astype(np.float64)
    share = number / max(number.sum(), 1.0)
    if not share.any() or 1 / float(share @ share) < LEAST_SWEEPS:
        return 0.0, math.inf
    mean = float(skewness.mean())
    away = np.bincount(sweep, skewness - mean) / len(skewness)
    several = np.count_nonzero(number)
    return mean, float(np.sqrt(several / (several - 1) * (away @ away)))


def farthest_mean_mm(cloud: Cloud, part: NDArray[np.int64], direction: Array) -> Array:
    """How far behind each part's surface its light comes from at most, on the mean, in mm of depth; 0 if not surely.

    Parameters
    ----------
    cloud
        The points. Those of the fan, few lines of one speckle, tell nothing.
    part
        (N,) which face each point is on, from 0.
    direction
        (N, 3) the faces' normals. Sections on curved ones are skewed without any of that: 0.
    """
    found = np.zeros(int(part.max(initial=-1)) + 1)
    for number in range(len(found)):
        mine = np.flatnonzero((part == number) & (cloud.sweep >= 0))
        if not len(mine) or np.ptp(direction[mine], axis=0).max() > 0:
            continue
        mean, error = mean_skewness(cloud.skewness[mine], cloud.sweep[mine])
        if error > 0 and abs(mean) > max(SURELY * error, LEAST_SKEWNESS):
            found[number] = MEAN_OF_CUMULANT * np.cbrt(mean) * float(np.median(cloud.spread_mm[mine]))
    return found


def doubt_of_light(budget: Sequence[Contribution]) -> Message | None:
    """Why a value with this budget proves nothing, if skewed light makes up much of it."""
    skewed = [row.u_mm for row in budget if row.source == SKEWED_LIGHT]
    rest = [row.u_mm for row in budget if row.source != SKEWED_LIGHT]
    if not skewed or max(skewed) <= SHARE_THAT_MATTERS * math.hypot(*rest):
        return None
    return Message(
        "inspection.light_is_skewed",
        "The laser's light is skewed in depth on what was measured: part of it comes from below the surface (plastic, "
        "wax, paper), or shines to one side. U holds what that may do, but nothing is proved: spray the part matt, or "
        "compare it with a master of its material.",
    )
