"""The fields of `workbench.pages.scan_settings` in a form."""

from __future__ import annotations

from core.scan.method import Method
from workbench.language import tr
from workbench.pages.channels import add_channel
from workbench.pages.stripes import add_stripe
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm


def add_scan_settings(form: SettingsForm) -> None:
    """Add method, cut, stripes and "channel" to a form."""
    methods = [
        (Method.NETWORK.value, tr("Network")),
        (Method.THREE_CROSSINGS.value, tr("Three crossings a frame")),
    ]
    form.add_choice(
        "method", tr("Method"), methods,
        tr("Network: all frames adjusted together, the most accurate. Three crossings: each frame by itself."),
    )  # fmt: skip
    form.add_number(
        "sigma_cut_mm",
        tr("Largest σ"),
        NumberRange(0.001, 10.0, decimals=3, step=0.01, unit="mm"),
        tr("Points with a larger standard uncertainty of depth are left out."),
    )
    add_stripe(form, tr("Width and contrast of the stripes are taken from the pictures, for each laser."))
    add_channel(form)
