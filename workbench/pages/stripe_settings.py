"""Width and contrast of the stripes as settings of a page: found, or given."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from core.image.stripes.stripe import USUAL_STRIPE, StripeSettings

FIELDS = ("automatic", "width_px", "contrast")
"""Keys of the settings; "automatic": taken from the pictures."""


def stripe_values(given: StripeSettings | None, found: StripeSettings | None) -> dict[str, Any]:
    """FIELDS: as `given`, or as they were `found` where they are found automatically."""
    stripe = _shown(given, found)
    return {"automatic": given is None, "width_px": stripe.width_px, "contrast": stripe.contrast}


def changed_stripe(
    given: StripeSettings | None, found: StripeSettings | None, field: str, value: Any
) -> StripeSettings | None:
    """What is given after one of FIELDS was changed; ValueError if it cannot be so."""
    stripe = _shown(given, found)
    if field == "automatic":
        return None if value else stripe
    return replace(stripe, **{field: float(value)})


def _shown(given: StripeSettings | None, found: StripeSettings | None) -> StripeSettings:
    if given is not None:
        return given
    return USUAL_STRIPE if found is None else StripeSettings(round(found.width_px, 1), round(found.contrast))
