"""What a technician tells of a stripe: its width and contrast."""

from __future__ import annotations

import math
from dataclasses import dataclass

WIDTH_IN_SIGMA = 4.0
"""The visible width of a laser stripe, where it has fallen to 1/e² of its height, in σ."""
FILTER_IN_SIGMA = 1.4
"""Filter over stripe σ: within 3 % of the Cramér–Rao bound under shot noise, and blunt to too small a width."""
_SMALLEST_FILTER_PX = 1.2  # sampled Gaussian derivatives alias below


@dataclass(frozen=True, slots=True)
class StripeSettings:
    """What a technician can say of a stripe by looking at it.

    Parameters
    ----------
    width_px
        Its visible width in pixels: from where the light rises out of the background to where it is gone. For a
        Gaussian section of σ = s this is the laser trade's 1/e² width, 4 s.
    contrast
        Height of a stripe above its background, in grey levels of the picture, where it is rather faint. Stripes are
        found from about a third of it.
    """

    width_px: float
    contrast: float

    def __post_init__(self) -> None:
        for name in ("width_px", "contrast"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}, not a positive number")

    @property
    def stripe_px(self) -> float:
        """σ of the stripe's cross-section in pixels."""
        return self.width_px / WIDTH_IN_SIGMA

    @property
    def filter_px(self) -> float:
        """σ of the Gaussian filter in pixels."""
        return filter_for(self.stripe_px)


def filter_for(stripe_px: float) -> float:
    """σ in pixels of the Gaussian filter for a stripe of σ `stripe_px`."""
    return max(FILTER_IN_SIGMA * stripe_px, _SMALLEST_FILTER_PX)
