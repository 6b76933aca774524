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

Where skewness does not show it surely, it may be there all the same: what light from below would do is weighed by how
well it agrees with the skewness κ ± its standard error that was found. Before any picture is seen, light comes from
below a surface with the probability that is stated of its material; then a share f of it, all alike up to a half, from
depths D from 0.1 to 3 mm, all alike in their logarithm, falling evenly or exponentially (τ = D/2). What is left of m,
so weighed, gives its standard uncertainty. Where sections tell nothing (a curved face, few sweeps, the fan's own lines)
nothing but the probability before is left. How wide sections are is compared on part and table, where lens and slant
are known (`core.scan.part_light`): a part on which they are surely wider is behind by what that may do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, stdtrit

from core.findings.proof import Doubt, Doubts
from core.findings.table import note_of
from core.inspect.causes import FROM_BELOW, Cause
from core.inspect.results import Contribution
from core.inspect.uncertainty.coverage import COVERAGE
from core.inspect.uncertainty.part import Part
from core.model.arrays import Array
from core.scan.part_light import ON_PART_MM, PartLight
from core.scan.surface.cloud import Cloud

MEAN_OF_CUMULANT = 0.8
"""Mean depth of the light over the cube root of its third cumulant, at most; see above."""
SURELY = 4.0
"""Symmetric sections may seem skewed as seldom as a normal deviate exceeds it.

Held by tests/accuracy/test_matter.py on matt parts."""
LEAST_SKEWNESS = 0.015
"""Skewness from which on it counts: what lens, pixels and slanted faces may do is less."""
LEAST_SWEEPS = 10.0
"""Sweeps, as many as weigh alike, whose scatter tells surely how sure their mean is."""
FEWEST_SWEEPS = 3.0
"""Sweeps, as many as weigh alike, whose scatter tells anything."""
SHARE_THAT_MATTERS = 0.25
"""Share of all other uncertainty, but for such light that is not seen, from which on it is told."""


class MeanSkewness(NamedTuple):
    """Mean skewness of sections, its standard error, and the number of sweeps, as many as weigh alike, it rests on."""

    mean: float
    error: float
    sweeps: float


def mean_skewness(skewness: Array, sweep: NDArray[np.int64]) -> MeanSkewness:
    """Compute the mean `skewness` (N,) of the points' stripe sections, with a standard error from sweep to sweep.

    The error is infinite where the scatter of fewer than three sweeps, or none at all, would have to tell.
    """
    number = np.bincount(sweep).astype(np.float64)
    share = number / max(number.sum(), 1.0)
    alike = 1 / float(share @ share) if share.any() else 0.0
    if alike < FEWEST_SWEEPS:
        return MeanSkewness(0.0, math.inf, alike)
    mean = float(skewness.mean())
    away = np.bincount(sweep, skewness - mean) / len(skewness)
    several = np.count_nonzero(number)
    error = float(np.sqrt(several / (several - 1) * (away @ away)))
    return MeanSkewness(mean, error or math.inf, alike)


def is_surely_skewed(seen: MeanSkewness) -> bool:
    """Whether stripe sections are skewed by more than chance, the lens and slanted faces explain.

    The scatter of n sweeps tells the error, so the limit is that of Student's t with n − 1 degrees of freedom.
    """
    if seen.sweeps < LEAST_SWEEPS:
        return False
    limit = float(stdtrit(seen.sweeps - 1, float(ndtr(SURELY))))
    return abs(seen.mean) > max(limit * seen.error, LEAST_SKEWNESS)


def farthest_mean_mm(cloud: Cloud, part: NDArray[np.int64], direction: Array) -> Array:
    """Estimate the largest mean depth in mm behind each face that its light may come from; 0 if not surely skewed.

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
        seen = mean_skewness(cloud.skewness[mine], cloud.sweep[mine])
        if is_surely_skewed(seen):
            found[number] = MEAN_OF_CUMULANT * np.cbrt(seen.mean) * float(np.median(cloud.spread_mm[mine]))
    return found


SHARES = np.linspace(0.0, 0.5, 33)[:-1] + 1 / 128
"""Shares of light from below that are weighed."""
DEPTHS_MM = np.geomspace(0.1, 3.0, 41)
"""Depths that are weighed: from what moves the mean by 0.025 mm at most, to wax. Held by tests/accuracy/test_matter.py
where sections tell little."""


def unseen_mean_mm(seen: MeanSkewness, spread_mm: float, lets_light_in: float) -> float:
    """Compute the standard uncertainty in mm by light from below a surface that the mean skewness does not exclude.

    Twice as much holds 95 % of what is left: that is one-sided, and reaches far. The skewness is known by the scatter
    of n sweeps, so it is weighed by Student's t with n − 1 degrees of freedom.

    Parameters
    ----------
    seen
        Of the sections on the face.
    spread_mm
        σ of the sections in depth.
    lets_light_in
        Probability of light from below before they are seen.

    Examples
    --------
    >>> of_errors = [MeanSkewness(0.0, error, 25.0) for error in (float("inf"), 0.02, 0.002)]
    >>> [round(unseen_mean_mm(seen, 0.6, 0.5), 3) for seen in of_errors]
    [0.157, 0.024, 0.012]
    """
    f, depth = SHARES[:, None], DEPTHS_MM[None, :]
    even = depth**3 * (f / 4 - f**2 / 2 + f**3 / 4)
    exponential = (depth / 2) ** 3 * (6 * f - 6 * f**2 + 2 * f**3)
    expected = np.stack([even, exponential]) / max(spread_mm, 1e-9) ** 3
    free = max(seen.sweeps - 1, 1.0)
    likely = (1 + ((seen.mean - expected) / seen.error) ** 2 / free) ** (-(free + 1) / 2)
    matt = (1 + (seen.mean / seen.error) ** 2 / free) ** (-(free + 1) / 2)
    means = np.append(np.broadcast_to(f * depth / 2, expected.shape), 0.0)
    weights = np.append(lets_light_in * likely / likely.size, (1 - lets_light_in) * matt)
    weights /= weights.sum()
    order = np.argsort(means, kind="stable")
    most = means[order][np.searchsorted(np.cumsum(weights[order]), COVERAGE)]
    return max(float(np.sqrt(weights @ means**2)), float(most) / 2)


NOTHING_SEEN = MeanSkewness(0.0, math.inf, 0.0)
"""Where sections tell nothing."""


@dataclass(frozen=True, eq=False, slots=True)
class LightBelow:
    """Mean depth in mm behind each face that its light comes from.

    `skewed_mm` at most where sections are surely skewed, `wider_mm` at most where they are surely wider than on the
    table; `unseen_mm` its standard uncertainty where they are neither. Faces that are skewed alike may be skewed by the
    laser's beam, and differ in what width says all the same: so each counts by itself, as if independent. What both of
    them say is contained, up to 1.4 times.
    """

    skewed_mm: Array
    wider_mm: Array
    unseen_mm: Array


def light_below(
    cloud: Cloud, part: NDArray[np.int64], direction: Array, stated: Part | None, light: PartLight | None = None
) -> LightBelow:
    """Estimate the mean depth in mm behind each face that its light comes from, as far as its sections show it.

    `stated` is what is known of the part; None: no more is reckoned with than what is seen. `light` is how much wider
    sections are on it than on the table: a face off the table is behind by what that may do, unless an offset that was
    measured holds it.
    """
    skewed = farthest_mean_mm(cloud, part, direction)
    wider = np.zeros(len(skewed))
    if light is not None and light.behind_mm and (stated is None or stated.offset_mm is None):
        off_table = np.abs(cloud.points @ light.table - 1) > ON_PART_MM * np.linalg.norm(light.table)
        for face in range(len(wider)):
            on_it = part == face
            if on_it.any() and np.median(off_table[on_it]) > 0:
                wider[face] = light.behind_mm
    unseen = np.zeros(len(skewed))
    chance = 0.0 if stated is None else stated.lets_light_in
    if chance:
        for number in np.flatnonzero((skewed == 0) & (wider == 0)):
            mine = np.flatnonzero((part == number) & (cloud.sweep >= 0))
            flat = len(mine) and np.ptp(direction[mine], axis=0).max() == 0
            seen = mean_skewness(cloud.skewness[mine], cloud.sweep[mine]) if flat else NOTHING_SEEN
            spread = float(np.median(cloud.spread_mm[mine])) if flat else 1.0
            unseen[number] = unseen_mean_mm(seen, spread, chance)
    return LightBelow(skewed, wider, unseen)


def doubts_of_light(budget: Sequence[Contribution]) -> Doubts:
    """Make the doubt that skewed light makes up much of a value's uncertainty, so that it proves nothing; else ()."""
    skewed = [row.u_mm for row in budget if row.source is Cause.SKEWED_LIGHT]
    rest = [row.u_mm for row in budget if row.source not in {Cause.SKEWED_LIGHT, *FROM_BELOW}]
    if not skewed or max(skewed) <= SHARE_THAT_MATTERS * math.hypot(*rest):
        return ()
    return (Doubt.of(note_of("inspection.light_is_skewed")),)
