"""The settings of each kind of feature, one line of help each."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from core.inspect.feature_spec import FeatureSpec, Section
from workbench.pages import inspect_feature_values as fields
from workbench.views.forms import SettingsForm

WIDEST = 5000.0
MOST_PX = 100_000.0


def add_limits(form: SettingsForm, spec: FeatureSpec) -> None:
    """Nominal value and permitted deviations of each result."""
    unit = "°" if spec.kind == "angle" else "mm"
    for result in dict.fromkeys(spec.results):
        form.add_section(_tr("Asked of the {0}").format(result) if spec.section is None else result)
        if fields.one_sided(spec, result):
            _limit(form, "upper", result, _tr("Tolerance"), unit, _tr("It may be so large at most; empty: no verdict."))
            continue
        if spec.kind != "steps":
            _limit(form, "nominal", result, _tr("Nominal value"), unit, _tr("What it should be; empty: no verdict."))
        _limit(form, "lower", result, _tr("Lower deviation"), unit, _tr("Permitted below, as −0.1; empty: no limit."))
        _limit(form, "upper", result, _tr("Upper deviation"), unit, _tr("Permitted above, as 0.1; empty: no limit."))


def add_filters(form: SettingsForm) -> None:
    """Which points of the region are used."""
    form.add_section(_tr("Which points are used"))
    form.add_number(
        "sigma_max_mm", _tr("σ up to"), "mm", _tr("Points with a larger standard uncertainty are left out."),
        minimum=0.0001, maximum=WIDEST, decimals=4, step=0.01, none_text=_tr("any"), first=0.1,
    )  # fmt: skip
    form.add_number(
        "margin_mm", _tr("Margin at edges"), "mm", _tr("Points so near to a plane face's edge are left out."),
        minimum=0.0, maximum=100.0, decimals=2, step=0.1,
    )  # fmt: skip
    form.add_number(
        "outliers", _tr("Outliers beyond"), "σ", _tr("Robust standard deviations from the fit; 4.685 is usual."),
        minimum=2.0, maximum=100.0, decimals=3, step=0.5,
    )  # fmt: skip
    form.add_number(
        "cell_mm", _tr("Form over cells of"), "mm", _tr("Noise is averaged over cells so wide; 0: single points."),
        minimum=0.0, maximum=100.0, decimals=2, step=0.5,
    )  # fmt: skip


def add_steps(form: SettingsForm) -> None:
    """Over what the heights count, and what they should be."""
    over = [("lowest", _tr("the lowest")), ("previous", _tr("the previous"))]
    form.add_choice("over", _tr("Heights over"), over, _tr("From which level each height is measured."))
    form.add_text(
        "heights", _tr("Nominal heights in mm"), _tr("From the lowest up, with semicolons; empty: no verdict."),
        placeholder="10; 20; 30",
    )  # fmt: skip


def add_deviation(form: SettingsForm) -> None:
    """The nominal surface and how it is laid on the scan."""
    form.add_text("nominal", _tr("Nominal surface"), _tr("STL file in mm, in the project's folder or elsewhere."))
    ways = [
        ("best fit", _tr("best fit")),
        ("frame", _tr("part coordinates")),
        ("as measured", _tr("as measured")),
    ]
    form.add_choice("align", _tr("Aligned by"), ways, _tr("How the nominal surface is laid on the scan."))
    form.add_number(
        "tolerance_mm", _tr("Colours up to ±"), "mm", _tr("Marks + ++ +++ are its quarters, ! lies beyond."),
        minimum=0.0001, maximum=WIDEST, decimals=4, step=0.01,
    )  # fmt: skip
    form.add_number(
        "reach_mm", _tr("Part within"), "mm", _tr("Points farther off belong to a table or a clamp."),
        minimum=0.01, maximum=WIDEST, decimals=2, step=0.5,
    )  # fmt: skip


def add_section(form: SettingsForm, section: Section) -> None:
    """Where the cut is, and how wide."""
    ends = (
        (_tr("From"), _tr("Where it begins; drag its end in the picture.")),
        (_tr("To"), _tr("Where it ends; drag its end in the picture.")),
    )
    for place, (title, help) in enumerate(ends if section.line_px is not None else ()):
        for axis, name in enumerate("uv"):
            form.add_number(
                f"line {place} {axis}", f"{title}, {name}", "px", help,
                minimum=-MOST_PX, maximum=MOST_PX, decimals=1, step=10.0,
            )  # fmt: skip
    form.add_number(
        "half_width_mm", _tr("Half width"), "mm", _tr("Points so near to the cut are taken for points in it."),
        minimum=0.01, maximum=WIDEST, decimals=2, step=0.1,
    )  # fmt: skip
    form.add_number(
        "step_mm", _tr("Profile in steps of"), "mm", _tr("The profile drawn is averaged over so much."),
        minimum=0.01, maximum=WIDEST, decimals=2, step=0.1,
    )  # fmt: skip


def add_cuts(form: SettingsForm, section: Section) -> None:
    """What is measured in the section."""
    kinds = [("height", _tr("height")), ("distance", _tr("distance")), ("radius", _tr("radius"))]
    for place, cut in enumerate(section.cuts):
        form.add_section(_tr("Measurement {0}").format(place + 1))
        form.add_text(f"cut {place} name", _tr("Name"), _tr("As it is called in the list and in the report."))
        form.add_choice(f"cut {place} kind", _tr("What"), kinds, _tr("Of what lies over the stretches below."))
        stretches = ("first",) if cut.kind == "radius" else ("first", "second")
        for stretch in stretches:
            title = _tr("Stretch") if cut.kind == "radius" else _tr("1st stretch")
            title = title if stretch == "first" else _tr("2nd stretch")
            for end, words in enumerate((_tr("from"), _tr("to"))):
                form.add_number(
                    f"cut {place} {stretch} {end}", f"{title}, {words}", "mm", _tr("Position along the cut."),
                    minimum=-WIDEST, maximum=WIDEST, decimals=2, step=1.0,
                )  # fmt: skip


def _limit(form: SettingsForm, side: str, result: str, label: str, unit: str, help: str) -> None:
    form.add_number(
        f"limits {side} {result}", label, unit, help,
        minimum=-WIDEST, maximum=WIDEST, decimals=4, step=0.01, none_text=_tr("none"), first=0.0,
    )  # fmt: skip


def _tr(text: str) -> str:
    return QCoreApplication.translate("Inspect", text)
