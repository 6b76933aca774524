"""How a scan is measured, as the fields of a form, and back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from core.files.options import Options
from core.image.stripe import StripeSettings
from core.scan.scan_look import ScanLook

USUAL_STRIPE = StripeSettings(6.0, 60.0)
"""Where width and contrast start when they are to be given and nothing has been measured yet."""


def values_of(options: Options, look: ScanLook | None) -> dict[str, Any]:
    """The fields; width and contrast as they were found where they are found automatically."""
    stripe = _stripe(options, look)
    return {
        "method": options.method,
        "sigma_cut_mm": options.sigma_cut_mm,
        "automatic": options.stripe is None,
        "width_px": stripe.width_px,
        "contrast": stripe.contrast,
    }


def changed_options(options: Options, look: ScanLook | None, field: str, value: Any) -> Options:
    """The options with one field changed; InputError or ValueError if it cannot be so."""
    stripe = _stripe(options, look)
    if field == "automatic":
        return replace(options, stripe=None if value else stripe)
    if field in ("width_px", "contrast"):
        return replace(options, stripe=replace(stripe, **{field: float(value)}))
    return replace(options, **{field: value})


def _stripe(options: Options, look: ScanLook | None) -> StripeSettings:
    """As given, or as the last measurement found it."""
    found = look.stripe if look is not None else None
    usual = StripeSettings(round(found.width_px, 1), round(found.contrast)) if found is not None else USUAL_STRIPE
    return options.stripe or usual
