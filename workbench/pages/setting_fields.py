"""Fields of a form for the settings of a step, from the table of settings."""

from __future__ import annotations

from core.settings.options import settings_of
from core.settings.setting import Choice, Number, Row, Setting, Values, rows_within
from workbench.language import tr
from workbench.pages.settings import AUTOMATIC
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm


def add_settings(form: SettingsForm, step: str) -> None:
    """Add a field for each setting of a step that has a title; of those of a stripe, also whether it is found."""
    for row in settings_of(step):
        if isinstance(row.setting.kind, Values) and row.setting.title:
            form.add_check(AUTOMATIC, tr(row.setting.title), tr(row.setting.help))
        for one in rows_within(row):
            if one.setting.title:
                _add(form, one, one.setting)


def set_stripe_editable(form: SettingsForm, automatic: bool) -> None:
    """Let width and contrast be edited where they are given."""
    why = tr("Found automatically; take away the tick above to give it.")
    for key in ("width_px", "contrast"):
        form.set_editable(key, not automatic, why)


def _add(form: SettingsForm, row: Row, one: Setting) -> None:
    title, help = tr(one.title), tr(one.help)
    if isinstance(one.kind, Number):
        kind = one.kind
        allowed = NumberRange(kind.least, kind.largest, kind.decimals, kind.step, tr(kind.unit))
        form.add_number(row.key, title, allowed, help)
    elif isinstance(one.kind, Choice):
        values = (getattr(value, "value", value) for value in one.kind.values)
        form.add_choice(row.key, title, list(zip(values, map(tr, one.kind.shown), strict=True)), help)
    else:
        form.add_check(row.key, title, help)
