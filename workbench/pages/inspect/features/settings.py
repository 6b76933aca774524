"""What stands in the form of a feature beside its regions: a section a group of settings, a line of help each."""

from __future__ import annotations

from collections.abc import Iterator

from core.inspect.plan.feature_kind import ChoiceField, FormField, NumberField, ResultKind, TextField
from core.inspect.plan.feature_spec import Cut, FeatureSpec
from core.inspect.plan.kinds import FILTERS, WIDEST_MM, kind_of, results_of
from core.messages import label
from workbench.language import tr
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm

MOST_PX = 100_000.0
"""Furthest place in a picture in pixels that can be entered, to either side."""

_LINE = tuple(
    NumberField(f"line {place} {axis}", title, help, "px", -MOST_PX, MOST_PX, 1, 10.0)
    for place, help, titles in (
        (0, label("Where it begins; drag its end in the picture."), (label("From, u"), label("From, v"))),
        (1, label("Where it ends; drag its end in the picture."), (label("To, u"), label("To, v"))),
    )
    for axis, title in enumerate(titles)
)
"""Where a section is."""

_ENDS = {
    "first": (label("1st stretch, from"), label("1st stretch, to")),
    "second": (label("2nd stretch, from"), label("2nd stretch, to")),
    "only": (label("Stretch, from"), label("Stretch, to")),
}


def add_settings(form: SettingsForm, spec: FeatureSpec) -> None:
    """All settings of a feature."""
    for title, fields in _sections(spec):
        if title:
            form.add_section(title)
        for one in fields:
            _add(form, one)


def _sections(spec: FeatureSpec) -> Iterator[tuple[str, tuple[FormField, ...]]]:
    """Title ("" for none) and fields of each group."""
    kind, section = kind_of(spec), spec.section
    yield "", (*(_LINE if section is not None and section.line_px is not None else ()), *kind.fields)
    for place, cut in enumerate(section.cuts if section is not None else ()):
        yield tr("Measurement {number}", number=place + 1), _cut(f"cut {place}", cut)
    for result, given in results_of(spec).items():
        yield tr("Asked of the {result}", result=result) if section is None else result, _limits(result, given)
    if not kind.made_of:
        yield tr("Which points are used"), FILTERS


def _cut(key: str, cut: Cut) -> tuple[FormField, ...]:
    """What is measured in a section."""
    stretches = {"first": "only"} if cut.kind == "radius" else {"first": "first", "second": "second"}
    kinds = (("height", label("height")), ("distance", label("distance")), ("radius", label("radius")))
    return (
        TextField(f"{key} name", label("Name"), label("As it is called in the list and in the report.")),
        ChoiceField(f"{key} kind", label("What"), label("Of what lies over the stretches below."), kinds),
        *(
            NumberField(
                f"{key} {stretch} {end}", title, label("Position along the cut."), "mm", -WIDEST_MM, WIDEST_MM, 2, 1.0
            )
            for stretch, named in stretches.items()
            for end, title in enumerate(_ENDS[named])
        ),
    )


def _limits(result: str, kind: ResultKind) -> tuple[FormField, ...]:
    """Nominal value and permitted deviations."""
    asked = {
        "nominal": (label("Nominal value"), label("What it should be; empty: no verdict.")),
        "lower": (label("Lower deviation"), label("Permitted below, as −0.1; empty: no limit.")),
        "upper": (label("Upper deviation"), label("Permitted above, as 0.1; empty: no limit.")),
    }
    if kind.one_sided:
        asked = {"upper": (label("Tolerance"), label("It may be so large at most; empty: no verdict."))}
    elif kind.numbered:
        del asked["nominal"]
    unit = "°" if kind.quantity == "angle" else "mm"
    return tuple(
        NumberField(
            f"limits {side} {result}", title, help, unit, -WIDEST_MM, WIDEST_MM, 4, 0.01, none=label("none"), first=0.0
        )
        for side, (title, help) in asked.items()
    )


def _add(form: SettingsForm, one: FormField) -> None:
    match one:
        case NumberField():
            form.add_number(
                one.key,
                tr(one.label),
                NumberRange(
                    one.minimum,
                    one.maximum,
                    decimals=one.decimals,
                    step=one.step,
                    unit=one.unit,
                    none_text=tr(one.none) if one.none else None,
                    first=one.first,
                ),
                tr(one.help),
            )
        case ChoiceField():
            form.add_choice(one.key, tr(one.label), [(value, tr(text)) for value, text in one.choices], tr(one.help))
        case TextField():
            form.add_text(one.key, tr(one.label), tr(one.help), placeholder=one.placeholder)
