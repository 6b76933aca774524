"""Width and contrast of the stripes to be found."""

from __future__ import annotations

import math
from dataclasses import dataclass

from core.errors import WrongValue
from core.messages import Message

WIDTH_IN_SIGMA = 4.0
"""Visible width of a laser stripe in its σ: the trade's 1/e² width of a Gaussian."""
FILTER_IN_SIGMA = 1.4
"""Filter σ over stripe σ: within 3 % of the Cramér–Rao bound under shot noise from 1.3 to 1.5, and insensitive to a
width stated too small (measured on rendered stripes)."""
CONTRAST_QUANTILE = 0.2
"""Quantile of the heights along all stripes that is taken as their contrast, rather faint:
tests/image/stripes/test_extraction.py (settings are chosen) holds it."""
PIXEL_VARIANCE = 1 / 12
"""Variance in px² that integrating the light over a pixel adds to a cross-section."""
_SMALLEST_FILTER_PX = 1.2  # filter σ; sampled Gaussian derivatives alias below


@dataclass(frozen=True, slots=True)
class StripeSettings:
    """Visible width and contrast of the stripes in a picture, as a technician can read them off.

    Parameters
    ----------
    width_px
        Its visible width in pixels: from where the light rises out of the background to where it is gone. For a
        Gaussian section of σ = s this is the laser trade's 1/e² width, 4 s.
    contrast
        Height of a stripe above its background, in grey levels of the picture, where it is rather faint. Stripes are
        found from about a third of it.

    Raises
    ------
    WrongValue
        If either is not a positive number.
    """

    width_px: float
    contrast: float

    def __post_init__(self) -> None:
        for name in ("width_px", "contrast"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise WrongValue(
                    Message("stripes.not_positive", "{name} is {value}, not a positive number", name=name, value=value)
                )

    @property
    def stripe_px(self) -> float:
        """Gaussian σ in px of the stripe's cross-section."""
        return self.width_px / WIDTH_IN_SIGMA

    @property
    def filter_px(self) -> float:
        """Gaussian σ in px of the filter that suits the stripe."""
        return filter_for(self.stripe_px)


USUAL_STRIPE = StripeSettings(6.0, 60.0)
"""What is looked for where nothing is given and nothing was found."""


def filter_for(stripe_px: float) -> float:
    """Compute σ in px of the Gaussian filter that suits a stripe of Gaussian σ `stripe_px`."""
    return max(FILTER_IN_SIGMA * stripe_px, _SMALLEST_FILTER_PX)
