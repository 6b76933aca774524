"""How a scan is measured, as settings of a page: its method, its cut, its stripes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from core.files.recording.options import Options
from core.image.stripes.stripe import StripeSettings
from workbench.pages.stripe_settings import FIELDS, changed_stripe, stripe_values


def values_of(options: Options, found: StripeSettings | None) -> dict[str, Any]:
    """The fields; width and contrast as they were `found` where they are found automatically."""
    stripe = stripe_values(options.stripe, found)
    return {"method": str(options.method), "sigma_cut_mm": options.sigma_cut_mm, **stripe}


def changed_options(options: Options, found: StripeSettings | None, field: str, value: Any) -> Options:
    """The options with one field changed; InputError or ValueError if it cannot be so."""
    if field in FIELDS:
        return replace(options, stripe=changed_stripe(options.stripe, found, field, value))
    return replace(options, **{field: value})
