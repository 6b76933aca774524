"""The settings of a step as fields of a form: what they are, and what the options are after one was changed."""

from __future__ import annotations

from dataclasses import replace
from enum import Enum
from typing import Any

from core.image.stripes.stripe import USUAL_STRIPE, StripeSettings
from core.settings.options import STRIPE, Options, settings_of
from core.settings.setting import Row, rows_within

AUTOMATIC = "automatic"
"""The field beside width and contrast of the stripes: they are taken from the pictures."""


def fields_of(step: str) -> dict[str, Row]:
    """List the settings of a step that have a field, by key; a stripe's width and contrast have one each."""
    within = (one for row in settings_of(step) for one in rows_within(row))
    return {one.key: one for one in within if one.setting.title}


def values_of(step: str, options: Options, found: StripeSettings | None = None) -> dict[str, Any]:
    """Convert a step's options to the fields of its form; `found` gives width and contrast if automatic."""
    values: dict[str, Any] = {}
    for row in settings_of(step):
        if row.setting.kind is STRIPE:
            given = row.value(options)
            stripe = _shown(given, found)
            values |= {AUTOMATIC: given is None, "width_px": stripe.width_px, "contrast": stripe.contrast}
    others = {key: one.value(options) for key, one in fields_of(step).items() if key not in values}
    return {**{key: one.value if isinstance(one, Enum) else one for key, one in others.items()}, **values}


def changed_options(step: str, options: Options, found: StripeSettings | None, field: str, value: Any) -> Options:
    """Return the options with one field of a step's form changed; InputError or ValueError if impossible."""
    for row in settings_of(step):
        if row.setting.kind is STRIPE and field in (AUTOMATIC, *STRIPE.settings):
            stripe = _shown(row.value(options), found)
            if field == AUTOMATIC:
                return row.changed(options, None if value else stripe)
            return row.changed(options, replace(stripe, **{field: float(value)}))
    return fields_of(step)[field].changed(options, value)


def _shown(given: StripeSettings | None, found: StripeSettings | None) -> StripeSettings:
    if given is not None:
        return given
    return USUAL_STRIPE if found is None else StripeSettings(round(found.width_px, 1), round(found.contrast))
