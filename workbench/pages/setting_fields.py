"""Fields of a form for the settings of a step, from the table of settings."""

from __future__ import annotations

from core.messages import capital
from core.settings.options import settings_of
from core.settings.rig import RIG
from core.settings.setting import Choice, Number, Setting, Values, rows_within
from workbench.language import tr
from workbench.pages.settings import AUTOMATIC
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm


def add_settings(form: SettingsForm, step: str) -> None:
    """Add a field for each setting of a step that has a title to a form; a stripe also gets "automatic"."""
    for row in settings_of(step):
        if isinstance(row.setting.kind, Values) and row.setting.title:
            form.add_check(AUTOMATIC, tr(row.setting.title), tr(row.setting.help))
        for one in rows_within(row):
            if one.setting.title:
                add_setting(form, one.key, one.setting)


def add_rig_settings(form: SettingsForm, table: str) -> None:
    """Add a field for each setting in the table `table` of rig.toml to a form."""
    for key, one in RIG[table].items():
        add_setting(form, key, one)


def set_stripe_editable(form: SettingsForm, automatic: bool) -> None:
    """Enable the fields for a stripe's width and contrast, unless these are found automatically."""
    why = tr("Found automatically; take away the tick above to give it.")
    for key in ("width_px", "contrast"):
        form.set_editable(key, not automatic, why)


def add_setting(form: SettingsForm, key: str, one: Setting) -> None:
    """Add the field for one setting to a form."""
    title, help = capital(tr(one.title)), tr(one.help)
    if isinstance(one.kind, Number):
        kind = one.kind
        none = tr(kind.none) if kind.none else None
        allowed = NumberRange(kind.least, kind.largest, kind.decimals, kind.step, tr(kind.unit), none, kind.first)
        form.add_number(key, title, allowed, help)
    elif isinstance(one.kind, Choice):
        values = (getattr(value, "value", value) for value in one.kind.values)
        form.add_choice(key, title, list(zip(values, map(tr, one.kind.shown), strict=True)), help)
    else:
        form.add_check(key, title, help)
