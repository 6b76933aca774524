"""Width and contrast of the stripes, found or given, in a form of a page."""

from __future__ import annotations

from workbench.language import tr
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm


def add_stripe(form: SettingsForm, automatic: str) -> None:
    """Add the fields of `workbench.pages.stripe_settings` to a form; `automatic` says what the first of them does."""
    form.add_check("automatic", tr("Stripe found automatically"), automatic)
    form.add_number(
        "width_px",
        tr("Stripe width"),
        NumberRange(1.0, 200.0, decimals=1, step=0.5, unit="px"),
        tr("From where the light rises out of the background to where it is gone."),
    )
    form.add_number(
        "contrast",
        tr("Stripe contrast"),
        NumberRange(1.0, 65535.0, decimals=0, step=5.0, unit=tr("grey levels")),
        tr("Height above the background where the stripe is rather faint."),
    )


def set_stripe_editable(form: SettingsForm, automatic: bool) -> None:
    """Let width and contrast be edited where they are given."""
    why = tr("Found automatically; take away the tick above to give it.")
    for key in ("width_px", "contrast"):
        form.set_editable(key, not automatic, why)
