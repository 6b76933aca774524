"""How a stripe is exposed, and by how much the exposure should change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.image.centreline import Centreline

BEST_LEVEL = 0.5
"""Height of a well exposed stripe over the largest grey level: speckle stands up to half as high again above it."""

FAINTEST, BRIGHTEST = 0.1, 0.75
"""Between these a stripe is left as it is."""

MOST_SATURATED = 0.05
"""Share of its points: some always are where stripes cross or a face shines."""

_HALF_IS_LOST = 0.3
_LARGEST_FACTOR = 4.0
_FEWEST_POINTS = 50


@dataclass(frozen=True, slots=True)
class Exposure:
    """How the stripes of a picture are exposed.

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
        """Whether nothing needs to change."""
        return self.factor == 1.0


def stripe_exposure(centrelines: Sequence[Centreline], full_scale: float) -> Exposure | None:
    """How stripes are exposed; None where too little of them is seen to tell.

    Parameters
    ----------
    centrelines
        Of one picture.
    full_scale
        Largest grey level the picture can hold.

    Notes
    -----
    How far a saturated stripe is above white cannot be seen. So the factor is then a step (0.7, or 0.5 where much is
    lost) that leads to the right exposure in a few pictures; a stripe that is not saturated is put right in one.
    """
    if sum(map(len, centrelines)) < _FEWEST_POINTS:
        return None
    lost = np.concatenate([piece.saturated for piece in centrelines])
    level = float(np.median(np.concatenate([piece.strength for piece in centrelines]))) / full_scale
    saturated = float(np.mean(lost))
    if saturated > MOST_SATURATED:
        factor = 0.5 if saturated > _HALF_IS_LOST else 0.7
    elif not FAINTEST <= level <= BRIGHTEST:
        factor = min(BEST_LEVEL / max(level, 1e-6), _LARGEST_FACTOR)
    else:
        factor = 1.0
    return Exposure(level, saturated, factor)
