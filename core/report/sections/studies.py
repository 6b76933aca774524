"""The section of studies, from what study.json says: figures, tables, run chart, notes and the verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, Spacer

from core.messages import from_json, label
from core.report.content import ReportContent
from core.report.layout.blocks import Heading, Limits, OnOnePage, Picture, figures, heads, ruled_table, section
from core.report.layout.style import TEXT_WIDTH, ReportLook
from core.report.wording import decimals_of, study_name
from core.states import DECISIONS, SPREAD, VERDICT

TITLES = {
    "repeats": label("Repeats of {name}"),
    "type1": label("Type-1 gauge study"),
    "grr": label("Gauge R&R (ANOVA)"),
    "series": label("Series of {name}"),
    "acceptance": label("Acceptance check after the pattern of VDI/VDE 2634-2"),
}
"""Heading of each kind of study."""

SOURCES = (
    label("gauge R&R"), label("repeatability"), label("reproducibility"), label("operators"), label("interaction"),
    label("parts"), label("total"),
)  # fmt: skip
"""Of variation, as study.json has them."""

Study = Mapping[str, Any]


def studies(
    look: ReportLook, content: ReportContent, pictures: Mapping[str, ImageReader], limits: Limits
) -> list[Flowable]:
    """Every study, each with a heading of its own."""
    parts: list[Flowable] = []
    for number, study in enumerate(content.studies):
        title = look.words(TITLES[study["kind"]], **_named(look, study))
        body: list[Flowable] = [
            Heading(look, f"study-{number}", title, "small_strong", 1),
            *_parts(look, study),
        ]
        if f"study-{number}" in pictures:
            body += [Spacer(0, 2 * mm), Picture(pictures[f"study-{number}"], limits.picture_scale)]
        body += [*look.bullets(tuple(look.words.known(from_json(note)) for note in study["notes"])), Spacer(0, 2 * mm)]
        parts.append(OnOnePage(body) if number else section(look, "studies", "Studies", body))
    return parts


def study_values(study: Study) -> Sequence[float]:
    """The values of a run chart, in the order of measuring; none where a study has no such order."""
    if study["kind"] == "repeats":
        return [scan["value"] for scan in study["scans"]]
    if study["kind"] == "series":
        return [part["value"] for part in study["parts"]]
    return study["values"] if study["kind"] == "type1" else []


def study_lines(study: Study) -> dict[str, float]:
    """The lines of a run chart by what they are called; only those that are known."""
    if study["kind"] == "repeats":
        run = study["run_chart"] or {}
        lines = {label("mean"): study["mean"], label("nominal"): study["nominal"]}
        lines |= {label("upper control limit"): run.get("upper"), label("lower control limit"): run.get("lower")}
    elif study["kind"] == "series":
        lines = {label("mean"): study["mean"]}
        lines |= {label("upper limit"): study["upper_limit"], label("lower limit"): study["lower_limit"]}
    else:
        tenth = 0.1 * study["tolerance_width"]
        lines = {label("mean"): study["mean"], label("reference value"): study["reference"]}
        lines |= {
            label("reference + 0.1 T"): study["reference"] + tenth,
            label("reference − 0.1 T"): study["reference"] - tenth,
        }
    return {name: value for name, value in lines.items() if value is not None and math.isfinite(value)}


def study_charts(study: Study) -> dict[str, Mapping[str, Any]]:
    """The control charts of a series, by what their points are called; none where they are too few for limits."""
    if study["kind"] != "series" or study["chart"] is None:
        return {}
    names = (label("single value"), label("moving range")) if study["subgroup_size"] == 1 else (label("X̄"), label("s"))
    return dict(zip(names, (study["chart"], study["spread_chart"]), strict=True))


def _named(look: ReportLook, study: Study) -> dict[str, str]:
    return {"name": study_name(study["characteristic"], look.words)} if study["kind"] in ("repeats", "series") else {}


def _parts(look: ReportLook, study: Study) -> list[Flowable]:
    """Figures and tables of one study."""
    verdict = {look.words(VERDICT): look.words(DECISIONS[study["verdict"]])} if study["verdict"] else {}
    match study["kind"]:
        case "repeats":
            return [figures(look, _repeats(look, study) | verdict)]
        case "type1":
            return [figures(look, _type1(look, study) | verdict)]
        case "series":
            return [figures(look, _series(look, study) | verdict)]
        case "grr":
            return [_components(look, study), Spacer(0, 1 * mm), figures(look, _grr(look, study) | verdict)]
        case _:
            return [_quantities(look, study)]


def _repeats(look: ReportLook, study: Study) -> dict[str, str]:
    spread, unit, words = study["std"], study["unit"], look.words
    decimals = max(decimals_of(spread or math.nan), 3)
    budget = study["budget_of_mean"]
    lengths = {
        words("mean"): study["mean"],
        words("error"): study["error"],
        words("RMSE"): study["rmse"],
        words(SPREAD): spread,
        words("largest error"): study["largest_error"],
        words("U of the mean"): budget["U"],
    }
    return {words("n"): f"{study['n']}"} | _lengths(look, lengths, decimals, unit)


def _type1(look: ReportLook, study: Study) -> dict[str, str]:
    decimals, unit, words = max(decimals_of(study["s"] or math.nan), 3), study["unit"], look.words
    lengths = {
        words("reference value"): study["reference"],
        words("T"): study["tolerance_width"],
        words("mean"): study["mean"],
        words(SPREAD): study["s"],
        words("bias"): study["bias"],
    }
    ratios = {words("Cg"): _ratio(look, study["cg"]), words("Cgk"): _ratio(look, study["cgk"])}
    t_test = {words("p"): "" if study["p"] is None else words.general(float(f"{study['p']:.2g}"))}
    return {words("n"): f"{study['n']}"} | _lengths(look, lengths, decimals, unit) | ratios | t_test


def _series(look: ReportLook, study: Study) -> dict[str, str]:
    decimals, unit, words = max(decimals_of(study["s"] or math.nan), 3), study["unit"], look.words
    limits = {
        words("lower limit"): study["lower_limit"],
        words("upper limit"): study["upper_limit"],
        words("mean"): study["mean"],
        words(SPREAD): study["s"],
    }
    known = {name: value if value is not None and math.isfinite(value) else None for name, value in limits.items()}
    found = {words("n"): f"{study['n']}"} | _lengths(look, known, decimals, unit)
    for name, index in study["indices"].items():
        low, high = (words.fixed(end, 2) for end in index["interval"])
        said = words("{value} ({low} to {high})", value=words.fixed(index["value"], 2), low=low, high=high)
        found[words("{index} (95 %)", index=name)] = said
    if study["share_of_u"] is not None:
        low, high = (words.fixed(100 * share, 1) for share in study["share_of_u"])
        found[words("measurement in s²")] = words("{low} to {high} %", low=low, high=high)
    return found


def _grr(look: ReportLook, study: Study) -> dict[str, str]:
    words = look.words
    shares = {
        words("%GRR of the total"): study["grr_of_total"]["value"],
        words("%GRR of T"): study["grr_of_tolerance"]["value"],
    }
    shown = {name: f"{words.fixed(100 * value, 1)} %" for name, value in shares.items() if value is not None}
    categories = study["ndc"]["categories"]
    return shown | {words("ndc"): "∞" if categories is None else f"{categories}"}


def _components(look: ReportLook, study: Study) -> Flowable:
    words = look.words
    sigma = look.text(f"σ, {study['unit']}", "head_number")
    rows: list[list[Flowable]] = [
        [
            look.say("Source of variation", "head"),
            sigma,
            *heads(look, "share of σ², %", "of the total, %", "of T, %", numbers=(0, 1, 2)),
        ]
    ]
    for one in study["components"]:
        percent = (one["contribution"], one["of_total"], one["of_tolerance"])
        rows.append(
            [
                look.text(words.known(one["source"]), "small"),
                look.text(words.fixed(one["sigma"], max(decimals_of(one["sigma"]), 3)), "number"),
                *(look.text("" if value is None else words.fixed(100 * value, 1), "number") for value in percent),
            ]
        )
    return ruled_table(rows, [TEXT_WIDTH * share for share in (0.32, 0.17, 0.17, 0.17, 0.17)])


def _ratio(look: ReportLook, value: float) -> str:
    return "∞" if math.isinf(value) else look.words.fixed(value, 2)


def _quantities(look: ReportLook, study: Study) -> Flowable:
    words = look.words
    rows: list[list[Flowable]] = [
        heads(look, "Quantity", "positions", "largest error, mm", "at", "limit, mm", VERDICT, numbers=(1, 2, 4))
    ]
    rows += [
        [
            look.text(words.known(from_json(one["title"])), "small"),
            look.text(f"{len(one['readings'])}", "number"),
            look.text(words.fixed(one["largest_error"], 4, signed=True), "number"),
            look.text(one["worst_position"], "small"),
            look.text("" if one["limit"] is None else words.general(one["limit"]), "number"),
            look.text(words(DECISIONS[one["verdict"]]), "small_strong"),
        ]
        for one in study["quantities"]
    ]
    table = ruled_table(rows, [TEXT_WIDTH * share for share in (0.32, 0.11, 0.16, 0.14, 0.11, 0.16)])
    table.setStyle([("LEFTPADDING", (place, 0), (place, -1), 6) for place in (3, 5)])
    return table


def _lengths(look: ReportLook, lengths: Mapping[str, float | None], decimals: int, unit: str) -> dict[str, str]:
    return {name: f"{look.words.fixed(value, decimals)} {unit}" for name, value in lengths.items() if value is not None}
