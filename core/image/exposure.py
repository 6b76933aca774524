"""Exposure of stripes, and by how much it should change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.image.stripes.centreline import Centreline

# Heights of a stripe over the largest grey level. Chosen so that one step is enough and a good exposure stays as it is:
# tests/pipeline/live/test_exposure.py holds them.
BEST_LEVEL = 0.5  # aimed at: speckle stands up to half as high again above it
FAINTEST, BRIGHTEST = 0.1, 0.75  # between these nothing is changed

# Shares of a stripe's points that are saturated, and what is then done; chosen likewise.
MOST_SATURATED = 0.05  # accepted: some always are where stripes cross or a face shines
_MOSTLY_SATURATED = 0.3  # from here on the light is halved
_STEP_DOWN, _LARGE_STEP_DOWN = 0.7, 0.5  # factors of light: how far above white a stripe is cannot be seen

_LARGEST_FACTOR = 4.0  # factor of light in one step up: a very faint stripe tells its height badly
_LEAST_POINTS = 50  # stripe points; fewer do not tell the exposure


@dataclass(frozen=True, slots=True)
class Exposure:
    """Exposure of the stripes of a picture.

    Parameters
    ----------
    level
        Median height of the stripes over the largest grey level.
    saturated
        Share of their points that are overexposed.
    factor
        By which the light collected should change; 1 where all is well.
    """

    level: float
    saturated: float
    factor: float

    @property
    def is_good(self) -> bool:
        """Whether the exposure needs no change: its factor is 1."""
        return self.factor == 1.0


def stripe_exposure(centrelines: Sequence[Centreline], full_scale: float) -> Exposure | None:
    """Measure the exposure of the stripes of one picture, and its factor of change; None with too few points to tell.

    Parameters
    ----------
    centrelines
        Of one picture.
    full_scale
        Largest grey level the picture can hold.

    Returns
    -------
    None where the stripes have too few points to tell.

    Notes
    -----
    How far a saturated stripe is above white cannot be seen. So the factor is then a step (0.7, or 0.5 where much is
    lost) that leads to the right exposure in a few pictures; a stripe that is not saturated is put right in one.
    """
    if sum(map(len, centrelines)) < _LEAST_POINTS:
        return None
    lost = np.concatenate([piece.saturated for piece in centrelines])
    level = float(np.median(np.concatenate([piece.strength for piece in centrelines]))) / full_scale
    saturated = float(np.mean(lost))
    if saturated > MOST_SATURATED:
        factor = _LARGE_STEP_DOWN if saturated > _MOSTLY_SATURATED else _STEP_DOWN
    elif not FAINTEST <= level <= BRIGHTEST:
        factor = min(BEST_LEVEL / max(level, 1e-6), _LARGEST_FACTOR)
    else:
        factor = 1.0
    return Exposure(level, saturated, factor)
