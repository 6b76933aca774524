"""The settings of each kind of feature, one line of help each."""

from __future__ import annotations

from collections.abc import Sequence

from core.inspect.plan.feature_kind import ChoiceField, FormField, NumberField, TextField
from core.inspect.plan.feature_spec import FeatureSpec, Section
from core.inspect.plan.kinds import WIDEST_MM, results_of
from workbench.language import tr
from workbench.views.forms.form import SettingsForm

MOST_PX = 100_000.0


def add_limits(form: SettingsForm, spec: FeatureSpec) -> None:
    """Nominal value and permitted deviations of each result."""
    for result, kind in results_of(spec).items():
        unit = "°" if kind.quantity == "angle" else "mm"
        form.add_section(tr("Asked of the {result}", result=result) if spec.section is None else result)
        if kind.one_sided:
            _limit(form, "upper", result, tr("Tolerance"), unit, tr("It may be so large at most; empty: no verdict."))
            continue
        if not kind.numbered:
            _limit(form, "nominal", result, tr("Nominal value"), unit, tr("What it should be; empty: no verdict."))
        _limit(form, "lower", result, tr("Lower deviation"), unit, tr("Permitted below, as −0.1; empty: no limit."))
        _limit(form, "upper", result, tr("Upper deviation"), unit, tr("Permitted above, as 0.1; empty: no limit."))


def add_filters(form: SettingsForm) -> None:
    """Which points of the region are used."""
    form.add_section(tr("Which points are used"))
    form.add_number(
        "sigma_max_mm", tr("σ up to"), "mm", tr("Points with a larger standard uncertainty are left out."),
        minimum=0.0001, maximum=WIDEST_MM, decimals=4, step=0.01, none_text=tr("any"), first=0.1,
    )  # fmt: skip
    form.add_number(
        "margin_mm", tr("Margin at edges"), "mm", tr("Points so near to a plane face's edge are left out."),
        minimum=0.0, maximum=100.0, decimals=2, step=0.1,
    )  # fmt: skip
    form.add_number(
        "outliers", tr("Outliers beyond"), "σ", tr("Robust standard deviations from the fit; 4.685 is usual."),
        minimum=2.0, maximum=100.0, decimals=3, step=0.5,
    )  # fmt: skip
    form.add_number(
        "cell_mm", tr("Form over cells of"), "mm", tr("Noise is averaged over cells so wide; 0: single points."),
        minimum=0.0, maximum=100.0, decimals=2, step=0.5,
    )  # fmt: skip


def add_fields(form: SettingsForm, fields: Sequence[FormField]) -> None:
    """The settings that a kind of feature has for itself."""
    for one in fields:
        match one:
            case NumberField():
                form.add_number(
                    one.key, tr(one.label), one.unit, tr(one.help),
                    minimum=one.minimum, maximum=one.maximum, decimals=one.decimals, step=one.step,
                )  # fmt: skip
            case ChoiceField():
                form.add_choice(
                    one.key, tr(one.label), [(value, tr(text)) for value, text in one.choices], tr(one.help)
                )
            case TextField():
                form.add_text(one.key, tr(one.label), tr(one.help), placeholder=one.placeholder)


def add_line(form: SettingsForm, section: Section) -> None:
    """Where the cut is."""
    ends = (
        (tr("From"), tr("Where it begins; drag its end in the picture.")),
        (tr("To"), tr("Where it ends; drag its end in the picture.")),
    )
    for place, (title, help) in enumerate(ends if section.line_px is not None else ()):
        for axis, name in enumerate("uv"):
            form.add_number(
                f"line {place} {axis}", f"{title}, {name}", "px", help,
                minimum=-MOST_PX, maximum=MOST_PX, decimals=1, step=10.0,
            )  # fmt: skip


def add_cuts(form: SettingsForm, section: Section) -> None:
    """What is measured in the section."""
    kinds = [("height", tr("height")), ("distance", tr("distance")), ("radius", tr("radius"))]
    for place, cut in enumerate(section.cuts):
        form.add_section(tr("Measurement {number}", number=place + 1))
        form.add_text(f"cut {place} name", tr("Name"), tr("As it is called in the list and in the report."))
        form.add_choice(f"cut {place} kind", tr("What"), kinds, tr("Of what lies over the stretches below."))
        stretches = ("first",) if cut.kind == "radius" else ("first", "second")
        for stretch in stretches:
            title = tr("Stretch") if cut.kind == "radius" else tr("1st stretch")
            title = title if stretch == "first" else tr("2nd stretch")
            for end, words in enumerate((tr("from"), tr("to"))):
                form.add_number(
                    f"cut {place} {stretch} {end}", f"{title}, {words}", "mm", tr("Position along the cut."),
                    minimum=-WIDEST_MM, maximum=WIDEST_MM, decimals=2, step=1.0,
                )  # fmt: skip


def _limit(form: SettingsForm, side: str, result: str, label: str, unit: str, help: str) -> None:
    form.add_number(
        f"limits {side} {result}", label, unit, help,
        minimum=-WIDEST_MM, maximum=WIDEST_MM, decimals=4, step=0.01, none_text=tr("none"), first=0.0,
    )  # fmt: skip
