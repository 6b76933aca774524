"""Pictures of a pose whose light is in the one that is to have the fan off."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.stripes.pair_exposure import Exposed
from core.messages import Message

PAIRS_TRIED = 3
"""So many pairs tell whether a set's are exchanged, by their median."""
_TIMES = 1.5
"""Light that is so many times stronger in the off picture is told. In 44 real pairs of three cameras the strongest
light was 1.1 to 30 times stronger in the on picture."""
EXCHANGED = Message(
    "fan.exchanged", "the light is in the picture that is to have the fan off: are on and off exchanged?"
)
"""Of one pose, or of all of them."""


def light_off_over_on(on: NDArray[Any], off: NDArray[Any]) -> float:
    """Compute the ratio of the strongest light that only `off` (H, W) shows to that only `on` (H, W) shows.

    Picture `off` is first brought to the exposure of `on`. 0 where the two differ in size.
    """
    if on.shape != off.shape:
        return 0.0
    alike = Exposed.of(on, off, float(np.iinfo(on.dtype).max)).like(off.astype(np.float32))
    light = cv2.blur(on.astype(np.float32) - alike, (5, 5))
    light -= np.median(light[::4, ::4])
    return float(-light.min() / max(float(light.max()), 1e-9))


def are_exchanged(ratios: Sequence[float]) -> bool:
    """Whether fan on and off are exchanged in most pairs, by `ratios` of light in off alone to on alone."""
    return len(ratios) > 0 and float(np.median(ratios)) > _TIMES
