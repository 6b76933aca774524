"""The channel of colour pictures in which a laser is looked at, as a choice in a form."""

from __future__ import annotations

from core.acquire.channel import CHANNELS
from core.image.channel_names import CHANNEL_NAMES
from core.messages import capital
from workbench.language import text_of, tr
from workbench.views.forms.form import SettingsForm


def add_channel(form: SettingsForm) -> None:
    """Add the field "channel" to a form: in which colour channel the laser is looked for; "" is automatic."""
    choices = [("", tr("Found automatically")), *((name, capital(text_of(CHANNEL_NAMES[name]))) for name in CHANNELS)]
    form.add_choice(
        "channel", tr("Colour"), choices,
        tr("What the laser's light is looked for in, in colour pictures: one channel, or a difference of two, which is "
           "free of what is grey or white."),
    )  # fmt: skip
